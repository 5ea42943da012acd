"""`BatchSimulator`: N robots on M maps in arrays, each exactly as the kinematic simulator moves one."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, UnknownNameError
from trundle.extras import check_extra
from trundle.geometry import FloatArray
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.sim.batch.arrays import BatchModel, blocked_cells, check_maps, check_recordings, make_model, spread
from trundle.sim.batch.cpu import BatchEngine, CpuEngine, mask_of
from trundle.sim.batch.recording import MoverRecording
from trundle.sim.lidar import LidarChoice, choose_lidars
from trundle.sim.ramp import count_steps
from trundle.values import check_count, check_kind, check_number

NOTHING, CELL, MOVER = 0, 1, 2
"""What a robot touches: the first column of `BatchSimulator.contacts`."""

_MOST_ROBOTS = 10_000_000
_DEVICES = ("cpu", "cuda")

Robots: TypeAlias = npt.ArrayLike | None
"""Which robots: indices, a bool for each robot, or None for all."""


class BatchSimulator:
    """Simulates many robots of one kind, each alone on one of several maps.

    The motion is that of `KinematicSimulator`: the robot's limits at every substep, every arc integrated exactly, and
    a robot that touches something drives through it. Blocked cells of the map are walls of any height; beyond the map
    is nothing. Each robot has the same rollout, bit for bit, whatever the other robots do, how many there are, and how
    many threads compute them.

    Arrays of it are views of its state, and change with every `step`; copy what is to be kept. Reset robots stand at
    the time 0 of their recording.

    Args:
        maps: The maps; all have one resolution.
        robot: The robot.
        count: Number of robots, N.
        lidar: Lidars to simulate: all of the robot's, none, or those named.
        recordings: Movers that robots may be among; all have one period and length. Live crowds of them are computed
            for each robot by itself.
        timestep: Length of a substep [s].
        unknown: Treat unknown cells as "solid" or "free".
        device: Where it computes: "cpu"; or "cuda" or "cuda:1", a GPU of NVIDIA's, with the same bits (extra `gpu`).
            There its arrays are Warp's, on the GPU, and pass by DLPack, and methods take arrays that lie there: with
            a row for each robot of the batch. A bad value in one is raised by that call or a later one.
        threads: Number of threads. If None, TRUNDLE_THREADS, or as many as there are processors.

    Attributes:
        poses: (x, y, yaw) of base_link, map frame [m, rad], shape (N, 3). Yaws are not wrapped.
        wheels: Angles of the left and the right wheel since the reset [rad], shape (N, 2).
        lengths: Length of the path driven since the reset [m], shape (N,).
        steps: Substeps since the reset, shape (N,).
        contacts: What each robot touched first during the last step: (`NOTHING`, 0, 0, 0), (`CELL`, row, col, substep)
            or (`MOVER`, number, 0, substep), shape (N, 4).
        places: Map and recording, −1 for none, of each robot, shape (N, 2).

    Raises:
        InputError: If an argument is out of range, maps have different resolutions, or the robot is larger than a map.
        UnknownNameError: If the robot has no lidar of a chosen name, or there is no such kind of device.
        MissingExtraError: If a GPU is chosen without the extra `gpu`.
    """

    def __init__(
        self,
        maps: OccupancyGrid | Sequence[OccupancyGrid],
        robot: Robot,
        *,
        count: int,
        lidar: LidarChoice = False,
        recordings: Sequence[MoverRecording] = (),
        timestep: float = 0.005,
        unknown: Literal["solid", "free"] = "solid",
        device: str = "cpu",
        threads: int | None = None,
    ) -> None:
        check_kind(robot, Robot, "robot", "Robot.load(name) loads one")
        self._count = check_count("count", count, 1, _MOST_ROBOTS)
        self._timestep = check_number("timestep", timestep, 1e-6, 1.0, "s")
        self._period = 0.0, 0  # of the last step [s], and its substeps
        if unknown not in ("solid", "free"):
            raise InputError(f"unknown must be solid or free, got {unknown!r}")
        if not isinstance(maps, OccupancyGrid | Sequence):
            raise InputError(f"maps must be an OccupancyGrid or a list of them, got {type(maps).__name__}")
        self._maps = (maps,) if isinstance(maps, OccupancyGrid) else tuple(maps)
        check_maps(self._maps, robot)
        check_recordings(recordings)
        self._recordings = tuple(recordings)
        self._robot = robot
        names = choose_lidars(robot, lidar)
        chosen = [robot.lidars[name] for name in names]
        blocked = [blocked_cells(grid, unknown_is_solid=unknown == "solid") for grid in self._maps]
        workers = choose_threads(threads)
        model = make_model(self._maps, blocked, robot, chosen, self._recordings, self._timestep)
        self._engine = _find_device(device, workers)(model, self._recordings, self._count)
        ends = np.cumsum([0, *(each.beams for each in chosen)]).tolist()
        self._columns = {name: slice(first, end) for name, first, end in zip(names, ends, ends[1:], strict=False)}
        self.poses: FloatArray = self._engine.poses
        self.wheels: FloatArray = self._engine.wheels
        self.lengths: FloatArray = self._engine.lengths
        self.steps: npt.NDArray[np.int64] = self._engine.steps
        self.contacts: npt.NDArray[np.int64] = self._engine.contacts
        self.places: npt.NDArray[np.int64] = self._engine.places

    @property
    def count(self) -> int:
        """Number of robots, N."""
        return self._count

    @property
    def robot(self) -> Robot:
        """The robot that they all are."""
        return self._robot

    @property
    def maps(self) -> tuple[OccupancyGrid, ...]:
        """The maps."""
        return self._maps

    @property
    def timestep(self) -> float:
        """Length of a substep [s]."""
        return self._timestep

    @property
    def times(self) -> FloatArray:
        """Time since each robot's reset [s], shape (N,); a copy on the host."""
        return self._host(self.steps).astype(np.float64) * self._timestep

    @property
    def twists(self) -> FloatArray:
        """Speed v [m/s] and turning speed w [rad/s] of each robot now, shape (N, 2); a view."""
        return self._engine.motions[:, 2:4]

    @property
    def ranges(self) -> npt.NDArray[np.float32]:
        """The last scan of each robot; see `scan`."""
        return self._engine.ranges

    @property
    def columns(self) -> Mapping[str, slice]:
        """Which columns of `scan` are of which lidar."""
        return self._columns

    def reset(
        self,
        poses: npt.ArrayLike,
        *,
        robots: Robots = None,
        maps: npt.ArrayLike = 0,
        recordings: npt.ArrayLike = -1,
        seeds: npt.ArrayLike = 0,
        noise: npt.ArrayLike = 0.0,
        dropouts: npt.ArrayLike = 0.0,
    ) -> None:
        """Put robots at rest, and find what they touch there. The others go on as they are.

        Args:
            poses: (x, y, yaw), map frame [m, rad], shape (3,) or (n, 3) for n robots.
            robots: Which: indices, a bool for each robot, or None for all.
            maps: Number of the map, for all of them or for each.
            recordings: Number of the recording, −1 for none; likewise.
            seeds: Seeds of the noise of the lidars, and of live crowds; likewise.
            noise: Standard deviation of a range [m]; likewise.
            dropouts: Share of the beams without a return, 0 to 1; likewise.

        Raises:
            InputError: If a value is out of range or has another shape; nothing is reset then.
            WorldError: If a live crowd has no room beside a robot; nothing is reset then, too.
        """
        engine = self._engine
        if engine.takes(poses, robots, maps, recordings, seeds, noise, dropouts):
            given = {"poses": poses, "maps": maps, "recordings": recordings, "seeds": seeds}
            engine.put(self._active(robots), noise=noise, dropouts=dropouts, **given)
            return
        chosen = self._choose(robots)
        count = self._count if chosen is None else len(chosen)
        placed = spread(poses, np.float64, (count, 3), "poses")
        lost = np.logical_not(np.abs(placed) < 1e9).any(axis=1)
        if lost.any():
            raise InputError(f"the pose of robot {_first(chosen, lost)} is not finite")
        map_of = self._check_range(maps, chosen, "map", 0, len(self._maps) - 1)
        recording_of = self._check_range(recordings, chosen, "recording", -1, len(self._recordings) - 1)
        keys = spread(seeds, np.uint64, (count,), "seeds")
        sigma = spread(noise, np.float64, (count,), "noise")
        shares = spread(dropouts, np.float64, (count,), "dropouts")
        if not ((sigma >= 0.0) & (sigma <= 10.0) & (shares >= 0.0) & (shares <= 1.0)).all():
            raise InputError("noise must be from 0 to 10 m, and dropouts from 0 to 1")
        engine.put(chosen, poses=placed, maps=map_of, recordings=recording_of, seeds=keys, noise=sigma, dropouts=shares)

    def step(self, commands: npt.ArrayLike, dt: float, *, robots: Robots = None) -> None:
        """Drive one control period with a commanded twist for each robot.

        Args:
            commands: (v, w) [m/s, rad/s], shape (2,), or (N, 2) for all N robots, also where only some drive. Those
                above the robot's limits are clipped.
            dt: Length of the period [s], a multiple of the timestep.
            robots: Which robots drive; the others stay as they are, and their time stands still.

        Raises:
            InputError: If a command is not finite or has another shape, or `dt` is no such multiple; no robot has
                moved then.
        """
        if not (isinstance(dt, float) and dt == self._period[0]):
            self._period = dt, count_steps(dt, self._timestep)
        substeps = self._period[1]
        if self._engine.takes(commands, robots):
            self._engine.drive(commands, self._active(robots), substeps)
            return
        given = spread(commands, np.float64, (self._count, 2), "commands")
        finite = np.abs(given) < 1e9
        if not finite.all():
            first = int(np.argmin(finite.all(axis=1)))
            raise InputError(
                f"the command of robot {first} is ({given[first, 0]:g}, {given[first, 1]:g}); commands must be "
                "finite, and below 1e9 m/s and rad/s. No robot has moved"
            )
        self._engine.drive(given, self._mask(robots), substeps)

    def scan(self, *, robots: Robots = None) -> npt.NDArray[np.float32]:
        """Turn every lidar of the robots once.

        Returns:
            Ranges of all beams [m], one lidar after the other, infinite without a return; float32, shape (N, beams),
            a view. Robots that are not chosen keep the scan that they have.
        """
        self._engine.scan(self._active(robots))
        return self._engine.ranges

    def scan_exactly(self) -> FloatArray:
        """Turn every lidar of all robots once; as `scan`, in float64, and a copy on the host."""
        return self._engine.scan_exactly()

    def movers(self, robot: int) -> FloatArray:
        """Return where the movers around a robot are now: (x, y, yaw), map frame [m, rad], shape (M, 3).

        They are in the order of the outlines of its recording; none without a recording.

        Raises:
            InputError: If there is no such robot.
        """
        if isinstance(robot, bool) or not isinstance(robot, int | np.integer) or not 0 <= robot < self._count:
            raise InputError(f"a robot is a number from 0 to {self._count - 1}, got {robot!r}")
        number = int(self._host(self.places)[robot, 1])
        if number < 0:
            return np.zeros((0, 3))
        recording, time = self._recordings[number], float(self.times[robot])
        last = recording.tracks.shape[1] - 1
        sample = min(time / recording.period, float(last))
        first, second = recording.tracks[:, int(sample)], recording.tracks[:, min(int(sample) + 1, last)]
        poses = first + (sample - int(sample)) * (second - first)
        members = self._engine.members(int(robot), number, time)
        return np.concatenate([poses[: len(poses) - len(members)], members])

    def is_off_map(self) -> npt.NDArray[np.bool_]:
        """Return which robots have their base_link beyond their map, shape (N,)."""
        return self._engine.off_map()

    def synchronize(self) -> None:
        """Wait until the device is done; on the CPU it always is.

        Raises:
            InputError: If an array of the device that was given before holds a bad value.
        """
        self._engine.synchronize()

    @staticmethod
    def _host(array: Any) -> npt.NDArray[Any]:
        return array if isinstance(array, np.ndarray) else array.numpy()

    def _choose(self, robots: Robots) -> npt.NDArray[np.int64] | None:
        """Return the indices of robots, or None for all."""
        if robots is None:
            return None
        try:
            array = np.asarray(robots)
        except ValueError:
            raise InputError("robots must be indices, a bool for each robot, or None for all") from None
        if array.dtype == np.bool_:
            if array.shape != (self._count,):
                raise InputError(f"robots as bools need shape ({self._count},), got {array.shape}")
            return np.flatnonzero(array)
        chosen = np.atleast_1d(array)
        if chosen.size == 0:
            return np.zeros(0, dtype=np.int64)
        if chosen.ndim != 1 or chosen.dtype.kind not in "iu":
            raise InputError("robots must be indices, a bool for each robot, or None for all")
        if (
            chosen.min() < 0
            or chosen.max() >= self._count
            or (len(chosen) > 1 and len(np.unique(chosen)) != len(chosen))
        ):
            raise InputError(f"robots must be different indices from 0 to {self._count - 1}")
        return chosen.astype(np.int64)

    def _mask(self, robots: Robots) -> npt.NDArray[np.bool_] | None:
        chosen = self._choose(robots)
        return None if chosen is None else mask_of(chosen, self._count)

    def _active(self, robots: Any) -> Any:
        """Return a bool for each robot, or None for all: an array of the device as it is given."""
        return robots if self._engine.takes(robots) else self._mask(robots)

    def _check_range(
        self, values: npt.ArrayLike, chosen: npt.NDArray[np.int64] | None, what: str, least: int, most: int
    ) -> npt.NDArray[np.int64]:
        count = self._count if chosen is None else len(chosen)
        array = spread(values, np.int64, (count,), f"{what}s")
        bad = (array < least) | (array > most)
        if bad.any():
            number, robot = array[np.argmax(bad)], _first(chosen, bad)
            raise InputError(f"robot {robot} is to be on {what} {number}; there are {most + 1} {what}s, from 0 on")
        return array


def _first(chosen: npt.NDArray[np.int64] | None, bad: npt.ArrayLike) -> int:
    first = int(np.argmax(bad))
    return first if chosen is None else int(chosen[first])


def _find_device(name: str, threads: int) -> Callable[[BatchModel, Sequence[MoverRecording], int], BatchEngine]:
    """Return what makes the state of a batch on a device.

    Raises:
        UnknownNameError: If there is no such kind of device.
        MissingExtraError: If the extra gpu is not installed.
        InputError: If this machine has no such device.
    """
    if name == "cpu":
        return lambda model, recordings, count: CpuEngine(model, recordings, count, threads)
    if str(name).partition(":")[0] != "cuda":
        raise UnknownNameError("device", str(name), _DEVICES)
    check_extra("gpu", f'device="{name}"')
    from trundle.sim.batch.warp import make_engine

    return make_engine(name)


def choose_threads(threads: int | None) -> int:
    """Return how many threads to use: by default TRUNDLE_THREADS, or as many as there are processors.

    Raises:
        InputError: If it is not an integer from 1 to 1024.
    """
    if threads is not None:
        return check_count("threads", threads, 1, 1024)
    given = os.environ.get("TRUNDLE_THREADS", "").strip()
    if given:
        return check_count("TRUNDLE_THREADS", int(given) if given.isdecimal() else given, 1, 1024)
    return os.cpu_count() or 1
