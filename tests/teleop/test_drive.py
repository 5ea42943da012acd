"""Driving by hand passes the stop check."""

import math

import pytest

from trundle.errors import SimulationError
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.mission import LiveRun
from trundle.record.drive_log import DriveLog
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.teleop.drive import drive_by_hand
from trundle.worlds import World

WALL = World("wall", (Solid("wall", Box((0.2, 6.0, 1.0)), Pose3D((2.0, 0.0, 0.5))),))


class Script:
    """Keys that hold a command for so many control periods, and then leave."""

    def __init__(self, *held: tuple[Twist2D, int]) -> None:
        self._commands = [command for command, periods in held for _ in range(periods)]

    def read(self) -> Twist2D | None:
        return self._commands.pop(0) if self._commands else None


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drive as fast as the simulator can."""
    make = LiveRun.__init__

    def init(self: LiveRun, *arguments: object) -> None:
        make(self, *arguments, speed=math.inf)  # type: ignore[arg-type]

    monkeypatch.setattr(LiveRun, "__init__", init)


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
@pytest.mark.usefixtures("quick")
def test_keys_into_a_wall_stop_before_it_and_lead_away_again(backend: str) -> None:
    log, steps = DriveLog(), []
    keys = Script((Twist2D(0.8, 0.0), 120), (Twist2D(-0.5, 0.0), 30))
    with simulate(WALL, Robot.load("nova_carter"), backend=backend) as sim:
        drive_by_hand(sim, Pose2D(0.0, 0.0), log, keys, steps.append, period_s=0.05, seed=0)
    assert len(steps) == 150
    assert all(step.state.contacts == () for step in steps)
    assert steps[119].steering.held_back == "stopped before a solid of the world"
    assert steps[119].state.twist.v == pytest.approx(0.0, abs=0.01)
    front = steps[119].state.pose.x + Robot.load("nova_carter").planar.outline[:, 0].max()
    assert 1.6 < front < 1.9
    assert steps[-1].steering.held_back == ""
    assert steps[-1].state.pose.x < steps[119].state.pose.x - 0.3
    assert len(log) == 151


@pytest.mark.usefixtures("quick")
def test_a_screen_that_fails_ends_the_drive() -> None:
    def show(_step: object) -> None:
        raise OSError("the terminal is gone")

    with (
        simulate(WALL, Robot.load("nova_carter"), backend="kinematic") as sim,
        pytest.raises(OSError, match="the terminal is gone"),
    ):
        drive_by_hand(sim, Pose2D(0.0, 0.0), DriveLog(), Script((Twist2D(), 9)), show, period_s=0.05, seed=0)


@pytest.mark.usefixtures("quick")
def test_a_simulator_that_fails_ends_the_drive(monkeypatch: pytest.MonkeyPatch) -> None:
    with simulate(WALL, Robot.load("nova_carter"), backend="kinematic") as sim:

        def fail(command: Twist2D, dt: float) -> None:
            raise SimulationError("the physics diverged")

        monkeypatch.setattr(sim, "step", fail)
        with pytest.raises(SimulationError, match="diverged"):
            drive_by_hand(sim, Pose2D(0.0, 0.0), DriveLog(), Script((Twist2D(), 9)), print, period_s=0.05, seed=0)
