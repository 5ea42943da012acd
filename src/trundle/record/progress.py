"""The progress of a run on the error stream: a bar with the remaining time on a terminal, plain lines elsewhere."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Self

from trundle.geometry import Pose2D
from trundle.mission import Episode, RunInfo, Step

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

_EVERY = 5  # steps
_PLAIN_STEP = 0.25  # progress between plain lines


class ProgressBar:
    """An observer that shows the driven share of the planned length; use it in a `with` block.

    Args:
        quiet: Show nothing.
        plain: If the error stream is not a terminal, print a line for every quarter instead of nothing.
    """

    def __init__(self, *, quiet: bool = False, plain: bool = False) -> None:
        self._quiet = quiet
        self._plain = plain and not quiet and not sys.stderr.isatty()
        self._printed: dict[str, int] = {}
        self._bar: Progress | None = None
        self._tasks: dict[str, TaskID] = {}
        self._length_m = 0.0
        self._driven_m = 0.0
        self._last: Pose2D | None = None

    def __enter__(self) -> Self:
        if not self._quiet:
            self._bar = _make_bar()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()
            self._bar = None

    def on_start(self, run: RunInfo) -> None:
        """Start the bar at 0."""
        self._printed.clear()
        self._length_m = max(run.path_length_m, 1e-6)
        self._driven_m, self._last = 0.0, run.start
        self._show("driving", 0.0, 1.0)

    def on_step(self, step: Step) -> None:
        """Advance the bar."""
        if step.index % _EVERY == 0 and (self._plain or self._bar is not None):
            here = step.state.pose
            self._driven_m += here.distance_to(self._last or here)
            self._last = here
            self._show("driving", min(0.99, self._driven_m / self._length_m), 1.0)

    def on_end(self, episode: Episode) -> None:
        """Complete the bar."""
        self._show("driving", 1.0, 1.0)

    def report(self, what: str, done: int, total: int) -> None:
        """Show the progress of another task, e.g. the video: `done` parts of `total`."""
        self._show(what, float(done), float(total))

    def _show(self, what: str, done: float, total: float) -> None:
        if self._plain:
            self._print(what, done / total)
        if self._bar is None:
            return
        if what not in self._tasks:
            self._tasks[what] = self._bar.add_task(what, total=total)
        self._bar.update(self._tasks[what], completed=done, total=total)

    def _print(self, what: str, share: float) -> None:
        quarters = int(share / _PLAIN_STEP)
        if quarters > self._printed.get(what, -1):
            self._printed[what] = quarters
            sys.stderr.write(f"{what}: {quarters * _PLAIN_STEP:.0%}\n")
            sys.stderr.flush()


def _make_bar() -> Progress | None:
    """Return a started bar, or None if it would not be visible."""
    if not sys.stderr.isatty():
        return None
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    bar = Progress(
        TextColumn("{task.description:>8}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        transient=True,
    )
    bar.start()
    return bar
