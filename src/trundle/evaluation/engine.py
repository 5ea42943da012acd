"""`run_suite`: the episodes of a suite through worker processes into a folder."""

from __future__ import annotations

import os
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Self

import numpy as np

from trundle.errors import InputError, TrundleError
from trundle.evaluation.episode import EpisodeTask, facts_of, parts_of
from trundle.evaluation.pool import Done, Failed, Pool
from trundle.evaluation.pool.pool import MOST_WORKERS
from trundle.evaluation.report.write import InterimReports
from trundle.evaluation.row import Row
from trundle.evaluation.schedule import EpisodeOrder, GivenUp, Schedule
from trundle.evaluation.statistics import Interval, wilson
from trundle.evaluation.store import Results, Store, code_versions
from trundle.evaluation.store.folder import MANIFEST, Stopped
from trundle.evaluation.store.remote import is_remote, staged
from trundle.evaluation.suite import EpisodeSpec, Suite
from trundle.evaluation.suite.identity import unsampled_hash
from trundle.values import check_count, check_number

_SETUP_TRIES = 2
"""How often a part may fail while it is set up before it is not tried again: once by chance, twice is the part."""


class InterruptedEvaluationError(TrundleError):
    """The evaluation was stopped from outside; the message says how to continue it."""


@dataclass(slots=True)
class Progress:
    """The progress of an evaluation.

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
    """Return one worker for each CPU that this process may use."""
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
    time_budget_s: float | None = None,
    on_progress: OnProgress | None = None,
) -> Path | str:
    """Run the episodes of a suite that have no row in a folder yet.

    The reports are written from time to time meanwhile, but not at the end.

    Args:
        suite: What to run.
        folder: Where the rows go; by default a new `runs/<time>-<name>`. An unfinished evaluation in it is continued.
            With `ray` it may be in an object store (`s3://bucket/folder`).
        workers: Number of worker processes, with `ray` on each node; by default one for each CPU.
        ray: Address of a Ray cluster to run on, or `auto`, which starts one on this machine.
        mixed: Continue although earlier rows were made by other code.
        overwrite: Delete the evaluation that the folder holds.
        time_budget_s: Wall time [s] after which it stops, with the rows that it has; by default there is no limit.
        on_progress: Called at the start and after every row, with `ray` after every shard.

    Returns:
        The folder.

    Raises:
        InputError: If the suite cannot be run.
        OutputError: If the folder cannot be used, or a row cannot be written.
        ClusterError: If the cluster cannot be reached, or no node of it is left.
        InterruptedEvaluationError: After Ctrl-C; all rows so far are in the folder.
    """
    until = None
    if time_budget_s is not None:
        until = time.monotonic() + check_number("time_budget_s", time_budget_s, 0.001, 1e9, "s")
    _check_request(suite, folder, workers, ray)
    run = _Run(suite, workers, ray, mixed, until)
    with ExitStack() as opened:
        run.open_folder(opened, folder, overwrite=overwrite)
        run.find_what_is_left(opened, on_progress)
        interrupt: KeyboardInterrupt | None = None
        try:
            run.drive()
        except KeyboardInterrupt as error:
            interrupt = error
        run.note_end(was_interrupted=interrupt is not None)
        if interrupt is not None:
            raise InterruptedEvaluationError(run.tell_how_to_continue()) from interrupt
    return run.out


def _check_request(suite: Suite, folder: str | os.PathLike[str] | None, workers: int | None, ray: str | None) -> None:
    """Check what can be checked before anything is written."""
    if workers is not None:
        check_count("workers", workers, 1, MOST_WORKERS)
    suite.check()
    if ray is not None:
        from trundle.evaluation.cluster.connection import check_cluster

        check_cluster(ray)
    if is_remote(folder) and ray is None:
        raise InputError(f"{folder} is in an object store, which the nodes of a Ray cluster write to: give --ray, too")


class _Run:
    """One call of `run_suite`, whose steps are called in the order in which they stand here."""

    def __init__(self, suite: Suite, workers: int | None, ray: str | None, mixed: bool, until: float | None) -> None:
        self._suite, self._workers, self._ray, self._mixed, self._until = suite, workers, ray, mixed, until
        self._total, self._versions = len(suite), code_versions()
        self._in_flight_s: tuple[float, ...] = ()
        """For how long the episodes had been driven that had begun and not ended [s]."""

    def open_folder(self, opened: ExitStack, folder: str | os.PathLike[str] | None, *, overwrite: bool) -> None:
        """Open the folder of rows, or a copy of that in an object store."""
        self._copy = opened.enter_context(staged(str(folder))) if is_remote(folder) else None
        here = folder if self._copy is None else self._copy.folder
        self._store = opened.enter_context(
            Store.open(
                here,
                name=self._suite.title,
                suite_text=self._suite.to_yaml(Path(here or ".") / "suite.yaml"),
                total=self._total,
                versions=self._versions,
                mixed=self._mixed,
                overwrite=overwrite,
            )
        )
        self.out: Path | str = self._store.folder if self._copy is None else str(folder)

    def find_what_is_left(self, opened: ExitStack, on_progress: OnProgress | None) -> None:
        """Find the episodes without a row, in the order in which they are driven, and report that."""
        order, store = EpisodeOrder(self._suite), self._store
        missing = store.pending(self._suite.id_of(index) for index in range(self._total))
        self._pending = order.sort(np.fromiter(missing, np.int64)).tolist()
        if self._copy is not None:
            self._copy.push()
        resumed = self._total - len(self._pending)
        self._tally = _Tally(Progress(self.out, self._total, resumed, done=resumed, damage=store.damage), on_progress)
        self._interim = InterimReports(self.out)
        opened.callback(self._interim.close)
        self._given_up = GivenUp(order)
        if resumed:
            _note_rows(store.folder, self._given_up)

    def drive(self) -> None:
        """Drive them, until all are done or the time is up."""
        todo = (index for index in self._pending if not self._given_up.has(index))
        if self._pending and self._ray is not None:
            self._drive_on_cluster(self._ray, todo)
        elif self._pending:
            self._drive_here(todo)

    def _drive_here(self, todo: Iterator[int]) -> None:
        with SuiteRunner(self._suite, self._workers or default_workers(), self._given_up) as runner:
            try:
                for row in runner.rows(todo, until=self._until):
                    self._store.append(row)
                    self._tally.add({row.outcome: 1})
                    self._interim.look()
            finally:
                self._in_flight_s = runner.in_flight_s()

    def _drive_on_cluster(self, address: str, todo: Iterator[int]) -> None:
        """The nodes write the rows themselves, shard by shard."""
        from trundle.evaluation.cluster import run_on_cluster

        # Closed here, also by Ctrl-C: what runs there goes on for as long as the exception holds this frame.
        with closing(
            run_on_cluster(
                partial(SuiteRunner, self._suite),
                todo,
                out=self.out,
                address=address,
                versions=self._versions,
                mixed=self._mixed,
                workers=self._workers,
                until=self._until,
            )
        ) as shards:
            for shard in shards:
                for index in shard.errors:
                    self._given_up.note(index, "error")
                self._in_flight_s += tuple(shard.in_flight_s)
                self._tally.add(shard.outcomes)
                self._interim.look()

    def note_end(self, *, was_interrupted: bool) -> None:
        """Note in the folder why episodes are missing, if any are."""
        missing = self._total - self._tally.progress.done
        if not missing:
            return
        is_late = self._until is not None and (bool(self._in_flight_s) or time.monotonic() >= self._until)
        reason = "from outside" if was_interrupted else "by its time budget" if is_late else ""
        self._store.note_end(Stopped(reason=reason, in_flight_s=self._in_flight_s, left_out=0 if reason else missing))
        if self._copy is not None:
            self._copy.push((MANIFEST,))

    def tell_how_to_continue(self) -> str:
        """Return what is said after Ctrl-C."""
        text = (
            f"stopped after {self._tally.progress.done:,} of {self._total:,} episodes; to continue, give the same "
            f"command with -o {self.out}"
        )
        if self._in_flight_s:
            text += (
                f". Not counted: {len(self._in_flight_s):,} that had begun; slow episodes are more often among them, "
                "which flatters the figures"
            )
        return text


def _note_rows(folder: Path, given_up: GivenUp) -> None:
    """Count the outcomes of the rows that a folder has."""
    with Results.open(folder) as results:
        found = results.columns("index", "outcome")
    is_error = found["outcome"] == "error"
    for index in found["index"][is_error].tolist():
        given_up.note(index, "error")


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
        given_up: The combinations that are given up; by default none is at first.
    """

    def __init__(self, suite: Suite, workers: int, given_up: GivenUp | None = None) -> None:
        self._suite = suite
        task = EpisodeTask(suite)
        self._pool = Pool(
            task,
            workers=workers,
            deadline_s=suite.limits.wall_s,
            memory_mb=suite.limits.memory_mb,
            preload=task.modules,
        )
        self._workers = workers
        self._order = EpisodeOrder(suite)
        self._refused: deque[Row] = deque()
        self._unprepared: dict[str, list[Failed]] = {}
        """Failures of parts while they were set up, by part."""
        self._given_up = given_up or GivenUp(self._order)
        self._schedule: Schedule | None = None

    def rows(self, indices: Iterable[int], *, until: float | None = None) -> Iterator[Row]:
        """Run episodes, and give their rows as they end.

        Episodes of a combination that is given up have no rows; see `GivenUp`.

        Args:
            indices: Their numbers in the suite, in the order of `EpisodeOrder`.
            until: When to stop, in terms of `time.monotonic` [s]; by default when all are done.

        Raises:
            PoolSetupError: If no worker can be started.
        """
        self._schedule = schedule = Schedule(indices, self._order, self._workers, self._is_left_out)
        for outcome in self._pool.run(schedule, until=until):
            schedule.in_flight.pop(outcome.job)
            yield self._noted(self._row_of(outcome))
            yield from self._take_refused()
        yield from self._take_refused()

    def in_flight_s(self) -> tuple[float, ...]:
        """Return for how long the episodes have been driven that have begun and not ended [s], the longest first."""
        now = time.monotonic()
        return () if self._schedule is None else tuple(now - began for began in self._schedule.in_flight.values())

    def close(self) -> None:
        """End the processes."""
        self._pool.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _is_left_out(self, index: int) -> bool:
        """Return whether an episode is not to be tried: it is given up, or needs a part that failed twice in set-up."""
        if self._given_up.has(index):
            return True
        if not self._unprepared:
            return False
        spec = self._suite.spec(index)
        for part in parts_of(spec):
            failures = self._unprepared.get(part, [])
            if len(failures) >= _SETUP_TRIES:
                self._refused.append(self._noted(row_of_failure(spec, failures[0])))
                return True
        return False

    def _noted(self, row: Row) -> Row:
        self._given_up.note(row.index, row.outcome)
        return row

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
    """Return the row of an episode that did not end by itself.

    `failure` may be that of another episode which needs the same part.
    """
    noted = failure.noted or {}
    known = facts_of(spec)
    if failure.job == spec.index:
        known |= noted.get("row", {})
    place = f" at {failure.place}" if failure.place else ""
    during = f" (setting up {noted['part']})" if noted.get("stage") == "setup" else ""
    mission = known["mission"] or unsampled_hash(spec.content, spec.missions.rule(spec.listed), spec.seed)
    return Row(**{**known, "mission": mission, "outcome": failure.kind, "error": f"{failure.text}{place}{during}"})
