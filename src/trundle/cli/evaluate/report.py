"""`trundle evaluate report`: write the report of an evaluation."""

from __future__ import annotations

from cyclopts import App

from trundle.cli.evaluate import verdict
from trundle.cli.shared import options
from trundle.cli.shared.given import check_given
from trundle.evaluation import Evaluation
from trundle.files.kinds import EVALUATION

app = App(
    name="report",
    version_flags=[],
    help_epilogue="Examples:\n  trundle evaluate report runs/nightly --require 'success>=0.99'",
)


@app.default
def report(folder: str, /, *, require: verdict.Require = (), json: options.Json = False) -> int:
    """Write report.html, junit.xml and summary.json of an evaluation, which may still be running.

    Exit code 1 says that a requirement was not met.

    Args:
        folder: The folder that trundle evaluate wrote.
    """
    check_given(folder, EVALUATION)
    return verdict.give(Evaluation(folder), require or None, json=json)
