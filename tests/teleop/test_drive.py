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
from trundle.teleop.drive import DEAD_MAN_S, KeyDrive, StepDrive, drive_by_hand, split_keys
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


@pytest.mark.parametrize(
    ("data", "keys", "rest"),
    [
        (b"ijkl", ["i", "j", "k", "l"], b""),
        (b"I \x1b[A\x1b[B\x1bOC\x1b[D", ["i", " ", "i", "k", "l", "j"], b""),
        (b"\x1b[1;5Aq", ["i", "q"], b""),
        (b"\x1b[3~q", ["q"], b""),
        (b"i\x1b", ["i"], b"\x1b"),
        (b"i\x1b[", ["i"], b"\x1b["),
        (b"\x1bi", ["i"], b""),
        (b"\xff", ["\ufffd"], b""),
    ],
)
def test_keys_and_arrows(data: bytes, keys: list[str], rest: bytes) -> None:
    assert split_keys(data) == (keys, rest)


def test_a_key_counts_until_the_dead_man_lets_go() -> None:
    limits = Robot.load("nova_carter").limits
    drive = KeyDrive(limits)
    assert drive.twist(0.0) == Twist2D()
    drive.press("i", 1.0)
    assert drive.twist(0.99 + DEAD_MAN_S).v == pytest.approx(0.6 * limits.linear_speed)
    assert drive.twist(1.0 + DEAD_MAN_S + 0.01) == Twist2D()


def test_two_keys_drive_an_arc_and_space_stops_both() -> None:
    drive = KeyDrive(Robot.load("nova_carter").limits)
    drive.press("k", 0.0)
    drive.press("l", 0.1)
    assert drive.twist(0.15).v < 0 and drive.twist(0.15).w < 0  # noqa: PT018
    drive.press(" ", 0.2)
    assert drive.twist(0.2) == Twist2D()


def test_other_keys_do_nothing() -> None:
    drive = KeyDrive(Robot.load("nova_carter").limits)
    drive.press("x", 0.0)
    assert (drive.twist(0.0), drive.done) == (Twist2D(), False)


def test_each_press_steps_the_speed_within_the_limits():
    limits = Robot.load("nova_carter").limits
    drive = StepDrive(limits)
    drive.press("up")
    drive.press("left")
    assert drive.twist() == Twist2D(0.2 * limits.linear_speed, 0.2 * limits.angular_speed)
    for _ in range(20):
        drive.press("up")
        drive.press("right")
    assert drive.twist() == Twist2D(limits.linear_speed, -limits.angular_speed)
    drive.press("down")
    assert drive.twist().v == pytest.approx(0.8 * limits.linear_speed)
    drive.press("x")
    drive.press("stop")
    assert drive.twist() == Twist2D(0.0, 0.0)
