"""`Retreat`: makes room for those who wait for the robot to pass, while it waits for them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from trundle._core import distance_field
from trundle.costmap import INSCRIBED, LETHAL, Costmap
from trundle.errors import PlanningError
from trundle.geometry import FloatArray, Goal, Pose2D, Twist2D
from trundle.navigation.obstacle_watch import PAST_MOVERS_EVERY_S
from trundle.navigation.progress import FollowedPath
from trundle.navigation.replanner import Replanner
from trundle.navigation.route_planner import RoutePlanner, is_of_goal
from trundle.navigation.sensing import SensedMap
from trundle.navigation.state import NOTHING, Decision, DriveState, NavigationStatus, Snapshot
from trundle.planning import cost_field

_STAND = Twist2D()
_AFTER_S = 10.0
"""So long it stands first [s]: most people are gone by then, and it backs up straight after 2 s."""
_MOST = 6
"""So often it makes room on the way to a goal, each time at another place."""
_LEAST_M, _REACH_M = (2.0, 1.0), 9.0
"""How far it drives at least, or where there is no such place, and at most [m]."""
_PASS_M, _ROOM_M = 0.8, 3.0
"""Room for a person beside the circle in which the robot turns, and how far it is looked at from its middle [m]."""
_PASS_WORTH_M = 6.0
"""So much farther it drives to a place where a person can pass [m]."""
_OWN_M = 0.35
"""Cells around the robot that count as free [m]: what it sees may be that close."""
_BESIDE_M = 0.3
"""Room that it leaves to those it saw in the last seconds [m]: it does not drive past them."""
_OTHER_M = 1.5
"""Places that are nearer to each other than this are one and the same [m]."""
_WAIT_S, _LONGER_S = 5.0, 3.0
"""How long it waits there [s], and how much longer each time."""
_SLOWEST_MPS, _SET_OFF_S = 0.15, 6.0
"""It gives up a drive that takes longer than at this speed, and some time to turn [s]."""
_THERE_M = 0.1


class Retreat:
    """Drives back to where others can pass the robot, waits there, and lets it plan again.

    A person who comes through a gap that is as wide as one of them waits for a robot that stands at its other side,
    and the robot waits for the person. Backing up straight does not end that where more than one person waits, or
    where the robot is still in their way.

    Args:
        sensed: The costmap with what its scans saw.
        replanner: Plans again afterwards.
        routes: Plans the path to the place.
    """

    def __init__(self, sensed: SensedMap, replanner: Replanner, routes: RoutePlanner) -> None:
        self._sensed, self._replanner, self._routes = sensed, replanner, routes
        self._path: FollowedPath | None = None
        self.reset()

    def reset(self) -> None:
        """Forget how often it made room: there is another goal, or the robot is somewhere else."""
        if self._path is not None and self._replanner.followed is self._path:
            self._replanner.followed = None  # it does not lead to the goal
        self._path = None
        self._places: list[Goal] = []
        self._until_s, self._again_s = 0.0, -math.inf
        self._waits = False

    @property
    def is_active(self) -> bool:
        """Whether the robot drives to a place where others can pass, or waits there."""
        return self._path is not None

    def decide(self, now: Snapshot, state: DriveState) -> Decision:
        """Begin, go on or end; a decision without a command leaves it to the controller, on the path in it."""
        if self._path is None:
            return self._begin(now) if self._is_needed(now, state) else NOTHING
        if self._replanner.followed is not self._path:  # a program has planned another one
            self._path = None
            return NOTHING
        self._path.advance(now.pose)
        if self._waits:
            return self._stand() if now.time < self._until_s else self._end(now)
        if now.time >= self._until_s or self._path.first_hit(now.costmap) is not None:
            return self._end(now)
        if self._path.left_m > _THERE_M:
            return self._say()
        self._waits, self._until_s = True, now.time + _WAIT_S + _LONGER_S * (len(self._places) - 1)
        return self._stand()

    def _is_needed(self, now: Snapshot, state: DriveState) -> bool:
        obstacle = self._replanner.obstacle
        if not (obstacle.is_blocked and obstacle.by_mover):
            return False
        made_room = any(place.distance_to(now.pose) < _OTHER_M for place in self._places)
        return (
            obstacle.standing_s >= (2.0 * _AFTER_S if made_room else _AFTER_S)
            and now.time >= self._again_s
            and state.error is not None
            and not is_of_goal(state.error, state.ahead)
            and len(self._places) < _MOST
            and not self._replanner.is_given
        )

    def _begin(self, now: Snapshot) -> Decision:
        self._again_s = now.time + _AFTER_S
        place = find_room(now.costmap, now.pose, self._replanner.movers.recent, self._places)
        if place is None:
            return NOTHING
        replanner = self._replanner
        planner, deadline_s = replanner.quick or replanner.planner, replanner.tries.deadline_s(now.twist)
        try:
            path = self._routes.plan_aside(now.costmap, now.pose, (place,), planner, deadline_s)
        except PlanningError:
            return NOTHING
        finally:
            replanner.budget.spend(self._routes.expansions, now.time, needed=True)
        self._places.append(place)
        replanner.obstacle.clear()  # it is behind the robot then, and does not slow it down
        drive_s = float(path.check.along[-1]) / _SLOWEST_MPS + _SET_OFF_S
        self._path, self._waits, self._until_s = path, False, now.time + drive_s
        return self._say()._replace(path=path, status=NavigationStatus.BLOCKED)

    def _say(self) -> Decision:
        x, y = self._places[-1].x, self._places[-1].y
        doing = "waiting at" if self._waits else "driving to"
        return Decision(message=f"blocked: {doing} ({x:.2f}, {y:.2f}) to let others pass", restarts_progress=True)

    def _stand(self) -> Decision:
        return self._say()._replace(command=_STAND, status=NavigationStatus.BLOCKED)

    def _end(self, now: Snapshot) -> Decision:
        """Plan to the goal again; what blocks the path still counts as something that may leave."""
        self._path = self._replanner.followed = None
        self._again_s = now.time + _AFTER_S
        obstacle = self._replanner.obstacle
        if self._waits:  # others have had the time to pass: the next plan may search for long
            self._sensed.forget_hidden(self._replanner.movers.places)  # the robot may not see from here where they were
            self._replanner.budget.allow_more()
            obstacle.see(now.time - PAST_MOVERS_EVERY_S)
        else:
            obstacle.see(now.time)
        obstacle.by_mover = True
        return Decision(restarts_progress=True)


def find_room(costmap: Costmap, pose: Pose2D, movers: FloatArray, others: Sequence[Goal] = ()) -> Goal | None:
    """The place to let others pass: near, and with room for a person beside the robot.

    Args:
        costmap: With what was sensed: people are obstacles, so the place lies on the robot's side of them.
        pose: Where the robot is, map frame.
        movers: Where something was seen to move of late: x, y and radius [m], map frame, shape (N, 3).
        others: Places that are not to be chosen again.

    Returns:
        The place, to be reached with any yaw; None if there is none within 1 to 9 m of driving.
    """
    row, col = (int(index) for index in costmap.world_to_cell(pose.x, pose.y))
    if not costmap.contains(row, col):
        return None
    reach = math.ceil(_REACH_M / costmap.resolution)
    rows = slice(max(0, row - reach), row + reach + 1)
    cols = slice(max(0, col - reach), col + reach + 1)
    data = costmap.data[rows, cols]
    at_row, at_col = np.indices(data.shape)
    x, y = costmap.cell_to_world(at_row + rows.start, at_col + cols.start)
    walls = data >= INSCRIBED
    for mover_x, mover_y, radius in movers.tolist():
        keep_m = radius + costmap.inscribed_radius + _BESIDE_M
        near = math.ceil(keep_m / costmap.resolution) + 1
        at = [int(index) for index in costmap.world_to_cell(mover_x, mover_y)]
        part = tuple(
            slice(max(0, middle - first - near), max(0, middle - first + near + 1))
            for middle, first in zip(at, (rows.start, cols.start), strict=True)
        )
        walls[part] |= np.hypot(x[part] - mover_x, y[part] - mover_y) <= keep_m
    walls &= np.hypot(x - pose.x, y - pose.y) > _OWN_M
    costs = np.where(walls, 255, 1).astype(np.uint8)
    driven = costmap.resolution * cost_field(costs, (row - rows.start, col - cols.start), threads=1)
    room = distance_field((data >= LETHAL).view(np.uint8), costmap.resolution, 0.0, _ROOM_M)
    worth = _PASS_WORTH_M * np.minimum((room - costmap.circumscribed_radius) / _PASS_M, 1.0) - driven
    worth[driven > _REACH_M] = -np.inf
    for other in others:
        worth[np.hypot(x - other.x, y - other.y) <= _OTHER_M] = -np.inf
    for least_m in _LEAST_M:
        best = np.where(driven >= least_m, worth, -np.inf).argmax()
        if math.isfinite(worth.flat[best]):
            return Goal(float(x.flat[best]), float(y.flat[best]))
    return None
