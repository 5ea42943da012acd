"""`Evaluation`: the episodes in a folder as one value; `evaluate`, which makes one; and its files that have moved."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from trundle.errors import InputError, TrundleError
from trundle.evaluation.engine import OnProgress, run_suite
from trundle.evaluation.episode import EpisodeTask
from trundle.evaluation.episode.task import facts_of
from trundle.evaluation.report.summary import count_outcomes, summarise
from trundle.evaluation.report.write import HTML, SUMMARY, write_apart, write_reports
from trundle.evaluation.row import Row
from trundle.evaluation.statistics import Comparison, Gate, GateResult, Interval, Table, compare, wilson
from trundle.evaluation.store import Results, code_versions
from trundle.evaluation.store.folder import SUITE, WRITTEN_AFTERWARDS
from trundle.evaluation.store.remote import staged
from trundle.evaluation.suite import Suite
from trundle.evaluation.suite.expand import Expansion
from trundle.evaluation.suite.parts import SuiteWorld
from trundle.files.opening import advise_missing, exists
from trundle.maps import OccupancyGrid
from trundle.mission import Scenario

if TYPE_CHECKING:
    import pandas  # pyright: ignore[reportMissingImports] - an extra


_MANY = 100_000
"""Episodes whose report takes a few hundred megabytes."""


def evaluate(
    suite: Suite | str | os.PathLike[str] | Mapping[str, Any],
    *,
    workers: int | None = None,
    ray: str | None = None,
    out: str | os.PathLike[str] | None = None,
    mixed: bool = False,
    overwrite: bool = False,
    time_budget_s: float | None = None,
    on_progress: OnProgress | None = None,
) -> Evaluation:
    """Run a suite's episodes in worker processes, and write the report.

    Args:
        suite: A suite, the path of one, the name of one that trundle ships, or the fields of one.
        workers: Number of worker processes, with `ray` on each node; by default one for each CPU.
        ray: Address of a Ray cluster to run on, or `auto`, which starts one on this machine (extra `ray`).
        out: Folder for the rows and the report; by default a new `runs/<time>-<name>`. An unfinished evaluation in it
            is continued. With `ray` it may be in an object store (`s3://bucket/folder`).
        mixed: Continue although earlier rows were made by other code.
        overwrite: Delete the evaluation that the folder holds.
        time_budget_s: Wall time [s] after which it stops, with the rows that it has; by default there is no limit. The
            same call with this folder as `out` continues it.
        on_progress: Called at the start and after every episode.

    Raises:
        InputError: If the suite cannot be run.
        OutputError: If the folder cannot be used.
        InterruptedEvaluationError: After Ctrl-C; the same call with this folder as `out` continues.
    """
    if isinstance(suite, Mapping):
        suite = Suite.make(**suite)
    elif not isinstance(suite, Suite):
        suite = Suite.load(suite)
    folder = run_suite(
        suite,
        out,
        workers=workers,
        ray=ray,
        mixed=mixed,
        overwrite=overwrite,
        time_budget_s=time_budget_s,
        on_progress=on_progress,
    )
    with ExitStack() as opened:
        evaluation = opened.enter_context(Evaluation(folder, suite=suite))
        evaluation.write_report()
        opened.pop_all()
    return evaluation


class Evaluation:
    """The episodes in the folder of an evaluation: those that it held when this was made.

    It holds files open until it is closed: `with trundle.evaluate(suite) as evaluation:` closes it at the end. What was
    read of it before, as `success`, stays; its rows do not.

    Args:
        folder: The folder that `trundle evaluate` wrote, also one in an object store, of which a copy is read; its
            evaluation may be unfinished.
        suite: The suite, where it is known. By default that of the folder is read, which has no Python objects.

    Attributes:
        folder: The folder.
        results: Its rows.

    Raises:
        InputError: If the folder holds no evaluation, or is damaged.
    """

    def __init__(self, folder: str | os.PathLike[str], *, suite: Suite | None = None) -> None:
        self.folder = os.fspath(folder)
        with ExitStack() as opened:
            self._copy = opened.enter_context(staged(self.folder))
            self.results = opened.enter_context(Results.open(self._copy.folder))
            self._opened = opened.pop_all()
        self._suite = suite

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __len__(self) -> int:
        return len(self.results)

    def __repr__(self) -> str:
        if self.results.is_closed:
            return f"Evaluation({self.folder!r}, closed)"
        arrived = int(self.table.arrived.sum())
        return f"Evaluation({self.folder!r}, {len(self)} of {self.results.total} episodes, {arrived} arrived)"

    @cached_property
    def suite(self) -> Suite:
        """The suite that was run."""
        return self._suite or find_beside(Suite.load(self._copy.folder / SUITE), self._copy.folder)

    @cached_property
    def table(self) -> Table:
        """Its rows by column."""
        return Table.of(self.results.rows())

    @property
    def success(self) -> Interval:
        """Wilson's 95 % interval of the share of episodes that arrived."""
        arrived = self.table.arrived
        return wilson(int(arrived.sum()), len(arrived))

    @property
    def outcomes(self) -> dict[str, int]:
        """How many episodes ended how: `arrived` first, then the others from the most frequent."""
        return count_outcomes(self.table)

    @property
    def is_complete(self) -> bool:
        """Whether all episodes of the suite have a row."""
        return len(self) >= self.results.total

    def rows(self) -> Iterator[Row]:
        """Its rows, by index."""
        yield from self.results.rows()  # holds this, and so the copy that is read, until the last row

    def to_pandas(self) -> pandas.DataFrame:
        """Return its rows as a data frame (extra `evaluate`)."""
        return self.results.to_pandas()

    def query(self, sql: str) -> pandas.DataFrame:
        """Ask in SQL, e.g. `SELECT planner, avg(spl) FROM episodes GROUP BY planner` (extra `evaluate`).

        Raises:
            InputError: If the query cannot be run.
        """
        return self.results.query(sql)

    def gates(self, require: Sequence[str] | None = None) -> list[GateResult]:
        """Judge it by requirements, by default those of the suite.

        Raises:
            InputError: If one cannot be read, or names what there is not.
        """
        return [gate.judge(self.table) for gate in self._parse(require)]

    def summary(self, require: Sequence[str] | None = None) -> dict[str, Any]:
        """Return the figures of `summary.json`."""
        results = self.results
        return summarise(self.table, total=results.total, gates=self.gates(require), stopped=results.stopped)

    def compare(self, other: Evaluation | str | os.PathLike[str]) -> Comparison:
        """Compare it, as the reference, with another evaluation of the same missions.

        Raises:
            InputError: If they have no mission in common.
        """
        if not isinstance(other, Evaluation):
            with Evaluation(other) as opened:
                return self.compare(opened)
        return compare(self.table, other.table, names=(self.folder, other.folder))

    def scenario_of(self, prefix: str, *, map: str | os.PathLike[str] | None = None) -> Scenario:
        """Return the exact scenario of the episode whose id starts so; running it repeats the episode.

        Args:
            prefix: The start of its id.
            map: Its map, or the file of its world, or the folder that holds it, where that has moved. By default it is
                where the suite says, or else beside the folder's suite.yaml.

        Raises:
            InputError: If there is none or more than one, or its map is not there, or is another one.
        """
        row = self.results.find(prefix)
        suite = self.suite
        if map is not None:
            suite = use_map(suite, row, map, (self.results.versions, code_versions()))
        check_there(suite, row, self._copy.folder)
        return EpisodeTask(suite).scenario_of(row.index)

    def map_of(self, place: str) -> OccupancyGrid | None:
        """Return the map of a place by the key that its rows have; None where it cannot be made (any more).

        It knows the places of `table.failed` and `table.examples`, which reports draw.
        """
        examples = chain(self.table.failed, *self.table.examples.values())
        row = next((row for row in examples if row.place == place), None)
        if row is None:
            return None
        try:
            return EpisodeTask(self.suite).grid_of(row.index)
        except TrundleError:
            return None

    def close(self) -> None:
        """Free what it holds: open files, and the copy of a folder in an object store."""
        self._opened.close()

    def write_report(self, require: Sequence[str] | None = None, *, apart: bool | None = None) -> str:
        """Write report.html, junit.xml and summary.json into the folder.

        Args:
            require: The requirements to judge by; by default those of the suite.
            apart: Whether a separate process writes them, whose memory is free afterwards. By default it does for more
                than 100,000 episodes.

        Returns:
            The path of report.html.

        Raises:
            OutputError: If they cannot be written.
        """
        if len(self) > _MANY if apart is None else apart:
            write_apart(self.folder, require)
            self._copy.pull(WRITTEN_AFTERWARDS)
        else:
            results = self.results
            write_reports(
                self._copy.folder,
                self.table,
                shown=self.folder,
                name=results.name,
                total=results.total,
                require=self._parse(require),
                maps=self.map_of,
                facts={"started": results.started, **results.versions},
                stopped=results.stopped,
            )
            self._copy.push(WRITTEN_AFTERWARDS)
        return f"{self.folder.rstrip('/')}/{HTML}"

    def read_summary(self) -> dict[str, Any]:
        """Return the figures of summary.json as `write_report` wrote them.

        Raises:
            InputError: If it was not written, or is damaged.
        """
        file = self._copy.folder / SUMMARY
        try:
            return json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InputError(
                f"cannot read {file}: {error}; write it with trundle evaluate report {self.folder}"
            ) from error

    def _parse(self, require: Sequence[str] | None) -> list[Gate]:
        return [Gate.parse(text) for text in (self.suite.require if require is None else require)]


def find_beside(suite: Suite, folder: Path) -> Suite:
    """Return the suite with the files of a folder in place of those that are not where it says."""

    def moved(path: str) -> str:
        beside = folder / Path(path).name
        return str(beside) if not exists(path) and exists(beside) else path

    return suite.with_paths(moved)


def use_map(suite: Suite, row: Row, place: str | os.PathLike[str], versions: tuple[Mapping[str, str], ...]) -> Suite:
    """Return the suite with a map, or a world's file, in place of the one that an episode was driven in.

    Args:
        suite: The suite of the evaluation.
        row: The row of the episode.
        place: The file, or the folder that holds it.
        versions: Versions of the code that made the row, and of the code here; where they are equal, the content is
            compared.

    Raises:
        InputError: If it is not there, or is another map than that of the episode.
    """
    at = _world_of(suite, row)
    world = suite.worlds[at]
    if not world.is_file:
        raise InputError(
            f"--map {os.fspath(place)}: episode {row.id} was driven in a generated world, {row.world}; leave --map out"
        )
    given = Path(place)
    found = {"name": str(given)}
    if given.is_dir():
        files = {field: str(given / Path(path).name) for field, path in world.files().items()}
        found = {field: path for field, path in files.items() if exists(path)}
        if "name" not in found:
            raise InputError(f"--map {given}: there is no {Path(world.name).name} in it; give the folder that has it")
    elif not exists(given):
        raise InputError(f"--map {given}: no such file{advise_missing(given)}")
    worlds = [*suite.worlds]
    worlds[at] = SuiteWorld.model_validate({**world.model_dump(), **found, "label": row.world})
    changed = suite.with_fields(worlds=worlds)
    if versions[0] == versions[1] and facts_of(changed.spec(row.index))["place"] != row.place:
        raise InputError(
            f"--map {found['name']}: this is not the map of episode {row.id}, {row.world}: its content is different; "
            "give the map as it was"
        )
    return changed


def check_there(suite: Suite, row: Row, folder: Path) -> None:
    """Refuse an episode of which a file is missing.

    Raises:
        InputError: If one is; the message says how to give it.
    """
    for path in suite.worlds[_world_of(suite, row)].files().values():
        if not exists(path):
            raise InputError(
                f"{path}: this file of episode {row.id} is not there any more; put it beside {folder / 'suite.yaml'}, "
                "or give it, or its folder, with --map"
            )


def _world_of(suite: Suite, row: Row) -> int:
    return Expansion(suite).world_of(row.index)
