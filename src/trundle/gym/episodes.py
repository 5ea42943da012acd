"""`Episodes`: the episodes of N robots: their starts and ends, rewards and figures; without Gymnasium."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry import FloatArray
from trundle.gym.arena import Arena
from trundle.gym.draws import episode_keys, uniform
from trundle.gym.settings import SPLITS, NavigationSettings
from trundle.gym.variation import Variation
from trundle.sim.batch import NOTHING, BatchSimulator

Bools = npt.NDArray[np.bool_]

_TRIES = 16
"""Other starts that are drawn where a mover stands on the first."""

_ROUNDING = 1e-5
"""Actions beyond their bounds by less than this are rounding of float32."""


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What a step has brought, in arrays of shape (N,).

    Attributes:
        rewards: The rewards.
        terminated: Whether the episode has ended: arrival, contact, or beyond the map.
        truncated: Whether its time is over.
        info: Figures by name.
    """

    rewards: FloatArray
    terminated: Bools
    truncated: Bools
    info: dict[str, Any] = field(default_factory=dict)


class Episodes:
    """The episodes of N robots. Each robot's depend on its own seed, and on nothing of the others.

    Args:
        settings: The settings.
        arena: Where they drive.
        count: Number of robots.

    Attributes:
        command_scale, command_offset: Command (v, w) of a scaled action of 1, less that of 0, and of 0, shape (2,).
    """

    def __init__(self, settings: NavigationSettings, arena: Arena, count: int) -> None:
        self.settings, self.arena, self.count = settings, arena, count
        self.sim = BatchSimulator(
            arena.grids,
            arena.robot,
            count=count,
            lidar=True,
            recordings=arena.recordings,
            timestep=settings.timestep,
            threads=settings.threads,
            device=settings.device,
        )
        limits = arena.robot.limits
        reverse = limits.linear_speed if limits.reverse_speed is None else limits.reverse_speed
        self.speeds = np.array([limits.linear_speed, limits.angular_speed])
        low = np.array([-reverse, -limits.angular_speed])
        # A robot that cannot drive backwards has the whole of an action for driving forwards.
        self.command_offset, self.command_scale = (self.speeds + low) / 2.0, (self.speeds - low) / 2.0
        if settings.scaled_actions and reverse > 0.0:
            self.command_offset, self.command_scale = np.zeros(2), self.speeds.copy()
        self.action_low = -np.ones(2) if settings.scaled_actions else low
        self.action_high = np.ones(2) if settings.scaled_actions else self.speeds.copy()
        self._seeds = np.zeros(count, dtype=np.uint64)
        self._episodes = np.full(count, -1, dtype=np.int64)
        self._split = SPLITS.index(settings.split)
        vary = settings.vary
        self._variation = vary if isinstance(vary, Variation) else Variation.of(vary)
        self.missions = np.zeros(count, dtype=np.int64)
        self.fields = np.zeros(count, dtype=np.int64)
        self.goals = np.zeros((count, 2))
        self.shortest = np.ones(count)
        self.distances = np.zeros(count)
        self.elapsed = np.zeros(count, dtype=np.int64)
        self._factors = np.ones((count, 2))
        self._last_actions = np.zeros((count, 2))
        self._everyone = np.ones(count, dtype=bool)

    def seed(self, seeds: npt.ArrayLike, robots: npt.NDArray[np.int64]) -> None:
        """Give robots new seeds; their next episode is their first."""
        self._seeds[robots] = np.asarray(seeds, dtype=np.uint64)
        self._episodes[robots] = -1

    def reset(self, robots: npt.NDArray[np.int64]) -> None:
        """Begin the next episode of some robots: another mission, other movers, other values of what is varied."""
        if len(robots) == 0:
            return
        arena = self.arena
        self._episodes[robots] += 1
        keys = episode_keys(self._seeds[robots], self._episodes[robots], self._split)
        maps = np.minimum((uniform(keys, 0) * len(arena.grids)).astype(np.int64), len(arena.grids) - 1)
        counts = arena.recording_counts[maps]
        recordings = np.where(
            counts > 0, arena.first_recording[maps] + (uniform(keys, 1) * counts).astype(np.int64), -1
        )
        drawn = self._variation.draw_many(self._seeds[robots], self._episodes[robots])
        self._factors[robots] = np.column_stack([drawn["wheel_radius"], drawn["wheel_radius"] / drawn["track"]])
        self._start(robots, keys, maps, recordings, drawn, 0)
        touched = self.sim.contacts[robots, 0] != NOTHING
        for attempt in range(1, _TRIES):
            if not touched.any():
                break
            again = np.flatnonzero(touched)
            here = {name: values[again] for name, values in drawn.items()}
            self._start(robots[again], keys[again], maps[again], recordings[again], here, attempt)
            touched = self.sim.contacts[robots, 0] != NOTHING
        self.elapsed[robots] = 0
        self._last_actions[robots] = 0.0
        self.distances[robots] = self.shortest[robots]

    def _start(
        self,
        robots: npt.NDArray[np.int64],
        keys: npt.NDArray[np.uint64],
        maps: npt.NDArray[np.int64],
        recordings: npt.NDArray[np.int64],
        drawn: dict[str, FloatArray],
        attempt: int,
    ) -> None:
        arena = self.arena
        counts = arena.mission_counts[maps]
        picked = arena.first_mission[maps] + (uniform(keys, 10 + attempt) * counts).astype(np.int64)
        poses = arena.starts[picked].copy()
        turned = np.isnan(poses[:, 2])
        poses[turned, 2] = (uniform(keys, 50 + attempt)[turned] * 2.0 - 1.0) * math.pi
        self.missions[robots], self.fields[robots] = picked, arena.mission_fields[picked]
        self.goals[robots], self.shortest[robots] = arena.goals[picked], arena.distances[picked]
        self.sim.reset(
            poses,
            robots=robots,
            maps=maps,
            recordings=recordings,
            seeds=keys,
            noise=drawn["lidar_noise"],
            dropouts=drawn["lidar_dropout"],
        )

    def check_actions(self, actions: npt.ArrayLike, active: Bools) -> FloatArray:
        """Return actions as float64, shape (N, 2).

        Raises:
            InputError: If they have another shape, or one is not finite or out of bounds; nothing has moved then.
        """
        try:
            given = np.array(actions, dtype=np.float64)
        except (TypeError, ValueError):
            raise InputError(f"actions must be numbers of shape ({self.count}, 2)") from None
        if given.shape != (self.count, 2):
            raise InputError(f"actions need shape ({self.count}, 2), got {given.shape}")
        allowed = (given >= self.action_low - _ROUNDING) & (given <= self.action_high + _ROUNDING)
        if not allowed.all():
            bad = ~allowed.all(axis=1) & active
            if bad.any():
                first = int(np.argmax(bad))
                raise InputError(
                    f"the action of robot {first} is ({given[first, 0]:g}, {given[first, 1]:g}); it must be finite and "
                    f"from {self.action_low.tolist()} to {self.action_high.tolist()}: clip it. No robot has moved"
                )
            given = np.where(allowed, given, 0.0)
        return given

    def step(self, actions: npt.ArrayLike, active: Bools | None = None) -> Outcome:
        """Drive a period with an action for each robot; robots that are not active stay as they are.

        Raises:
            InputError: As `check_actions`.
        """
        settings, sim = self.settings, self.sim
        active = self._everyone if active is None else active
        given = self.check_actions(actions, active)
        commands = given * self.command_scale + self.command_offset if settings.scaled_actions else given
        before = sim.lengths.copy()
        sim.step(commands * self._factors, settings.period_s, robots=None if active is self._everyone else active)
        self.elapsed += active
        maps = sim.places[:, 0]
        row, col = self.arena.cells_of(sim.poses[:, :2], maps)
        away = self.arena.field_at(row, col, maps, self.fields)
        away = np.where(np.isfinite(away), away, self.distances)  # too close to a wall for the field
        dx, dy = self.goals[:, 0] - sim.poses[:, 0], self.goals[:, 1] - sim.poses[:, 1]
        straight = np.hypot(dx, dy)
        off_map = ~self.arena.is_inside(row, col, maps)
        contact = (sim.contacts[:, 0] != NOTHING) & active
        arrived = (straight <= settings.goal_tolerance) & ~contact & active
        terminated = arrived | contact | (off_map & active)
        truncated = (self.elapsed >= settings.max_steps) & ~terminated & active
        terms = self._terms(given, before, away, arrived, contact | off_map, active)
        rewards = np.zeros(self.count)
        info: dict[str, Any] = {}
        for name, weight in settings.rewards.items():
            term = info[f"reward/{name}"] = terms[name] * weight
            rewards += term
        if active is self._everyone:
            self.distances, self._last_actions = away, given
        else:
            self.distances = np.where(active, away, self.distances)
            self._last_actions = np.where(active[:, None], given, self._last_actions)
        return Outcome(rewards, terminated, truncated, info | self.figures(arrived, contact, off_map & active))

    def figures(self, arrived: Bools, contact: Bools, off_map: Bools) -> dict[str, Any]:
        """Return the figures of the episodes up to now, by name."""
        lengths = self.sim.lengths
        return {
            "is_success": arrived,
            "contact": contact,
            "off_map": off_map,
            "spl": np.where(arrived, self.shortest / np.maximum(self.shortest, lengths), 0.0),
            "path_length": lengths.copy(),
            "shortest_length": self.shortest.copy(),
            "distance_to_goal": self.distances.copy(),
            "time_s": self.elapsed * self.settings.period_s,
            "map": self.sim.places[:, 0].copy(),
        }

    def start_figures(self) -> dict[str, Any]:
        """Return the figures of episodes that have just begun."""
        none = np.zeros(self.count, dtype=bool)
        return self.figures(none, none.copy(), none.copy())

    def _terms(
        self, actions: FloatArray, before: FloatArray, away: FloatArray, arrived: Bools, contact: Bools, active: Bools
    ) -> dict[str, FloatArray]:
        """What each reward term measures, shape (N,); 0 where a robot is not active."""
        terms = {"progress": self.distances - away, "success": arrived, "contact": contact, "time": self._everyone}
        if "smoothness" in self.settings.rewards:
            change = (actions - self._last_actions) / (self.action_high - self.action_low) * 2.0
            terms["smoothness"] = np.einsum("ij,ij->i", change, change)
        if "reverse" in self.settings.rewards:
            terms["reverse"] = np.where(self.sim.twists[:, 0] < 0.0, self.sim.lengths - before, 0.0)
        return {name: terms[name] * active for name in self.settings.rewards}
