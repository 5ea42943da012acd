"""`EpisodeSpec`, everything that decides an episode; and hashes of it by content: paths and labels do not count."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from trundle.errors import InputError
from trundle.evaluation.suite.parts import ListedMission, Missions, SuiteWorld
from trundle.files.opening import describe_unreadable, open_file
from trundle.files.yaml_config import plain_value
from trundle.files.yaml_nodes import compose
from trundle.geometry import Goal, Pose2D
from trundle.mission import Scenario
from trundle.robots import Robot

_DIGITS = 16
_BLOCK = 1 << 20


def digest(value: Any) -> bytes:
    """Return the hash of a plain value: mappings by their keys, whatever the order."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), default=_plain)
    return hashlib.sha256(text.encode()).digest()


def short(parts: Iterable[bytes]) -> str:
    """Return the hash of several hashes, as it stands in results."""
    return hashlib.sha256(b"".join(parts)).hexdigest()[:_DIGITS]


def mission_hash(content: tuple[str, str], start: Pose2D, goals: Iterable[Goal], seed: int) -> str:
    """Return the hash of a mission: world, robot, start, goals and seed."""
    ends = [list(start.as_tuple()), [list(goal) for goal in goals]]
    return short([digest([*content, ends, seed])])


def unsampled_hash(content: tuple[str, str], rule: dict[str, Any], seed: int) -> str:
    """Return the hash of a mission whose start and goal could not be sampled: of how they would have been."""
    return short([digest([*content, rule, seed])])


def robot_content(robot: str) -> bytes:
    """Return the hash of a robot, wherever its description is."""
    return digest(Robot.load(robot).model_dump(mode="json"))


def world_content(world: SuiteWorld) -> bytes:
    """Return the hash of a world: the contents of its files, or how it is generated; without what is drawn by seed.

    Raises:
        InputError: If a file is not there.
    """
    plain = world.model_dump(mode="json", include={"compat", "floor_z", "options"}, exclude_defaults=True)
    plain["files"] = {
        field: _file_hash(path, is_map=world.is_map if field == "name" else field != "reference")
        for field, path in world.files().items()
    }
    if not world.is_file:
        plain |= {"generator": world.name, "seed": world.seed}
    return digest(plain)


def world_of_seed(world: SuiteWorld, content: bytes, seed: int) -> bytes:
    """Return the hash of the world that a seed has: with what is drawn."""
    if not world.is_seeded:
        return content
    return digest([content.hex(), world.draw_options(seed), seed if world.seed is None else world.seed])


def _file_hash(path: str, *, is_map: bool) -> str:
    """Return the hash of a file's content; of a map's YAML also of its image's."""
    found = hashlib.sha256(_hash(Path(path)))
    if is_map and Path(path).suffix.lower() != ".map":
        settings = plain_value(compose(path, allow_duplicate_keys=True), path)
        image = settings.get("image") if isinstance(settings, dict) else None
        if not isinstance(image, str):
            raise InputError(f"{path}: this is no map: it has no image")
        found.update(_hash(Path(path).parent / image))
    return found.hexdigest()


def _hash(path: Path) -> bytes:
    found = hashlib.sha256()
    try:
        with open_file(path) as stream:
            while block := stream.read(_BLOCK):
                found.update(block)
    except OSError as error:
        raise InputError(describe_unreadable(path, error)) from error
    return found.digest()


def _plain(value: Any) -> Any:
    if hasattr(value, "model_dump"):
        return value.model_dump(mode="json")
    raise TypeError(f"{value!r} has no canonical form")


@dataclass(frozen=True, slots=True)
class EpisodeSpec:
    """Everything that decides one episode of a suite.

    Attributes:
        index: Number of the episode in its suite.
        id: Hash of everything that decides the episode; 16 hexadecimal digits.
        world: Label of the world.
        robot: Label of the robot.
        planner: Label of the planner.
        controller: Label of the controller; or of the agent, whose planner is `none`.
        agent: Label of the agent; `navigator` where planner and controller drive.
        backend: Label of the simulator.
        settings: What else the suite crosses, as `name=value`, separated by spaces.
        seed: Seed of the mission.
        scenario: The scenario; without start and goal where they are sampled.
        missions: How they are sampled.
        listed: The mission, where it is listed.
        vary: The values that were drawn, by name.
        reference: Path of the file of the world's reference path, if it has one.
        content: Hashes of the contents of the world and the robot, which a mission is identified by.
    """

    index: int
    id: str
    world: str
    robot: str
    planner: str
    controller: str
    agent: str
    backend: str
    settings: str
    seed: int
    scenario: Scenario
    missions: Missions
    listed: ListedMission | None
    vary: Mapping[str, float]
    reference: str | None
    content: tuple[str, str]
