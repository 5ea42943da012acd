"""`run_suite`: the episodes of a suite through worker processes into a folder."""

from __future__ import annotations

import os
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Self

import numpy as np

from trundle.errors import InputError, TrundleError
from trundle.evaluation.episode import EpisodeTask, facts_of, parts_of
from trundle.evaluation.interim import InterimReports
from trundle.evaluation.pool import Done, Failed, Pool
from trundle.evaluation.pool.pool import MOST_WORKERS
from trundle.evaluation.row import Row
from trundle.evaluation.statistics import Interval, wilson
from trundle.evaluation.store import Store, code_versions
from trundle.evaluation.store.remote import is_remote, staged
from trundle.evaluation.suite import EpisodeSpec, Suite
from trundle.evaluation.suite.identity import unsampled_hash
from trundle.values import check_count

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
        damage: What of the folder was damaged: a message for each part and line, whose episodes run again.
    """

    folder: str | os.PathLike[str]
    total: int
    resumed: int = 0
    done: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    elapsed_s: float = 0.0
    damage: Sequence[str] = ()

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
    ray: str | None = None,
    mixed: bool = False,
    overwrite: bool = False,
    on_progress: OnProgress | None = None,
) -> Path | str:
    """Run the episodes of a suite that have no row in a folder yet.

    The reports are written from time to time meanwhile, but not at the end.

    Args:
        suite: What to run.
        folder: Where the rows go; none means a new `runs/<time>-<name>`. An unfinished evaluation in it is continued.
            With `ray` it may be in an object store (`s3://bucket/folder`).
        workers: Number of worker processes, with `ray` on each node; none means one for each CPU.
        ray: Address of a Ray cluster to run on, or `auto`, which starts one on this machine.
        mixed: Continue although earlier rows were made by other code.
        overwrite: Delete the evaluation that the folder holds.
        on_progress: Called at the start and after every row, with `ray` after every shard.

    Returns:
        The folder.

    Raises:
        InputError: If the suite cannot be run.
        OutputError: If the folder cannot be used, or a row cannot be written.
        ClusterError: If the cluster cannot be reached, or no node of it is left.
        InterruptedEvaluationError: After Ctrl-C; all rows so far are in the folder.
    """
    if workers is not None:
        check_count("workers", workers, 1, MOST_WORKERS)
    suite.check()
    if ray is not None:
        from trundle.evaluation.cluster.connection import check_cluster

        check_cluster(ray)
    if is_remote(folder) and ray is None:
        raise InputError(f"{folder} is in an object store, which the nodes of a Ray cluster write to: give --ray, too")
    total, versions = len(suite), code_versions()
    with ExitStack() as opened:
        copy = opened.enter_context(staged(str(folder))) if is_remote(folder) else None
        here = folder if copy is None else copy.folder
        store = opened.enter_context(
            Store.open(
                here,
                name=suite.title,
                suite_text=suite.to_yaml(Path(here or ".") / "suite.yaml"),
                total=total,
                versions=versions,
                mixed=mixed,
                overwrite=overwrite,
            )
        )
        pending = np.fromiter(store.pending(suite.id_of(index) for index in range(total)), np.int64)
        if copy is not None:
            copy.push()
        out = store.folder if copy is None else str(folder)
        resumed = total - len(pending)
        tally = _Tally(Progress(out, total, resumed, done=resumed, damage=store.damage), on_progress)
        interim = InterimReports(out)
        opened.callback(interim.close)
        try:
            if ray is not None and len(pending):
                from trundle.evaluation.cluster import run_on_cluster

                cluster = {"out": out, "address": ray, "versions": versions, "mixed": mixed, "workers": workers}
                for shard in run_on_cluster(partial(SuiteRunner, suite), pending.tolist(), **cluster):
                    tally.add(shard.outcomes)
                    interim.look()
            elif len(pending):
                with SuiteRunner(suite, workers or default_workers()) as runner:
                    for row in runner.rows(pending.tolist()):
                        store.append(row)
                        tally.add({row.outcome: 1})
                        interim.look()
        except KeyboardInterrupt as interrupt:
            raise InterruptedEvaluationError(
                f"stopped after {tally.progress.done:,} of {total:,} episodes; to continue, give the same command with "
                f"-o {out}"
            ) from interrupt
    return out


class _Tally:
    """Counts what is done, and tells how far it is."""

    def __init__(self, progress: Progress, on_progress: OnProgress | None) -> None:
        self.progress = progress
        self._on_progress = on_progress
        self._began = time.monotonic()
        self._report()

    def add(self, outcomes: Mapping[str, int]) -> None:
        self.progress.outcomes.update(outcomes)
        self.progress.done += sum(outcomes.values())
        self._report()

    def _report(self) -> None:
        if self._on_progress is not None:
            self.progress.elapsed_s = time.monotonic() - self._began
            self._on_progress(self.progress)


class SuiteRunner:
    """Runs episodes of a suite in worker processes of this machine; use it in a `with` block, or close it.

    Args:
        suite: The suite.
        workers: Number of processes.
    """

    def __init__(self, suite: Suite, workers: int) -> None:
        self._suite = suite
        task = EpisodeTask(suite)
        self._pool = Pool(
            task,
            workers=workers,
            deadline_s=suite.limits.wall_s,
            memory_mb=suite.limits.memory_mb,
            preload=task.modules,
        )
        self._refused: deque[Row] = deque()
        self._unprepared: dict[str, list[Failed]] = {}
        """Failures of parts while they were set up, by part."""

    def rows(self, indices: Iterable[int]) -> Iterator[Row]:
        """Run episodes, and give their rows as they end.

        Args:
            indices: Their numbers in the suite.

        Raises:
            PoolSetupError: If no worker can be started.
        """
        for outcome in self._pool.run(self._jobs(indices)):
            yield self._row_of(outcome)
            yield from self._take_refused()
        yield from self._take_refused()

    def close(self) -> None:
        """End the processes."""
        self._pool.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _jobs(self, indices: Iterable[int]) -> Iterator[int]:
        """The episodes to try; one that needs a part which failed twice in set-up gets that failure as its row."""
        for index in indices:
            failure = self._refusal(index) if self._unprepared else None
            if failure is None:
                yield index
            else:
                self._refused.append(row_of_failure(self._suite.spec(index), failure))

    def _refusal(self, index: int) -> Failed | None:
        for part in parts_of(self._suite.spec(index)):
            failures = self._unprepared.get(part, [])
            if len(failures) >= _SETUP_TRIES:
                return failures[0]
        return None

    def _row_of(self, outcome: Done | Failed) -> Row:
        if isinstance(outcome, Done):
            return outcome.value
        noted = outcome.noted or {}
        if noted.get("stage") == "setup":
            self._unprepared.setdefault(noted["part"], []).append(outcome)
        return row_of_failure(self._suite.spec(outcome.job), outcome)

    def _take_refused(self) -> Iterator[Row]:
        while self._refused:
            yield self._refused.popleft()


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
