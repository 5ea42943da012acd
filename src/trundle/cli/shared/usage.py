"""Messages about a command line that cannot be parsed."""

from __future__ import annotations

import re
from collections.abc import Sequence

from cyclopts import CoercionError, CycloptsError, UnusedCliTokensError

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_WITH_UNIT = re.compile(rf"({_NUMBER})\s*(mm|cm|m|s|ms|Hz)")
_SCALE = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "s": 1.0, "ms": 1e-3, "Hz": 1.0}
_KINDS = {float: "a number", int: "an integer"}


def describe_usage(error: CycloptsError, arguments: Sequence[str]) -> tuple[str, str]:
    """Describe what is wrong with a command line, and how to get its help."""
    verb = " ".join(error.command_chain or ())
    see = f"See: trundle {verb} --help" if verb else "See: trundle --help"
    if isinstance(error, CoercionError):
        return _describe_value(error), see
    if isinstance(error, UnusedCliTokensError):
        return _describe_unused(list(error.unused_tokens or ()), list(arguments)), see
    return str(error).rstrip("."), see


def _describe_value(error: CoercionError) -> str:
    token, kind = error.token, _KINDS.get(error.target_type or object)
    if token is None or kind is None or token.keyword is None:
        return str(error).rstrip(".")
    found = _WITH_UNIT.fullmatch(token.value)
    message = f"{token.keyword} {token.value}: must be {kind}"
    if found is None:
        return message
    return f"{message}; write it without a unit, in metres, seconds or Hz: {float(found[1]) * _SCALE[found[2]]:g}"


def _describe_unused(unused: list[str], arguments: list[str]) -> str:
    first = arguments.index(unused[0]) if unused and unused[0] in arguments else 0
    start, end = first, first
    while start > 0 and re.fullmatch(_NUMBER, arguments[start - 1].strip(",")):
        start -= 1
    while end < len(arguments) and re.fullmatch(_NUMBER, arguments[end].strip(",")):
        end += 1
    given = [arguments[start - 1], *arguments[start:end]]
    if start > 0 and given[0].startswith("--") and len(given) > 2:
        numbers = ",".join(number.strip(",") for number in given[1:])
        return f"{' '.join(given)}: write numbers with commas, without spaces: {given[0]} {numbers}"
    return f"unexpected argument {' '.join(unused)!r}"
