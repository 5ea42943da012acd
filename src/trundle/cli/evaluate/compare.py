"""`trundle evaluate compare`: what changed between two evaluations of the same missions."""

from __future__ import annotations

from cyclopts import App

from trundle.cli.shared import options, output
from trundle.cli.shared.given import check_given
from trundle.evaluation import Evaluation
from trundle.evaluation.report.text import comparison_lines
from trundle.files.kinds import EVALUATION

app = App(
    name="compare",
    version_flags=[],
    help_epilogue="Examples:\n  trundle evaluate compare runs/before runs/after",
)


@app.default
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
