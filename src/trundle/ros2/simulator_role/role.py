"""`SimulatorRole`: other programs drive the robot by /cmd_vel, as in Gazebo or Isaac Sim."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from trundle.errors import InputError
from trundle.geometry import Goal, Twist2D
from trundle.messages.qos import Qos
from trundle.mission import Observer, Session
from trundle.mission.setup import SessionOptions
from trundle.navigation import Agent, AgentInfo, NavigationStatus
from trundle.observation import Estimate, Observation
from trundle.robots import Robot
from trundle.ros2.bad_input import BadInputError, check_frame, check_stamp, check_twist, is_wall_time
from trundle.ros2.inlet import Inlet
from trundle.ros2.profile import Profile
from trundle.ros2.role import BridgeContext, SimulationClock
from trundle.ros2.wire import Wire

COMMANDS = Qos(10)
"""QoS of /cmd_vel: reliable, as most publishers are; Nav2's and teleop's offer that."""

_TWIST, _STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"

TIMEOUT_S = 0.5
"""A source that is silent for this simulated time [s] leaves the robot to others; stamps may be off by as much."""

STAND = Twist2D()


class SimulatorRole:
    """Takes commands from the network. There is no map, no localizer and no collision monitor: those are Nav2's.

    A contact is published, and does not end the run.

    Args:
        context: What it plugs into.

    Attributes:
        agent: What drives the robot.
    """

    def __init__(self, context: BridgeContext) -> None:
        self._context = context
        self.agent = RosAgent(context.wire, context.profile, context.clock, context.mission.robot)

    def open(self) -> None:
        """Listen to commands."""
        self.agent.open()

    def begin(self, observers: Sequence[Observer], seed: int | None) -> Session:
        """Begin a run; see `Role`."""
        options: SessionOptions = {
            "localizer": None,
            "latency": self._context.mission.scenario.latency,
            "rules": None,
            "monitor": False,
            "through": False,
        }
        return self._context.begin_session(self.agent, observers, seed, options)

    def lost(self, why: str) -> None:
        """Stop the robot."""
        self.agent.lost(why)

    def close(self) -> None:
        """Do nothing: the wire is closed by the bridge."""


class RosAgent(Agent):
    """Drives what other programs command on /cmd_vel, as Twist or as TwistStamped.

    A command holds as long as the profile says; then the robot stops. Where the last publisher goes, or the transport
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
        holds_s = math.inf if profile.command_holds_s is None else profile.command_holds_s
        self._arbiter = CommandArbiter(wire.warn, wire.describe_source, holds_s=holds_s)
        self._inlets: list[Inlet] = []
        self._had_writers = False
        self._heard: dict[str, float] = {}

    def open(self) -> None:
        """Listen to commands of both types."""
        topic, wire = self._topic, self._wire
        self._inlets = [wire.listen(topic, kind, COMMANDS, self._take) for kind in (_TWIST, _STAMPED)]
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

    def _take(self, message: Any, source: str) -> None:
        """Receive a Twist or a TwistStamped; a bad one is dropped and reported."""
        twist = message
        try:
            if message.__msgtype__ == _STAMPED:
                check_frame(message.header.frame_id, self._frames)
                self._check_stamp(message.header.stamp, source)
                twist = message.twist
            command = check_twist(twist)
        except BadInputError as error:
            reason = str(error)
            self._wire.warn(
                f"cmd_vel: {error.kind}",
                lambda: f"a command of {self._wire.describe_source(source)} on {self._topic} is dropped: {reason}",
            )
            return
        if twist.linear.y or twist.linear.z or twist.angular.x or twist.angular.y:
            self._wire.warn(
                "cmd_vel: other directions",
                lambda: (
                    f"{self._wire.describe_source(source)} commands speeds besides linear.x and angular.z, which "
                    "this robot cannot drive: they are ignored"
                ),
            )
        if not source and self._is_shared(message.__msgtype__):
            self._wire.warn(
                "cmd_vel: two sources",
                f"several publishers command the robot on {self._topic}: the last command drives it, whosever it is",
            )
        self._arbiter.offer(command, source, self._clock.now)

    def _check_stamp(self, stamp: Any, source: str) -> None:
        """Drop a command that is too old; one with wall time is obeyed as it comes, as Gazebo does, and reported."""
        if is_wall_time(stamp, self._clock.now):
            self._wire.warn(
                "cmd_vel: wall time",
                lambda: (
                    f"{self._wire.describe_source(source)} stamps its commands on {self._topic} with the wall clock "
                    "instead of the simulated time: they are obeyed as they come, however old they are; start it with "
                    "--ros-args -p use_sim_time:=true"
                ),
            )
            return
        check_stamp(stamp, self._clock.now, tolerance_s=TIMEOUT_S)

    def _is_shared(self, kind: str) -> bool:
        """Return whether several publishers command, where messages do not say whose they are.

        Programs may offer commands of both types, and send one of them.
        """
        now = self._clock.now
        self._heard[kind] = now
        types = sum(0.0 <= now - heard <= TIMEOUT_S for heard in self._heard.values())
        return types > 1 or any(inlet.writers > 1 for inlet in self._inlets)

    def _writers(self) -> int:
        return sum(inlet.writers for inlet in self._inlets)

    def _look(self) -> None:
        """Stop where the last publisher has gone."""
        writers = self._writers()
        if self._had_writers and not writers and self._arbiter.clear():
            self._wire.warnings.note(f"nobody publishes {self._topic} any more: the robot stops")
        self._had_writers = writers > 0


@dataclass(frozen=True, slots=True)
class _Command:
    twist: Twist2D
    source: str
    time: float


class CommandArbiter:
    """Holds the command that drives the robot; the listening thread offers, the thread of the run reads.

    One source drives at a time: the first that moves the robot keeps it until it commands to stand, or is silent for
    `TIMEOUT_S`. What another source sends meanwhile is dropped and reported.

    Args:
        warn: Reports what is dropped: its kind, and what makes the text.
        describe: Who a source is, in words.
        holds_s: How long a command drives the robot, in simulated time [s].
    """

    def __init__(
        self,
        warn: Callable[[str, Callable[[], str]], None],
        describe: Callable[[str], str],
        *,
        holds_s: float = TIMEOUT_S,
    ) -> None:
        self._warn, self._describe, self._holds_s = warn, describe, holds_s
        self._held: _Command | None = None

    def offer(self, twist: Twist2D, source: str, now: float) -> bool:
        """Take a command that came at a simulated time [s], and return whether it drives the robot."""
        held = self._held
        if held is not None and held.source != source and held.twist != STAND and not _is_old(held, now, TIMEOUT_S):
            self._warn(
                "cmd_vel: two sources",
                lambda: (
                    f"{self._describe(source)} commands the robot, too, while {self._describe(held.source)} drives "
                    f"it: it is not heard until the other commands to stand, or is silent for {TIMEOUT_S:g} s"
                ),
            )
            return False
        self._held = _Command(twist, source, now)
        return True

    def command(self, now: float) -> Twist2D:
        """Return the command at a simulated time [s]; without one, or if it is too old, the robot stands."""
        held = self._held
        if held is None:
            return STAND
        if _is_old(held, now, self._holds_s):
            if held.twist != STAND and now >= held.time:
                self._warn(
                    "cmd_vel: timeout",
                    lambda: f"no command for {self._holds_s:g} s from {self._describe(held.source)}: the robot stops",
                )
            self._held = None
            return STAND
        return held.twist

    def clear(self) -> bool:
        """Let the robot stand until the next command, and return whether it was driven."""
        held, self._held = self._held, None
        return held is not None and held.twist != STAND


def _is_old(held: _Command, now: float, most_s: float) -> bool:
    return not -1e-9 <= now - held.time < most_s - 1e-9
