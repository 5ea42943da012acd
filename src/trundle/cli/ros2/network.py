"""What both verbs of `trundle ros2` share: the options of the network, and joining it."""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

from cyclopts import Parameter

from trundle.cli.shared import options
from trundle.extras import missing_extra

if TYPE_CHECKING:
    from trundle.ros2.names import Names
    from trundle.ros2.transport.domain import Settings
    from trundle.ros2.transport.transport import Transport


StaticFrames: TypeAlias = Annotated[
    Literal["auto", "always", "never"],
    Parameter(
        name="--static-frames",
        help="Publish where the robot's sensors and wheels are: where nobody else does (auto), always or never.",
    ),
]
"""The option of every verb that publishes a robot's frames."""

Namespace: TypeAlias = Annotated[str, Parameter(name="--namespace", help="Namespace of all relative names: robot1.")]

Remaps: TypeAlias = Annotated[
    list[str] | None,
    Parameter(
        name="--remap",
        negative="",
        metavar="FROM:=TO",
        help="Rename a topic, service or action as ROS does: scan:=front/scan; __node:=NAME renames the node; "
        "repeatable.",
    ),
]


@Parameter(name="*")
@dataclass(frozen=True, slots=True)
class NetworkOptions:
    """Options of the network of ROS 2.

    Attributes:
        distro: The distribution whose types are spoken.
        transport: What carries the messages.
        range_: How far others are looked for.
        domain: The domain.
        ros_python: The Python of the sourced ROS, for rclpy.
    """

    distro: Annotated[
        Literal["humble", "jazzy", "kilted", "lyrical"] | None,
        Parameter(name="--distro", help="The distribution of the other side; default: ROS_DISTRO, otherwise jazzy."),
    ] = None
    transport: Annotated[
        Literal["auto", "dds", "rclpy"],
        Parameter(
            name="--transport",
            help="dds: topics alone, without a ROS installation; rclpy: also services and actions, through the rclpy "
            "of a sourced ROS; auto: rclpy where it can be imported, otherwise dds.",
        ),
    ] = "auto"
    range_: Annotated[
        Literal["localhost", "subnet"] | None,
        Parameter(
            name="--range",
            help="Who is looked for: programs on this machine (localhost, the default), or those in its networks.",
        ),
    ] = None
    domain: Annotated[
        options.Integer | None,
        Parameter(name="--domain", help="The domain, 0 to 232; default: ROS_DOMAIN_ID, otherwise 0."),
    ] = None
    ros_python: Annotated[
        str | None,
        Parameter(
            name="--ros-python",
            metavar="PYTHON",
            help="The Python that imports rclpy; default: TRUNDLE_ROS_PYTHON, otherwise the python3 of PATH.",
        ),
    ] = None

    def read(self) -> Settings:
        """Read the settings of the network from the environment; options come before it.

        Raises:
            InputError: If a setting cannot be used.
        """
        from trundle.ros2.transport.domain import read_settings

        return read_settings(distro=self.distro, domain=self.domain, range_=self.range_)

    def open(self, settings: Settings, names: Names) -> Transport:
        """Join the network as a node.

        Args:
            settings: What `read` gave.
            names: Name of the node, and its namespace.

        Raises:
            MissingExtraError: If a library is not installed.
            TransportError: If the network cannot be joined.
        """
        from trundle.ros2.transport.opening import open_transport

        return open_transport(
            self.transport, settings=settings, node=names.node, namespace=names.namespace, python=self.ros_python
        )


def check_extra() -> None:
    """Check that the library of messages is installed, which both transports need.

    Raises:
        MissingExtraError: If it is not; the message gives the install command.
    """
    if importlib.util.find_spec("rosbags") is None:
        raise missing_extra("trundle ros2", "rosbags", "ros2")


DEFAULTS = NetworkOptions()
"""Default options."""
