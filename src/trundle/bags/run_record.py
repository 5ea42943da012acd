"""`RunRecord`: what trundle's own recordings say about their run, in metadata records."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, cast

from pydantic import TypeAdapter, ValidationError

from trundle.bags.records import open_bag_file
from trundle.errors import InputError
from trundle.mission import RunInfo, Scenario
from trundle.robots import Robot

RUN_RECORD, END_RECORD = "trundle", "trundle_episode"
"""Names of the metadata records with the settings of the run, and with its episode."""

FORMAT = "1"


@dataclass(frozen=True, slots=True)
class RunFacts:
    """The settings of a run; see `RunInfo`."""

    name: str
    planner: str
    controller: str
    seed: int
    start: tuple[float, float, float]
    goals: tuple[tuple[float, float] | tuple[float, float, float], ...]
    dt: float
    time_limit_s: float | None
    path_length_m: float
    localizer: str = "none"


@dataclass(frozen=True, slots=True, eq=False)
class RunRecord:
    """The settings and the end of a recorded run.

    Attributes:
        distro: Distribution of ROS 2 whose types the recording has.
        run: Its settings.
        robot: The robot.
        scenario: What repeats the run, or None.
        episode: Its episode as `Episode.as_dict` has it; None if the run did not end.
    """

    distro: str
    run: RunFacts
    robot: Robot
    scenario: Scenario | None
    episode: Mapping[str, Any] | None


def describe_run(run: RunInfo, scenario: Scenario | None, distro: str) -> dict[str, str]:
    """Return the settings of a run as a metadata record."""
    facts = RunFacts(
        name=run.name,
        planner=run.planner,
        controller=run.controller,
        seed=run.seed,
        start=run.start.as_tuple(),
        goals=cast("tuple[tuple[float, float], ...]", tuple(tuple(goal) for goal in run.goals)),
        dt=run.dt,
        time_limit_s=run.time_limit_s if math.isfinite(run.time_limit_s) else None,
        path_length_m=run.path_length_m,
        localizer=run.localizer,
    )
    texts: dict[str, object] = {"run": asdict(facts), "robot": run.robot.model_dump(mode="json")}
    if scenario is not None:
        texts["scenario"] = scenario.model_dump(mode="json", exclude_none=True)
    return {"format": FORMAT, "distro": distro, **{name: json.dumps(value) for name, value in texts.items()}}


def read_record(path: Path) -> RunRecord | None:
    """Read the records of a complete MCAP file; None where it is another file, or of another writer.

    Raises:
        InputError: If a record of trundle's is damaged, or of a later version.
    """
    from mcap.exceptions import McapError
    from mcap.reader import make_reader

    if path.suffix != ".mcap" or not path.is_file():
        return None
    try:
        with open_bag_file(path) as stream:
            records = {record.name: record.metadata for record in make_reader(stream).iter_metadata()}
    except (McapError, ValueError, OSError, OverflowError, struct.error) as error:
        raise InputError(f"{path}: its metadata cannot be read: {error}") from error
    return parse_records(path, records)


def parse_records(path: Path, records: Mapping[str, Mapping[str, str]]) -> RunRecord | None:
    """Read what the metadata records, by name, say about a run; see `read_record`."""
    facts = records.get(RUN_RECORD)
    if facts is None:
        return None
    if facts.get("format") != FORMAT:
        found = facts.get("format")
        raise InputError(
            f"{path}: recorded by a later version of trundle (format {found!r}, not {FORMAT}); use that one"
        )
    try:
        scenario = json.loads(facts["scenario"]) if "scenario" in facts else None
        ended = records.get(END_RECORD)
        return RunRecord(
            facts["distro"],
            TypeAdapter(RunFacts).validate_python(json.loads(facts["run"])),
            Robot.model_validate(json.loads(facts["robot"])),
            None if scenario is None else Scenario.make(**scenario),
            None if ended is None else json.loads(ended["episode"]),
        )
    except (KeyError, TypeError, ValueError, ValidationError, RecursionError) as error:
        raise InputError(f"{path}: its settings are damaged: {error}") from error
