"""Running a suite with a line that says how far it is, until it is done, stopped, or out of time."""

from __future__ import annotations

import json
import os
import re
import sys
import threading
from typing import Annotated, Self

from cyclopts import Parameter

from trundle.cli.shared import output
from trundle.cli.shared.termination import ends_as_by_ctrl_c
from trundle.errors import InputError
from trundle.evaluation import Evaluation, Suite
from trundle.evaluation.engine import InterruptedEvaluationError, Progress, run_suite

_WIDTH = 79
_EVERY_S = {"terminal": 0.2, "plain": 10.0, "json": 1.0}
"""Time between two lines: on a terminal the line is written over, elsewhere each one stays in a log."""

_DURATION = re.compile(r"(?:(\d+)h)?(?:(\d+)m(?:in)?)?(?:(\d+(?:\.\d*)?)s)?")
_LONGEST_S = 3.6e6  # 1000 hours
TimeBudget = Annotated[
    str | None,
    Parameter(
        name="--time-budget",
        help="Wall time after which it stops, as 90s, 10m or 1h30m; the same command continues it. Left out: none.",
    ),
]


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
    """Run a suite; see `run_suite` for arguments and errors. If it is stopped from outside, return None."""
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


class ProgressLine:
    """Shows the progress of an evaluation; use it in a `with` block.

    On a terminal it is a line that is written over; elsewhere a line every ten seconds, both on the error stream. As
    JSON it is a line a second on stdout, also while no episode ends.

    Args:
        json: Print JSON lines.
        quiet: Show no progress; JSON lines are printed all the same.
        every_s: Time between two lines [s]; by default as above.
    """

    def __init__(self, *, json: bool = False, quiet: bool = False, every_s: float | None = None) -> None:
        self._kind = "json" if json else "terminal" if sys.stderr.isatty() else "plain"
        self._every_s = every_s or _EVERY_S[self._kind]
        self._hidden = quiet and not json
        self._last: Progress | None = None
        self._shown, self._printed = False, -1
        self._fault: OSError | None = None
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._repeat, daemon=True)

    def __enter__(self) -> Self:
        if not self._hidden:
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        if self._thread.is_alive():
            self._thread.join()
        if self._last is not None and self._fault is None and self._printed != self._last.done:
            self._print(self._last)
        if self._kind == "terminal" and self._shown:
            print(file=sys.stderr)

    def show(self, progress: Progress) -> None:
        """Show it at once if it is the first, with what was damaged, even where quiet; else with the next line.

        Raises:
            OSError: If the stream has been closed.
        """
        if self._fault is not None:
            raise self._fault
        first, self._last = self._last is None, progress
        if first:
            for damage in progress.damage:
                print(f"trundle: {damage}", file=sys.stderr)
            self._print(progress)

    def _repeat(self) -> None:
        while not self._ended.wait(self._every_s):
            try:
                if self._last is not None:
                    self._print(self._last)
            except OSError as error:
                self._fault = error
                return

    def _print(self, progress: Progress) -> None:
        if self._hidden:
            return
        self._shown, self._printed = True, progress.done
        if self._kind == "json":
            print(json.dumps(as_dict(progress)), flush=True)
        elif self._kind == "plain":
            print(describe(progress), file=sys.stderr, flush=True)
        else:
            print(f"\r{describe(progress):<{_WIDTH}}", end="", file=sys.stderr, flush=True)


def describe(progress: Progress) -> str:
    """Describe what is done, the rate, the time left, the success and the outcomes so far, in at most 79 columns."""
    parts = [f"{progress.done:,}/{progress.total:,}"]
    counts = sum(progress.outcomes.values())
    if counts:
        low, high = progress.success
        share = progress.outcomes["arrived"] / counts
        parts += [f"{progress.rate:.3g}/s", f"{_duration(progress.left_s)} left"]
        parts.append(f"arrived {100.0 * share:.1f} % ({100.0 * low:.1f}-{100.0 * high:.1f})")
        others = [(name, count) for name, count in progress.outcomes.most_common() if name != "arrived"]
        parts += [f"{count:,} {name}" for name, count in others]
    line = ""
    for part in parts:
        longer = f"{line}  {part}" if line else part
        if len(longer) > _WIDTH - 2:
            return f"{line} …"
        line = longer
    return line


def as_dict(progress: Progress) -> dict[str, object]:
    """Return the progress as plain values, for JSON."""
    counts = sum(progress.outcomes.values())
    low, high = progress.success
    return {
        "done": progress.done,
        "total": progress.total,
        "resumed": progress.resumed,
        "rate": round(progress.rate, 3),
        "left_s": None if progress.left_s is None else round(progress.left_s, 1),
        "outcomes": dict(progress.outcomes),
        "success": progress.outcomes["arrived"] / counts if counts else None,
        "success_low": low,
        "success_high": high,
        "folder": str(progress.folder),
    }


def _duration(seconds: float | None) -> str:
    if seconds is None:
        return "?"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
