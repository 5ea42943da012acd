"""`Remark`: what was not taken over as it is between Nav2's parameters and trundle's settings."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from trundle.files.yaml_config import Plain

RemarkKind: TypeAlias = Literal["changed", "no counterpart"]
"""Whether something was taken over with another meaning, or not at all."""

ROS_OWN = "topics, frames, clocks and lifecycles"
"""Why most parameters have no counterpart."""


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
    """Return lines for people: what changes the motion, then what else means something else, then what is left out.

    Each remark of kind "changed" has a line, the others one for each reason. What is ROS's own is in every file and
    says nothing about the motion: one line counts it.
    """
    given = list(remarks)
    changed = sorted((remark for remark in given if remark.kind == "changed"), key=_rank)
    lines = [_describe_change(remark) for remark in changed]
    reasons: dict[str, dict[str, list[str]]] = {}
    for remark in given:
        if remark.kind == "no counterpart":
            reasons.setdefault(remark.text, {}).setdefault(remark.node, []).append(remark.name)
    own = sum(len(names) for names in reasons.pop(ROS_OWN, {}).values())
    for text, nodes in reasons.items():
        named = "; ".join(f"{node}: {', '.join(names)}" if node else ", ".join(names) for node, names in nodes.items())
        lines.append(f"no counterpart: {named} ({text})")
    return [*lines, f"left to ROS ({ROS_OWN}): {own} parameters"] if own else lines


def _rank(remark: Remark) -> int:
    """How much a parameter says about the motion: which controller, how fast, how the controller drives, the rest."""
    if remark.node == "controller_server":
        return 0 if remark.name.endswith(".plugin") else 2
    return {"velocity_smoother": 1, "planner_server": 3, "collision_monitor": 4}.get(remark.node, 5)


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
