"""`open_transport`: the user's own ROS where there is one, otherwise Cyclone DDS."""

from __future__ import annotations

from typing import Literal, TypeAlias, get_args

from trundle.errors import TransportError, UnknownNameError
from trundle.ros2.transport.dds import library
from trundle.ros2.transport.dds.node import DdsTransport
from trundle.ros2.transport.domain import NOT_DDS, Settings
from trundle.ros2.transport.rclpy import find
from trundle.ros2.transport.rclpy.relay import open_rclpy
from trundle.ros2.transport.transport import Transport

Kind: TypeAlias = Literal["auto", "dds", "rclpy"]

KINDS: tuple[Kind, ...] = get_args(Kind)


def open_transport(
    kind: Kind = "auto",
    *,
    settings: Settings,
    node: str = "trundle",
    namespace: str = "",
    python: str | None = None,
) -> Transport:
    """Join the network of ROS 2.

    Args:
        kind: "rclpy" is the user's own ROS, with services and actions; "dds" is Cyclone DDS, topics alone. "auto" is
            rclpy where a Python imports it, and otherwise dds; `Transport.notes` then says what is off.
        settings: Domain and range; see `read_settings`.
        node: Name of our node.
        namespace: Its namespace ("/robot"); "" for none.
        python: The Python that imports rclpy; otherwise it is looked for.

    Raises:
        UnknownNameError: If there is no such kind.
        TransportError: If no transport can be used; the message says why, and what to do.
        MissingExtraError: If a library is not installed.
        InputError: If the settings cannot be used, such as another distribution than that of the ROS found.
    """
    if kind not in KINDS:
        raise UnknownNameError("transport", kind, KINDS)
    if kind == "dds":
        return DdsTransport(settings, node=node, namespace=namespace)
    # A Python that was named, or programs that nothing else reaches, leave no choice.
    if kind == "rclpy" or python is not None or settings.rmw in NOT_DDS:
        return open_rclpy(settings, node=node, namespace=namespace, python=python)
    try:
        return open_rclpy(settings, node=node, namespace=namespace)
    except TransportError as error:
        no_dds = library.why_not()
        if no_dds:
            raise TransportError(f"{no_dds}. And {error}") from error
        return DdsTransport(settings, node=node, namespace=namespace)


def why_not(kind: Literal["dds", "rclpy"], *, python: str | None = None) -> str:
    """Return why a transport cannot be used here, and what to do about it; "" if it can. It opens none."""
    return library.why_not() if kind == "dds" else find.why_not(python)
