import pytest

from trundle.geometry import Twist2D
from trundle.robots import Robot
from trundle.teleop.keys import DEAD_MAN_S, KeyDrive, StepDrive, split_keys


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
