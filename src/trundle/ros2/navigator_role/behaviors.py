"""Spin, BackUp, DriveOnHeading and Wait; AssistedTeleop, in which somebody drives by hand."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeAlias

from trundle.errors import InputError, TrundleError
from trundle.geometry import Twist2D, wrap_angle
from trundle.messages.qos import Qos
from trundle.mission import Manual, Release, RunBehavior, Step, TaskEnd
from trundle.ros2.actions import ActionGoal
from trundle.ros2.bad_input import BadInputError, check_twist
from trundle.ros2.navigator_role.codes import behavior_code
from trundle.ros2.navigator_role.context import Kit, ServedAction, seconds_of
from trundle.ros2.outputs.output import Cadence, observed

CYCLE_S = 0.1
"""Nav2's behavior server reports at its cycle_frequency of 10 Hz."""

_LONGEST_S = 1e6
"""A wait that is longer [s] is refused: eleven days are a mistake."""

Read: TypeAlias = Callable[[Any], RunBehavior]
"""Reads a goal; raises InputError."""


class Behaving:
    """Reports on a behavior that runs.

    Args:
        kit: What actions work with.
        action: The type of the action.
        seconds: How long a `Wait` takes [s]; 0 for the others.
    """

    def __init__(self, kit: Kit, action: str, seconds: float) -> None:
        self._kit, self._action, self._seconds = kit, action, seconds
        self._begun_s = self._sent_s = -math.inf
        self._traveled_m = self._turned_rad = 0.0
        self._last: tuple[float, float, float] | None = None

    def begin(self, time: float) -> None:
        """Take note that the behavior runs from this time on [s]."""
        self._begun_s = time

    def feedback(self, step: Step) -> dict[str, Any] | None:
        """Return how far the robot has come by its odometry, or how long it still waits; at Nav2's rate."""
        here = observed(step).odometry.as_tuple()
        if self._last is not None:
            self._traveled_m += math.dist(here[:2], self._last[:2])
            self._turned_rad += wrap_angle(here[2] - self._last[2])
        self._last = here
        time = step.state.time
        if time - self._sent_s < CYCLE_S - 1e-9:
            return None
        self._sent_s = time
        if self._action == "Wait":
            return {"time_left": self._kit.duration(self._seconds - (time - self._begun_s))}
        if self._action == "Spin":
            return {"angular_distance_traveled": abs(self._turned_rad)}
        return {"distance_traveled": self._traveled_m}

    def refused(self, error: TrundleError) -> dict[str, Any]:
        """Return the result of a behavior that the run does not take."""
        return self._kit.failure(self._action, "UNKNOWN", str(error))

    def ended(self, end: TaskEnd) -> dict[str, Any]:
        """Return how the behavior ended, and how long it took."""
        took = {"total_elapsed_time": self._kit.duration(end.time - self._begun_s if self._begun_s > -1.0 else 0.0)}
        if end.result == "failed":
            return took | self._kit.failure(self._action, behavior_code(end), end.message)
        return took if end.result in ("succeeded", "cancelled") else took | {"error_msg": end.message}


class Behave(ServedAction):
    """Serves an action that runs a behavior. A second goal replaces the first, which is aborted.

    Args:
        kit: What actions work with.
        name: Name of the action on the network.
        action: Its type.
        read: Reads its goals.
    """

    def __init__(self, kit: Kit, name: str, action: str, read: Read) -> None:
        super().__init__(kit, name)
        self._action, self._read = action, read

    def accepted(self, goal: ActionGoal) -> None:
        """Run the behavior from now on."""
        kit = self._kit
        try:
            directive = self._read(goal.request)
        except InputError as error:
            self._report("goal", error, "bad goal")
            goal.abort(**kit.failure(self._action, "INVALID_INPUT", str(error)))
            return
        report = Behaving(kit, self._action, float(directive.options.get("seconds", 0.0)))
        kit.tasks.behavior.start(goal, report, directive, self._name)

    def cancel(self, goal: ActionGoal) -> bool:
        """End the behavior, if this one runs; the robot drives on to its goal, if it has one."""
        return self._kit.tasks.behavior.cancel(goal, self._name)


def read_spin(request: Any) -> RunBehavior:
    """Read a turn by an angle [rad]."""
    angle = float(request.target_yaw)
    if not math.isfinite(angle):
        raise InputError(f"target_yaw must be a finite angle [rad], got {angle}")
    return RunBehavior("spin", {"angle": angle, **_allowance(request)})


def read_back_up(request: Any) -> RunBehavior:
    """Read a straight drive back: Nav2 takes the amounts of target.x and of the speed."""
    distance, speed = _read_line(request)
    return RunBehavior("back_up", {"distance": abs(distance), "speed": abs(speed), **_allowance(request)})


def read_drive_on_heading(request: Any) -> RunBehavior:
    """Read a straight drive on, or back where target.x and speed are negative."""
    distance, speed = _read_line(request)
    if (distance > 0.0) != (speed > 0.0):
        raise InputError(f"target.x = {distance:g} m and speed = {speed:g} m/s must have the same sign")
    name = "drive_on_heading" if distance > 0.0 else "back_up"
    return RunBehavior(name, {"distance": abs(distance), "speed": abs(speed), **_allowance(request)})


def read_wait(request: Any) -> RunBehavior:
    """Read how long to stand."""
    seconds = seconds_of(request.time)
    if not 0.0 <= seconds <= _LONGEST_S:
        raise InputError(f"the time to wait must be 0 to {_LONGEST_S:g} s, got {seconds:g} s")
    return RunBehavior("wait", {"seconds": seconds})


def _read_line(request: Any) -> tuple[float, float]:
    target, speed = request.target, float(request.speed)
    numbers = float(target.x), float(target.y), float(target.z), speed
    if not all(map(math.isfinite, numbers)):
        raise InputError(f"target and speed must be finite, got ({target.x}, {target.y}, {target.z}) and {speed}")
    if target.y != 0.0 or target.z != 0.0:
        raise InputError("the robot moves along x alone: leave target.y and target.z at 0")
    if target.x == 0.0 or speed == 0.0:
        raise InputError(f"target.x and speed must not be 0, got {target.x:g} m and {speed:g} m/s")
    return float(target.x), speed


def _allowance(request: Any) -> dict[str, float]:
    """Read the time that a behavior may take; 0 is no limit in Nav2, and the behavior's own in trundle."""
    seconds = seconds_of(request.time_allowance)
    if seconds < 0.0:
        raise InputError(f"time_allowance must not be negative, got {seconds:g} s")
    return {"allowance": seconds} if seconds > 0.0 else {}


COMMANDS, PREEMPT = "cmd_vel_teleop", "preempt_teleop"
"""Topics of Nav2's behavior server."""

HOLDS_S = 0.5
"""How long a command holds [simulated time], as one on /cmd_vel does."""

_TWIST, _STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
_STAND = Twist2D()


class AssistedTeleop(ServedAction):
    """Serves AssistedTeleop: what comes on cmd_vel_teleop drives the robot, as far as the stop check lets it pass.

    The drive to a goal is interrupted meanwhile, and goes on afterwards. A message on preempt_teleop ends it, as
    succeeded; the time allowance, as failed, as in Nav2.

    Args:
        kit: What actions work with.
        name: Name of the action on the network.
    """

    def __init__(self, kit: Kit, name: str) -> None:
        super().__init__(kit, name)
        self._goal: ActionGoal | None = None
        self._begun_s = 0.0
        self._command, self._given_s = _STAND, -math.inf
        self._cadence = Cadence(CYCLE_S)
        kit.tasks.ends.append(self._abort)

    def open(self) -> None:
        """Listen to the commands."""
        wire = self._kit.context.wire
        for kind in (_TWIST, _STAMPED):
            wire.listen(COMMANDS, kind, Qos(10), self._take)
        wire.listen(PREEMPT, "std_msgs/msg/Empty", Qos(10), self._preempt)

    def accepted(self, goal: ActionGoal) -> None:
        """Stop, and obey the commands from now on; a goal that ran is aborted."""
        kit = self._kit
        self._abort("another goal has come")
        self._begun_s = kit.context.clock.now
        self._command, self._given_s = _STAND, -math.inf
        self._goal = goal
        self._drive(_STAND)

    def cancel(self, goal: ActionGoal) -> bool:
        """End this goal, if it runs."""
        return goal is self._goal

    def publish(self, step: Step, time: float) -> None:
        """Hold the command, send feedback, and end the goal when it is due; in the thread that drives."""
        goal = self._goal
        if goal is None:
            return
        taken_s, allowed_s = time - self._begun_s, seconds_of(goal.request.time_allowance)
        if goal.cancel_requested:
            self._kit.tasks.later(lambda: self._finish(goal, "cancelled"))
        elif 0.0 < allowed_s < taken_s:
            self._kit.tasks.later(lambda: self._finish(goal, "late"))
        else:
            self._drive(self._command if 0.0 <= time - self._given_s < HOLDS_S else _STAND)
            if self._cadence.is_due(time):
                self._cadence.mark(time)
                goal.publish_feedback(current_teleop_duration=self._kit.duration(taken_s))

    def _take(self, message: Any, source: str) -> None:
        """Take a command, while a goal runs; its stamp does not count, as it does not in Nav2."""
        twist = message.twist if message.__msgtype__ == _STAMPED else message
        try:
            command = check_twist(twist)
        except BadInputError as error:
            self._kit.context.wire.warn(f"{COMMANDS}: {error.kind}", f"a command on {COMMANDS} is dropped: {error}")
            return
        if self._goal is None:
            self._kit.context.wire.warn(
                f"{COMMANDS}: no goal", f"commands on {COMMANDS} are not obeyed while no goal of {self._name} runs"
            )
            return
        self._command, self._given_s = command, self._kit.context.clock.now
        self._drive(command)

    def _preempt(self, message: Any, source: str) -> None:
        goal = self._goal
        if goal is not None:
            self._finish(goal, "preempted")

    def _drive(self, command: Twist2D) -> None:
        self._kit.context.driver.steering.put(Manual(command.v, command.w), by=self._name)

    def _abort(self, why: str) -> None:
        goal = self._goal
        if goal is not None:
            self._finish(goal, why)

    def _finish(self, goal: ActionGoal, why: str) -> None:
        """End a goal that runs, in the listening thread: the robot stops, or drives on to its goal."""
        if goal is not self._goal:
            return
        self._goal = None
        kit = self._kit
        kit.context.driver.steering.put(Release(), by=self._name)
        took = {"total_elapsed_time": kit.duration(kit.context.clock.now - self._begun_s)}
        if why == "cancelled":
            goal.canceled(**took)
        elif why == "preempted":
            goal.succeed(**took)
        elif why == "late":
            text = f"the time allowance of {seconds_of(goal.request.time_allowance):g} s is over"
            goal.abort(**took, **kit.failure("AssistedTeleop", "TIMEOUT", text))
        else:
            goal.abort(**took, **kit.failure("AssistedTeleop", "UNKNOWN", why))
