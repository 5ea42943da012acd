"""Running a suite with a progress line, until it is done or stopped."""

from __future__ import annotations

import os

from trundle.cli.evaluate.progress import ProgressLine
from trundle.cli.shared import output
from trundle.cli.shared.termination import ends_as_by_ctrl_c
from trundle.evaluation import Evaluation, Suite
from trundle.evaluation.engine import InterruptedEvaluationError, run_suite

INTERRUPTED = 130
"""Exit code: 128 + SIGINT, as shells count; SIGTERM ends it in the same way."""


def carry_out(
    suite: Suite,
    out: str | os.PathLike[str] | None,
    *,
    json: bool,
    quiet: bool,
    workers: int | None = None,
    ray: str | None = None,
    mixed: bool = False,
    overwrite: bool = False,
    time_budget_s: float | None = None,
) -> Evaluation | None:
    """Run a suite; see `run_suite` for arguments and errors. None means that it was stopped from outside."""
    try:
        with ends_as_by_ctrl_c(), ProgressLine(json=json, quiet=quiet) as line:
            folder = run_suite(
                suite,
                out,
                workers=workers,
                ray=ray,
                mixed=mixed,
                overwrite=overwrite,
                time_budget_s=time_budget_s,
                on_progress=line.show,
            )
    except InterruptedEvaluationError as stopped:
        output.remark(f"trundle: {stopped}", quiet=False)
        return None
    return Evaluation(folder, suite=suite)
