"""What an evaluation found: its report, its episodes, and the difference to another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice
from typing import Annotated, Any

from cyclopts import App, Parameter

from trundle.cli.shared import options, output
from trundle.cli.shared.sources import check_given
from trundle.errors import UnknownNameError
from trundle.evaluation import Evaluation
from trundle.evaluation.report.summary import describe_missing
from trundle.evaluation.report.text import clean, comparison_lines, table_lines
from trundle.files.kinds import EVALUATION

_HELP = (
    "What must hold, as 'success>=0.99' or 'success[planner=auto]>=0.99': the end of the 95 % interval is compared. "
    "Repeat it for several. Left out: what the suite requires."
)
Require = Annotated[tuple[str, ...], Parameter(name="--require", help=_HELP, negative="", show_default=False)]

report_app = App(
    name="report",
    version_flags=[],
    help_epilogue="Examples:\n  trundle evaluate report runs/nightly --require 'success>=0.99'",
)
compare_app = App(
    name="compare",
    version_flags=[],
    help_epilogue="Examples:\n  trundle evaluate compare runs/before runs/after",
)
show_app = App(
    name="show",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle evaluate show runs/nightly --failed\n"
        "  trundle evaluate show runs/nightly --outcome stuck --json"
    ),
)


@report_app.default
def report(folder: str, /, *, require: Require = (), json: options.Json = False) -> int:
    """Write report.html, junit.xml and summary.json of an evaluation, which may still be running.

    Exit code 1 says that a requirement was not met.

    Args:
        folder: The folder that trundle evaluate wrote.
    """
    check_given(folder, EVALUATION)
    return report_evaluation(Evaluation(folder), require or None, json=json)


@compare_app.default
def compare(before: str, after: str, /, *, json: options.Json = False) -> int:
    """Compare two evaluations on the missions that both have.

    Exit code 1 says that the second is clearly worse, or that settings of it only raised exceptions.

    Args:
        before: The folder of the reference.
        after: The folder of what is compared with it.
    """
    for folder in (before, after):
        check_given(folder, EVALUATION)
    comparison = Evaluation(before).compare(Evaluation(after))
    if json:
        output.print_json(comparison.as_dict())
    else:
        print("\n".join(comparison_lines(comparison)))
    return 1 if comparison.worse or comparison.only_errors[1] else 0


@show_app.default
def show(
    folder: str,
    /,
    *,
    failed: options.Flag = False,
    outcome: str | None = None,
    limit: options.Integer = 50,
    json: options.Json = False,
) -> int:
    """List episodes; below each that failed, its cause and the command that runs it again.

    Args:
        folder: The folder that trundle evaluate wrote; its evaluation may still be running.
        failed: Only those that did not arrive.
        outcome: Only those of this outcome.
        limit: How many to list at most.
    """
    check_given(folder, EVALUATION)
    evaluation = Evaluation(folder)
    known = evaluation.outcomes
    if outcome is not None and outcome not in known:
        raise UnknownNameError("outcome in this evaluation", outcome, known)
    wanted = {name for name in known if (outcome is None or name == outcome) and not (failed and name == "arrived")}
    count = sum(known[name] for name in wanted)
    rows = list(islice((row for row in evaluation.rows() if row.outcome in wanted), max(0, limit)))
    if json:
        output.print_json([row.as_dict() for row in rows])
        return 0
    print("\n".join(table_lines(rows, str(folder))))
    if count > len(rows):
        output.remark(f"{count - len(rows):,} more; --limit {count} lists all", quiet=False)
    return 0


def report_evaluation(
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
        require: What it is judged by; by default what its suite requires.
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
        "outcomes": _counts(summary["outcomes"]),
        **({"to kinematic": _counts(summary["handed_over"])} if summary["handed_over"] else {}),
    }


def _counts(found: Mapping[str, int]) -> str:
    return ", ".join(f"{count:,} {name}" for name, count in found.items())


def _label(labels: Mapping[str, str]) -> str:
    return " · ".join(text for text in labels.values() if text)


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"
