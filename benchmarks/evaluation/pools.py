"""The pool and its peer on the same jobs, with what each costs; shared by the benchmarks here."""

from __future__ import annotations

import itertools
import multiprocessing
import os
import resource
import time
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from trundle.evaluation.pool import Done, Pool


@dataclass(frozen=True)
class Cost:
    """What a batch took.

    Attributes:
        jobs: How many were done.
        job_cpu_s: CPU time of the jobs themselves.
        cpu_s: CPU time of all processes, start-up included.
        wall_s: From nothing to all jobs done.
        steady_s: From the first job done to the last one.
    """

    jobs: int
    job_cpu_s: float
    cpu_s: float
    wall_s: float
    steady_s: float

    @property
    def overhead(self) -> float:
        """CPU time beyond that of the jobs, relative to it."""
        return self.cpu_s / self.job_cpu_s - 1.0

    @property
    def rate(self) -> float:
        """Jobs per second, start-up included."""
        return self.jobs / self.wall_s

    @property
    def steady_rate(self) -> float:
        """Jobs per second between the first that ended and the last."""
        return (self.jobs - 1) / self.steady_s


class Burn:
    """Uses CPU for so long, as an episode would."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds

    def setup(self) -> None:
        """Nothing."""

    def __call__(self, job: int, note: Callable[[dict[str, Any]], None]) -> int:
        until = time.process_time() + self.seconds
        while time.process_time() < until:
            sum(range(2000))
        return job


def make_task(world: str | None, backend: str, episodes: int, seconds: float) -> Any:
    """Episodes on a map, or jobs that only use so much CPU."""
    if world is None:
        return Burn(seconds)
    from trundle.evaluation.episode import EpisodeTask
    from trundle.evaluation.suite import Suite

    return EpisodeTask(Suite.make(maps=[world], backends=backend, seeds=f"0:{episodes}"))


def preload_of(task: Any) -> tuple[str, ...]:
    """Modules that workers for a task share."""
    return () if isinstance(task, Burn) else task.modules


def run_pool(task: Any, jobs: int, workers: int) -> Cost:
    """Jobs in trundle's pool."""

    def times() -> Iterator[float]:
        with Pool(task, workers=workers, deadline_s=600.0, memory_mb=4000.0, preload=preload_of(task)) as pool:
            for outcome in pool.run(range(jobs)):
                if not isinstance(outcome, Done):
                    raise SystemExit(f"job {outcome.job} failed: {outcome.text} {outcome.place or ''}")
                yield outcome.cpu_s

    return _measure(times())


def run_executor(task: Any, jobs: int, workers: int) -> Cost:
    """The same jobs in a bare ProcessPoolExecutor, whose workers are forked from this process."""

    def times() -> Iterator[float]:
        context = multiprocessing.get_context("fork")
        with ProcessPoolExecutor(workers, context, initializer=_prepare, initargs=(task,)) as pool:
            numbers = iter(range(jobs))
            futures = {pool.submit(_do, number) for number in itertools.islice(numbers, 2 * workers)}
            while futures:
                ended, futures = wait(futures, return_when=FIRST_COMPLETED)
                futures |= {pool.submit(_do, number) for number in itertools.islice(numbers, len(ended))}
                for future in ended:
                    yield future.result()[1]

    return _measure(times())


def descendants(pid: int) -> list[int]:
    """Processes below a process."""
    parents: dict[int, int] = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal():
            try:
                parents[int(entry.name)] = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            except OSError:
                continue  # it has just ended
    found, above = [], {pid}
    while above:
        above = {each for each, parent in parents.items() if parent in above}
        found.extend(sorted(above))
    return found


def private_mb(pid: int) -> float:
    """Memory that only this process has [MB]."""
    lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    return sum(int(line.split()[1]) for line in lines if line.startswith("Private_")) * 1024 / 1e6


def _measure(times: Iterator[float]) -> Cost:
    begin, cpu = time.perf_counter(), _cpu_s()
    first = last = begin
    jobs, job_cpu_s = 0, 0.0
    for seconds in times:
        last = time.perf_counter()
        first = last if jobs == 0 else first
        jobs, job_cpu_s = jobs + 1, job_cpu_s + seconds
    return Cost(jobs, job_cpu_s, _cpu_s() - cpu, time.perf_counter() - begin, last - first)


def _cpu_s() -> float:
    """Of this process and of all below it that have ended."""
    whom = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return sum(usage.ru_utime + usage.ru_stime for usage in map(resource.getrusage, whom))


_task: Any = None


def _prepare(task: Any) -> None:
    global _task
    os.environ["TRUNDLE_THREADS"] = "1"
    _task = task
    _task.setup()


def _do(number: int) -> tuple[Any, float]:
    begin = time.process_time()
    value = _task(number, lambda _: None)
    return value, time.process_time() - begin
