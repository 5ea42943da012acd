import pytest

from trundle.errors import SimulationError
from trundle.geometry import Twist2D
from trundle.robots import Robot
from trundle.viewer.native import NativeWindow, StepDrive, has_screen
from trundle.worlds import World


@pytest.fixture
def carter():
    return Robot.load("nova_carter")


def test_without_a_display_there_is_no_screen_and_no_window(monkeypatch, carter):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    assert not has_screen()
    with pytest.raises(SimulationError, match="no screen"):
        NativeWindow(World("empty", ()), carter)


def test_a_display_that_does_not_answer_is_no_screen(monkeypatch):
    monkeypatch.setenv("DISPLAY", ":4095")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert not has_screen()


def test_each_press_steps_the_speed_within_the_limits(carter):
    drive = StepDrive(carter.limits)
    drive.press("up")
    drive.press("left")
    assert drive.twist() == Twist2D(0.2 * carter.limits.linear_speed, 0.2 * carter.limits.angular_speed)
    for _ in range(20):
        drive.press("up")
        drive.press("right")
    assert drive.twist() == Twist2D(carter.limits.linear_speed, -carter.limits.angular_speed)
    drive.press("down")
    assert drive.twist().v == pytest.approx(0.8 * carter.limits.linear_speed)
    drive.press("x")
    drive.press("stop")
    assert drive.twist() == Twist2D(0.0, 0.0)
