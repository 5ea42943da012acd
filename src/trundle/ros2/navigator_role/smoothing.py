"""SmoothPath, in a thread of its own."""

from __future__ import annotations

import threading
import time as clock
from typing import Any

import numpy as np

from trundle.costmap import Costmap
from trundle.errors import InputError, TrundleError, UnknownNameError
from trundle.mission.steering.goal_directives import MOST_POSES
from trundle.path import Path
from trundle.planning.smoother import Smoother, create_smoother, smoother_names
from trundle.ros2.actions import ActionGoal
from trundle.ros2.navigator_role.context import Kit, ServedAction, seconds_of
from trundle.ros2.navigator_role.driving import drivable
from trundle.ros2.navigator_role.plans import dense

_PLUGINS = ("", "simple_smoother", "SmoothPath")
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
        if name not in _PLUGINS:
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
