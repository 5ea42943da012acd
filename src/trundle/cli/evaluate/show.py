"""`trundle evaluate show`: the episodes of an evaluation as a table."""

from __future__ import annotations

from itertools import islice
from typing import Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import options, output
from trundle.cli.shared.given import check_given
from trundle.errors import UnknownNameError
from trundle.evaluation import Evaluation
from trundle.evaluation.report.text import table_lines
from trundle.files.kinds import EVALUATION

app = App(
    name="show",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle evaluate show runs/nightly --failed\n"
        "  trundle evaluate show runs/nightly --outcome stuck --json"
    ),
)


@app.default
def show(
    folder: str,
    /,
    *,
    failed: Annotated[bool, Parameter(negative="")] = False,
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
