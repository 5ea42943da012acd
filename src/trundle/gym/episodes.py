"""`Episodes`: the episodes of N robots: their starts and ends, rewards and figures; without Gymnasium."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, WorldError
from trundle.gym.arena import Arena
from trundle.gym.arrays import HOST, episode_keys, seed_keys, stream_numbers, uniform
from trundle.gym.lookup import Lookup
from trundle.gym.navigation_settings import SPLITS, NavigationSettings, Variation
from trundle.sim.batch import NOTHING, BatchSimulator
from trundle.sim.batch.simulator import choose_threads

_TRIES = 16
"""Starts that are drawn, until no mover stands on one and it leaves room for a crowd."""

LARGEST_SEED = 2**64 - 1
"""Random numbers are drawn of 64 bits."""

_ROUNDING = 1e-5
"""Actions beyond their bounds by less than this are rounding of float32."""


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What a step has brought, in the device's arrays of shape (N,).

    Attributes:
        rewards: The rewards.
        terminated: Whether the episode has ended: arrival, contact, or beyond the map.
        truncated: Whether its time is over.
        info: Figures by name.
    """

    rewards: Any
    terminated: Any
    truncated: Any
    info: dict[str, Any] = field(default_factory=dict)


class Episodes:
    """The episodes of N robots. Each robot's depend on its own seed, and on nothing of the others.

    Args:
        settings: The settings.
        arena: Where they drive.
        count: Number of robots.

    Attributes:
        arrays: The arrays of `settings.device`: all that changes is kept and computed in them.
        command_scale, command_offset: Command (v, w) of a scaled action of 1, less that of 0, and of 0, shape (2,).
        is_placed: Whether the last reset of each robot found a start with room for it, shape (N,).
    """

    def __init__(self, settings: NavigationSettings, arena: Arena, count: int) -> None:
        self.settings, self.arena, self.count = settings, arena, count
        sim = BatchSimulator(
            arena.grids,
            arena.robot,
            count=count,
            lidar=True,
            recordings=arena.recordings,
            timestep=settings.timestep,
            threads=settings.threads,
            device=settings.device,
        )
        self.sim: Any = sim
        self.arrays = HOST
        if settings.device != "cpu":
            from trundle.gym.gpu import TorchArrays, TorchSimulator

            self.sim = TorchSimulator(sim)
            self.arrays = TorchArrays(self.sim.poses.device)
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
        put, full = self.arrays.put, self.arrays.full
        self._low, self._high = put(self.action_low - _ROUNDING), put(self.action_high + _ROUNDING)
        self._scale, self._offset = put(self.command_scale), put(self.command_offset)
        self._half_span = put((self.action_high - self.action_low) / 2.0)
        self._most_steps = settings.max_steps
        self._split = SPLITS.index(settings.split)
        vary = settings.vary
        self._variation = vary if isinstance(vary, Variation) else Variation.of(vary)
        self._varies = bool(self._variation)
        self.lookup = Lookup(arena, self.arrays, count, choose_threads(settings.threads))
        self._starts, self._goals, self._shortest, self._fields = (
            put(each) for each in (arena.starts, arena.goals, arena.distances, arena.mission_fields)
        )
        self._mission_counts, self._first_mission = put(arena.mission_counts), put(arena.first_mission)
        self._recording_counts, self._first_recording = put(arena.recording_counts), put(arena.first_recording)
        self._seeds, self._episodes = full(count, 0, "int64"), full(count, -1, "int64")
        self._seed_keys = seed_keys(self._seeds)
        self.goals, self.shortest, self.distances = full((count, 2), 0.0), full(count, 1.0), full(count, 0.0)
        self.elapsed = full(count, 0, "int64")
        self._factors, self._last_actions = full((count, 2), 1.0), full((count, 2), 0.0)
        self._everyone, self._nobody = full(count, 1, "bool"), full(count, 0, "bool")
        self.is_placed = full(count, 0, "bool")
        self._standing = full(count, 0.0)
        # Of an episode's map and recording, and of each try's mission and yaw.
        self._streams = put(stream_numbers(0, 1))
        self._tries = [put(stream_numbers(10 + attempt, 50 + attempt)) for attempt in range(_TRIES)]

    def seed(self, seeds: npt.ArrayLike, robots: Any) -> None:
        """Give robots new seeds, from 0 to `LARGEST_SEED`; their next episode is their first."""
        given = self.arrays.put(np.asarray(seeds, dtype=np.uint64).view(np.int64))
        self._seeds[robots], self._seed_keys[robots] = given, seed_keys(given)
        self._episodes[robots] = -1

    def reset(self, robots: Any) -> None:
        """Begin the next episode of some robots: another mission, other movers, other values of what is varied.

        Args:
            robots: Their indices, an array of the device.

        Raises:
            WorldError: If no start leaves room for the crowd of a robot: that one's episode stays as it is, and the
                others' begin; see `is_placed`.
            InputError: If a GPU has found a bad action of an earlier step; nothing is reset then.
        """
        if len(robots) == 0:
            return
        arrays, number = self.arrays, len(self.arena.grids)
        episodes = self._episodes[robots] + 1
        keys = episode_keys(self._seed_keys[robots], episodes, self._split)
        of_map, of_recording = uniform(arrays, keys, self._streams)
        maps = arrays.clip(arrays.cast(of_map * number, "int64"), 0, number - 1)
        recordings: Any = -1
        if self.arena.recordings:
            counts = self._recording_counts[maps]
            picked = self._first_recording[maps] + arrays.cast(of_recording * counts, "int64")
            recordings = arrays.lib.where(counts > 0, picked, -1)
        factors, drawn = self._vary(robots, episodes)
        self.is_placed[robots] = False
        error = self._start(robots, keys, maps, recordings, drawn, 0)
        # Walls leave room around every start; only movers may stand there, and crowds need more.
        for attempt in range(1, _TRIES if self.arena.recordings else 1):
            again = arrays.indices((self.sim.contacts[robots, 0] != NOTHING) | ~self.is_placed[robots])
            if len(again) == 0:
                break
            here = {name: values[again] for name, values in drawn.items()}
            error = self._start(robots[again], keys[again], maps[again], recordings[again], here, attempt)
        placed: Any = slice(None) if error is None else self.is_placed[robots]
        begun = robots[placed]
        self._episodes[begun] = episodes[placed]
        if self._varies:
            self._factors[begun] = factors[placed]
        self.elapsed[begun] = 0
        self._last_actions[begun] = 0.0
        self.distances[begun] = self.shortest[begun]
        if error is not None and len(begun) < len(robots):
            what = str(error).removesuffix(". Nothing was reset")
            raise WorldError(
                f"{what}. None of {_TRIES} starts has room; the robot was not reset: reset it with another seed"
            )

    def _vary(self, robots: Any, episodes: Any) -> tuple[Any, dict[str, Any]]:
        """Draw what is varied for new episodes; return factors of commands, and what the lidars need of it."""
        if not self._varies:
            return None, {}
        host, put = self.arrays.host, self.arrays.put
        drawn = self._variation.draw_many(host(self._seeds[robots]).view(np.uint64), host(episodes))
        factors = np.column_stack([drawn["wheel_radius"], drawn["wheel_radius"] / drawn["track"]])
        return put(factors), {"noise": put(drawn["lidar_noise"]), "dropouts": put(drawn["lidar_dropout"])}

    def _start(
        self, robots: Any, keys: Any, maps: Any, recordings: Any, drawn: dict[str, Any], attempt: int
    ) -> WorldError | None:
        """Put robots at starts that are drawn; return why some have no room for their crowd, and are not placed."""
        arrays = self.arrays
        of_mission, of_yaw = uniform(arrays, keys, self._tries[attempt])
        counts = self._mission_counts[maps]
        picked = self._first_mission[maps] + arrays.cast(of_mission * counts, "int64")
        poses = self._starts[picked]
        yaws = (of_yaw * 2.0 - 1.0) * math.pi
        poses[:, 2] = arrays.lib.where(arrays.lib.isnan(poses[:, 2]), yaws, poses[:, 2])
        seeds = keys.view(np.uint64) if arrays.on_host else keys
        try:
            self.sim.reset(poses, robots=robots, maps=maps, recordings=recordings, seeds=seeds, **drawn)
        except WorldError as error:
            if len(robots) == 1:
                return error
            found: WorldError | None = None
            for part in np.array_split(np.arange(len(robots)), 2):  # halves, until those without room are alone
                here = {name: values[part] for name, values in drawn.items()}
                failed = self._start(robots[part], keys[part], maps[part], recordings[part], here, attempt)
                found = found or failed
            return found
        except InputError as error:
            raise self._explain(error) from None
        self.lookup.settle(robots, maps, self._fields[picked])
        self.goals[robots], self.shortest[robots] = self._goals[picked], self._shortest[picked]
        self.is_placed[robots] = True
        return None

    def check_actions(self, actions: Any, active: Any = None) -> Any:
        """Return actions as float64, shape (N, 2); those of robots that are not active do not matter.

        Raises:
            InputError: If they have another shape, or one is not finite or out of bounds; nothing has moved then. On a
                GPU the bad ones become NaN instead, which the simulator finds later: the host does not wait.
        """
        arrays = self.arrays
        try:
            given = arrays.cast(arrays.put(actions), "float64")
        except (TypeError, ValueError):
            raise InputError(f"actions must be numbers of shape ({self.count}, 2)") from None
        if tuple(given.shape) != (self.count, 2):
            raise InputError(f"actions need shape ({self.count}, 2), got {tuple(given.shape)}")
        allowed = (given >= self._low) & (given <= self._high)
        if not arrays.on_host:
            found = arrays.lib.where(allowed, given, math.nan)
            return found if active is None else arrays.lib.where(active[:, None], found, 0.0)
        if allowed.all():
            return given
        bad = ~allowed.all(axis=1)
        bad &= self._everyone if active is None else active
        if bad.any():
            first = int(np.argmax(bad))
            raise InputError(
                f"the action of robot {first} is ({given[first, 0]:g}, {given[first, 1]:g}); {self._demand()}. "
                "No robot has moved"
            )
        return np.where(allowed, given, 0.0)

    def _explain(self, error: InputError) -> InputError:
        """Return the error of a bad command as that of its action."""
        return InputError(f"{error}. It comes of its action: {self._demand()}, and reset all robots")

    def _demand(self) -> str:
        return f"it must be finite and from {self.action_low.tolist()} to {self.action_high.tolist()}: clip it"

    def step(self, given: Any, active: Any = None) -> Outcome:
        """Drive a period with a checked action for each robot; robots that are not active stay as they are.

        Args:
            given: What `check_actions` returns.
            active: A bool for each robot, or None for all.

        Raises:
            InputError: If a GPU has found a bad action, perhaps that of an earlier step.
        """
        settings, sim, arrays = self.settings, self.sim, self.arrays
        lib, goals, poses = arrays.lib, self.goals, sim.poses
        commands = given * self._scale + self._offset if settings.scaled_actions else given
        before = arrays.copy(sim.lengths) if "reverse" in settings.rewards else sim.lengths
        if self._varies:
            commands = commands * self._factors
        try:
            sim.step(commands, settings.period_s, robots=active)
        except InputError as error:
            raise self._explain(error) from None
        self.elapsed += 1 if active is None else active
        cell, inside = self.lookup.locate(poses)
        away = self.lookup.distance(cell, inside, self.distances)  # as before, too close to a wall for the field
        straight = lib.hypot(goals[:, 0] - poses[:, 0], goals[:, 1] - poses[:, 1])
        off_map, contact = ~inside, sim.contacts[:, 0] != NOTHING
        arrived = (straight <= settings.goal_tolerance) & ~contact
        late = self.elapsed >= self._most_steps
        if active is not None:
            off_map, contact, arrived, late = off_map & active, contact & active, arrived & active, late & active
            away = lib.where(active, away, self.distances)
            given = lib.where(active[:, None], given, self._last_actions)
        terminated = arrived | contact | off_map
        truncated = late & ~terminated
        terms = self._terms(given, before, away, arrived, contact | off_map, active)
        # In place: what RSL-RL makes in its inference mode cannot be changed outside of that.
        self.distances[:], self._last_actions[:] = away, given
        rewards, info = arrays.copy(self._standing), dict[str, Any]()
        for name, weight in settings.rewards.items():
            term = info[f"reward/{name}"] = terms[name] * weight
            rewards += term
        return Outcome(rewards, terminated, truncated, info | self.figures(arrived, contact, off_map))

    def figures(self, arrived: Any, contact: Any, off_map: Any) -> dict[str, Any]:
        """Return the figures of the episodes up to now, by name."""
        arrays, lengths = self.arrays, self.sim.lengths
        ratio = self.shortest / arrays.lib.maximum(self.shortest, lengths)
        return {
            "is_success": arrived,
            "contact": contact,
            "off_map": off_map,
            "spl": arrays.lib.where(arrived, ratio, 0.0),
            "path_length": arrays.copy(lengths),
            "shortest_length": arrays.copy(self.shortest),
            "distance_to_goal": arrays.copy(self.distances),
            "time_s": self.sim.times,
            "map": arrays.copy(self.sim.places[:, 0]),
        }

    def start_figures(self) -> dict[str, Any]:
        """Return the figures of episodes that have just begun."""
        return self.figures(*(self.arrays.copy(self._nobody) for _ in range(3)))

    def _terms(self, actions: Any, before: Any, away: Any, arrived: Any, contact: Any, active: Any) -> dict[str, Any]:
        """Return what each reward term measures, float64, shape (N,); 0 where a robot is not active."""
        arrays, wanted = self.arrays, self.settings.rewards
        everyone = self._everyone if active is None else active
        terms = {"progress": self.distances - away}
        for name, flags in (("success", arrived), ("contact", contact), ("time", everyone)):
            if name in wanted:
                terms[name] = arrays.cast(flags, "float64")
        if "smoothness" in wanted:
            change = (actions - self._last_actions) / self._half_span
            terms["smoothness"] = arrays.lib.einsum("ij,ij->i", change, change)
        if "reverse" in wanted:
            backwards = self.sim.twists[:, 0] < 0.0
            terms["reverse"] = arrays.lib.where(backwards & everyone, self.sim.lengths - before, 0.0)
        return terms
