"""`RosAgent`: an agent that drives what comes on /cmd_vel."""

from __future__ import annotations

from typing import Any

from trundle.errors import InputError
from trundle.geometry import Goal, Twist2D
from trundle.messages.qos import Qos
from trundle.navigation import Agent, AgentInfo, NavigationStatus
from trundle.observation import Estimate, Observation
from trundle.robots import Robot
from trundle.ros2.inputs.checks import BadInputError, check_frame, check_stamp, check_twist
from trundle.ros2.inputs.command_arbiter import TIMEOUT_S, CommandArbiter
from trundle.ros2.profile import Profile
from trundle.ros2.simulation.clock import SimulationClock
from trundle.ros2.wire import Inlet, Wire

COMMANDS = Qos(10)
"""Of /cmd_vel: reliable, as most publishers are; Nav2's and teleop's offer that."""

_TWIST, _STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"


class RosAgent(Agent):
    """Drives what other programs command on /cmd_vel, as Twist or as TwistStamped.

    A command holds for 0.5 s of simulated time; then the robot stops. Where the last publisher goes, or the transport
    is lost, it stops at once. The robot's limits are applied by the simulator; nothing else is changed or checked, as
    on a real robot.

    Args:
        wire: The network.
        profile: The names.
        clock: The simulated time.
        robot: The robot.

    Attributes:
        status: DRIVING.
        dt: Length of a control period [s].
        robot: The robot.
    """

    def __init__(self, wire: Wire, profile: Profile, clock: SimulationClock, robot: Robot) -> None:
        self._wire, self._clock = wire, clock
        self.robot = robot
        self.dt = profile.control_period_s
        self.status = NavigationStatus.DRIVING
        self._topic = wire.names.resolve(profile.topics.cmd_vel)
        frames = profile.frames
        bases = (frames.base, *frames.also_base)
        self._frames = tuple(dict.fromkeys(name for base in bases for name in (wire.names.frame(base), base)))
        self._arbiter = CommandArbiter(wire.warn, wire.describe_source)
        self._inlets: list[Inlet] = []
        self._had_writers = False

    def open(self) -> None:
        """Listen to commands of both types."""
        topic, wire = self._topic, self._wire
        self._inlets = [
            wire.listen(topic, _TWIST, COMMANDS, self._take),
            wire.listen(topic, _STAMPED, COMMANDS, self._take_stamped),
        ]
        wire.every_round(self._look)

    def lost(self, why: str) -> None:
        """Stop where the other side is lost."""
        if why and self._arbiter.clear():
            self._wire.warnings.note(f"the robot stops, as the other side is lost: {why}")

    # The session's thread -------------------------------------------------------------------------------------------

    def info(self) -> AgentInfo:
        """Say that ROS 2 drives this robot."""
        return AgentInfo("ros2", robot=self.robot)

    def reset(self, *, seed: int = 0) -> None:
        """Forget the last command."""
        self._arbiter.clear()

    def set_goal(self, goal: Goal, /) -> None:
        """Refuse a goal: other programs say where to drive.

        Raises:
            InputError: Always; this robot takes no goals.
        """
        raise InputError("other programs drive this robot (--role simulator): give the goal to them")

    def update(self, observation: Observation, estimate: Estimate) -> Twist2D:
        """Return the command that holds now."""
        return self._arbiter.command(self._clock.offset + observation.time)

    # The listening thread -------------------------------------------------------------------------------------------

    def _take(self, twist: Any, source: str) -> None:
        try:
            self._offer(twist, source)
        except BadInputError as error:
            self._drop(error, source)

    def _take_stamped(self, message: Any, source: str) -> None:
        try:
            check_frame(message.header.frame_id, self._frames)
            check_stamp(message.header.stamp, self._clock.now, tolerance_s=TIMEOUT_S)
            self._offer(message.twist, source)
        except BadInputError as error:
            self._drop(error, source)

    def _offer(self, twist: Any, source: str) -> None:
        command = check_twist(twist)
        if twist.linear.y or twist.linear.z or twist.angular.x or twist.angular.y:
            self._wire.warn(
                "cmd_vel: other directions",
                lambda: (
                    f"{self._wire.describe_source(source)} commands speeds besides linear.x and angular.z, which "
                    "this robot cannot drive: they are ignored"
                ),
            )
        writers = self._writers()
        if not source and writers > 1:
            self._wire.warn(
                "cmd_vel: two sources",
                f"{writers} publishers command the robot on {self._topic}: the last command drives it, whosever it is",
            )
        self._arbiter.offer(command, source, self._clock.now)

    def _writers(self) -> int:
        return sum(inlet.writers for inlet in self._inlets)

    def _drop(self, error: BadInputError, source: str) -> None:
        self._wire.warn(
            f"cmd_vel: {error.kind}",
            lambda: f"a command of {self._wire.describe_source(source)} on {self._topic} is dropped: {error}",
        )

    def _look(self) -> None:
        """Stop where the last publisher has gone."""
        writers = self._writers()
        if self._had_writers and not writers and self._arbiter.clear():
            self._wire.warnings.note(f"nobody publishes {self._topic} any more: the robot stops")
        self._had_writers = writers > 0
