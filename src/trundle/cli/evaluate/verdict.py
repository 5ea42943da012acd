"""What the verbs of an evaluation print at the end, and their exit code."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from cyclopts import Parameter

from trundle.cli.shared import output
from trundle.errors import InputError
from trundle.evaluation import Evaluation
from trundle.evaluation.report.summary import describe_missing
from trundle.evaluation.report.text import clean

_DURATION = re.compile(r"(?:(\d+)h)?(?:(\d+)m(?:in)?)?(?:(\d+(?:\.\d*)?)s)?")
_LONGEST_S = 3.6e6
TimeBudget = Annotated[
    str | None,
    Parameter(
        name="--time-budget",
        help="Wall time after which it stops, as 90s, 10m or 1h30m; the same command continues it. Left out: none.",
    ),
]

_HELP = (
    "What must hold, as 'success>=0.99' or 'success[planner=auto]>=0.99': the end of the 95 % interval is compared. "
    "Repeat it for several. Left out: what the suite requires."
)
Require = Annotated[tuple[str, ...], Parameter(name="--require", help=_HELP, negative="")]


def parse_time_budget(text: str | None) -> float | None:
    """Read the option `--time-budget` [s].

    Raises:
        InputError: If it is no time.
    """
    if text is None:
        return None
    found = _DURATION.fullmatch(text.strip())
    hours, minutes, seconds = (float(part or 0) for part in found.groups()) if found else (0.0, 0.0, 0.0)
    budget = 3600.0 * hours + 60.0 * minutes + seconds
    if not 0.0 < budget <= _LONGEST_S:
        raise InputError(f"--time-budget {text}: give a time of up to 1000 hours, as 90s, 10m or 1h30m")
    return budget


def give(
    evaluation: Evaluation,
    require: Sequence[str] | None = None,
    *,
    json: bool,
    figures: Mapping[str, float | None] | None = None,
    facts: Mapping[str, object] | None = None,
) -> int:
    """Write the report of an evaluation, and print what it says.

    Args:
        evaluation: The evaluation.
        require: What it is judged by; none means what its suite requires.
        json: Print one JSON line.
        figures: Further ones to print, by name.
        facts: More for the JSON line.

    Returns:
        The exit code: 1 where a requirement is not met, else 0.
    """
    report = evaluation.write_report(require)
    summary = evaluation.read_summary()
    if json:
        output.print_json_line({**summary, **(figures or {}), **(facts or {}), "folder": evaluation.folder})
    else:
        more = {name.replace("_", " "): _number(value) for name, value in (figures or {}).items()}
        output.print_facts(_facts(summary) | more | {"report": report})
        for gate in summary["gates"]:
            print(gate["text"])
    if summary["episodes"] < summary["total"]:
        text = describe_missing(summary["episodes"], summary["total"], summary["stopped"])
        output.remark(f"trundle: {text}", quiet=json)
    for damage in evaluation.results.damage:
        output.remark(f"trundle: {damage}", quiet=False)
    return 1 if summary["passed"] is False else 0


def _facts(summary: Mapping[str, Any]) -> dict[str, object]:
    done, total = summary["episodes"], summary["total"]
    success, low, high = (summary[name] for name in ("success", "success_low", "success_high"))
    share = f"{100.0 * success:.1f} % (95 %: {100.0 * low:.1f} to {100.0 * high:.1f} %)" if done else None
    broken = [f"{_label(each['labels'])}: {each['error']}" for each in summary["only_errors"]]
    return {
        **({"only errors": "; ".join(map(clean, broken))} if broken else {}),
        "episodes": f"{done:,}" if done == total else f"{done:,} of {total:,}",
        "arrived": share,
        "outcomes": ", ".join(f"{count:,} {name}" for name, count in summary["outcomes"].items()),
    }


def _label(labels: Mapping[str, str]) -> str:
    return " · ".join(text for text in labels.values() if text)


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"
