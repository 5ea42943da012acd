"""Regulated pure pursuit that stops and turns in place at sharp bends, and always keeps room to stop.

After Macenski et al., "Regulated Pure Pursuit for Robot Path Tracking" (2023), with the defaults of Nav2's controller
of that name. Two things are added. The path is cut at sharp bends, where its direction changes, and at bends that the
footprint cannot take in a curve, into sections with turns in place between them. And every command is checked with the
footprint over its stopping distance. A section that is driven backwards is followed as if the robot faced the other
way, with the speed negated.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from trundle.control.collision import can_stop, cost_under
from trundle.control.controller import Controller
from trundle.control.pursuit_settings import PursuitSettings
from trundle.control.sections import (
    SECTION_DONE_M,
    Motion,
    Section,
    Vertex,
    changes_direction,
    cut_sections,
    path_vertices,
    turn_by,
)
from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import NoValidControlError
from trundle.geometry import FloatArray, Pose2D, Twist2D, wrap_angle
from trundle.path import Path
from trundle.robots import Robot

_STAND = Twist2D(0.0, 0.0)
_TURN_DONE_RAD = 0.02  # about a degree: pursuit makes what is left of the turn
_SECTION_MISSED_M = 0.02
"""A lookahead with which the robot would miss a section's end by more is too long for it [m]."""

_ROOM_STEP_M = 0.005
_ROOM_STEP_RAD = math.radians(0.5)
"""Steps in which the least room along a path is looked for, fine enough not to step over its narrowest place."""

_SLOWER = (1.0, 0.5, 0.25)  # shares of a command that are tried, the same arc at less speed

_LEAD_S = 0.2
"""How far commands may lead what the robot reaches: with less, motors that lag behind would hardly speed it up."""

_LEAST_SHARE = 0.25
"""Share of the acceleration that is left in any turn, so that a robot that turns all the time still drives off."""


@dataclass(slots=True)
class _Turn:
    """A turn in place in progress: the angle that is left [rad] and the yaw at the last measurement."""

    remaining: float
    yaw: float


class RegulatedPurePursuit(Controller):
    """Follows a path of straight stretches, curves and turns in place; stops at its end, turned to its last yaw.

    Args:
        robot: What is driven; its limits hold over the settings.
        settings: Any field of `PursuitSettings`.

    Raises:
        InputError: If a setting is out of range.
    """

    def __init__(self, robot: Robot, **settings: Any) -> None:
        self._robot = robot
        self.settings = PursuitSettings(**settings)
        self._reach_m = robot.circumscribed_radius + self.settings.footprint_padding
        self._outline = robot.planar.padded(self.settings.footprint_padding).outline
        self._driving_off = DrivingOff(robot, self.settings.acceleration_of(robot))
        self.reset()

    def reset(self, *, seed: int = 0) -> None:
        """Forget the path and the speed limit; nothing here is random."""
        self._outlines: list[FloatArray] = []
        self._path: Path | None = None
        self._sections: list[Section] | None = None
        self._lookaheads: list[float] = []
        self._index = 0
        self._s = 0.0
        self._turn: _Turn | None = None
        self._done = True
        self._speed_limit = math.inf
        self._driving_off.reset()

    @property
    def remaining_m(self) -> float:
        """How much of the path is left [m]; all of it until the first command on it."""
        if self._done:
            return 0.0
        if self._sections is None:
            vertices = [] if self._path is None else path_vertices(self._path)
            return sum(math.hypot(b.x - a.x, b.y - a.y) for a, b in itertools.pairwise(vertices))
        return sum(section.length for section in self._sections[self._index :]) - self._s

    @property
    def is_turning(self) -> bool:
        """Whether it turns in place."""
        return self._turn is not None

    @property
    def is_done(self) -> bool:
        """Whether it has no path, or has come to its end."""
        return self._done

    def set_speed_limit(self, limit: float) -> None:
        """Drive no faster than this [m/s] from now on; infinity takes the limit away."""
        self._speed_limit = limit

    def set_path(self, path: Path) -> None:
        """Follow this path from now on, from its beginning."""
        self._path = path
        self._sections = None
        self._done = False
        self._driving_off.reset()

    def compute_velocity(self, pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float) -> Twist2D:
        """Return the command for the next control period; see `Controller`.

        Raises:
            NoValidControlError: If every command would cause a contact.
        """
        if not self._done and self._sections is None and self._path is not None:
            self._lay_out(path_vertices(self._path), pose, costmap)
        if not self._done:
            self._finish_what_is_done(pose)
        if self._done:
            self._driving_off.reset()
            return _STAND
        if self._turn is not None:
            commands = [Twist2D(0.0, self._turn_speed(self._turn.remaining))]
        else:
            commands = self._pursue(pose, costmap)
        for wish in commands:
            command = self._driving_off.limit(wish, twist, dt)
            for factor in _SLOWER:
                slower = Twist2D(factor * command.v, factor * command.w)
                if self._is_clear(costmap, pose, twist, slower, dt):
                    self._driving_off.note(slower)
                    return slower
        self._driving_off.reset()
        what = "turning in place" if self._turn is not None else "following the path"
        raise NoValidControlError(
            f"no valid control at ({pose.x:.2f}, {pose.y:.2f}, {pose.yaw:.2f}): {what} would cause a contact at every "
            "speed; plan again from here, or back up"
        )

    # Laying out -----------------------------------------------------------------------------------------------------

    def _lay_out(self, vertices: list[Vertex], pose: Pose2D, costmap: Costmap) -> None:
        """Cut the path into sections: stop at sharp bends, and at bends whose curve the footprint cannot take."""
        sharp = self.settings.rotate_to_heading_min_angle
        self._index, self._s, self._turn = 0, 0.0, None
        if len(vertices) == 1:
            self._sections = []
            at = vertices[0]
            self._outlines = [self._pad(costmap, [turn_by((at.x, at.y, pose.yaw), at.turn)])]
            self._begin_turn(vertices[0].turn, pose)
            self._done = self._turn is None
            return
        stops = [abs(vertex.turn) > sharp or changes_direction(vertices, i) for i, vertex in enumerate(vertices)]
        stops[-1] = True
        sections = cut_sections(vertices, stops)
        self._lookaheads, bend = self._choose_lookaheads(sections, stops, pose, costmap)
        while bend is not None:
            stops[bend] = True
            sections = cut_sections(vertices, stops)
            self._lookaheads, bend = self._choose_lookaheads(sections, stops, pose, costmap)
        self._sections = sections
        driven = [section.motions() for section in sections]
        driven[0].append(turn_by(driven[0][0][0], -vertices[0].turn))
        self._outlines = [self._pad(costmap, motions) for motions in driven]
        if stops[0]:
            self._begin_turn(vertices[0].turn, pose)

    def _pad(self, costmap: Costmap, motions: list[Motion]) -> FloatArray:
        """Return the padded outline; where the path passes closer to something, padded by half of its clearance there.

        Where the path touches something it is blocked, and the padding stays as it is.
        """
        first, last = (np.array(ends) for ends in zip(*motions, strict=True))
        hit = np.isfinite(costmap.footprint_sweeps(first, last, outline=self._outline))
        if not hit.any():
            return self._outline
        room = min(_least_room(costmap, *ends) for ends in zip(first[hit], last[hit], strict=True))
        if room == 0.0:
            return self._outline
        return self._robot.planar.padded(min(0.5 * room, self.settings.footprint_padding)).outline

    @property
    def _padded(self) -> FloatArray:
        """The padded outline for the current section, or for the turn at its end."""
        turned = self._index - 1 if self._turn is not None else self._index
        return self._outlines[max(turned, 0)]

    def _choose_lookaheads(
        self, sections: list[Section], stops: list[bool], pose: Pose2D, costmap: Costmap
    ) -> tuple[list[float], int | None]:
        """The lookahead [m], the usual or the short one, that follows each section to its end without a collision.

        Where the short one collides too, also the index of the nearest bend that is not a stop yet.
        """
        lookaheads: list[float] = []
        first = 0
        for section in sections:
            last = first + len(section.points) - 1
            lookaheads.append(self.settings.lookahead_dist)
            bends = [i for i in range(first, last) if not stops[i]]
            if bends:
                yaw = section.headings[0] if first > 0 or stops[0] else section.travel_yaw(pose.yaw)
                touched, missed = self._pursue_ideally(section, yaw, self.settings.lookahead_dist, costmap)
                if touched is not None or missed > _SECTION_MISSED_M:
                    lookaheads[-1] = self.settings.min_lookahead_dist
                    touched, _ = self._pursue_ideally(section, yaw, self.settings.min_lookahead_dist, costmap)
                if touched is not None:
                    return lookaheads, self._nearest_bend(bends, section, first, touched)
            first = last
        return lookaheads, None

    def _pursue_ideally(
        self, section: Section, yaw: float, lookahead: float, costmap: Costmap
    ) -> tuple[float | None, float]:
        """Return the arc length [m] of an ideal pursuit's first collision, or None; and how far it misses the end."""
        driven, along = section.pursue(yaw, lookahead)
        if len(driven) == 0:
            return None, 0.0
        hits = np.flatnonzero(costmap.footprint_collides(driven, outline=self._outline))
        (x, y), heading = section.points[-1], section.headings[-1]
        missed = abs((driven[-1, 1] - y) * math.cos(heading) - (driven[-1, 0] - x) * math.sin(heading))
        return along[int(hits[0])] if len(hits) else None, missed

    @staticmethod
    def _nearest_bend(bends: list[int], section: Section, first: int, s: float) -> int:
        return min(bends, key=lambda bend: abs(section.starts[bend - first] - s))

    # Following ------------------------------------------------------------------------------------------------------

    def _finish_what_is_done(self, pose: Pose2D) -> None:
        """Update the progress along the current section or turn, and begin the next one when it is done."""
        sections = self._sections or []
        if self._turn is not None:
            self._turn.remaining -= wrap_angle(pose.yaw - self._turn.yaw)
            self._turn.yaw = pose.yaw
            if abs(self._turn.remaining) > _TURN_DONE_RAD:
                return
            self._turn = None
            if self._index >= len(sections):
                self._done = True
                return
        section = sections[self._index]
        self._s = section.project(pose.x, pose.y, self._s, self.settings.lookahead_dist)
        if section.length - self._s > SECTION_DONE_M:
            return
        self._index, self._s = self._index + 1, 0.0
        # In the planned direction of rotation, to the planned yaw, from the yaw that the robot really has.
        self._begin_turn(section.end_turn + wrap_angle(section.headings[-1] - section.travel_yaw(pose.yaw)), pose)
        if self._turn is None and self._index >= len(sections):
            self._done = True

    def _begin_turn(self, turn: float, pose: Pose2D) -> None:
        self._turn = _Turn(turn, pose.yaw) if abs(turn) > _TURN_DONE_RAD else None

    def _turn_speed(self, remaining: float) -> float:
        """Return turning speed [rad/s] that can still stop at the end of the turn."""
        limits, settings = self._robot.limits, self.settings
        fastest = min(settings.rotate_to_heading_angular_vel, limits.angular_speed)
        braking = math.sqrt(2.0 * settings.approach_deceleration * limits.angular_acceleration * abs(remaining))
        return math.copysign(max(min(fastest, braking), min(0.05, fastest)), remaining)

    def _pursue(self, pose: Pose2D, costmap: Costmap) -> list[Twist2D]:
        """Commands to follow the section, the best first; the later ones lead back onto it where it is tight."""
        sections = self._sections or []
        section, settings = sections[self._index], self.settings
        yaw = section.travel_yaw(pose.yaw)
        curvature, bearing = section.curvature(pose.x, pose.y, yaw, self._s, self._lookaheads[self._index])
        rotate = min(settings.rotate_to_heading_angular_vel, self._robot.limits.angular_speed)
        back_to_path = Twist2D(0.0, math.copysign(min(rotate, max(0.1, 2.0 * abs(bearing))), bearing))
        if abs(bearing) > settings.rotate_to_heading_min_angle:
            return [back_to_path, Twist2D(0.0, -back_to_path.w)]
        speed = self._regulated_speed(curvature, section, pose, costmap)
        tight = section.curvature(pose.x, pose.y, yaw, self._s, settings.min_lookahead_dist)[0]
        slow = min(speed, settings.regulated_linear_scaling_min_speed, self._fastest_in_curve(tight))
        sign = -1.0 if section.backward else 1.0
        arcs = [Twist2D(sign * speed, speed * curvature), Twist2D(sign * slow, slow * tight)]
        # Turning does not help a robot that faces along its path: it would only sway in front of the obstacle.
        return [*arcs, back_to_path] if abs(bearing) > _TURN_DONE_RAD else arcs

    def _fastest_in_curve(self, curvature: float) -> float:
        limit = self._robot.limits.angular_speed
        return limit / abs(curvature) if abs(curvature) > 1e-9 else math.inf

    def _regulated_speed(self, curvature: float, section: Section, pose: Pose2D, costmap: Costmap) -> float:
        """Speed [m/s] for a curvature, the distance to obstacles and the distance to the end of the section."""
        settings, limits = self.settings, self._robot.limits
        fastest = limits.linear_speed
        if section.backward and limits.reverse_speed is not None:
            fastest = limits.reverse_speed
        wanted = fastest if settings.desired_linear_vel is None else min(settings.desired_linear_vel, fastest)
        wanted = min(wanted, self._speed_limit)
        regulated = wanted
        radius = 1.0 / max(abs(curvature), 1e-9)
        if radius < settings.regulated_linear_scaling_min_radius:
            regulated = min(regulated, wanted * radius / settings.regulated_linear_scaling_min_radius)
        distance = self._distance_to_obstacle(pose, costmap)
        if distance < settings.cost_scaling_dist:
            regulated = min(regulated, wanted * distance / settings.cost_scaling_dist)
        regulated = max(regulated, min(wanted, settings.regulated_linear_scaling_min_speed))
        remaining = max(section.length - self._s, 0.0)
        approach = math.sqrt(2.0 * settings.approach_deceleration * limits.linear_acceleration * remaining)
        is_last = self._index == len(self._sections or []) - 1
        if is_last and remaining < settings.approach_velocity_scaling_dist:
            approach = min(approach, wanted * remaining / settings.approach_velocity_scaling_dist)
        approach = max(approach, min(wanted, settings.min_approach_linear_velocity))
        return min(regulated, approach, self._fastest_in_curve(curvature))

    @staticmethod
    def _distance_to_obstacle(pose: Pose2D, costmap: Costmap) -> float:
        """Return the distance [m] from base_link to the nearest obstacle, by the cost; infinite outside inflation."""
        cost = cost_under(costmap, pose.x, pose.y)
        if cost == 0:
            return math.inf
        if cost >= INSCRIBED:
            return 0.0
        return costmap.inscribed_radius - math.log(cost / (INSCRIBED - 1)) / costmap.cost_scaling_factor

    def _is_clear(self, costmap: Costmap, pose: Pose2D, twist: Twist2D, command: Twist2D, dt: float) -> bool:
        # Where the cost is 0 the inflation, which reaches beyond the footprint's swing and the stopping distance, ends.
        limits = self._robot.limits
        fastest = max(limits.linear_speed, abs(twist.v))
        stop_m = fastest * (max(0.1, dt) + fastest / (2.0 * limits.linear_acceleration))
        if costmap.inflation_radius >= self._reach_m + stop_m and cost_under(costmap, pose.x, pose.y) == 0:
            return True
        return can_stop(costmap, limits, pose, twist, command, dt, padded=self._padded)


def _least_room(costmap: Costmap, first: FloatArray, last: FloatArray) -> float:
    """Return the clearance [m] of the footprint along a straight line or a turn in place."""
    length, turn = math.dist(first[:2], last[:2]), abs(float(last[2] - first[2]))
    pieces = max(1, math.ceil(max(length / _ROOM_STEP_M, turn / _ROOM_STEP_RAD)))
    return float(costmap.clearance(np.linspace(first, last, pieces + 1)).min())


class DrivingOff:
    """Limits how fast commands speed a robot up: the outer wheel's acceleration stays within that of the robot.

    A robot that drives off while it still turns asks its outer wheel for both accelerations at once. Where the wheel
    then slips, odometry counts a turn that the robot did not make. So the more the turning speed changes, the less the
    speed may grow; the arc stays the same. Braking is not limited.

    Args:
        robot: What is driven.
        acceleration: Acceleration of each wheel along the floor [m/s²].
    """

    def __init__(self, robot: Robot, acceleration: float) -> None:
        self._limits, self._half_track = robot.limits, robot.drive.track_width / 2.0
        self._acceleration = acceleration
        self.reset()

    def reset(self) -> None:
        """Forget the last command."""
        self._last = 0.0

    def limit(self, command: Twist2D, twist: Twist2D, dt: float) -> Twist2D:
        """The same arc, not faster than may be commanded for the next `dt` [s] to a robot that moves with `twist`.

        Speeds grow from the last command, which may lead what the robot reaches by 0.2 s of its acceleration: a robot
        whose motors lag behind would hardly speed up otherwise.
        """
        forward = 1.0 if command.v >= 0.0 else -1.0
        wanted, moving = abs(command.v), max(0.0, forward * twist.v)
        most = moving + self._acceleration * _LEAD_S
        base = min(max(moving, forward * self._last), most)
        step = self._acceleration * dt
        slowest = base + _LEAST_SHARE * step
        if wanted <= slowest:
            return command
        turned = max(abs(share * command.w - twist.w) for share in (1.0, slowest / wanted))
        across = self._half_track * min(turned, self._limits.angular_acceleration * dt)
        share = min(1.0, max(slowest, base + step - across) / wanted)
        return Twist2D(share * command.v, share * command.w)

    def note(self, command: Twist2D) -> None:
        """Note the command that was chosen."""
        self._last = command.v
