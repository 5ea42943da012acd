"""What the verbs of an evaluation print at the end, and their exit code."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from cyclopts import Parameter

from trundle.cli.shared import output
from trundle.evaluation import Evaluation

_HELP = (
    "What must hold, as 'success>=0.99' or 'success[planner=auto]>=0.99': the end of the 95 % interval is compared. "
    "Repeat it for several. Left out: what the suite requires."
)
Require = Annotated[tuple[str, ...], Parameter(name="--require", help=_HELP, negative="")]


def give(evaluation: Evaluation, require: Sequence[str] | None = None, *, json: bool) -> int:
    """Write the report of an evaluation, and print what it says.

    Args:
        evaluation: The evaluation.
        require: What it is judged by; none means what its suite requires.
        json: Print one JSON line.

    Returns:
        The exit code: 1 where a requirement is not met, else 0.
    """
    report = evaluation.write_report(require)
    gates = evaluation.gates(require)
    if json:
        output.print_json_line({**evaluation.summary(require), "folder": evaluation.folder})
    else:
        output.print_facts(_facts(evaluation) | {"report": report})
        for gate in gates:
            print(gate.text)
    for damage in evaluation.results.damage:
        output.remark(f"trundle: {damage}", quiet=False)
    return 0 if all(gate.passed for gate in gates) else 1


def _facts(evaluation: Evaluation) -> dict[str, object]:
    done, total = len(evaluation), evaluation.results.total
    low, high = evaluation.success
    arrived = int(evaluation.table.arrived.sum())
    share = f"{100.0 * arrived / done:.1f} % (95 %: {100.0 * low:.1f} to {100.0 * high:.1f} %)" if done else None
    return {
        "episodes": f"{done:,}" if done == total else f"{done:,} of {total:,}: not finished",
        "arrived": share,
        "outcomes": ", ".join(f"{count:,} {name}" for name, count in evaluation.outcomes.items()),
    }
