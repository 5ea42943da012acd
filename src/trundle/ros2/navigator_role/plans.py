"""ComputePathToPose, ComputePathThroughPoses and SmoothPath, in threads of their own."""

from __future__ import annotations

import threading
import time as clock
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from trundle.costmap import Costmap
from trundle.errors import InputError, PlanningError, TrundleError, UnknownNameError
from trundle.geometry import FloatArray, Goal, Pose2D, wrap_angles
from trundle.mission import Mission
from trundle.mission.steering.goal_directives import MOST_POSES
from trundle.navigation.route_planner import join_legs
from trundle.path import Path
from trundle.planning import Planner, create_planner, planner_names
from trundle.planning.cancellation import Cancellation
from trundle.planning.motions import sample_between
from trundle.planning.smoother import Smoother, create_smoother, smoother_names
from trundle.ros2.actions import ActionGoal
from trundle.ros2.navigator_role.codes import planning_code
from trundle.ros2.navigator_role.context import FrameError, Kit, ServedAction, poses_of, seconds_of
from trundle.ros2.navigator_role.driving import drivable

_PLUGINS = ("", "GridBased")
"""Names of Nav2's planner plugin that mean the planner in use."""

_MOST_GOALS = 100

_ENDS_S = 1.0
"""How long `close` waits for a plan that is given up [s]; the thread is a daemon, and ends with the process."""

_STEP_RAD = np.radians(10.0)
"""Poses of a plan that turn in place are no farther apart than this."""


@dataclass(frozen=True, slots=True)
class _Query:
    """A plan to make.

    Attributes:
        goal: The goal whose result it is.
        action: The type of its action.
        planner: The planner that makes it.
        costmap: The costmap that it is made on.
        start: The pose that it starts at.
        ends: The poses that it leads to, in order.
        cancel: Gives it up.
    """

    goal: ActionGoal
    action: str
    planner: Planner
    costmap: Costmap
    start: Pose2D
    ends: tuple[Pose2D, ...]
    cancel: Cancellation


class PlanServer:
    """Makes plans for others, one at a time, beside the run, by a planner like the navigator's.

    As in Nav2, a second goal replaces the first, which is aborted.

    Args:
        kit: What actions work with.
    """

    def __init__(self, kit: Kit) -> None:
        self._kit = kit
        self._use(kit.context.mission)
        self._changed = threading.Condition()
        self._next: _Query | None = None
        self._current: _Query | None = None
        self._ends = False
        self._thread: threading.Thread | None = None

    def start(self, query: Callable[[Planner], _Query], planner_id: str) -> None:
        """Make this plan next.

        Raises:
            UnknownNameError: If there is no such planner.
        """
        if self._kit.context.mission is not self._mission:  # another map was loaded
            self._use(self._kit.context.mission)
        if planner_id not in _PLUGINS:
            if planner_id not in planner_names():  # nothing is imported by a name that comes over the network
                raise UnknownNameError("planner", planner_id, planner_names())
            planner = create_planner(planner_id, self._robot, self._grid)
        else:
            planner = self._planner
        made = query(planner)
        with self._changed:
            replaced, self._next = self._next, made
            if self._current is not None:
                self._current.cancel.cancel()
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name="trundle-ros2-plans", daemon=True)
                self._thread.start()
            self._changed.notify_all()
        if replaced is not None:
            self._abort(replaced, "UNKNOWN", "another plan was asked for")

    def _use(self, mission: Mission) -> None:
        """Plan for the robot of a mission, on its map."""
        robot, grid = mission.navigator.robot, mission.navigator.grid
        self._planner = create_planner(mission.scenario.planner, robot, grid)
        self._robot, self._grid, self._mission = robot, grid, mission

    def cancel(self, goal: ActionGoal) -> bool:
        """End the plan for a goal, and return whether there is one."""
        with self._changed:
            for query in (self._current, self._next):
                if query is not None and query.goal is goal:
                    query.cancel.cancel()
                    return True
        return False

    def close(self) -> None:
        """End the thread."""
        with self._changed:
            self._ends = True
            if self._current is not None:
                self._current.cancel.cancel()
            self._changed.notify_all()
        if self._thread is not None:
            self._thread.join(_ENDS_S)

    def _work(self) -> None:
        while True:
            with self._changed:
                self._current = None
                self._changed.wait_for(lambda: self._ends or self._next is not None)
                if self._ends or self._next is None:
                    return
                query, self._next = self._next, None
                self._current = query
            self._answer(query)

    def _answer(self, query: _Query) -> None:
        began = clock.perf_counter()
        try:
            path = self._plan(query)
        except TrundleError as error:
            name, message = planning_code(error, query.start), str(error)
            self._kit.tasks.later(lambda: self._fail(query, name, message))
            return
        kit = self._kit
        poses = dense(path, query.costmap.resolution)
        query.goal.succeed(
            path=kit.make.path(kit.beliefs.now.time, poses, kit.map_frame),
            planning_time=kit.duration(clock.perf_counter() - began),
        )

    def _fail(self, query: _Query, name: str, message: str) -> None:
        if query.goal.cancel_requested:
            query.goal.canceled()
        else:
            self._abort(query, name, message)

    def _plan(self, query: _Query) -> Path:
        legs, here = list[Path](), query.start
        for number, end in enumerate(query.ends, 1):
            try:
                legs.append(query.planner.plan(query.costmap, here, Goal.of(end), cancel=query.cancel))
            except PlanningError as error:
                if len(query.ends) > 1:
                    error.args = (f"goal {number}: {error}",)
                raise
            here = end
        return join_legs(legs, query.costmap, 0.0)[0]

    def _abort(self, query: _Query, name: str, message: str) -> None:
        query.goal.abort(**self._kit.failure(query.action, name, message))


class ComputePath(ServedAction):
    """Serves ComputePathToPose, or ComputePathThroughPoses.

    Args:
        kit: What actions work with.
        server: Makes the plans.
        name: Name of the action on the network.
        through: Whether it is a path through several poses.
    """

    def __init__(self, kit: Kit, server: PlanServer, name: str, *, through: bool) -> None:
        super().__init__(kit, name)
        self._server, self._through = server, through
        self._action = "ComputePathThroughPoses" if through else "ComputePathToPose"

    def accepted(self, goal: ActionGoal) -> None:
        """Make the plan."""
        kit = self._kit
        try:
            start, ends = self._read(goal.request)
        except FrameError as error:
            goal.abort(**kit.failure(self._action, "TF_ERROR", str(error)))
            return
        except InputError as error:
            self._report("goal", error, "bad goal")
            code = "UNKNOWN" if ends_of(goal.request, self._through) else "NO_VIAPOINTS_GIVEN"
            goal.abort(**kit.failure(self._action, code, str(error)))
            return
        costmap = kit.beliefs.now.costmap

        def make(planner: Planner) -> _Query:
            return _Query(goal, self._action, planner, costmap, start, ends, Cancellation())

        planner_id = goal.request.planner_id
        try:
            self._server.start(make, planner_id)
        except InputError as error:
            text = f"{error} Leave planner_id empty for the planner in use."
            goal.abort(**kit.failure(self._action, "INVALID_PLANNER", text))

    def cancel(self, goal: ActionGoal) -> bool:
        """Give up the plan."""
        return self._server.cancel(goal)

    def _read(self, request: Any) -> tuple[Pose2D, tuple[Pose2D, ...]]:
        beliefs, stamped = self._kit.beliefs, ends_of(request, self._through)
        if not 0 < len(stamped) <= _MOST_GOALS:
            raise InputError(f"give 1 to {_MOST_GOALS} poses to plan to, got {len(stamped)}")
        ends = tuple(beliefs.read(one, f"pose {number} of the goal") for number, one in enumerate(stamped, 1))
        return (beliefs.read(request.start, "the start") if request.use_start else beliefs.now.pose), ends


def ends_of(request: Any, through: bool) -> list[Any]:
    """Return the poses that a goal asks for a path to."""
    return poses_of(request.goals) if through else [request.goal]


def dense(path: Path, step_m: float) -> FloatArray:
    """Sample poses along a path, no farther apart than this, as programs expect them of Nav2; shape (N, 3).

    Yaws are within a half turn, also those of a smoother that counts its turns.
    """
    if len(path.poses) == 1:
        return path.poses
    first, last = path.poses[:-1], path.poses[1:].copy()
    last[:, 2] = first[:, 2] + np.remainder(last[:, 2] - first[:, 2] + np.pi, 2.0 * np.pi) - np.pi
    poses, _, _ = sample_between(first, last, step_m, _STEP_RAD)
    changes = np.abs(np.diff(poses, axis=0)).max(axis=1) > 0.0
    poses[:, 2] = wrap_angles(poses[:, 2])
    return poses[np.concatenate([[True], changes])]


_SMOOTHERS = ("", "simple_smoother", "SmoothPath")
"""Names of Nav2's smoother plugin that mean the smoother in use; without one, that is `_USUAL`."""

_USUAL = "constrained"


class SmoothPath(ServedAction):
    """Serves SmoothPath. A second goal replaces the first, which is aborted.

    A path that touches something where it is given is refused: what comes out is free wherever it was free.

    Args:
        kit: What actions work with.
        name: Name of the action on the network.
    """

    def __init__(self, kit: Kit, name: str) -> None:
        super().__init__(kit, name)
        self._usual: Smoother | None = None
        self._current: ActionGoal | None = None
        kit.tasks.ends.append(self._end)

    def accepted(self, goal: ActionGoal) -> None:
        """Smooth the path."""
        self._end("another path has come")
        try:
            smoother = self._choose(goal.request.smoother_id)
        except InputError as error:
            self._abort(goal, "INVALID_SMOOTHER", f"{error} Leave smoother_id empty for the smoother in use.")
            return
        try:
            path = self._read(goal.request.path)
        except TrundleError as error:
            self._report("path", error, "no path")
            self._abort(goal, "INVALID_PATH", str(error))
            return
        self._current = goal
        costmap = self._kit.beliefs.now.costmap
        work = threading.Thread(
            target=self._work, args=(goal, smoother, path, costmap), name="trundle-ros2-smoother", daemon=True
        )
        work.start()

    def cancel(self, goal: ActionGoal) -> bool:
        """Give up the path, and return whether it is being smoothed: its result says so when the smoother is done."""
        return goal is self._current

    def _work(self, goal: ActionGoal, smoother: Smoother, path: Path, costmap: Costmap) -> None:
        """Smooth a path, and let the listening thread answer."""
        began = clock.perf_counter()
        try:
            smoothed = smoother.smooth(path, costmap)
            poses = dense(smoothed, costmap.resolution)
        except TrundleError as error:
            text = str(error)
            self._kit.tasks.later(lambda: self._answer(goal, "FAILED_TO_SMOOTH_PATH", text))
            return
        except Exception as error:  # noqa: BLE001 - a smoother of another package; its client gets a result
            text = f"the smoother raised {type(error).__name__}: {error}"
            self._kit.tasks.later(lambda: self._answer(goal, "UNKNOWN", text))
            return
        took_s, allowed_s = clock.perf_counter() - began, seconds_of(goal.request.max_smoothing_duration)
        touches = goal.request.check_for_collisions and bool(costmap.footprint_collides(poses).any())
        code = "SMOOTHED_PATH_IN_COLLISION" if touches else ""
        self._kit.tasks.later(
            lambda: self._answer(
                goal,
                code,
                "the smoothed path touches something" if touches else "",
                path=self._kit.make.path(self._kit.beliefs.now.time, poses, self._kit.map_frame),
                smoothing_duration=self._kit.duration(took_s),
                was_completed=allowed_s <= 0.0 or took_s <= allowed_s,
            )
        )

    def _answer(self, goal: ActionGoal, code: str, text: str, **fields: Any) -> None:
        if self._current is goal:
            self._current = None
        if goal.cancel_requested:
            goal.canceled()
        elif code:
            self._abort(goal, code, text, **fields)
        else:
            goal.succeed(**fields)

    def _abort(self, goal: ActionGoal, code: str, text: str, **fields: Any) -> None:
        goal.abort(**fields, **self._kit.failure("SmoothPath", code, text))

    def _end(self, why: str) -> None:
        goal, self._current = self._current, None
        if goal is not None:
            self._abort(goal, "UNKNOWN", why)

    def _choose(self, name: str) -> Smoother:
        if name not in _SMOOTHERS:
            if name not in smoother_names():  # nothing is imported by a name that comes over the network
                raise UnknownNameError("smoother", name, smoother_names())
            return create_smoother(name)
        if self._usual is None:
            self._usual = create_smoother(self._kit.context.mission.scenario.smoother or _USUAL)
        return self._usual

    def _read(self, path: Any) -> Path:
        if not 2 <= len(path.poses) <= MOST_POSES:
            raise InputError(f"a path to smooth has 2 to {MOST_POSES} poses, and this one has {len(path.poses)}")
        for stamped in path.poses:
            stamped.header.frame_id = stamped.header.frame_id or path.header.frame_id
        beliefs = self._kit.beliefs
        poses = [beliefs.read(stamped, f"pose {number}").as_tuple() for number, stamped in enumerate(path.poses, 1)]
        kept, backward = drivable(np.array(poses))
        return Path(np.array(kept), planner="given", backward=np.array(backward, dtype=np.bool_))
