"""`Remark`: what was not taken over as it is between Nav2's parameters and trundle's settings."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from trundle.files.yaml_config import Plain

RemarkKind: TypeAlias = Literal["changed", "no counterpart"]
"""Whether something was taken over with another meaning, or not at all."""


@dataclass(frozen=True, slots=True)
class Remark:
    """Says that the other side lacks a parameter of Nav2 or a setting of trundle, or takes it otherwise.

    Attributes:
        kind: "changed": it was taken over, but means something else; "no counterpart": it was left out.
        node: Nav2's node, such as `controller_server`; empty for a setting of trundle.
        name: The parameter, such as `FollowPath.max_lookahead_dist`, or the setting, such as `replan_margin`.
        value: Its value.
        text: What is done instead, and what to do where one can do something.
        line: Its line in the file, from 1; None where it is not in a file.
    """

    kind: RemarkKind
    node: str
    name: str
    value: Plain
    text: str
    line: int | None = None


def describe_remarks(remarks: Iterable[Remark]) -> list[str]:
    """Return a line for each remark of kind "changed", and one, by node, for each reason of the others."""
    given = list(remarks)
    lines = [_describe_change(remark) for remark in given if remark.kind == "changed"]
    groups: dict[tuple[str, str], list[Remark]] = {}
    for remark in given:
        if remark.kind == "no counterpart":
            groups.setdefault((remark.node, remark.text), []).append(remark)
    for (node, text), found in groups.items():
        names = ", ".join(remark.name for remark in found)
        lines.append(f"{node}: no counterpart: {names} ({text})" if node else f"no counterpart: {names} ({text})")
    return lines


def _describe_change(remark: Remark) -> str:
    where = "" if remark.line is None else f"line {remark.line}: "
    node = f"{remark.node}: " if remark.node else ""
    return f"{where}{node}{remark.name} = {_show(remark.value)}: {remark.text}"


def _show(value: Plain) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:g}"
    text = str(value)
    return text if len(text) <= 60 else f"{text[:57]}…"
