"""Crowds in NumPy, all members at once: what the kernel of crowds is compared with."""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from support.crowd_forces import (
    MARGIN_M,
    border_force,
    driving,
    enters_path,
    give_way,
    keep_apart,
    repulsion,
    swings_into,
)
from support.floor_oracle import IndexArray, WalkableFloor
from trundle.errors import WorldError
from trundle.geometry import FloatArray, wrap_angles
from trundle.geometry.solids import Solid, solids_bounds
from trundle.worlds.movers.crowd import Crowd
from trundle.worlds.movers.mover import Mover, outline_of, radius_of, top_of
from trundle.worlds.movers.walk import PERIOD_S, RobotMotion

# Members start at least this far from the robot [m], beside both radii, so that nobody touches it before it can brake.
_CLEAR_OF_ROBOT = 2.0
# Random places that are tried for one member, and placings of a whole crowd that are tried: the first members may leave
# no room for the last. A placing that ends below 80 % of them, less 5, is not repeated: others would fail as well.
_TRIES = 400
_PLACINGS = 20
_NEARLY_ALL, _A_FEW = 0.8, 5
_LEAST_WALK_M = 4.0  # to the next place, where there is one so far away
_LEAST_RETREAT_M = 1.5  # the same for one who is stuck
_RETREATS = 12  # places that one who is stuck looks at
_BLOCKING_M = 0.5  # those who are nearer than this block it
_THERE_M = 0.4  # a member this near to its goal has reached it, or nearer than its radius if that is larger
_STUCK_S = 2.0  # one that gets nowhere for so long goes elsewhere
_SOMEWHERE_M = 0.5  # so far is somewhere: by speed, those who are pushed to and fro in a jam never count as stuck
_SWING_M = 0.2  # bodies that are farther from the robot's circle do not swing into it [m]
_TURN, _STEER = 4.0, 1.2  # how fast those who step aside, and those who steer, turn [rad/s]


class CrowdOracle:
    """Steps crowds through a run; the same seed and robot give the same steps.

    Args:
        crowds: The crowds.
        movers: Others that move, by functions of time; crowds keep clear of them, too.
        solids: The world's solids.

    Raises:
        WorldError: If there is no room for a crowd.
    """

    def __init__(self, crowds: Sequence[Crowd], movers: Sequence[Mover], solids: Sequence[Solid]) -> None:
        self._crowds, self._movers = tuple(crowds), tuple(movers)
        self.names = [name for crowd in crowds for name in crowd.members]
        counts = [crowd.count for crowd in crowds]
        self._outlines = [outline_of(crowd.body) for crowd in crowds for _ in range(crowd.count)]
        self._radii = np.repeat([radius_of(crowd.body) for crowd in crowds], counts)
        self._top = np.repeat([crowd.speed for crowd in crowds], counts)
        self._sees = np.repeat([crowd.sees_robot for crowd in crowds], counts)
        self._steers = np.repeat([crowd.steers for crowd in crowds], counts)
        self._mover_radii = np.array([radius_of(mover.parts) for mover in movers])
        self._floors = [_make_floor(crowd, solids) for crowd in crowds]
        ends = np.cumsum(counts)
        self._slices = [slice(int(end - count), int(end)) for end, count in zip(ends, counts, strict=True)]

    def reset(self, seed: int, robot: RobotMotion) -> None:
        """Start from a seed, away from the robot.

        Raises:
            WorldError: If there is no room for all of them.
        """
        count = len(self.names)
        self._rngs = [
            np.random.default_rng([seed if crowd.seed is None else crowd.seed, zlib.crc32(crowd.name.encode())])
            for crowd in self._crowds
        ]
        self._from = np.zeros((count, 6))
        self._goals = np.zeros((count, 2))
        self._waits, self._was_at = np.zeros(count), np.full((count, 2), np.inf)
        self._preferred = np.zeros(count)
        self._fields = [np.zeros((0, 0, 0), dtype=np.float32)] * len(self._crowds)
        for index, part in enumerate(self._slices):
            self._place(index, part, robot)
        self._step_index = 0
        self._to = self._next(robot)

    def is_due(self, time: float) -> bool:
        """Return whether `at` needs the robot for this time [s]."""
        return math.floor(time / PERIOD_S + 1e-9) > self._step_index

    def at(self, time: float, robot: RobotMotion | None = None) -> FloatArray:
        """Return (x, y, yaw, vx, vy, w) of all members at a time [s] not before the last one, shape (N, 6).

        Args:
            time: Since the start of the run [s].
            robot: Where the robot is; needed where the time is due.
        """
        wanted = math.floor(time / PERIOD_S + 1e-9)
        while self._step_index < wanted:
            self._step_index += 1
            self._from = self._to
            self._to = self._next(robot)
        state = self._to.copy()
        share = time / PERIOD_S - self._step_index
        state[:, :3] = self._from[:, :3] + (share * PERIOD_S) * self._to[:, 3:]
        return state

    def _place(self, index: int, part: slice, robot: RobotMotion) -> None:
        """Put the members of a crowd at random places, and let each draw where it goes."""
        crowd, floor = self._crowds[index], self._floors[index]
        low, high = self._top[part] * 0.7, self._top[part]
        self._preferred[part] = self._rngs[index].uniform(low, high)
        number = part.start
        for _ in range(_PLACINGS):
            number = part.start
            while number < part.stop and self._place_one(index, number, robot):
                number += 1
            if number == part.stop:
                self._fields[index] = np.zeros((crowd.count, *floor.shape), dtype=np.float32)
                for cell, field in zip(floor.cells_of(self._goals[part]), self._fields[index], strict=True):
                    field[:] = floor.field_to(cell)
                return
            if number - part.start < _NEARLY_ALL * crowd.count - _A_FEW:
                break
        raise WorldError(
            f"the crowd {crowd.name!r}: found no place for {self.names[number]!r} with a radius of "
            f"{self._radii[number]:.2f} m that is {_CLEAR_OF_ROBOT:g} m from the robot and clear of the "
            f"{number - part.start} before it; make the crowd smaller"
        )

    def _place_one(self, index: int, number: int, robot: RobotMotion) -> bool:
        """Put one at a random place that is clear of those before it, and draw where it goes; whether there is one."""
        floor, rng, radius = self._floors[index], self._rngs[index], float(self._radii[number])
        for _ in range(_TRIES):
            point = floor.middles_of(floor.free[int(rng.integers(len(floor.free)))])
            gaps = np.hypot(*(self._from[:number, :2] - point).T) - self._radii[:number] - radius
            from_robot = math.hypot(point[0] - robot.x, point[1] - robot.y) - robot.radius - radius
            if from_robot > _CLEAR_OF_ROBOT and (gaps > 0.1).all() and self._is_off_movers(point, radius):
                self._from[number, :3] = *point, rng.uniform(-math.pi, math.pi)
                cell = self._far_cell(floor, rng, self._from[number, :2], _LEAST_WALK_M)
                self._goals[number] = floor.middles_of(cell)
                return True
        return False

    def _is_off_movers(self, point: FloatArray, radius: float) -> bool:
        states = [mover.motion.at(0.0) for mover in self._movers]
        return all(
            math.hypot(state.x - point[0], state.y - point[1]) > radius + other
            for state, other in zip(states, self._mover_radii.tolist(), strict=True)
        )

    def _draw_goal(self, index: int, number: int) -> None:
        """Draw where one goes."""
        floor = self._floors[index]
        cell = self._far_cell(floor, self._rngs[index], self._from[number, :2], _LEAST_WALK_M)
        self._go_to(index, number, cell, floor.field_to(cell))

    def _back_out(self, index: int, number: int, robot: RobotMotion | None) -> None:
        """Draw where one who is stuck goes: where it gets without passing those next to it, if there is any."""
        floor, here = self._floors[index], self._from[number, :2]
        others, least = self._from[:, :2], self._radii + self._radii[number]
        if robot is not None:
            others = np.vstack([others, (robot.x, robot.y)])
            least = np.append(least, self._radii[number] + robot.radius + MARGIN_M)
        apart = np.hypot(*(others - here).T)
        near = (apart < least + _BLOCKING_M) & (apart > 0.0)
        if not near.any():
            self._draw_goal(index, number)
            return
        discs = np.column_stack([others[near], np.minimum(least[near], apart[near] - floor.resolution)])
        reached = floor.field_to(floor.cells_of(here[None])[0], discs)
        for choice in self._rngs[index].integers(len(floor.free), size=_RETREATS).tolist():
            cell = floor.free[choice]
            is_far = math.hypot(*(floor.middles_of(cell) - here)) >= _LEAST_RETREAT_M
            if is_far and math.isfinite(reached[cell[0], cell[1]]):
                self._go_to(index, number, cell, floor.field_to(cell, discs))
                return

    def _go_to(self, index: int, number: int, cell: IndexArray, field: npt.NDArray[np.float32]) -> None:
        self._goals[number] = self._floors[index].middles_of(cell)
        self._fields[index][number - self._slices[index].start] = field

    @staticmethod
    def _far_cell(floor: WalkableFloor, rng: np.random.Generator, here: FloatArray, walk: float) -> IndexArray:
        """Return a free cell at least as far away as `walk` [m], if one is found soon."""
        cell = floor.free[int(rng.integers(len(floor.free)))]
        for _ in range(8):
            if math.hypot(*(floor.middles_of(cell) - here)) >= walk:
                break
            cell = floor.free[int(rng.integers(len(floor.free)))]
        return cell

    def _next(self, robot: RobotMotion | None) -> FloatArray:
        """Return the state a period later; its velocities are those of the period between."""
        points, yaws = self._from[:, :2], self._from[:, 2]
        velocities = np.zeros_like(points) if self._step_index == 0 else self._from[:, 3:5]
        self._choose_goals(points, robot)
        directions, forces = self._wishes(points)
        forces += driving(velocities, directions, self._preferred)
        moving = [mover.motion.at(self._step_index * PERIOD_S) for mover in self._movers]
        others = np.vstack([points, np.array([state[:2] for state in moving]).reshape(-1, 2)])
        other_velocities = np.vstack([velocities, np.array([state[3:5] for state in moving]).reshape(-1, 2)])
        radii = np.concatenate([self._radii, self._mover_radii])
        forces += repulsion(points, self._radii, directions, others, other_velocities, radii).sum(axis=1)
        if robot is not None and self._sees.any():
            there, speed = np.array([[robot.x, robot.y]]), np.array([[robot.vx, robot.vy]])
            push = repulsion(points, self._radii, directions, there, speed, np.array([robot.radius]))
            forces += push[:, 0] * self._sees[:, None]
        wanted = velocities + forces * PERIOD_S
        fast = np.hypot(wanted[:, 0], wanted[:, 1])
        wanted *= np.minimum(1.0, self._top / np.maximum(fast, 1e-9))[:, None]
        wanted, turned = self._steer(wanted, points, yaws, robot)
        if robot is not None:
            wanted = give_way(points, wanted, self._radii, self._sees, robot, PERIOD_S)
        reached = self._off_solids(points, points + wanted * PERIOD_S)
        reached = keep_apart(points, reached, others, radii)
        allowed = np.concatenate(
            [floor.is_free(reached[part]) for floor, part in zip(self._floors, self._slices, strict=True)]
        )
        if robot is not None:
            allowed &= ~(self._sees & enters_path(points, reached, self._radii, robot))
        reached = np.where(allowed[:, None], reached, points)
        state = np.empty_like(self._from)
        state[:, :2], state[:, 2] = reached, turned
        state[:, 3:5] = (reached - points) / PERIOD_S
        state[:, 5] = (turned - yaws) / PERIOD_S
        return state

    def _choose_goals(self, points: FloatArray, robot: RobotMotion | None) -> None:
        moved = np.hypot(*(points - self._was_at).T) >= _SOMEWHERE_M
        self._was_at[moved] = points[moved]
        self._waits = np.where(moved, np.minimum(self._waits, 0.0), self._waits + PERIOD_S)
        there = np.hypot(*(self._goals - points).T) < np.maximum(_THERE_M, self._radii)
        for index, part in enumerate(self._slices):
            for number in np.flatnonzero(there[part] | (self._waits[part] > _STUCK_S)) + part.start:
                if there[number]:
                    self._draw_goal(index, int(number))
                else:
                    self._back_out(index, int(number), robot if self._sees[number] else None)
                # Two who block each other do not both try again at the same time, and those who steer turn first.
                turning = math.pi / _STEER if self._steers[number] else 0.0
                self._waits[number] = -float(self._rngs[index].uniform(0.0, _STUCK_S)) - turning

    def _wishes(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the directions in which the members want to go, and the forces [m/s²] that solids exert on them."""
        directions, forces = np.zeros_like(points), np.zeros_like(points)
        for floor, field, part in zip(self._floors, self._fields, self._slices, strict=True):
            directions[part] = floor.ahead(points[part], field) - points[part]
            distances, away = floor.push(points[part])
            forces[part] = border_force(distances, away, self._radii[part])
        length = np.hypot(directions[:, 0], directions[:, 1])
        return directions / np.maximum(length, 1e-9)[:, None], forces

    def _steer(
        self, wanted: FloatArray, points: FloatArray, yaws: FloatArray, robot: RobotMotion | None
    ) -> tuple[FloatArray, FloatArray]:
        """Return velocities of those who drive where they face, and the new yaws of all (not wrapped).

        Those who see the robot do not turn their body into it.
        """
        speed = np.hypot(wanted[:, 0], wanted[:, 1])
        off = wrap_angles(np.arctan2(wanted[:, 1], wanted[:, 0]) - yaws)
        off[speed < 0.02] = 0.0
        most = np.where(self._steers, _STEER, _TURN) * PERIOD_S
        turned = yaws + np.clip(off, -most, most)
        if robot is not None:
            near = np.hypot(points[:, 0] - robot.x, points[:, 1] - robot.y) < self._radii + robot.radius + _SWING_M
            beside = np.flatnonzero(self._sees & self._steers & near & (turned != yaws))
            outlines = [self._outlines[index] for index in beside.tolist()]
            stays = beside[swings_into(points[beside], yaws[beside], turned[beside], outlines, robot)]
            turned[stays] = yaws[stays]
        ahead = speed * np.maximum(0.0, np.cos(off))
        steered = ahead[:, None] * np.column_stack([np.cos(turned), np.sin(turned)])
        return np.where(self._steers[:, None], steered, wanted), turned

    def _off_solids(self, points: FloatArray, reached: FloatArray) -> FloatArray:
        """Return where the members get without entering a solid: along one axis where not along both, or nowhere."""
        for floor, part in zip(self._floors, self._slices, strict=True):
            for number in np.flatnonzero(~floor.is_free(reached[part])) + part.start:
                (x, y), (to_x, to_y) = points[number], reached[number]
                options = np.array([[to_x, y], [x, to_y]])
                open_ones = floor.is_free(options)
                reached[number] = options[int(np.argmax(open_ones))] if open_ones.any() else points[number]
        return reached


def _make_floor(crowd: Crowd, solids: Sequence[Solid]) -> WalkableFloor:
    if crowd.area is not None:
        bounds = crowd.area
    elif solids:
        lows, highs = solids_bounds(solids)
        (x0, y0), (x1, y1) = lows.min(axis=0)[:2].tolist(), highs.max(axis=0)[:2].tolist()
        bounds = (x0, y0, x1, y1)
    else:
        raise WorldError(f"the crowd {crowd.name!r}: the world has no solids that bound it; give its area")
    radius = radius_of(crowd.body)
    floor = WalkableFloor(solids, bounds, radius, top_of(crowd.body))
    if len(floor.free) == 0:
        raise WorldError(
            f"the crowd {crowd.name!r}: the world has no room for one; a member has a radius of {radius:.2f} m"
        )
    return floor
