"""`EpisodeSpec`: everything that decides one episode."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from trundle.evaluation.suite.parts import ListedMission, Missions
from trundle.mission import Scenario


@dataclass(frozen=True, slots=True)
class EpisodeSpec:
    """Everything that decides one episode of a suite.

    Attributes:
        index: Number of the episode in its suite.
        id: Hash of everything that decides the episode; 16 hexadecimal digits.
        world: Label of the world.
        robot: Label of the robot.
        planner: Label of the planner.
        controller: Likewise; or of the agent, whose planner is `none`.
        backend: Likewise.
        settings: What else the suite crosses, as `name=value`, separated by spaces.
        seed: Of the mission.
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
    backend: str
    settings: str
    seed: int
    scenario: Scenario
    missions: Missions
    listed: ListedMission | None
    vary: Mapping[str, float]
    reference: str | None
    content: tuple[str, str]
