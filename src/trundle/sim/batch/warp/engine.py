"""`WarpEngine`: the state of a batch on a device of Warp's, and what is launched there."""

# pyright: reportAttributeAccessIssue=false, reportCallIssue=false, reportArgumentType=false

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np
import warp as wp

from trundle.errors import InputError
from trundle.geometry import FloatArray
from trundle.sim.batch.arrays import BatchModel, spread
from trundle.sim.batch.cpu import mask_of
from trundle.sim.batch.recording import MoverRecording, find_live
from trundle.sim.batch.warp import beams, contacts, convert, motion
from trundle.sim.batch.warp import model as shared
from trundle.sim.batch.warp.crowds import WarpCrowds

_MOST_CELLS = 2**31 - 1
_CHUNK = 16
"""Substeps whose contacts are looked for side by side."""

_MOST_LOOKS = 2**20
"""Poses that are looked at side by side, unless there are more robots: each needs memory for a footprint."""

_MOST_LANES, _ENOUGH_THREADS = 8, 2**18
"""Threads that share the rows of a footprint, where fewer would leave some of a GPU idle: an H100 runs some 2^17."""

_MOST_LAUNCHES = 64
"""Chunks of a step that are recorded as a graph; longer steps are launched one by one."""

_NUMBERS = (
    *(wp.bool, wp.int8, wp.uint8, wp.int16, wp.uint16, wp.int32, wp.uint32, wp.int64, wp.uint64),
    *(wp.float16, wp.float32, wp.float64),
)

_FAULTS = {
    shared.COMMAND: "the command of robot {robot} is not finite. No robot has moved since",
    shared.POSE: "the pose of robot {robot} is not finite; nothing was reset",
    shared.MAP: (
        "robot {robot} is to be on a map that is not there; there are {maps} maps, from 0 on. Nothing was reset"
    ),
    shared.RECORDING: (
        "robot {robot} is to be on a recording that is not there; there are {recordings} recordings, from 0 on. "
        "Nothing was reset"
    ),
    shared.ERRORS: "the noise of robot {robot} must be from 0 to 10 m, and its dropouts from 0 to 1; nothing was reset",
}


@runtime_checkable
class _Exported(Protocol):
    """An array that passes by DLPack."""

    def __dlpack_device__(self) -> tuple[int, int]: ...


class WarpEngine:
    """Computes a batch on a device of Warp's, with the bits of the kernel on the CPU.

    Its arrays are Warp's: they stay where they are from reset to reset, and pass by DLPack.

    Args:
        model: What the robots share.
        recordings: The movers, some of them with live crowds.
        count: Number of robots.
        device: The device.

    Raises:
        InputError: If the maps, or the floors of live crowds, have more cells than the device can number.
    """

    def __init__(self, model: BatchModel, recordings: Sequence[MoverRecording], count: int, device: Any) -> None:
        if model.fields.size > _MOST_CELLS:
            raise InputError(
                f"the maps have {model.fields.size:,} cells in all, more than the {_MOST_CELLS:,} of a device; use "
                "fewer maps, or coarser ones"
            )
        self._device, self._count = device, count
        self._maps, self._recordings = len(model.shapes), max(len(model.recordings) - 1, 0)
        self._beams, self._lidars = len(model.angles), len(model.lidars)
        counts = np.diff(model.recordings) if self._recordings else np.zeros(1, dtype=np.int64)
        self._most_movers = int(counts.max(initial=0))
        self._model = self._put_model(model)
        live = find_live(recordings)
        firsts = [model.recordings[number + 1] - len(crowds.walk.names) for number, crowds in live.items()]
        members = np.full(max(self._recordings, 1), _MOST_CELLS)
        members[list(live)] = firsts
        self._model.members = self._array(members, wp.int32)
        self.poses = self._zeros((count, 3))
        self.motions = self._zeros((count, 6))
        self.wheels = self._zeros((count, 2))
        self.lengths = self._zeros(count)
        self.steps = self._zeros(count, wp.int64)
        self.contacts = self._zeros((count, 4), wp.int64)
        self.places = self._array(np.full((count, 2), (0, -1)), wp.int64)
        self.ranges = self._array(np.full((count, self._beams), np.inf), wp.float32)
        self._errors = self._zeros((count, 2))
        self._keys = self._zeros(count, wp.uint64)
        self._commands = self._zeros((count, 2))
        self._everyone = self._array(np.ones(count), wp.bool)
        self._some = self._array(np.ones(count), wp.bool)
        self._new_poses, self._new_errors = self._zeros((count, 3)), self._zeros((count, 2))
        self._new_places, self._new_keys = self._zeros((count, 2), wp.int64), self._zeros(count, wp.uint64)
        self._chunk = max(1, min(_CHUNK, _MOST_LOOKS // count))
        self._passed = self._zeros((count, self._chunk), wp.vec3d)
        self._speeds = self._zeros((count, self._chunk))
        self._crowds = WarpCrowds(live, model, count, self._chunk, device, self._launch) if live else None
        self._members = self._crowds.now if self._crowds else self._zeros((1, 1, 1), wp.vec3d)
        self._first = self._zeros(count, wp.int64)
        self._edges = self._zeros((len(model.outline), self._chunk * count), wp.vec3d)
        self._origins = self._zeros((max(self._lidars, 1), count), wp.vec4d)
        self._seen = self._zeros((max(self._most_movers, 1), count), wp.vec4d)
        self._off = self._zeros(count, wp.bool)
        self._fault = self._array(np.array([shared.NO_FAULT]), wp.int64)
        # What the host reads of it without waiting: memory that the device writes to.
        self._fault_here = wp.array([shared.NO_FAULT], dtype=wp.int64, device="cpu", pinned=device.is_cuda)
        self._fault_read = self._fault_here.numpy()  # a view
        self._graphs: dict[tuple[str, int, bool], Any] = {}
        self._launched: set[tuple[str, int, bool]] = set()

    def takes(self, *values: object) -> bool:
        """Return whether one of these is an array of a device."""
        return any(_is_on_device(value) for value in values)

    def put(self, robots: Any, **given: Any) -> None:
        """Put robots at rest. With indices, arrays of the host have a row for each of these, and are spread.

        Raises:
            InputError: If an earlier input was bad; a reset of all waits for the device, so that it is not in vain.
            WorldError: If a live crowd has no room beside a robot; with live crowds every reset waits.
        """
        if robots is None or self._crowds:
            self.synchronize()
        else:
            self.check()
        if robots is not None and not self.takes(robots, *given.values()):
            rows, given = given, {}
            for name, values in rows.items():
                given[name] = np.zeros((self._count, *values.shape[1:]), dtype=values.dtype)
                given[name][robots] = values
            robots = mask_of(robots, self._count)
        active = self._active(robots)
        self._take(given["poses"], self._new_poses, "poses")
        self._take(given["maps"], self._new_places[:, 0], "maps")
        self._take(given["recordings"], self._new_places[:, 1], "recordings")
        self._take(given["noise"], self._new_errors[:, 0], "noise")
        self._take(given["dropouts"], self._new_errors[:, 1], "dropouts")
        self._take(given["seeds"], self._new_keys, "seeds")
        self._run(("reset", 0, robots is None), lambda: self._launch_reset(active))
        if self._crowds:
            self.synchronize()
        else:
            self.check()

    def drive(self, commands: Any, robots: Any, substeps: int) -> None:
        """Drive some substeps with a command for each robot, and find what is touched first."""
        self.check()
        active = self._active(robots)
        self._take(commands, self._commands, "commands")
        self._run(("drive", substeps, robots is None), lambda: self._launch_drive(active, substeps))
        self.check()

    def scan(self, robots: Any) -> None:
        """Turn the lidars of some robots once."""
        if self._beams:
            active = self._active(robots)
            self._run(("scan", 0, robots is None), lambda: self._launch_scan(active, self.ranges))

    def scan_exactly(self) -> FloatArray:
        """Turn the lidars of all robots once, in float64, and copy the ranges to the host."""
        ranges = self._array(np.full((self._count, self._beams), np.inf), wp.float64)
        if self._beams:
            self._launch_scan(self._everyone, ranges)
        return ranges.numpy()

    def off_map(self) -> Any:
        """Return which robots have their base_link beyond their map."""
        self._launch(motion.find_off_map, self._count, [self._model, self.poses, self.places, self._off])
        return self._off

    def members(self, robot: int, recording: int, time: float) -> FloatArray:
        """Return (x, y, yaw) of the members of crowds around a robot at its time [s], a copy on the host."""
        return np.zeros((0, 3)) if self._crowds is None else self._crowds.members(robot, recording, time)

    def synchronize(self) -> None:
        """Wait until the device is done.

        Raises:
            InputError: If an earlier input was bad.
        """
        wp.synchronize_device(self._device)
        self.check()

    def check(self) -> None:
        """Raise what the device has found so far; the robots go on from where they are.

        Raises:
            InputError: If an earlier input was bad.
        """
        found = self._fault_read[0]
        if found == shared.NO_FAULT:
            return
        wp.synchronize_device(self._device)
        found = int(self._fault_read[0])
        self._fault.fill_(shared.NO_FAULT)
        self._fault_here.fill_(shared.NO_FAULT)
        robot, kind = divmod(found, 8)
        if kind == shared.NO_ROOM and self._crowds:
            raise self._crowds.has_no_room(robot, int(self._new_places.numpy()[robot, 1]))
        raise InputError(_FAULTS[kind].format(robot=robot, maps=self._maps, recordings=self._recordings))

    def _launch_reset(self, active: Any) -> None:
        new = [self._new_poses, self._new_places, self._new_errors]
        self._launch(
            motion.check_places,
            self._count,
            [active, *new, wp.int64(self._maps), wp.int64(self._recordings), self._fault],
        )
        if self._crowds:
            self._crowds.draw(active, self._new_poses, self._new_places, self._new_keys, self._fault)
        state = [self.poses, self.motions, self.wheels, self.lengths, self.steps, self.places]
        self._launch(
            motion.place_robots,
            self._count,
            [active, *new, self._new_keys, self._fault, *state, self._errors, self._keys],
        )
        if self._crowds:
            self._crowds.begin(active, self.poses, self.places, self._fault)
        self._launch_look(active, 0, 0)
        self._launch_settle(active)

    def _launch_drive(self, active: Any, substeps: int) -> None:
        self._launch(motion.check_commands, self._count, [self._commands, self._fault])
        for before in range(0, substeps, self._chunk):
            self._launch_look(active, before, min(self._chunk, substeps - before))
        self._launch_settle(active)

    def _launch_look(self, active: Any, before: int, substeps: int) -> None:
        """Drive a few substeps, and look for contacts after each; without substeps where the robots are."""
        state, passed = [self.poses, self.motions, self.wheels, self.lengths, self.steps], [self._passed, self._speeds]
        self._launch(
            motion.drive,
            self._count,
            [self._model, active, self._commands, before, substeps, self._fault, *state, *passed, self._first],
        )
        if self._crowds:
            here = [self._fault, self.places, self.steps]
            self._crowds.follow(self._model, active, *here, *passed, substeps)
        poses, number_of_first = max(substeps, 1), before + min(substeps, 1)
        lanes = _MOST_LANES
        while lanes > 1 and self._count * poses * lanes > _ENOUGH_THREADS:
            lanes //= 2
        where = [self._passed, self.places, self.steps, self._members, self._edges, self._first]
        self._launch(
            contacts.touch,
            (self._count, poses * lanes),
            [self._model, active, number_of_first, poses, lanes, self._fault, *where],
        )

    def _launch_settle(self, active: Any) -> None:
        found = [self.places, self._first, self.contacts]
        self._launch(contacts.settle, self._count, [self._model, active, *found, self._fault, self._fault_here])

    def _launch_scan(self, active: Any, ranges: Any) -> None:
        self._launch(
            beams.place_lidars,
            (self._lidars, self._count),
            [self._model, active, self.poses, self.places, self._origins],
        )
        shape = (self._count, self._beams)
        if self._crowds:
            self._crowds.place(self._model, active, self.places, self.steps, 1)
        if self._most_movers:
            self._launch(
                beams.place_movers,
                (self._most_movers, self._count),
                [self._model, active, self.poses, self.places, self.steps, self._members, self._seen],
            )
        if self._recordings:  # also where nothing moves in any: this clears the ranges before
            self._launch(beams.meet_movers, shape, [self._model, active, self.places, self._seen, ranges])
        state = [self.places, self.steps, self._errors, self._keys]
        self._launch(beams.cast_beams, shape, [self._model, active, *state, self._origins, ranges])

    def _launch(self, kernel: Any, dim: Any, inputs: list[Any]) -> None:
        # Else blocks have 256 threads, whatever the module says; it would be compiled for both.
        block = kernel.module.options["block_dim"]
        wp.launch(kernel, dim=dim, inputs=inputs, device=self._device, block_dim=block)

    def _run(self, key: tuple[str, int, bool], launch: Callable[[], None]) -> None:
        """Launch; from the second time on as one graph, where the device has such."""
        graph = self._graphs.get(key)
        if graph is not None:
            wp.capture_launch(graph)
        elif key in self._launched and self._device.is_cuda and key[1] <= _MOST_LAUNCHES * self._chunk:
            with wp.ScopedCapture(device=self._device, force_module_load=False) as capture:
                launch()
            self._graphs[key] = capture.graph
            wp.capture_launch(capture.graph)
        else:
            launch()
            self._launched.add(key)

    def _active(self, robots: Any) -> Any:
        if robots is None:
            return self._everyone
        self._take(robots, self._some, "robots")
        return self._some

    def _take(self, given: Any, out: Any, what: str) -> None:
        """Write an array of the host or of the device, or one row of the host for all, into one of ours."""
        source = self._here(given, what) if _is_on_device(given) else None
        if source is None:
            kind = wp.dtype_to_numpy(out.dtype)
            values = given if kind is np.bool_ else spread(given, kind, out.shape, what)
            wp.copy(out, wp.array(values, dtype=out.dtype, device="cpu"))
        elif source.shape != out.shape:
            raise InputError(f"{what} on a device need shape {out.shape}, got {source.shape}")
        elif source.dtype == out.dtype:
            wp.copy(out, source)
        else:
            self._launch(convert.convert1 if out.ndim == 1 else convert.convert2, out.shape, [source, out])

    def _here(self, given: Any, what: str) -> Any:
        array = given if isinstance(given, wp.array) else wp.from_dlpack(given)
        if array.device != self._device:
            raise InputError(f"{what} are on {array.device}, and the batch computes on {self._device}: move them there")
        if array.dtype not in _NUMBERS:
            raise InputError(f"{what} must be numbers, got {array.dtype}")
        return array

    def _zeros(self, shape: Any, dtype: Any = wp.float64) -> Any:
        return wp.zeros(shape, dtype=dtype, device=self._device)

    def _array(self, values: Any, dtype: Any) -> Any:
        return wp.array(values, dtype=dtype, device=self._device)

    def _turns(self, angles: FloatArray) -> FloatArray:
        """Sine and cosine of each angle, with the kernel's bits, shape (n, 2)."""
        out = self._zeros(len(angles), wp.vec2d)
        if len(angles):
            self._launch(shared.turn_angles, len(angles), [self._array(angles, wp.float64), out])
        return out.numpy().reshape(-1, 2)

    def _put_model(self, given: BatchModel) -> Any:
        model = shared.Model()
        sizes = given.shapes.prod(axis=1)
        model.cells = self._array(given.fields, wp.uint8)
        model.shapes = self._array(np.column_stack([np.cumsum(sizes) - sizes, given.shapes]), wp.int32)
        model.frames = self._array(np.column_stack([given.frames, self._turns(given.frames[:, 2])]), wp.float64)
        model.resolution = given.resolution
        model.outline = self._array(given.outline, wp.vec2d)
        model.radius = _reach_of(given.outline)
        cover, model.cover_radius = _cover_of(given.outline)
        model.cover = self._array(cover, wp.vec2d)
        (model.forward, model.reverse, model.turning, model.linear_step, model.angular_step) = given.limits[:5].tolist()
        (model.wheel_radius, model.track_width, model.wheel_speed, model.timestep) = given.limits[5:].tolist()
        model.lidars = self._array(given.lidars[:, [0, 1, 3, 4]], wp.vec4d)
        model.lidar_of = self._array(np.repeat(np.arange(len(given.beams)), given.beams), wp.int32)
        yaws = np.repeat(given.lidars[:, 2], given.beams)
        model.beams = self._array(self._turns(given.angles + yaws)[:, ::-1], wp.vec2d)
        ends = np.cumsum(given.corner_counts)
        model.corners = self._array(given.corners, wp.vec2d)
        model.corner_ranges = self._array(np.column_stack([ends - given.corner_counts, ends]), wp.vec2i)
        pieces = np.split(given.corners, ends[:-1]) if len(ends) else []
        radii = [_reach_of(piece) if len(piece) else radius for piece, radius in zip(pieces, given.radii, strict=True)]
        model.radii = self._array(np.array(radii, dtype=np.float64), wp.float64)
        model.tracks = self._array(given.tracks, wp.vec3d)
        model.recordings = self._array(
            np.column_stack([given.recordings[:-1], given.recordings[1:]]).astype(np.int32), wp.vec2i
        )
        model.samples, model.period = given.tracks.shape[1], given.period
        return model


def _is_on_device(value: object) -> bool:
    """Return whether an array is Warp's, or on a GPU by DLPack."""
    if isinstance(value, np.ndarray | int | float):
        return False
    # 1 is the CPU, and 3 its pinned memory.
    return isinstance(value, wp.array) or (isinstance(value, _Exported) and value.__dlpack_device__()[0] not in (1, 3))


def _reach_of(polygon: FloatArray) -> float:
    return max(math.sqrt(x * x + y * y) for x, y in polygon.tolist())


def _cover_of(outline: FloatArray) -> tuple[FloatArray, float]:
    """Centres and radius of the discs of `RobotModel::cover_outline`."""
    (left, low), (right, high) = outline.min(axis=0).tolist(), outline.max(axis=0).tolist()
    half, across = (right - left) / 8.0, (high - low) / 2.0
    centres = [(left + (2 * number + 1) * half, (low + high) / 2.0) for number in range(4)]
    return np.array(centres), math.sqrt(half * half + across * across) * (1.0 + 1e-9)
