"""Which transport is opened, and what is said where none can be."""

import pytest

from trundle.errors import InputError, TransportError, UnknownNameError
from trundle.ros2.transport import opening
from trundle.ros2.transport.domain import Settings
from trundle.ros2.transport.opening import open_transport, why_not


class Opened:
    def __init__(self, name: str, settings: Settings, **options: object) -> None:
        self.name, self.settings, self.options = name, settings, options


@pytest.fixture(autouse=True)
def dds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(opening, "DdsTransport", lambda settings, **more: Opened("dds", settings, **more))
    monkeypatch.setattr(opening.library, "why_not", lambda: "")


def rclpy_is(monkeypatch: pytest.MonkeyPatch, error: Exception | None = None) -> None:
    def open_rclpy(settings: Settings, **more: object) -> Opened:
        if error is not None:
            raise error
        return Opened("rclpy", settings, **more)

    monkeypatch.setattr(opening, "open_rclpy", open_rclpy)


def test_auto_is_rclpy_where_it_is_there_and_otherwise_dds(monkeypatch: pytest.MonkeyPatch) -> None:
    rclpy_is(monkeypatch)
    assert open_transport(settings=Settings()).name == "rclpy"
    rclpy_is(monkeypatch, TransportError("no rclpy"))
    transport = open_transport(settings=Settings(), node="robot", namespace="/ns")
    assert transport.name == "dds"
    assert transport.options == {"node": "robot", "namespace": "/ns"}  # pyright: ignore[reportAttributeAccessIssue]


def test_a_kind_that_is_named_is_the_one_that_is_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    rclpy_is(monkeypatch)
    assert open_transport("dds", settings=Settings()).name == "dds"
    assert open_transport("rclpy", settings=Settings(), python="/usr/bin/python3").name == "rclpy"
    rclpy_is(monkeypatch, TransportError("no rclpy"))
    with pytest.raises(TransportError, match="no rclpy"):
        open_transport("rclpy", settings=Settings())
    with pytest.raises(UnknownNameError, match="zenoh"):
        open_transport("zenoh", settings=Settings())  # pyright: ignore[reportArgumentType]


def test_auto_does_not_fall_back_where_the_user_chose(monkeypatch: pytest.MonkeyPatch) -> None:
    rclpy_is(monkeypatch, TransportError("no rclpy"))
    with pytest.raises(TransportError, match="no rclpy"):
        open_transport(settings=Settings(), python="/usr/bin/python3")
    with pytest.raises(TransportError, match="no rclpy"):
        open_transport(settings=Settings(rmw="rmw_zenoh_cpp"))
    rclpy_is(monkeypatch, InputError("another distribution"))
    with pytest.raises(InputError, match="another distribution"):
        open_transport(settings=Settings())


def test_where_there_is_neither_both_reasons_are_given(monkeypatch: pytest.MonkeyPatch) -> None:
    rclpy_is(monkeypatch, TransportError("no Python imports rclpy"))
    monkeypatch.setattr(opening.library, "why_not", lambda: "no wheel here")
    with pytest.raises(TransportError, match=r"no wheel here.*no Python imports rclpy"):
        open_transport(settings=Settings())


def test_why_not_asks_without_opening(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(opening.library, "why_not", lambda: "no wheel here")
    monkeypatch.setattr(opening.find, "why_not", lambda python: f"not in {python}")
    assert why_not("dds") == "no wheel here"
    assert why_not("rclpy", python="/usr/bin/python3") == "not in /usr/bin/python3"
