"""`PoseInputs`: the topics /goal_pose and /initialpose; a run that begins again takes what comes meanwhile."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from trundle.errors import InputError, TrundleError
from trundle.localization.localizer import check_covariance
from trundle.messages import readers
from trundle.messages.qos import Qos
from trundle.mission import SetGoal, SetPose, TaskEnd
from trundle.ros2.bad_input import STAMP_S, BadInputError, check_frame, check_pose
from trundle.ros2.navigator_role.context import FrameError, Kit

_GOAL, _POSE = "goal_pose", "initialpose"


class PoseInputs:
    """Takes goals and the localizer's pose from topics, as RViz sends them.

    A message is dropped, with one warning for each kind, where its frame is not known, a number is not finite, or the
    quaternion has length 0. A stamp that is far from the simulated time is reported and otherwise left out of account,
    as it is in Nav2: a pose on the map is the same at any time.

    Args:
        kit: What the navigator works with.
        told: Called when a pose was told, whether the run takes it or not.
    """

    def __init__(self, kit: Kit, told: Callable[[], None]) -> None:
        self._kit, self._told = kit, told
        self._newest: _Goal | None = None
        self._lock = threading.Lock()
        """Held while a goal is given: what was dropped before is not given after."""

    def open(self) -> None:
        """Listen to both topics."""
        wire = self._kit.context.wire
        wire.listen(_GOAL, "geometry_msgs/msg/PoseStamped", Qos(10), self._goal)
        wire.listen(_POSE, "geometry_msgs/msg/PoseWithCovarianceStamped", Qos(10), self._pose)

    def _goal(self, message: Any, source: str) -> None:
        kit = self._kit
        try:
            pose = kit.beliefs.read(message, "the goal")
        except (BadInputError, FrameError) as error:
            self._drop(_GOAL, error)
            return
        if kit.tasks.refuses:
            kit.context.wire.warn(f"{_GOAL}: refused", f"a goal of {_GOAL} is refused: {kit.tasks.refuses}")
            return
        self._look_at_stamp(_GOAL, message)
        kit.tasks.drive.preempt("a goal came on /goal_pose")
        goal = _Goal(SetGoal(pose), self._give, self._refused(_GOAL))
        with self._lock:
            self._newest = goal
        self._give(goal)

    def carry(self) -> None:
        """Let a drive to a goal of the topic go on in the next run, unless a newer goal comes."""
        newest = self._newest
        if newest is not None:
            newest.is_carried = True

    def drop(self) -> None:
        """Give no later run the goal of the topic: the robot is stopped."""
        with self._lock:
            self._newest = None

    def _give(self, goal: _Goal) -> None:
        with self._lock:
            if goal is self._newest:
                self._kit.context.driver.steering.put(goal.directive, by=_GOAL, watcher=goal, waits=True)

    def _pose(self, message: Any, source: str) -> None:
        if not self._kit.is_own_pose(message, source):
            self.take_pose(message, _POSE)

    def take_pose(self, message: Any, where: str) -> None:
        """Tell the localizer the pose of a geometry_msgs/PoseWithCovarianceStamped; what is wrong is reported.

        Args:
            message: The message.
            where: The topic or service that it came by.
        """
        kit = self._kit
        try:
            check_frame(message.header.frame_id, (kit.map_frame,))
            pose = check_pose(message.pose.pose)
            given = SetPose(pose, _covariance_of(message.pose))
        except BadInputError as error:
            self._drop(where, error)
            return
        if kit.context.mission.scenario.localizer is None:
            kit.context.wire.warn(
                f"{where}: no localizer",
                f"a pose of {where} changes nothing: the robot knows its true pose, which is in amcl_pose; start "
                "trundle with --localizer amcl for one that has to be found",
            )
            self._told()
            return
        self._look_at_stamp(where, message)
        kit.context.driver.steering.put(given, by=where, refused=self._refused(where), waits=True)
        self._told()

    def _drop(self, topic: str, error: BadInputError | FrameError) -> None:
        kind = error.kind if isinstance(error, BadInputError) else "wrong frame"
        self._kit.context.wire.warn(f"{topic}: {kind}", f"a message of {topic} is dropped: {error}")

    def _refused(self, topic: str) -> Callable[[str], None]:
        def report(why: str) -> None:
            self._kit.context.wire.warn(f"{topic}: refused", f"a message of {topic} is refused: {why}")

        return report

    def _look_at_stamp(self, topic: str, message: Any) -> None:
        time, now = readers.read_stamp(message.header.stamp), self._kit.beliefs.now.time
        if time != 0.0 and abs(time - now) > STAMP_S:
            where = "past" if time < now else "future"
            self._kit.context.wire.warn(
                f"{topic}: stamp in the {where}",
                f"a message of {topic} is stamped {time:.3f} s, in the {where} of the simulated time {now:.3f} s; it "
                "is taken all the same: set use_sim_time of the node that sends it",
            )


class _Goal:
    """A goal of the topic; it watches what becomes of it.

    Args:
        directive: What the run is given.
        give: Gives it to the run.
        refused: Reports why it is not taken.

    Attributes:
        directive: The same.
        is_carried: Whether the next run goes on with it, where the present one ends before it is reached.
    """

    def __init__(self, directive: SetGoal, give: Callable[[_Goal], None], refused: Callable[[str], None]) -> None:
        self.directive, self._give, self._refused = directive, give, refused
        self.is_carried = False

    def begin(self, time: float) -> None:
        """Do nothing: nobody waits for that."""

    def refuse(self, error: TrundleError) -> None:
        """Report why it is not driven to."""
        self._refused(str(error))

    def end(self, end: TaskEnd) -> None:
        """Give it to the next run, where this one has stopped for that."""
        carried, self.is_carried = self.is_carried, False
        if carried and end.result == "stopped":
            self._give(self)


def _covariance_of(pose: Any) -> list[list[float]] | None:
    """Read the covariance of a geometry_msgs/PoseWithCovariance that comes from outside.

    Raises:
        BadInputError: If it is none.
    """
    covariance = readers.read_covariance(pose)
    try:
        return None if covariance is None else check_covariance(covariance, "the pose").tolist()
    except InputError as error:
        raise BadInputError("no covariance", str(error)) from error
