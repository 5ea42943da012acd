"""A robot and a navigator of it, on a network in memory, in real time."""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ros2.fake_transport import FakeNetwork
from ros2.nav2_texts import nav2_codec
from ros2.navigator_role.conftest import QUICK_S, wait_for
from ros2.remote.robot import FakeRobot, Habits
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.messages import Codec
from trundle.mission import End, Episode, Scenario
from trundle.mission.steering.directives import Directive
from trundle.robots import Robot
from trundle.ros2.names import Names
from trundle.ros2.remote.bridge import RemoteBridge
from trundle.ros2.remote.setting import RemoteOptions
from trundle.ros2.types import Types

START = Pose2D(2.0, 2.0, 0.0)
STAND = Twist2D()

LOOKS_S = 0.03
"""Two looks of a test are no further apart, where the machine runs it."""


@cache
def jazzy() -> Codec:
    """One for all tests: it takes a while to load."""
    return Codec("jazzy")


def make_room() -> OccupancyGrid:
    """A walled room of 10 x 8 m with a pillar, so that no two places look the same."""
    data = np.zeros((160, 200), dtype=np.int8)
    data[[0, -1], :] = 100
    data[:, [0, -1]] = 100
    data[100:120, 40:52] = 100
    data[20:30, 150:180] = 100
    return OccupancyGrid(data, 0.05)


@pytest.fixture(scope="session")
def room_file(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("remote") / "room.yaml"
    make_room().save(path)
    return str(path)


@pytest.fixture(scope="session")
def quick_waffle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A TurtleBot3 that drives three times as fast: tests wait for it in real time."""
    path = tmp_path_factory.mktemp("robot") / "turtlebot3_waffle.yaml"
    catalogue = Path(str(resources.files("trundle.robots"))) / "catalogue"
    text = (catalogue / path.name).read_text(encoding="utf-8")
    assert "linear_speed: 0.26" in text
    path.write_text(text.replace("linear_speed: 0.26", "linear_speed: 0.78"), encoding="utf-8")
    return path


class Remote:
    """A robot, and trundle's navigator that drives it in a thread."""

    def __init__(self, robot: FakeRobot, bridge: RemoteBridge, said: list[str]) -> None:
        self.robot, self.bridge, self.said = robot, bridge, said
        self.episode: Episode | None = None
        self._stops: Counter[str] = Counter()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        self.episode = self.bridge.run()

    @property
    def habits(self) -> Habits:
        return self.robot.habits

    @property
    def reasons(self) -> set[str]:
        return set(self.bridge.guard.reasons)

    @property
    def kinds(self) -> set[str]:
        return set(self.bridge.wire.warnings.counts)

    def put(self, directive: Directive) -> None:
        self.bridge.context.driver.steering.put(directive)

    def wait_until_moving(self) -> None:
        wait_for(lambda: abs(self.robot.twist.v) > 0.1, f"for a motion: {self.bridge.guard.reasons}")
        self._stops = Counter(self.bridge.guard.counts)

    def stops(self, kind: str) -> int:
        """How often it has stopped for this reason since it was last seen to move."""
        return self.bridge.guard.counts[kind] - self._stops[kind]

    def wait_until_standing(self) -> float:
        """Wait until the robot is commanded to stand, or not at all.

        Returns:
            How long that took [s], without the times in which the machine did not run this process.
        """
        looked = began = time.monotonic()

        def is_stopped() -> bool:
            nonlocal looked, began
            before, looked = looked, time.monotonic()
            began += max(0.0, looked - before - LOOKS_S)
            at, command = self.robot.commands[-1]
            return command == STAND or looked - at > 0.6

        wait_for(is_stopped, "for a stop")
        at, _ = self.robot.commands[-1]
        return at - began

    def wait_for_end(self) -> Episode:
        self._thread.join(QUICK_S)
        assert not self._thread.is_alive(), f"it does not end: {self.bridge.guard.reasons}"
        assert self.episode is not None
        return self.episode

    def close(self) -> None:
        if self._thread.is_alive():
            self.put(End("the test is over"))
            self._thread.join(QUICK_S)
        self.bridge.close()
        self.robot.close()


@pytest.fixture
def network() -> FakeNetwork:
    return FakeNetwork()


@pytest.fixture
def navigate(network: FakeNetwork, room_file: str, quick_waffle: Path) -> Iterator[Callable[..., Remote]]:
    """Makes a robot and its navigator; they are closed after the test."""
    made: list[Remote] = []

    def navigate(
        *,
        goal: tuple[float, ...] | None = (2.7, 2.2),
        start: Pose2D | None = START,
        localizer: str = "odometry",
        robot: str | Path = quick_waffle,
        habits: dict[str, Any] | None = None,
        starts_robot: bool = True,
        options: dict[str, Any] | None = None,
        has_services: bool = False,
        has_map: bool = True,
        room: OccupancyGrid | None = None,
        more: dict[str, Any] | None = None,
        **scenario: Any,
    ) -> Remote:
        theirs = FakeRobot(network, jazzy(), room or make_room(), Robot.load(str(robot)), START)
        theirs.habits = Habits(**habits or {})
        if starts_robot:
            theirs.start()
        transport = network.transport("trundle", has_services=has_services)
        said: list[str] = []
        chosen = None if localizer == "tf" else localizer
        place = {"map": room_file} if has_map else {"world": {"name": "lot"}, "known_map": False}
        given = Scenario.make(**place, lidar=True, robot=str(robot), localizer=chosen, **scenario)
        how = RemoteOptions(
            localizer="tf" if localizer == "tf" else None,
            start=start,
            goals=() if goal is None else (Goal.of(goal),),
            **options or {},
        )
        codec = nav2_codec("jazzy") if has_services else jazzy()
        bridge = RemoteBridge(given, transport, Types(codec, transport), Names(), how, report=said.append, **more or {})
        made.append(Remote(theirs, bridge, said))
        return made[-1]

    yield navigate
    for remote in made:
        remote.close()
