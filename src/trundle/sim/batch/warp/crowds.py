"""`WarpCrowds`: the live crowds of a batch on a device, and what is launched to start and step them."""

# pyright: reportAttributeAccessIssue=false, reportCallIssue=false, reportArgumentType=false

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import warp as wp

from trundle.errors import InputError, WorldError
from trundle.geometry import FloatArray
from trundle.sim.batch.arrays import BatchModel
from trundle.sim.batch.cpu import reach_of
from trundle.sim.batch.recording import LiveCrowds
from trundle.sim.batch.warp import crowd_draws, crowd_goals, crowd_paths, crowd_starts, crowd_steps
from trundle.sim.batch.warp import crowd_model as shared
from trundle.worlds.movers.walk import PERIOD_S, WALL

_MOST_CELLS = 2**31 - 1
_WINDOW, _LEAST_WINDOW = 256, 32
"""Largest and smallest edge of the square in which a member's path is kept [cells]: who leaves it searches again."""

_FOR_PATHS, _FOR_SEARCH = 4, 8
"""Shares of the free memory: of paths, where smaller squares keep to it, and of the blocks that search."""

_MEMORY_OF_CPU = 2**33
"""What Warp's CPU device counts as free [bytes]; it is for tests."""

_OF_MEMBER = 350
"""What the state of a member takes [bytes], without its path and the discs that this leads around."""

_MOST_BLOCKS = 1024
"""Blocks that search side by side: an H200 runs eight on each of its 132 multiprocessors."""


class WarpCrowds:
    """Live crowds around the robots of a batch, with the bits of `BatchCrowds`.

    Args:
        live: The crowds, by the number of their recording.
        batch: What the robots share.
        count: Number of robots.
        chunk: Most substeps that robots drive before their crowds follow.
        device: The device.
        launch: Launches a kernel with a shape and its arguments.

    Attributes:
        now: (x, y, yaw) of the members, rows, around each robot, after each substep of a chunk; see `place`.

    Raises:
        InputError: If the floors of the crowds have more cells than the device can number, or its memory is too small.
    """

    def __init__(
        self,
        live: Mapping[int, LiveCrowds],
        batch: BatchModel,
        count: int,
        chunk: int,
        device: Any,
        launch: Callable[..., None],
    ) -> None:
        self._walks = {number: crowds.walk for number, crowds in live.items()}
        self._radius, self._timestep = reach_of(batch), float(batch.limits[8])
        self._count, self._device, self._launch = count, device, launch
        walks = list(self._walks.values())
        self._members = max(len(walk.names) for walk in walks)
        floors = [floor for walk in walks for floor in walk.arrays.floors]
        cells = sum(floor.costs.size for floor in floors)
        if cells > _MOST_CELLS:
            raise InputError(
                f"the floors of live crowds have {cells:,} cells in all, more than the {_MOST_CELLS:,} of a device; "
                "use fewer crowds, or smaller areas"
            )
        self._model = self._put_model(live, len(batch.recordings) - 1)
        self._free_memory = free_memory(device)  # beside the floors
        self._model.window = self._window_of(max(max(floor.costs.shape) for floor in floors))
        self._check_memory(chunk)
        self._state = self._make_state(max(len(walk.arrays.floors) for walk in walks))
        self._starts = self._make_starts(max(len(walk.arrays.floors) for walk in walks))
        self._search = self._make_search(max(floor.costs.size for floor in floors))
        self.now = self._zeros((self._members, count, chunk), wp.vec3d)

    def draw(self, active: Any, poses: Any, places: Any, seeds: Any, fault: Any) -> None:
        """Draw where the crowds of some robots start, and blame robots that leave no room."""
        given = [active, poses, places, seeds, self._radius, fault]
        self._launch(crowd_starts.draw_starts, self._count, [self._model, self._starts, *given])

    def begin(self, active: Any, poses: Any, places: Any, fault: Any) -> None:
        """Let the crowds that were drawn begin."""
        given = [active, poses, places, self._radius, fault]
        self._launch(crowd_starts.begin_crowds, self._count, [self._model, self._starts, self._state, *given])
        self._step(places)

    def follow(
        self, model: Any, active: Any, fault: Any, places: Any, steps: Any, passed: Any, speeds: Any, substeps: int
    ) -> None:
        """Step the crowds while robots have driven some substeps, and write where members are after each of these."""
        self.place(model, active, places, steps, max(substeps, 1))
        # One more than the periods that fit in, wherever the first begins.
        for _ in range(math.floor(substeps * self._timestep / PERIOD_S + 1e-6) + 1 if substeps else 0):
            given = [active, fault, places, steps, passed, speeds, substeps]
            self._launch(crowd_goals.begin_step, self._count, [model, self._model, self._state, *given])
            self._step(places)
            self.place(model, active, places, steps, substeps)

    def place(self, model: Any, active: Any, places: Any, steps: Any, substeps: int) -> None:
        """Write where members are after each of the last substeps; of one, where they are now."""
        given = [active, places, steps, substeps, self.now]
        shape = (self._members, self._count)
        self._launch(crowd_steps.place_members, shape, [model, self._model, self._state, *given])

    def members(self, robot: int, recording: int, time: float) -> FloatArray:
        """Return (x, y, yaw) of the members around a robot at its time [s], shape (N, 3), a copy on the host."""
        count = len(self._walks[recording].names) if recording in self._walks else 0
        out = self._zeros(max(count, 1), wp.vec3d)
        self._launch(crowd_steps.find_members, count, [self._state, robot, time, out])
        return out.numpy()[:count].reshape(-1, 3)

    def has_no_room(self, robot: int, recording: int) -> WorldError:
        """Return the error of a robot that leaves no room for a crowd."""
        missing = int(self._starts.missing.numpy()[robot])
        return WorldError(f"robot {robot}: {self._walks[recording].has_no_room(missing)}. Nothing was reset")

    def _step(self, places: Any) -> None:
        model, state = self._model, self._state
        self._launch(crowd_goals.choose_goals, self._count, [model, state, places])
        blocks, lanes = len(self._search.costs), self._lanes
        self._launch(crowd_paths.find_paths, (blocks, lanes), [model, state, self._search, places, blocks, lanes])
        shape = (self._members, self._count)
        self._launch(crowd_steps.push_members, shape, [model, state, places])
        reached, slid = state.reached, state.slid
        for turn in range(3):
            self._launch(crowd_steps.keep_apart, shape, [model, state, places, turn, reached, slid])
            reached, slid = slid, reached
        self._launch(crowd_steps.settle_members, shape, [model, state, places])

    def _put_model(self, live: Mapping[int, LiveCrowds], recordings: int) -> Any:
        model = shared.Crowds()
        arrays = [crowds.walk.arrays for crowds in live.values()]
        floors = [floor for each in arrays for floor in each.floors]
        counts = [each.counts for each in arrays]
        scenes = np.zeros((recordings, 8), dtype=np.int32)
        first_crowd = first_member = first_other = first_row = 0
        for number, each in live.items():
            steps, others = each.movers.shape[:2]
            members = len(each.walk.names)
            own = len(each.walk.arrays.floors)
            scenes[number] = first_crowd, own, first_member, members, first_other, others, first_row, steps
            first_crowd, first_member, first_other = first_crowd + own, first_member + members, first_other + others
            first_row += steps * others
        model.scenes = self._array(scenes, wp.int32)
        model.ends = self._array(np.concatenate([np.cumsum(each) for each in counts]), wp.int32)
        named = [each for crowds in live.values() for each in crowds.walk.seeds]
        model.keys = self._array(np.array([key for key, _ in named], dtype=np.uint32), wp.uint32)
        model.has_seed = self._array(np.array([seed is not None for _, seed in named]), wp.bool)
        model.words = self._array(np.concatenate([crowds.walk.words(0) for crowds in live.values()]), wp.uint64)
        free = [np.flatnonzero(floor.costs != WALL) for floor in floors]
        sizes, free_sizes = [floor.costs.size for floor in floors], [len(each) for each in free]
        model.floors = self._array(
            np.array(
                [
                    (end - size, *floor.costs.shape, floor.look, free_end - free_size, free_size)
                    for floor, size, end, free_size, free_end in zip(
                        floors, sizes, np.cumsum(sizes), free_sizes, np.cumsum(free_sizes), strict=True
                    )
                ]
            ),
            wp.int32,
        )
        frames = [(floor.corner_x, floor.corner_y, floor.resolution, floor.reach) for floor in floors]
        model.frames = self._array(np.array(frames), wp.vec4d)
        model.costs = self._array(np.concatenate([floor.costs.ravel() for floor in floors]), wp.uint8)
        model.nearness = self._array(np.concatenate([floor.nearness.ravel() for floor in floors]), wp.uint8)
        model.free = self._array(np.concatenate(free), wp.int32)
        model.crowd_of = self._array(np.repeat(np.arange(len(floors)), np.concatenate(counts)), wp.int32)
        members = np.concatenate([each.members for each in arrays])
        model.radii, model.tops = self._array(members[:, 0], wp.float64), self._array(members[:, 1], wp.float64)
        model.sees, model.steers = (self._array(members[:, column] != 0.0, wp.bool) for column in (2, 3))
        corner_counts = np.concatenate([each.corner_counts for each in arrays])
        ends = np.cumsum(corner_counts)
        model.outlines = self._array(np.column_stack([ends - corner_counts, ends]), wp.vec2i)
        model.corners = self._array(np.concatenate([each.corners for each in arrays]), wp.vec2d)
        model.other_radii = self._array(np.concatenate([each.mover_radii for each in arrays]), wp.float64)
        model.others = self._array(np.concatenate([each.movers.reshape(-1, 4) for each in live.values()]), wp.vec4d)
        return model

    def _check_memory(self, chunk: int) -> None:
        pairs = self._members * (self._members + 1)
        needed = self._count * (24 * pairs + self._members * (self._model.window**2 // 2 + 24 * chunk + _OF_MEMBER))
        if needed > self._free_memory - self._free_memory // _FOR_SEARCH:
            raise InputError(
                f"{self._count:,} robots among live crowds of {self._members} members need {needed / 1e9:.2g} GB of "
                f"the device, which has {self._free_memory / 1e9:.2g} GB free; use fewer robots, or smaller crowds"
            )

    def _window_of(self, longest: int) -> int:
        """The edge of the squares for paths: the largest that memory allows."""
        window = _WINDOW
        while (
            window > _LEAST_WINDOW
            and self._members * self._count * window * window // 2 > self._free_memory // _FOR_PATHS
        ):
            window //= 2
        return min(window, longest - 2)

    def _make_state(self, crowds: int) -> Any:
        state, shape, count = shared.CrowdState(), (self._members, self._count), self._count
        state.index, state.due = self._zeros(count, wp.int32), self._zeros(count, wp.int32)
        state.robots, state.radius = self._zeros(count, wp.vec4d), self._zeros(count)
        state.draws = self._zeros((crowds, count, crowd_draws.DRAWS), wp.uint64)
        for name in ("at", "velocity", "next_at", "next_velocity"):
            setattr(state, name, self._zeros(shape, wp.vec3d))
        for name in ("was_at", "reached", "slid"):
            setattr(state, name, self._zeros(shape, wp.vec2d))
        for name in ("waits", "preferred", "turned"):
            setattr(state, name, self._zeros(shape))
        state.goals, state.disc_counts = self._zeros(shape, wp.int32), self._zeros(shape, wp.int32)
        state.windows = self._zeros(shape, wp.vec4i)
        state.paths = self._zeros((count, self._members, (self._model.window**2 + 1) // 2), wp.uint8)
        state.discs = self._zeros((*shape, self._members + 1), wp.vec3d)
        state.retreats = self._zeros((*shape, int(shared.RETREATS)), wp.int32)
        state.queue, state.queued = self._zeros(self._members * count, wp.vec2i), self._zeros(1, wp.int32)
        return state

    def _make_starts(self, crowds: int) -> Any:
        starts, shape = crowd_starts.Starts(), (self._members, self._count)
        starts.draws = self._zeros((crowds, self._count, crowd_draws.DRAWS), wp.uint64)
        starts.at, starts.goals = self._zeros(shape, wp.vec3d), self._zeros(shape, wp.int32)
        starts.preferred, starts.missing = self._zeros(shape), self._zeros(self._count, wp.int32)
        return starts

    def _make_search(self, cells: int) -> Any:
        search = crowd_paths.Search()
        # On Warp's CPU device threads run one after the other: a block is one.
        self._lanes = crowd_paths.BLOCK if self._device.is_cuda else 1
        wanted = min(_MOST_BLOCKS, self._members * self._count) if self._device.is_cuda else 1
        blocks = max(1, min(wanted, self._free_memory // _FOR_SEARCH // (20 * cells)))
        search.costs, search.stamps = self._zeros((blocks, cells), wp.int64), self._zeros((blocks, cells), wp.int32)
        search.fronts, search.sizes = self._zeros((blocks, 2, cells), wp.int32), self._zeros((blocks, 3), wp.int32)
        search.discs = self._zeros((blocks, self._members + 1), wp.vec3d)
        return search

    def _zeros(self, shape: Any, dtype: Any = wp.float64) -> Any:
        return wp.zeros(shape, dtype=dtype, device=self._device)

    def _array(self, values: Any, dtype: Any) -> Any:
        return wp.array(values, dtype=dtype, device=self._device)


def free_memory(device: Any) -> int:
    """Return the free memory of a device [bytes]."""
    return device.free_memory if device.is_cuda else _MEMORY_OF_CPU
