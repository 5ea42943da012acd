import pytest

from trundle.errors import SimulationError
from trundle.robots import Robot
from trundle.viewer.native import NativeWindow, has_screen
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
