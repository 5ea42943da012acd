"""Whether Cyclone DDS is here, and what to do where it is not."""

import re

import pytest

from trundle.errors import MissingExtraError, TransportError
from trundle.extras import install_line
from trundle.ros2.transport.dds import library
from trundle.ros2.transport.dds.node import DdsTransport
from trundle.ros2.transport.domain import Settings


@pytest.fixture
def without(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)


def test_where_it_is_installed_it_can_be_used() -> None:
    pytest.importorskip("cyclonedds", reason="cyclonedds is not installed, or has no wheel here")
    assert library.why_not() == ""


@pytest.mark.usefixtures("without")
def test_where_it_is_not_installed_the_line_that_installs_it_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(library, "lacks_wheels", lambda: False)
    with pytest.raises(MissingExtraError, match=re.escape(install_line("ros2"))):
        DdsTransport(Settings())
    assert "cyclonedds" in library.why_not()


@pytest.mark.usefixtures("without")
def test_where_it_has_no_wheel_rclpy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("platform.machine", lambda: "aarch64")
    monkeypatch.setattr("sys.platform", "linux")
    with pytest.raises(TransportError, match=r"aarch64.*--transport rclpy still works"):
        DdsTransport(Settings())
    monkeypatch.setattr("platform.machine", lambda: "x86_64")
    monkeypatch.setattr("sys.version_info", (3, 14, 0))
    assert library.lacks_wheels()


def test_a_library_that_does_not_load_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(name: str) -> None:
        raise OSError("libddsc is damaged")

    monkeypatch.setattr("importlib.util.find_spec", lambda name: name)
    monkeypatch.setattr("importlib.import_module", fail)
    with pytest.raises(TransportError, match="does not load: libddsc is damaged"):
        DdsTransport(Settings())
