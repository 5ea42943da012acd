"""AssistedTeleop: somebody drives by hand, and the stop check keeps the robot from touching anything."""

from __future__ import annotations

import math
from typing import Any

from trundle.geometry import Twist2D
from trundle.messages.qos import Qos
from trundle.mission import Manual, Release, Step
from trundle.ros2.actions import ActionGoal
from trundle.ros2.bad_input import BadInputError, check_twist
from trundle.ros2.navigator_role.behaviors import CYCLE_S
from trundle.ros2.navigator_role.context import Kit, ServedAction, seconds_of
from trundle.ros2.outputs.output import Cadence

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
