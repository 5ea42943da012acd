"""Model predictive path integral control, by name `mppi`.

In every control period thousands of sequences of commands are rolled out, rated, and averaged by how good they are
(Williams, Drews, Goldfain, Rehg and Theodorou, 2016). They are led by a field, the cost to go to where the path leaves
a window around the robot, so that the robot takes its own course round what blocks the path there.

The samples know the footprint as discs. Where these do not fit and the outline does, where the path leaves little room
beside the outline, on stretches that are driven backwards, and where samples bring the robot no further along its path,
it follows the planned path itself, by regulated pure pursuit. Whatever the command is, the outline must be able to
stop.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from trundle.control.collision import can_stop
from trundle.control.controller import Controller, Intent, Rollouts
from trundle.control.mppi.fields import FieldStyle, Window, cover_with_discs
from trundle.control.mppi.guide import Guide, Headway, Route
from trundle.control.mppi.mppi_settings import MppiSettings
from trundle.control.mppi.sampler import Aim, Answer, Sampler, Start
from trundle.control.regulated_pure_pursuit import RegulatedPurePursuit
from trundle.costmap import Costmap
from trundle.errors import InputError, NoValidControlError
from trundle.geometry import FloatArray, Pose2D, Twist2D, wrap_angle
from trundle.observation import Track
from trundle.path import Path
from trundle.registry import CopiedAsNew
from trundle.robots import Robot
from trundle.values import check_kind, check_number

_STAND = Twist2D(0.0, 0.0)
_SHARES = ((1.0, 1.0), (0.5, 1.0), (0.5, 0.5), (0.25, 1.0), (0.25, 0.25), (0.0, 1.0))
"""Shares of the best command's speed and turn that are tried in turn: slower in the same turn first."""
_EXACT_BEFORE_M, _EXACT_BEFORE_S = 0.4, 0.8
"""The planned path is followed from so far before a place where only the outline fits [m], [s] at top speed."""
_STILL_MPS, _STILL_RADPS = 0.05, 0.2
"""Slower than this the robot counts as standing: the noise of samples keeps speeds a little above 0."""

_BY_MOVER = "blocked by a mover"
_MANY_CONTACTS = 0.01  # of all samples: what moves is in the way
_STILL_S = 0.4
_PATIENCE_M = 0.3
"""A robot that stands for so long follows the path itself; where that is blocked, for so far [m] at most."""

_AT_REST = 0.02  # [m/s] and [rad/s]: below it a new path begins without the last one's commands
_LITTLE_TURN_RAD = 0.5  # turns up to this are not made the other way round
_FACES_AWAY_RAD, _TURN_STEP_RAD = 0.5 * math.pi, math.radians(10.0)
_ROOM_TO_LEAVE = 2.0
"""Samples are drawn again where there is so much more room than where they were given up, as a share."""
_LEAD_PAST = 0.5  # of the tolerance of a pose that it has to pass


@dataclass(frozen=True, slots=True)
class _Now:
    """What a controller is told each control period; see `Controller.compute_velocity`."""

    pose: Pose2D
    twist: Twist2D
    costmap: Costmap
    dt: float


class MppiController(CopiedAsNew, Controller):
    """Samples what the robot could do, and does the best of it; stops at the path's end, turned to its last yaw.

    Args:
        robot: What is driven; its limits hold over the settings.
        settings: Any field of `MppiSettings`.

    Attributes:
        settings: The same.
        reason: Why the robot makes no progress, such as "no free sample"; empty while it does.

    Raises:
        InputError: If a setting is out of range, or a limit of the robot is zero.
    """

    def __init__(self, robot: Robot, **settings: Any) -> None:
        check_kind(robot, Robot, "a controller's robot", "Robot.load(name) makes one")
        self._robot = robot
        self.settings = MppiSettings(**settings)
        for name in ("linear_speed", "angular_speed", "linear_acceleration", "angular_acceleration"):
            if not getattr(robot.limits, name) > 0.0:
                raise InputError(f"mppi: {robot.name} cannot move: its limit {name} must be above 0")
        self._limits = self.settings.limits_of(robot)
        padding = self.settings.footprint_padding
        self._padded = robot.planar.padded(padding).outline
        self._half_width = float(np.abs(robot.outline[:, 1]).max())
        room = self.settings.room_of(robot)
        self._rooms = tuple(robot.planar.padded(share * room).outline for share in (1.0, _ROOM_TO_LEAVE))
        self._discs = cover_with_discs(robot.planar, padding)
        self._sampler = Sampler(robot, self.settings, self._discs)
        style = FieldStyle(
            float(self._discs[:, 1].max()), self.settings.near_path_weight, self.settings.near_path_distance
        )
        reach = self._limits.linear_speed * self.settings.step_s(robot) * self._sampler.steps
        self._guide = Guide(style, reach)
        self._exact_before_m = _EXACT_BEFORE_M + _EXACT_BEFORE_S * self._limits.linear_speed
        self._pursuit = RegulatedPurePursuit(robot, footprint_padding=padding)
        self._headway = Headway()
        self.reset()

    def reset(self, *, seed: int = 0) -> None:
        """Forget the path, the speed limit and the last commands; samples are drawn by this seed."""
        self._sampler.reset(seed)
        self._guide.reset()
        self._pursuit.reset()
        self._route: Route | None = None
        self._done = True
        self._follows = False
        self._is_new = False
        self._speed_limit = math.inf
        self._movers: tuple[Track, ...] = ()
        self._through: tuple[float, ...] = ()
        self._lead_past_m = 0.0
        self._last = _STAND
        self._sample_below_m = math.inf
        self._end_on: Costmap | None = None
        self._end_has_room = True
        self._headway.reset()
        self._still_s = 0.0
        self.reason = ""

    def set_path(self, path: Path) -> None:
        """Follow this path from now on, from its beginning."""
        owed_m = 0.0 if self._route is None else max(0.0, self._route.left_m - self._sample_below_m)
        self._route = Route(path)
        self._sample_below_m = self._route.left_m - owed_m if owed_m > 0.0 else math.inf
        self._through = ()
        self._done = False
        self._follows = False
        self._is_new = True
        self._end_on = None
        self._still_s = 0.0
        self.reason = ""
        self._headway.begin()

    def set_speed_limit(self, limit: float) -> None:
        """Drive no faster than this [m/s] from now on; infinity takes the limit away."""
        self._speed_limit = limit
        self._pursuit.set_speed_limit(limit)

    def set_tracks(self, tracks: Sequence[Track]) -> None:
        """Set what moves around the robot, map frame; its motion is predicted from now on."""
        self._movers = tuple(track for track in tracks if track.confirmed and track.moving)

    def set_through(self, marks: Sequence[float], tolerance: float) -> None:
        """Set the poses that are still to be passed: how far along the path, and how near the robot must come."""
        passed = len(self._through) - len(marks)
        if passed > 0 and self._route is not None:
            self._route.reach(self._through[passed - 1])
        self._through, self._lead_past_m = tuple(marks), _LEAD_PAST * tolerance

    def rollouts(self, count: int = 30) -> Rollouts | None:
        """Return the best samples of the last control period; None where it needed no samples."""
        if self._follows or self._done:
            return None
        return Rollouts(*self._sampler.best(count))

    @property
    def intent(self) -> Intent | None:
        """What it means to command from now on; None where it follows the planned path itself."""
        return None if self._follows or self._done else self._sampler.intent

    def compute_velocity(self, pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float) -> Twist2D:
        """Return the command for the next control period; see `Controller`.

        Raises:
            NoValidControlError: If every command would cause a contact, or the costmap does not contain the robot.
            InputError: If the control period is not positive.
        """
        check_number("dt", dt, 1e-4, 10.0, "s")
        if self._route is None or self._done:
            self.reason = "no path yet" if self._route is None else ""
            return _STAND
        if not costmap.contains(*costmap.world_to_cell(pose.x, pose.y)):
            raise self._no_control(pose, "outside of the costmap")
        if self._is_new:
            self._begin(twist)
        try:
            command = self._drive(self._route, _Now(pose, twist, costmap, dt))
        except NoValidControlError:
            self.reason = self.reason or "the outline would touch something"
            raise
        self._watch(command, twist, costmap, dt)
        self._last = twist
        return command

    def _begin(self, twist: Twist2D) -> None:
        """Begin a new path: a robot that stands forgets what it did before."""
        self._is_new = False
        self._guide.reset()
        if max(abs(twist.v), abs(twist.w)) < _AT_REST:
            self._sampler.restart(_STAND)
            self._last = _STAND

    # Choosing -------------------------------------------------------------------------------------------------------

    def _drive(self, route: Route, now: _Now) -> Twist2D:
        followed: Twist2D | None = None
        if self._follows:
            followed = self._keep_following(route, now)
            if self._done or self._pursuit.is_turning:
                return followed
        else:
            route.advance(now.pose)
            self._guide.rejoin(route, now.pose)
            if self._has_arrived(route, now.pose):
                return self._follow(self._turn_at_end(route, now), now)
        window = self._guide.look(now.costmap, now.pose, self._movers)
        if self._is_exact(route, window, now.pose) or not self._is_led(route, window, now.pose):
            return self._follow(route.rest(now.pose), now) if followed is None else followed
        if self._follows:
            self._follows = False
            self._sampler.restart(now.twist)
        return self._sample(route, window, now)

    def _turn_at_end(self, route: Route, now: _Now) -> Path:
        """Return a turn in place to the yaw at the path's end: the shorter one, or the other where only that is free.

        Where neither is, its direction is the planned one: the robot stands a little beside the path.
        """
        x, y, yaw = now.pose.as_tuple()
        turn = wrap_angle(route.path.goal.yaw - yaw)
        other = turn - math.copysign(2.0 * math.pi, turn)
        if abs(turn) > _LITTLE_TURN_RAD and self._hits_in_turn(now.costmap, now.pose, turn):
            planned = float(route.last_turn[-1, 2] - route.last_turn[0, 2])
            if planned * turn < 0.0 or not self._hits_in_turn(now.costmap, now.pose, other):
                turn = other
        return Path(np.array([(x, y, yaw + share * turn) for share in (0.0, 0.5, 1.0)]))

    def _follow(self, path: Path, now: _Now) -> Twist2D:
        """Follow a planned path itself from now on."""
        self._follows = True
        self._pursuit.set_path(path)
        command = self._pursuit.compute_velocity(now.pose, now.twist, now.costmap, now.dt)
        self._done = self._pursuit.is_done
        return self._soften(command, now)

    def _keep_following(self, route: Route, now: _Now) -> Twist2D:
        command = self._pursuit.compute_velocity(now.pose, now.twist, now.costmap, now.dt)
        route.jump(self._pursuit.remaining_m)
        self._done = self._pursuit.is_done
        return self._soften(command, now)

    def _soften(self, command: Twist2D, now: _Now) -> Twist2D:
        """Return a command that speeds up as gently as the samples do; it may slow down as it likes."""
        gentle = self._limits.approach(now.twist, command, now.dt)
        v = gentle.v if abs(command.v) > abs(now.twist.v) else command.v
        w = gentle.w if abs(command.w) > abs(now.twist.w) else command.w
        return Twist2D(v, w)

    def _has_arrived(self, route: Route, pose: Pose2D) -> bool:
        near = pose.distance_to(route.path.goal) <= self.settings.goal_tolerance
        return near and route.left_m <= 2.0 * self.settings.goal_tolerance

    def _is_exact(self, route: Route, window: Window, pose: Pose2D) -> bool:
        """Return whether the planned path itself is to be followed here."""
        if route.left_m > self._sample_below_m:
            return True
        ahead = route.ahead(self._exact_before_m)
        if route.backward[ahead].any() or float(route.along[-1]) < self.settings.goal_tolerance:
            return True
        if self._is_narrow(window.costmap, route.poses[ahead], pose) or self._turns_first(route, window.costmap, pose):
            return True
        last = window.poses_in(route.last_turn)
        return route.left_m < self._exact_before_m and not window.discs_fit(last, self._discs).all()

    def _is_narrow(self, costmap: Costmap, poses: FloatArray, pose: Pose2D) -> bool:
        """Return whether the path is free here and leaves little room, and nothing moves nearby."""
        if self.settings.sampling_room == 0.0 or self._movers:
            return False
        off_m = math.hypot(poses[0, 0] - pose.x, poses[0, 1] - pose.y)
        if off_m > self._half_width and not self._follows:
            return False
        near = costmap.footprint_collides(poses, outline=self._rooms[self._follows])
        return bool(near.any()) and not costmap.footprint_collides(poses).any()

    def _turns_first(self, route: Route, costmap: Costmap, pose: Pose2D) -> bool:
        """Return whether the robot drives backwards to an end without room for a turn, and can turn here."""
        turn = wrap_angle(float(route.poses[route.index, 2]) - pose.yaw)
        if abs(turn) < _FACES_AWAY_RAD or self._has_room_at_end(route, costmap):
            return False
        return not self._hits_in_turn(costmap, pose, turn)

    def _has_room_at_end(self, route: Route, costmap: Costmap) -> bool:
        """Return whether the robot can turn round at the path's end, as far as the costmap knows by now."""
        if self._end_on is not costmap:
            self._end_on = costmap
            self._end_has_room = not self._hits_in_turn(costmap, route.path.goal, 2.0 * math.pi)
        return self._end_has_room

    def _hits_in_turn(self, costmap: Costmap, pose: Pose2D, turn: float) -> bool:
        """Return whether the padded outline touches something in a turn in place [rad]."""
        yaws = pose.yaw + np.linspace(0.0, turn, max(2, math.ceil(abs(turn) / _TURN_STEP_RAD) + 1))
        poses = np.column_stack([np.full((len(yaws), 2), (pose.x, pose.y)), yaws])
        return bool((costmap.footprint_sweeps(poses[:-1], poses[1:], outline=self._padded) < math.inf).any())

    def _is_led(self, route: Route, window: Window, pose: Pose2D) -> bool:
        """Return whether samples can go on from here: the cost to go leads to a place where the discs pass."""
        guide = self._guide
        guide.lead(window, route, self._lead_end(route), pose)
        if not math.isfinite(guide.cost_at(window, pose)):
            self.reason = "the path is blocked"
            return False
        near = float(route.along[guide.target] - route.along[route.index]) < self._exact_before_m
        if not (guide.stops_short and near):
            return True
        outlines = window.costmap.footprint_collides(route.poses[route.ahead(self._exact_before_m)])
        return bool(outlines.any())

    # Sampling -------------------------------------------------------------------------------------------------------

    def _sample(self, route: Route, window: Window, now: _Now) -> Twist2D:
        to_go, twist = self._guide.to_go, now.twist
        if to_go is None:
            raise self._no_control(now.pose, "the path is blocked")
        change = Twist2D((twist.v - self._last.v) / now.dt, (twist.w - self._last.w) / now.dt)
        start = Start(now.pose, twist, change, self._speed_limit, now.dt)
        answer = self._sampler.step(window, to_go, start, self._aim(route, window), self._movers)
        self.reason = _reason_of(answer)
        v, w = answer.command.v, answer.command.w
        for command in (Twist2D(slower * v, less * w) for slower, less in _SHARES):
            if can_stop(now.costmap, self._robot.limits, now.pose, twist, command, now.dt, padded=self._padded):
                return command
        self.reason = self.reason or "the outline would touch something"
        return self._follow(route.rest(now.pose), now)

    def _lead_end(self, route: Route) -> int:
        """Return the last pose to lead to: beyond it, samples would cut off the place where the path doubles back."""
        end = route.section_end
        if not self._through:
            return end
        past = int(route.along.searchsorted(self._through[0] + self._lead_past_m))
        return min(end, past) if past > route.index else end

    def _aim(self, route: Route, window: Window) -> Aim:
        end = route.section_end
        (x, y, yaw) = window.poses_in(route.poses[end : end + 1])[0].tolist()
        within = self._guide.target == end
        return Aim(x, y, yaw, has_yaw=within, reach=0.3 if within else 0.0)

    # Reasons --------------------------------------------------------------------------------------------------------

    def _watch(self, command: Twist2D, twist: Twist2D, costmap: Costmap, dt: float) -> None:
        """Switch to the planned path itself when samples let the robot stand for a while without a reason."""
        still = max(abs(command.v), abs(twist.v)) < _STILL_MPS and max(abs(command.w), abs(twist.w)) < _STILL_RADPS
        if not still or self._done:
            self._still_s, self.reason = 0.0, ""
            self._watch_headway(twist, costmap, dt)
            return
        self.reason = self.reason or "standing is the best sample"
        if self.reason == _BY_MOVER:
            return
        self._still_s += dt
        if self._still_s > _STILL_S and self._route is not None and not self._follows:
            self._still_s = 0.0
            self._hand_over(self._route, costmap, _PATIENCE_M)

    def _watch_headway(self, twist: Twist2D, costmap: Costmap, dt: float) -> None:
        """Switch to the planned path itself when samples drive to and fro, and bring the robot no further."""
        if self._route is None or self._movers or self._route.left_m > self._sample_below_m:
            return
        if self._headway.is_lost(self._route.left_m, twist, dt):
            self._hand_over(self._route, costmap, 0.0)

    def _hand_over(self, route: Route, costmap: Costmap, at_most_m: float) -> None:
        """Follow a stretch of the path itself from now on; at most so much [m] of one that is blocked."""
        stretch_m = self._headway.lose()
        if costmap.footprint_collides(route.poses[route.ahead(stretch_m + self._exact_before_m)]).any():
            stretch_m = min(stretch_m, at_most_m)
        self._sample_below_m = route.left_m - stretch_m

    def _no_control(self, pose: Pose2D, reason: str) -> NoValidControlError:
        self.reason = reason
        return NoValidControlError(
            f"no valid control at ({pose.x:.2f}, {pose.y:.2f}, {pose.yaw:.2f}): {reason}; plan again from here, or "
            "back up"
        )


def _reason_of(answer: Answer) -> str:
    if answer.free == 0:
        return "no free sample"
    everyone = answer.free + answer.blocked
    return _BY_MOVER if answer.contacts >= _MANY_CONTACTS * everyone else ""
