"""`run_suite`: the episodes of a suite through worker processes into a folder."""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from trundle.errors import TrundleError
from trundle.evaluation.episode import EpisodeTask, facts_of, parts_of
from trundle.evaluation.pool import Done, Failed, Pool
from trundle.evaluation.pool.pool import MOST_WORKERS
from trundle.evaluation.row import Row
from trundle.evaluation.statistics import Interval, wilson
from trundle.evaluation.store import Store, code_versions
from trundle.evaluation.suite import EpisodeSpec, Suite
from trundle.evaluation.suite.identity import unsampled_hash
from trundle.values import check_count

_PRELOAD = ("trundle.evaluation.episode",)
"""What the server that workers are forked from imports."""
_BACKENDS = {"kinematic": "trundle.sim.kinematic", "mujoco": "trundle.sim.mujoco.simulator"}
"""Their modules, which it imports where the suite has them."""

_SETUP_TRIES = 2
"""A part that failed so often while it was set up is not tried again."""


class InterruptedEvaluationError(TrundleError):
    """The evaluation was stopped from outside; the message says how to continue it."""


@dataclass(slots=True)
class Progress:
    """How far an evaluation is.

    Attributes:
        folder: Where its rows are.
        total: Number of episodes.
        resumed: How many of them an earlier run had done.
        done: How many are done, with those.
        outcomes: How the episodes of this run ended, by outcome.
        elapsed_s: Wall time since the start [s].
    """

    folder: Path
    total: int
    resumed: int = 0
    done: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    elapsed_s: float = 0.0

    @property
    def rate(self) -> float:
        """Episodes per second in this run."""
        return (self.done - self.resumed) / self.elapsed_s if self.elapsed_s > 0.0 else 0.0

    @property
    def left_s(self) -> float | None:
        """Time that the rest will take at this rate [s]; None before the first episode."""
        return (self.total - self.done) / self.rate if self.rate > 0.0 else None

    @property
    def success(self) -> Interval:
        """The 95 % interval of the share that arrived, of this run's episodes."""
        return wilson(self.outcomes["arrived"], sum(self.outcomes.values()))


OnProgress = Callable[[Progress], None]
IntArray = npt.NDArray[np.int64]


def default_workers() -> int:
    """One for each CPU that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def run_suite(
    suite: Suite,
    folder: str | os.PathLike[str] | None = None,
    *,
    workers: int | None = None,
    mixed: bool = False,
    overwrite: bool = False,
    on_progress: OnProgress | None = None,
) -> Path:
    """Run the episodes of a suite that have no row in a folder yet.

    Args:
        suite: What to run.
        folder: Where the rows go; none means a new `runs/<time>-<name>`. An unfinished evaluation in it is continued.
        workers: Number of worker processes; none means one for each CPU.
        mixed: Continue although earlier rows were made by other code.
        overwrite: Delete the evaluation that the folder holds.
        on_progress: Called at the start and after every row.

    Returns:
        The folder.

    Raises:
        InputError: If the suite cannot be run.
        OutputError: If the folder cannot be used, or a row cannot be written.
        InterruptedEvaluationError: After Ctrl-C; all rows so far are in the folder.
    """
    count = default_workers() if workers is None else check_count("workers", workers, 1, MOST_WORKERS)
    suite.check()
    total = len(suite)
    versions = code_versions()
    with Store.open(
        folder,
        name=suite.title,
        suite_text=suite.to_yaml(Path(folder or ".") / "suite.yaml"),
        total=total,
        versions=versions,
        mixed=mixed,
        overwrite=overwrite,
    ) as store:
        pending = np.fromiter(store.pending(suite.id_of(index) for index in range(total)), np.int64)
        progress = Progress(store.folder, total)
        run = _Run(suite, store, progress, on_progress)
        try:
            run.drive(pending, count)
        except KeyboardInterrupt as interrupt:
            raise InterruptedEvaluationError(
                f"stopped after {progress.done:,} of {total:,} episodes; to continue, give the same command with "
                f"-o {store.folder}"
            ) from interrupt
        return store.folder


class _Run:
    """One run of an evaluation: jobs to the pool, rows to the store."""

    def __init__(self, suite: Suite, store: Store, progress: Progress, on_progress: OnProgress | None) -> None:
        self._suite = suite
        self._store = store
        self._progress = progress
        self._on_progress = on_progress
        self._unprepared: dict[str, list[Failed]] = {}
        """Failures of parts while they were set up, by part."""
        self._began = time.monotonic()

    def drive(self, pending: IntArray, workers: int) -> None:
        limits = self._suite.limits
        self._progress.done = self._progress.resumed = self._progress.total - len(pending)
        self._report()
        if not len(pending):
            return
        with Pool(
            EpisodeTask(self._suite),
            workers=workers,
            deadline_s=limits.wall_s,
            memory_mb=limits.memory_mb,
            preload=_preload(self._suite),
        ) as pool:
            for outcome in pool.run(self._jobs(pending)):
                self._take(outcome)

    def _jobs(self, pending: IntArray) -> Iterator[int]:
        """The episodes to try; one that needs a part which failed twice in set-up gets that failure as its row."""
        for index in pending.tolist():
            failure = self._refusal(index) if self._unprepared else None
            if failure is None:
                yield index
            else:
                self._keep(row_of_failure(self._suite.spec(index), failure))

    def _refusal(self, index: int) -> Failed | None:
        for part in parts_of(self._suite.spec(index)):
            failures = self._unprepared.get(part, [])
            if len(failures) >= _SETUP_TRIES:
                return failures[0]
        return None

    def _take(self, outcome: Done | Failed) -> None:
        if isinstance(outcome, Done):
            self._keep(outcome.value)
            return
        noted = outcome.noted or {}
        if noted.get("stage") == "setup":
            self._unprepared.setdefault(noted["part"], []).append(outcome)
        self._keep(row_of_failure(self._suite.spec(outcome.job), outcome))

    def _keep(self, row: Row) -> None:
        self._store.append(row)
        self._progress.done += 1
        self._progress.outcomes[row.outcome] += 1
        self._report()

    def _report(self) -> None:
        if self._on_progress is not None:
            self._progress.elapsed_s = time.monotonic() - self._began
            self._on_progress(self._progress)


def row_of_failure(spec: EpisodeSpec, failure: Failed) -> Row:
    """The row of an episode that did not end by itself; `failure` may be that of another one which needs the same."""
    noted = failure.noted or {}
    known = facts_of(spec)
    if failure.job == spec.index:
        known |= noted.get("row", {})
    place = f" at {failure.place}" if failure.place else ""
    during = f" (setting up {noted['part']})" if noted.get("stage") == "setup" else ""
    mission = known["mission"] or unsampled_hash(spec.content, spec.missions.rule(spec.listed), spec.seed)
    return Row(**{**known, "mission": mission, "outcome": failure.kind, "error": f"{failure.text}{place}{during}"})


def _preload(suite: Suite) -> Sequence[str]:
    return (*_PRELOAD, *(_BACKENDS[backend.name] for backend in suite.backends if backend.name in _BACKENDS))
