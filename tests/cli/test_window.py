import time
from pathlib import Path
from types import TracebackType

import pytest

from support.command_line import Trundle
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.mission import Step
from trundle.navigation import NavigationStatus
from trundle.robots import WheelSpeeds
from trundle.sim import RobotState
from trundle.viewer.native import Watcher


class FakeWindow:
    """Stands for MuJoCo's window: keys come at given looks, and somebody closes it after so many."""

    def __init__(self, keys: dict[int, list[str]], looks: int) -> None:
        self.keys = keys
        self.looks = looks
        self.look = 0
        self.shown: list[Pose2D] = []
        self.routes: list[tuple[FloatArray | None, Pose2D | None]] = []

    @property
    def is_open(self) -> bool:
        return self.look < self.looks

    def read_keys(self) -> list[str]:
        return self.keys.get(self.look, [])

    def show(self, state: RobotState) -> None:
        self.shown.append(state.pose)
        self.look += 1

    def mark_route(self, path: FloatArray | None, goal: Pose2D | None) -> None:
        self.routes.append((path, goal))

    def __enter__(self) -> "FakeWindow":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.look = self.looks


def use(window: FakeWindow, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("trundle.viewer.native.open_window", lambda world, robot, pose: window)


def test_the_arrow_keys_of_a_window_drive(trundle: Trundle, monkeypatch: pytest.MonkeyPatch) -> None:
    window = FakeWindow({0: ["up", "up"], 10: ["stop", "left"]}, looks=20)
    use(window, monkeypatch)
    done = trundle("drive", "nova_carter", "--teleop", "--view", "--json")
    assert done.code == 0, done.err
    assert done.json[0]["x"] > 0.05
    assert done.json[0]["yaw"] > 0.005
    assert len(window.shown) == 20


def test_commands_are_shown_in_real_time(trundle: Trundle, monkeypatch: pytest.MonkeyPatch) -> None:
    window = FakeWindow({}, looks=1000)
    use(window, monkeypatch)
    began = time.monotonic()
    done = trundle("drive", "nova_carter", "--command", "0.4,0,0.5", "--view")
    assert done.code == 0, done.err
    assert time.monotonic() - began >= 0.45
    assert len(window.shown) == 10


def test_a_run_is_watched(trundle: Trundle, room_map: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    window = FakeWindow({}, looks=4)
    use(window, monkeypatch)
    ends = ("--start", "0.5,0.5", "--goal", "1.5,0.5")
    done = trundle("run", room_map, *ends, "--backend", "kinematic", "--no-video", "--view", "--json")
    assert done.code == 0, done.err
    assert done.json["outcome"] == "arrived"
    assert window.shown[0] == Pose2D(0.5, 0.5)
    ((path, goal),) = window.routes
    assert path is not None
    assert goal == Pose2D(1.5, 0.5)
    assert len(window.shown) == 4


def test_a_window_needs_a_screen(trundle: Trundle, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("trundle.viewer.native.has_screen", lambda: False)
    done = trundle("drive", "nova_carter", "--command", "0.4,0,0.5", "--view")
    assert done.code == 2
    assert "--view needs a screen" in done.err


def test_a_watched_run_goes_on_after_the_window_is_closed() -> None:
    window = FakeWindow({}, looks=2)
    watcher = Watcher(window)  # type: ignore[arg-type]
    began = time.monotonic()
    watcher._began = began
    for index in range(5):
        state = RobotState(
            0.02 * index, Pose2D(0.1 * index, 0.0), Twist2D(), WheelSpeeds(0, 0), WheelSpeeds(0, 0), Pose2D(0, 0)
        )
        watcher.on_step(Step(index, state, Twist2D(), 0, None, NavigationStatus.DRIVING))
    assert [pose.x for pose in window.shown] == [0.0, 0.1]
