"""Signatures of the compiled kernels."""

from typing import Any

import numpy as np
import numpy.typing as npt

class Batch:
    """Many robots of one model on many maps; no robot's results depend on the others or on the number of threads.

    Args:
        fields: Chebyshev fields of the maps, one after the other, shape (cells,).
        shapes: (rows, cols) of each, shape (M, 2).
        frames: (x, y, yaw) of the corner of cell (0, 0) in the map frame [m, rad], shape (M, 3).
        resolution: Edge of a cell [m].
        outline: Footprint in base_link [m], counter-clockwise, shape (C, 2).
        limits: Forward, reverse and turning speed, change of v and w in a substep, wheel radius, track width, speed of
            a wheel (infinite without a limit), substep [s], shape (9,).
        lidars: (x, y, yaw, range_min, range_max) of each, shape (L, 5).
        beams: Number of beams of each, shape (L,).
        angles: Of all beams in their lidar's frame [rad], shape (B,).
        corners: Of the polygons among the movers, in their frames [m], shape (C, 2).
        corner_counts: Number of corners of each mover, 0 for a disc, shape (K,).
        radii: Radius of each disc [m], shape (K,).
        tracks: (x, y, yaw) of each mover at each sample, map frame, shape (K, T, 3).
        recordings: Recording i is of the movers from `recordings[i]` up to `recordings[i + 1]`, shape (R + 1,).
        period: Time between two samples [s].
    """

    def __init__(
        self,
        fields: npt.NDArray[np.uint8],
        shapes: npt.NDArray[np.int64],
        frames: npt.NDArray[np.float64],
        resolution: float,
        outline: npt.NDArray[np.float64],
        limits: npt.NDArray[np.float64],
        lidars: npt.NDArray[np.float64],
        beams: npt.NDArray[np.int64],
        angles: npt.NDArray[np.float64],
        corners: npt.NDArray[np.float64],
        corner_counts: npt.NDArray[np.int64],
        radii: npt.NDArray[np.float64],
        tracks: npt.NDArray[np.float64],
        recordings: npt.NDArray[np.int64],
        period: float,
    ) -> None: ...
    def drive(
        self,
        poses: npt.NDArray[np.float64],
        motions: npt.NDArray[np.float64],
        wheels: npt.NDArray[np.float64],
        lengths: npt.NDArray[np.float64],
        steps: npt.NDArray[np.int64],
        contacts: npt.NDArray[np.int64],
        commands: npt.NDArray[np.float64],
        places: npt.NDArray[np.int64],
        active: npt.NDArray[np.bool_],
        substeps: int,
        threads: int,
        crowds: BatchCrowds | None = None,
    ) -> None:
        """Drive the active robots by some substeps, in place; without substeps, find what they touch where they are.

        `motions` are (ramp v, ramp w, v, w, left, right); `contacts` (kind, …): 0 nothing, 1 cell (row, col), 2 mover
        (index, 0), and the substep of the first one; `places` (map, recording or −1).
        """

    def scan(
        self,
        ranges: npt.NDArray[np.float32] | npt.NDArray[np.float64],
        poses: npt.NDArray[np.float64],
        steps: npt.NDArray[np.int64],
        places: npt.NDArray[np.int64],
        active: npt.NDArray[np.bool_],
        errors: npt.NDArray[np.float64],
        keys: npt.NDArray[np.uint64],
        threads: int,
        crowds: BatchCrowds | None = None,
    ) -> None:
        """Turn every lidar of the active robots once; `errors` are (noise [m], share of dropouts) of each robot."""

class BatchCrowds:
    """The crowds around each robot of a `Batch`, stepped while it drives.

    Args:
        models: Crowds of some recordings.
        firsts: Of each, which of the batch's movers is the first member; the others follow it. Their tracks are unused.
        of_recording: Which of the models each recording has, −1 for none, shape (R,).
        movers: Of each model, (x, y, vx, vy) of the other movers at each step of the crowds, shape (steps, M, 4).
        count: Number of robots.
    """

    def __init__(
        self,
        models: list[CrowdModel],
        firsts: npt.NDArray[np.int64],
        of_recording: npt.NDArray[np.int64],
        movers: list[npt.NDArray[np.float64]],
        count: int,
    ) -> None: ...
    def place(
        self,
        rows: npt.NDArray[np.int64],
        recordings: npt.NDArray[np.int64],
        poses: npt.NDArray[np.float64],
        radius: float,
        words: npt.NDArray[np.uint64],
        threads: int,
    ) -> npt.NDArray[np.int64]:
        """Start the crowds of the robots `rows`, of one radius, by random words of shape (rows, crowds, 4).

        Returns:
            Of each the first member without a place, or −1. If one has none, all crowds stay as they are.
        """

    def members(self, robot: int, time: float) -> npt.NDArray[np.float64]:
        """(x, y, yaw) of the members around a robot at the time that it has come to [s], shape (N, 3)."""

class BinaryGrid:
    def __init__(self, blocked: npt.NDArray[np.uint8], connectivity: int, method: str) -> None: ...
    def find_path(
        self, start: object, goal: object, seconds: float | None, cancel: npt.NDArray[np.uint8] | None
    ) -> tuple[int, int, int, bytes]: ...
    def find_point_path(
        self, start: object, goal: object, seconds: float | None, cancel: npt.NDArray[np.uint8] | None
    ) -> tuple[int, float, bytes]: ...
    def find_paths(
        self,
        starts: npt.NDArray[np.int64],
        goals: npt.NDArray[np.int64],
        threads: int,
        seconds: float | None,
        cancel: npt.NDArray[np.uint8] | None,
    ) -> tuple[Any, ...]: ...
    def find_point_paths(
        self,
        starts: npt.NDArray[np.int64],
        goals: npt.NDArray[np.int64],
        threads: int,
        seconds: float | None,
        cancel: npt.NDArray[np.uint8] | None,
    ) -> tuple[Any, ...]: ...
    def settle_ends(
        self,
        starts: npt.NDArray[np.int64],
        goals: npt.NDArray[np.int64],
        start_reach: float,
        goal_reach: float,
        partial: bool,
    ) -> tuple[int, int, npt.NDArray[np.int64], npt.NDArray[np.int64], npt.NDArray[np.uint8]]: ...
    def update(self, row: int, col: int, values: npt.NDArray[np.uint8]) -> None: ...
    @property
    def method(self) -> str: ...
    @property
    def clutter(self) -> float: ...
    @property
    def bytes(self) -> int: ...

class LeastCost:
    def __init__(self, weights: npt.NDArray[np.float64]) -> None: ...
    def find(
        self,
        costs: npt.NDArray[np.uint8],
        start: tuple[int, int],
        goal: tuple[int, int],
        ends: npt.NDArray[np.float64],
        seconds: float | None = None,
        cancel: npt.NDArray[np.uint8] | None = None,
    ) -> tuple[int, npt.NDArray[np.float64], float]: ...
    @property
    def bytes(self) -> int: ...

class CrowdFloor:
    """Where members of a crowd can be.

    Args:
        costs: Of a path through each cell, 255 where it is blocked, shape (rows, cols); the rim is blocked.
        nearness: Of solids: 255 in them, 0 from `reach` on, shape (rows, cols).
        corner_x, corner_y: The corner of cell (0, 0) [m].
        resolution: Edge of a cell [m].
        reach: Distance from which solids are not felt [m].
        look: How many cells ahead on its path somebody goes for.
    """

    def __init__(
        self,
        costs: npt.NDArray[np.uint8],
        nearness: npt.NDArray[np.uint8],
        corner_x: float,
        corner_y: float,
        resolution: float,
        reach: float,
        look: int,
    ) -> None: ...

class CrowdModel:
    """The crowds of a world.

    Args:
        floors: Of each crowd.
        counts: Members of each, shape (C,).
        members: Radius [m], highest speed [m/s], whether it sees the robot and whether it steers, shape (N, 4).
        corners: Of the members' outlines in their frames [m], counter-clockwise, shape (K, 2).
        corner_counts: Number of corners of each, shape (N,).
        mover_radii: Radii of those who move by functions of time [m], shape (M,).
    """

    def __init__(
        self,
        floors: list[CrowdFloor],
        counts: npt.NDArray[np.int64],
        members: npt.NDArray[np.float64],
        corners: npt.NDArray[np.float64],
        corner_counts: npt.NDArray[np.int64],
        mover_radii: npt.NDArray[np.float64],
    ) -> None: ...

class CrowdRun:
    """One run of crowds. A robot is (x, y, vx, vy, radius), movers are (x, y, vx, vy) each, shape (M, 4)."""

    def __init__(self, model: CrowdModel) -> None: ...
    def reset(
        self, words: npt.NDArray[np.uint64], robot: npt.NDArray[np.float64], movers: npt.NDArray[np.float64]
    ) -> int:
        """Start from random words of shape (crowds, 4); return the first member without a place, or −1."""

    def step(self, robot: npt.NDArray[np.float64] | None, movers: npt.NDArray[np.float64]) -> None:
        """Go on by 0.05 s; `movers` are at the start of the period."""

    def at(self, time: float) -> npt.NDArray[np.float64]:
        """(x, y, yaw, vx, vy, w) of all members at a time of the period that was stepped last [s], shape (N, 6)."""

    @property
    def index(self) -> int:
        """Steps since the reset."""

class HybridAStar:
    def __init__(
        self,
        *,
        radius: float,
        reverse: bool,
        in_place: bool,
        reverse_penalty: float,
        change_cost: float,
        turn_cost: float,
        cost_weight: float,
        heuristic_weight: float,
        cell_size: float,
    ) -> None: ...
    def plan(
        self,
        costs: npt.NDArray[np.uint8],
        resolution: float,
        outline: npt.NDArray[np.float64],
        start: npt.NDArray[np.float64],
        goal: npt.NDArray[np.float64],
        any_yaw: bool,
        step: float,
        spacing: float,
        max_expansions: int,
        seconds: float | None,
        cancel: npt.NDArray[np.uint8] | None,
        partial: bool = False,
        inner: npt.NDArray[np.float64] | None = None,
        thorough: bool = False,
    ) -> tuple[
        int,
        npt.NDArray[np.float64],
        npt.NDArray[np.uint8],
        npt.NDArray[np.float64],
        float,
        tuple[int, int, int],
    ]:
        """Poses are in the frame of the grid's corner [m, m, rad].

        Returns the status (0 found, 1 unreachable, 2 timeout, 3 cancelled, 4 out of expansions, 5 unreachable
        for the inscribed circle, too); poses, shape (N, 3);
        for each leg between two of them 1 where it is driven backwards, shape (N - 1,); the lengths [m], negative
        backwards, and turns [rad] of the arcs, lines and turns in place, shape (M, 2); the cost [m]; and how many
        nodes were expanded, cells of the field settled, and poses checked with the outline. With `partial` the status
        may be 1, 4 or 5 with poses all the same: they lead to the pose nearest to the goal of those that were tried.
        `outline` is kept free at poses at most `step` apart; with `inner`, of as many corners, only what that sweeps.
        With `thorough` it searches in smaller cells and by shorter motions.
        """
    @property
    def bytes(self) -> int: ...

class ScanTracker:
    """Follows what moves through scans; keeps the scans of the last second.

    Calls of several threads wait for each other.

    `settings` are max_range, max_size, min_points, same_surface, acceleration, min_speed, confirm_scans, hidden_s,
    aside_s.
    `body` is the robot's outline in base_link, counter-clockwise: hits inside are left out.
    """

    def __init__(self, settings: npt.NDArray[np.float64], body: npt.NDArray[np.float64]) -> None: ...
    def see(
        self,
        lidar: int,
        time: float,
        ranges: npt.NDArray[np.float64],
        angles: npt.NDArray[np.float64],
        poses: npt.NDArray[np.float64],
        sensor: npt.NDArray[np.float64],
    ) -> None:
        """Take a scan of a lidar.

        Args:
            lidar: Its number.
            time: Of the scan.
            ranges: Infinity for nothing in reach, NaN for no measurement.
            angles: Of the beams in the sensor's frame.
            poses: x, y, yaw of the sensor in the odom frame, shape (1, 3), or (beams, 3).
            sensor: x, y, yaw of the sensor in base_link, range_min, range_max.
        """

    def tracks(
        self, now: float
    ) -> tuple[
        npt.NDArray[np.int64],
        npt.NDArray[np.uint8],
        npt.NDArray[np.float64],
        npt.NDArray[np.float64],
    ]:
        """All tracks, predicted to a time.

        Returns:
            Numbers; whether it is confirmed and whether it moves, shape (K, 2); x, y, vx, vy and radius, shape (K, 5);
            covariances, shape (K, 4, 4).
        """

class MissionDriver:
    """Drives missions along their paths: the navigator's decisions with regulated pure pursuit, and kinematic motion.

    Args:
        costs: Costs of the costmap, shape (rows, cols).
        free: Chebyshev distance of each cell to the nearest one of 254 or 255, shape (rows, cols).
        resolution: Edge of a cell [m].
        origin: (x, y, yaw) of the corner of cell (0, 0) in the map frame [m, rad], shape (3,).
        inflation: Inscribed radius [m], cost scaling factor [1/m] and inflation radius [m], shape (3,).
        outline: Footprint in base_link [m], counter-clockwise, shape (C, 2).
        padded: The same with its padding, shape (C, 2).
        limits: Forward, reverse and turning speed, both accelerations, wheel radius, track width, speed of a wheel
            (infinite without a limit), substep [s], number of substeps in a control period, control period [s], shape
            (11,).
        pursuit: The fields of `PursuitSettings` in their order; the speed is infinite where it is None, shape (13,).
        goal: Tolerances of position and yaw, and speeds below which the robot stands, shape (4,).
        progress: Radius [m], angle [rad] and time allowance [s], shape (3,).
    """

    def __init__(
        self,
        costs: npt.NDArray[np.uint8],
        free: npt.NDArray[np.uint8],
        resolution: float,
        origin: npt.NDArray[np.float64],
        inflation: npt.NDArray[np.float64],
        outline: npt.NDArray[np.float64],
        padded: npt.NDArray[np.float64],
        limits: npt.NDArray[np.float64],
        pursuit: npt.NDArray[np.float64],
        goal: npt.NDArray[np.float64],
        progress: npt.NDArray[np.float64],
    ) -> None: ...
    def drive(
        self,
        starts: npt.NDArray[np.float64],
        goals: npt.NDArray[np.float64],
        time_limits: npt.NDArray[np.float64],
        paths: npt.NDArray[np.float64],
        backward: npt.NDArray[np.bool_],
        path_ends: npt.NDArray[np.int64],
        checks: npt.NDArray[np.float64],
        along: npt.NDArray[np.float64],
        check_ends: npt.NDArray[np.int64],
        threads: int,
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        """Drive missions, each to its end or to where it needs more than to follow its path.

        Args:
            starts: (x, y, yaw) [m, rad], shape (N, 3).
            goals: Likewise; a yaw of NaN is any yaw.
            time_limits: [s], shape (N,).
            paths: Poses of all paths, one after the other, shape (P, 3).
            backward: For each pose whether the leg to the next one is driven backwards, shape (P,).
            path_ends: Where the poses of each path end, shape (N,).
            checks: Poses close together on all paths, shape (C, 3).
            along: How far along its path each of these is [m], shape (C,).
            check_ends: Where those of each mission end, shape (N,).
            threads: How many threads drive.

        Returns:
            Rows (x, y, yaw, v, w, and the command v, w), one for the start and one for each control period, shape
            (T, 7); where those of each mission end, shape (N,); and how each has ended, with the number of its periods
            without a valid command, shape (N, 2). Endings are 0 arrived, 1 timed out, 2 touches something, 3 blocked,
            4 no progress along the path, 5 no progress, 6 the footprint touches something while it is checked.
        """
    def begin(
        self,
        start: npt.NDArray[np.float64],
        goal: npt.NDArray[np.float64],
        time_limit: float,
        path: npt.NDArray[np.float64],
        backward: npt.NDArray[np.bool_],
        check: npt.NDArray[np.float64],
        along: npt.NDArray[np.float64],
        patience: npt.NDArray[np.float64],
    ) -> MissionRun:
        """Begin one mission, to be stepped: `drive` says what it takes.

        `patience` is the radius [m], angle [rad] and time of standing [s] after which a robot that is held may be
        stuck, shape (3,).
        """

class MissionRun:
    """A mission in progress, whose commands somebody may change on their way; made by `MissionDriver.begin`."""

    def decide(self) -> tuple[int, float, float, float, float, float, float, float]:
        """Decide on the next command.

        Returns:
            How the drive ends instead, 8 where it goes on; x, y, yaw, v and w now; and v and w of the command.
        """

    def look(self) -> tuple[int, float, float, float, float, float]:
        """Begin a period whose command somebody else decides on.

        Returns:
            How the drive ends instead of another command, 8 where it goes on; and x, y, yaw, v and w now.
        """

    def take(self, v: float, w: float) -> int:
        """Take that command [m/s, rad/s]; how the drive ends instead of driving it, 8 where it goes on."""

    def move(self, v: float, w: float) -> None:
        """Drive one control period with what is sent instead of the command [m/s, rad/s]."""

    def result(self) -> tuple[npt.NDArray[np.float64], int]:
        """Rows so far, as of `MissionDriver.drive`, shape (R, 7), and the periods without a valid command."""

class MppiState:
    """Where the robot is now [m, rad], its speeds [m/s, rad/s], and their rates of change during the last period."""

    def __init__(self, *, x: float, y: float, yaw: float, v: float, w: float, v_rate: float, w_rate: float) -> None: ...

class MppiLimits:
    """The length `dt` of a step [s], and what the robot can do in it.

    `v_min` is at most 0. Speed above `speed_limit` [m/s] costs something; the other limits always hold.
    """

    def __init__(
        self,
        *,
        dt: float,
        v_min: float,
        v_max: float,
        w_max: float,
        acceleration: float,
        deceleration: float,
        angular_acceleration: float,
        speed_limit: float,
    ) -> None: ...

class MppiNoise:
    """How samples differ from the controls.

    Args:
        v_std: Standard deviation of the speed [m/s].
        w_std: Standard deviation of the turning speed [rad/s].
        share: Share of the samples that is to take effect (0 to 1), by which the temperature is chosen.
        seed: Seed of the draws, a whole number, the same every tick or not.
        shift: Steps by which the controls are shifted first (the period / dt), their end held.
    """

    def __init__(self, *, v_std: float, w_std: float, share: float, seed: float, shift: float) -> None: ...

class MppiWindow:
    """The square of the map around the robot.

    Args:
        nearness: As `inflate` makes it: 254 occupied, 255 unknown (taken as occupied), otherwise 254 − distance / unit,
            at least 0. A disc touches where 254 − radius / unit is reached.
        to_go: Cost from each cell's centre to the goal [m]; infinity and no number are unreachable.
        resolution: Edge of a cell [m].
        unit: What a step of `nearness` stands for [m].
    """

    def __init__(
        self, *, nearness: npt.NDArray[np.uint8], to_go: npt.NDArray[np.float32], resolution: float, unit: float
    ) -> None: ...

class MppiAim:
    """The pose that the samples are to reach.

    Args:
        x: Of the goal [m].
        y: Of the goal [m].
        yaw: Of the goal [rad].
        has_yaw: Whether the yaw counts.
        reach: Within this distance [m] the straight distance to the goal is the cost to go; 0 if the goal is not in
            sight.
        fade: Within this distance [m] the cost of the heading gives way to that of the goal's yaw.
        direction: Direction in which to drive: 1, -1, or 0 for both.
    """

    def __init__(
        self, *, x: float, y: float, yaw: float, has_yaw: bool, reach: float, fade: float, direction: float
    ) -> None: ...

class MppiCritics:
    """What costs how much: the weights of the critics, and from where on they count.

    Args:
        collision: For touching something that stands.
        contact: For touching a mover.
        to_go: For the cost to go, its mean over the horizon.
        to_go_end: For the cost to go at the end of the horizon.
        heading: For the heading (0 to 1: off the direction in which the cost to go falls).
        yaw: For the goal's yaw (0 to 1).
        overshoot: For the metres by which the robot cannot stop before the goal.
        obstacle: Per metre right beside an obstacle, falling with the square of the distance.
        obstacle_speed: The same per m/s.
        mover: Per second in touch with a mover.
        direction: Per metre driven the other way.
        twirl: Per radian of turning.
        acceleration: For accelerations, the mean of their squares as shares of the limits.
        jerk: For the changes of accelerations, likewise.
        speed: Per second and (m/s)² above the speed limit.
        obstacle_reach: Distance from the discs up to which obstacles have a cost [m].
        mover_margin: Distance from movers up to which they have a cost [m].
        mover_sigmas: Standard deviations of a mover's place by which that distance grows.
        free_heading: Heading error that is free [rad].
    """

    def __init__(
        self,
        *,
        collision: float,
        contact: float,
        to_go: float,
        to_go_end: float,
        heading: float,
        yaw: float,
        overshoot: float,
        obstacle: float,
        obstacle_speed: float,
        mover: float,
        direction: float,
        twirl: float,
        acceleration: float,
        jerk: float,
        speed: float,
        obstacle_reach: float,
        mover_margin: float,
        mover_sigmas: float,
        free_heading: float,
    ) -> None: ...

class Mppi:
    """Model predictive path integral control; keeps its memory, and the last step for `costs` and `rollouts`.

    Samples are a multiple of 16 from 128 on: 64 constant arcs, then draws in antithetic pairs around the sequence of
    controls, with a knot every `knot_steps` steps. `level` is base or avx2; without one it is the best that the
    processor has. Both give the same bits. Calls of several threads wait for each other.
    """

    def __init__(self, samples: int, steps: int, knot_steps: int, level: str | None = None) -> None: ...
    @property
    def level(self) -> str: ...
    def step(
        self,
        state: MppiState,
        controls: npt.NDArray[np.float32],
        limits: MppiLimits,
        noise: MppiNoise,
        discs: npt.NDArray[np.float64],
        window: MppiWindow,
        aim: MppiAim,
        movers: npt.NDArray[np.float64],
        critics: MppiCritics,
    ) -> tuple[float, float, float, float, int, int, int, int, int, float, float, bool]:
        """Improve a sequence of controls in place by one iteration.

        All is in the window's frame: origin in the lower left corner of cell (0, 0), axes along the grid, metres.
        Beyond the window its border cells go on. Costs are in metres of cost to go.

        Args:
            state: How the robot moves now.
            controls: v, w at the end of each step, shape (steps, 2): those of the last tick, or 0; then the new ones,
                which keep all limits.
            limits: What the robot can do.
            noise: How the samples differ from the controls.
            discs: Their centres ahead of base_link and their radii, shape (1 to 8, 2). Discs that touch something at
                the start may stay as near, but come no nearer.
            window: What is around the robot.
            aim: Where the samples are to lead.
            movers: x, y, vx, vy, radius, variance of the position [m²], of the velocity [m²/s²], shape (M, 7).
            critics: What costs how much.

        Returns:
            v and w at the end of the first step; cost of the new sequence; lowest cost; how many samples are free, how
            many touch something, how many touch a mover, how many were dropped for want of a finite cost; how many
            discs touch something at the start; the temperature; the effective sample size; and whether the sequence is
            the best sample, as the mean of all touches something.
        """
    def costs(self) -> npt.NDArray[np.float32]:
        """What each sample of the last step costs."""
    def rollouts(self, count: int) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
        """The best samples of the last step: poses (x, y, yaw), shape (count, steps + 1, 3), and their costs."""

class PathSmoother:
    """Keeps memory for the next path; several threads may smooth with one."""

    def __init__(self) -> None: ...
    def smooth(
        self,
        costs: npt.NDArray[np.uint8],
        resolution: float,
        outline: npt.NDArray[np.float64],
        poses: npt.NDArray[np.float64],
        backward: npt.NDArray[np.uint8],
        *,
        radius: float,
        reverse_penalty: float,
        change_cost: float,
        turn_cost: float,
        cost_weight: float,
        curve_weight: float,
        cost_tolerance: float,
        step: float,
        spacing: float,
        inner: npt.NDArray[np.float64] | None = None,
    ) -> tuple[
        npt.NDArray[np.float64],
        npt.NDArray[np.uint8],
        npt.NDArray[np.int32],
        npt.NDArray[np.uint8],
        tuple[float, float, float, float],
    ]: ...

def shortest_curves(
    starts: npt.NDArray[np.float64], goals: npt.NDArray[np.float64], radius: float, reverse: bool
) -> npt.NDArray[np.float64]:
    """The shortest Dubins or, with `reverse`, Reeds-Shepp curves between poses, shape (N, 3) each.

    Returns up to five pairs of length [m], negative backwards, and curvature [1/m], shape (N, 5, 2), filled up with 0.
    """

def flood_poses(
    costs: npt.NDArray[np.uint8],
    resolution: float,
    outline: npt.NDArray[np.float64],
    start: npt.NDArray[np.float64],
    any_yaw: bool,
    goal: npt.NDArray[np.float64],
    goal_any_yaw: bool,
    cell: float,
    headings: int,
    most: int,
    seconds: float | None,
    cancel: npt.NDArray[np.uint8] | None,
) -> tuple[int, int]:
    """Fill the boxes of poses, `cell` [m] wide and a share of the circle, from one end over those that are left.

    The outline is the footprint, shrunk by what a point of it moves within a box. Returns 0 where the boxes around the
    start are closed off from the goal, 1 where the goal is among them, 2 where there are more than `most`, 3 at the
    deadline and 4 when cancelled, and how many there are.
    """

def walk_corners(corners: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]: ...
def inflate(occupancy: npt.NDArray[np.int8], table: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]: ...
def footprint_collides(
    costs: npt.NDArray[np.uint8],
    resolution: float,
    origin_x: float,
    origin_y: float,
    origin_yaw: float,
    outline: npt.NDArray[np.float64],
    poses: npt.NDArray[np.float64],
) -> npt.NDArray[np.bool_]: ...
def footprint_sweep(
    costs: npt.NDArray[np.uint8],
    resolution: float,
    origin_x: float,
    origin_y: float,
    origin_yaw: float,
    outline: npt.NDArray[np.float64],
    first: npt.NDArray[np.float64],
    last: npt.NDArray[np.float64],
) -> npt.NDArray[np.float64]: ...
def footprint_clearance(
    costs: npt.NDArray[np.uint8],
    resolution: float,
    origin_x: float,
    origin_y: float,
    origin_yaw: float,
    outline: npt.NDArray[np.float64],
    poses: npt.NDArray[np.float64],
    cap: float,
) -> npt.NDArray[np.float64]: ...
def grid_search(
    costs: npt.NDArray[np.uint8],
    weights: npt.NDArray[np.uint16],
    start: tuple[int, int],
    goal: tuple[int, int],
    connectivity: int = 8,
    seconds: float | None = None,
    cancel: npt.NDArray[np.uint8] | None = None,
) -> tuple[npt.NDArray[np.int32], float]:
    """No cells, and a cost of 0, where there is no path; no cells and NaN where it was stopped."""

def cost_field(
    costs: npt.NDArray[np.uint8] | npt.NDArray[np.uint16] | npt.NDArray[np.float32],
    goals: npt.NDArray[np.int64],
    connectivity: int,
    threads: int,
    seconds: float | None,
    cancel: npt.NDArray[np.uint8] | None,
) -> tuple[int, npt.NDArray[np.float32] | None]: ...
def eikonal_field(
    classes: npt.NDArray[np.uint8],
    costs: npt.NDArray[np.float32],
    seeds: npt.NDArray[np.int64],
    values: npt.NDArray[np.float64],
    row: int,
    col: int,
    beyond: float,
) -> npt.NDArray[np.float32]:
    """Cost in any direction from each cell to the seeds (row, col), which start with `values`.

    `costs`, shape (256,), are of a cell's length by the cell's class, infinite for walls. Cells that cost more than the
    cell (row, col) by `beyond` are left out: they are infinite.
    """

def line_costs(
    costs: npt.NDArray[np.uint8],
    weights: npt.NDArray[np.float64],
    starts: npt.NDArray[np.float64],
    ends: npt.NDArray[np.float64],
) -> npt.NDArray[np.float64]: ...
def shortcut(
    costs: npt.NDArray[np.uint8],
    weights: npt.NDArray[np.float64],
    points: npt.NDArray[np.float64],
) -> tuple[npt.NDArray[np.int64], float]: ...
def png_unfilter(lines: npt.NDArray[np.uint8], step: int) -> npt.NDArray[np.uint8]: ...
def flood_free(cells: npt.NDArray[np.int8], seeds: npt.NDArray[np.int64]) -> int: ...
def flood_largest(cells: npt.NDArray[np.int8]) -> int: ...
def raster_hexahedra(
    cells: npt.NDArray[np.int8],
    corners: npt.NDArray[np.float64],
    low: float,
    high: float,
    resolution: float,
    depth: float,
    centre: bool,
) -> None: ...
def raster_cylinders(
    cells: npt.NDArray[np.int8],
    cylinders: npt.NDArray[np.float64],
    low: float,
    high: float,
    resolution: float,
    depth: float,
    centre: bool,
) -> None:
    """Mark cylinders that are not upright, shape (N, 8): middle, axis, radius, length."""

def raster_discs(
    cells: npt.NDArray[np.int8], discs: npt.NDArray[np.float64], resolution: float, depth: float, centre: bool
) -> None: ...
def floor_planes(
    heights: npt.NDArray[np.float64],
    spacing: float,
    x: float,
    y: float,
    resolution: float,
    rows: int,
    cols: int,
) -> npt.NDArray[np.float64]:
    """The floor of each cell, shape (rows, cols, 6), NaN where it is not known.

    Height at the cell's centre [m], rise along x and y [m a cell], least and most difference of the floor from that
    plane [m], steepest slope (rise over run). `spacing` of the samples and the place (x, y) of the first are in cells.
    """

def raster_mesh_over_floor(
    cells: npt.NDArray[np.int8],
    planes: npt.NDArray[np.float64],
    vertices: npt.NDArray[np.float64],
    faces: npt.NDArray[np.int32],
    transform: npt.NDArray[np.float64],
    low: float,
    high: float,
    resolution: float,
    depth: float,
    centre: bool,
) -> tuple[bool, bool, npt.NDArray[np.int32]]:
    """Mark a mesh between two heights above the floor of `floor_planes`; returns as `raster_mesh`."""

def raster_thin_faces_over_floor(
    cells: npt.NDArray[np.int8],
    planes: npt.NDArray[np.float64],
    vertices: npt.NDArray[np.float64],
    faces: npt.NDArray[np.int32],
    transform: npt.NDArray[np.float64],
    low: float,
    high: float,
    resolution: float,
    depth: float,
) -> None:
    """Mark as `raster_thin_faces` does, between two heights above the floor."""

def raster_mesh(
    cells: npt.NDArray[np.int8],
    vertices: npt.NDArray[np.float64],
    faces: npt.NDArray[np.int32],
    transform: npt.NDArray[np.float64],
    low: float,
    high: float,
    resolution: float,
    depth: float,
    centre: bool,
    fill: bool,
) -> tuple[bool, bool, npt.NDArray[np.int32]]:
    """Mark a mesh between two heights; `transform` has shape (3, 4).

    Returns whether it is closed (only asked with `fill`), whether any of it lies there, and the faces of a closed mesh
    that lie between two cells, for `raster_thin_faces`.
    """

def raster_thin_faces(
    cells: npt.NDArray[np.int8],
    vertices: npt.NDArray[np.float64],
    faces: npt.NDArray[np.int32],
    transform: npt.NDArray[np.float64],
    low: float,
    high: float,
    resolution: float,
    depth: float,
) -> None:
    """Make 99 of the cells on both sides of such faces where the cell behind is not 100: walls without thickness."""

def cast_grid_rays(
    blocked: npt.NDArray[np.uint8], x: float, y: float, angles: npt.NDArray[np.float64], reach: float
) -> npt.NDArray[np.float64]:
    """Distances in cells from (x, y), in cell units, to the first blocked cell along each angle [rad], or infinity."""

def cast_jumping_rays(
    field: npt.NDArray[np.uint8], x: float, y: float, angles: npt.NDArray[np.float64], reach: float
) -> npt.NDArray[np.float64]:
    """The same as `cast_grid_rays`, bit for bit, for the cells whose `chebyshev_field` this is."""

def chebyshev_field(blocked: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Chebyshev distance in cells of each cell from the nearest blocked one, 0 for those and at most 255."""

def mark_scan(
    evidence: npt.NDArray[np.uint8],
    points: npt.NDArray[np.uint8],
    times: npt.NDArray[np.float64],
    row: int,
    col: int,
    resolution: float,
    poses: npt.NDArray[np.float64],
    angles: npt.NDArray[np.float64],
    ranges: npt.NDArray[np.float64],
    outline: npt.NDArray[np.float64],
    limits: npt.NDArray[np.float64],
    infinite_is_free: bool,
    hit: int,
    miss: int,
    time: float,
) -> tuple[int, int, int, int]:
    """Add a scan to the evidence of a grid in place: each cell that it hit, and each other cell that its beams passed.

    Returns the rectangle (row, row end, col, col end) in which a cell became marked, unmarked, seen or surely free.
    """

def unmark_before(
    evidence: npt.NDArray[np.uint8], times: npt.NDArray[np.float64], before: float, hit: int, miss: int
) -> tuple[int, int, int, int]:
    """Unmark cells that were hit last before a time; returns the rectangle that changed."""

def unmark_within(
    evidence: npt.NDArray[np.uint8],
    points: npt.NDArray[np.uint8],
    row: int,
    col: int,
    resolution: float,
    outline: npt.NDArray[np.float64],
    hit: int,
    miss: int,
) -> tuple[int, int, int, int]:
    """Unmark what lies within a convex outline and count its cells as seen; returns the rectangle that changed."""

def paint_marks(
    evidence: npt.NDArray[np.uint8],
    points: npt.NDArray[np.uint8],
    row: int,
    col: int,
    resolution: float,
    cells: npt.NDArray[np.int8],
    kept: npt.NDArray[np.uint8],
    x: float,
    y: float,
    yaw: float,
    cell_size: float,
    clear_occupied: bool,
) -> None:
    """Put the evidence into a part of a map, whose lower left corner has this pose in the frame of the evidence."""

def repaint_marks(
    evidence: npt.NDArray[np.uint8],
    points: npt.NDArray[np.uint8],
    row: int,
    col: int,
    resolution: float,
    cells: npt.NDArray[np.int8],
    base: npt.NDArray[np.int8],
    kept: npt.NDArray[np.uint8],
    window: tuple[int, int, int, int],
    x: float,
    y: float,
    yaw: float,
    cell_size: float,
    clear_occupied: bool,
) -> tuple[int, int, int, int]:
    """Put the evidence into a window (row, row end, col, col end) of a map again, from what it is without, `base`.

    Returns the rectangle in which `cells` changed. (x, y, yaw) is the pose of the window's lower left corner.
    """

def draw_triangles(
    triangles: npt.NDArray[np.float64], width: int, height: int, scale: float, near: float, perspective: bool
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.float64]]:
    """Which triangle each pixel shows (−1 none) and its depth (infinity for none), shapes (height, width).

    Triangles have shape (N, 3, 3) in the camera's frame: right, up, forward. The camera is in the picture's middle;
    `scale` is in pixels per unit of right / forward, or of right where the view is parallel.
    """

def cast_outline_rays(
    segments: npt.NDArray[np.float64],
    discs: npt.NDArray[np.float64],
    x: float,
    y: float,
    first: float,
    step: float,
    count: int,
    reach: float,
) -> npt.NDArray[np.float64]:
    """Distances [m] from (x, y) along evenly spaced rays to the nearest segment or disc, or infinity."""

def measure_ranges(
    distances: npt.NDArray[np.float64],
    noise: npt.NDArray[np.float64],
    deviation: float,
    range_min: float,
    range_max: float,
) -> npt.NDArray[np.float64]:
    """Ranges [m] of a lidar from the distances along its beams, shape (N,).

    Args:
        distances: [m], shape (N,); those beyond `range_max` read infinity.
        noise: A number for each beam, shape (N,), or none, shape (0,).
        deviation: What it is multiplied with [m].
        range_min: The others are at least this [m].
        range_max: And at most this [m].
    """

def find_moved(
    points: npt.NDArray[np.float64],
    sensor: npt.NDArray[np.float64],
    angles: npt.NDArray[np.float64],
    through: npt.NDArray[np.float64],
    earlier: npt.NDArray[np.float64],
    earlier_sensor: npt.NDArray[np.float64],
    earlier_angles: npt.NDArray[np.float64],
    earlier_through: npt.NDArray[np.float64],
    seconds: float,
) -> tuple[npt.NDArray[np.float64], bool, npt.NDArray[np.float64]]:
    """What has moved since an earlier scan `seconds` ago, both of one lidar and in the order of its beams.

    Returns:
        A velocity for each point, 0 for what stands, shape (N, 2); whether anything moves; (x, y, vx, vy) of points
        that have moved in, shape (M, 4).
    """

def points_around(
    points: npt.NDArray[np.float64],
    velocities: npt.NDArray[np.float64],
    pose: npt.NDArray[np.float64],
    seconds: float,
    reach: float,
    horizon: float,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Points within `reach` [m] of a pose (x, y, yaw) and their velocities, seen from it, both of shape (M, 2).

    Each is continued at its velocity for `seconds`, and counts farther away by what it drives in `horizon` [s]. With
    velocities of shape (0, 2) all of them stand.
    """

def outline_clearances(
    points: npt.NDArray[np.float64],
    velocities: npt.NDArray[np.float64],
    poses: npt.NDArray[np.float64],
    times: npt.NDArray[np.float64],
    outline: npt.NDArray[np.float64],
    sides: npt.NDArray[np.float64],
    padding: float,
    rank: int,
) -> npt.NDArray[np.float64]:
    """The `rank`-th least distance [m] of a point from a convex outline at each pose (x, y, yaw), shape (K,).

    It is negative inside, at a corner a little short, and infinite with fewer points. Points that move, and those in
    the box round the outlines at all poses, wider by a padding, count. They are where they are at the times [s], shape
    (K,), or stand with times of shape (0,). Sides are the normal of each edge and how far the outline reaches along it,
    shape (E, 3).
    """

def drive_period(
    state: npt.NDArray[np.float64], v: float, w: float, limits: npt.NDArray[np.float64], steps: int
) -> tuple[npt.NDArray[np.float64], tuple[float, float, float, float], bool]:
    """Drive an ideal robot towards a command (v, w) [m/s, rad/s] for some steps.

    Args:
        state: x, y, yaw [m, rad], the angles of both wheels [rad], v and w of the ramp, v and w that are driven, and
            the speeds of both wheels [rad/s], shape (11,).
        v: The command [m/s].
        w: And how fast it turns [rad/s].
        limits: The greatest speed forward, backward [m/s] and of turns [rad/s], by how much v and w of the ramp may
            change in a step, the wheels' radius [m], the track width [m], the wheels' largest speed [rad/s], and the
            length of a step [s], shape (9,).
        steps: How many.

    Returns:
        The state after each step, shape (steps, 11); the least and the greatest x, and those of y, of these [m]; and
        whether the command was above the limits, or the wheels had to turn slower than the ramp asks.
    """

def stopping_poses(
    x: float,
    y: float,
    yaw: float,
    v: float,
    w: float,
    goal_v: float,
    goal_w: float,
    forward: float,
    reverse: float,
    turning: float,
    acceleration: float,
    angular_acceleration: float,
    dt: float,
    turn_step: float,
) -> npt.NDArray[np.float64]:
    """Return poses of a robot that drives a command for `dt` [s] and then brakes, the first one included, shape (K, 3).

    It is at (x, y, yaw), moves at (v, w), and turns by `turn_step` [rad] at most from pose to pose.
    """

def place_scan(
    ranges: npt.NDArray[np.float64],
    angles: npt.NDArray[np.float64],
    mount: npt.NDArray[np.float64],
    base: npt.NDArray[np.float64],
    body: npt.NDArray[np.float64],
    range_min: float,
    range_max: float,
    sensor: npt.NDArray[np.float64],
    earlier_ranges: npt.NDArray[np.float64],
    earlier_angles: npt.NDArray[np.float64],
    earlier_sensor: npt.NDArray[np.float64],
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return hits of a scan, shape (N, 2); angles of its beams, ascending; and how far each and those beside it saw.

    Hits lie in the frame of the pose `base`; lone ones (see `find_lone_hits`) and those in the body are left out. The
    sensor's pose is `mount` in the base and `sensor` in that frame. The body has a row (x, y of the normal, reach along
    it) for each side. The scan before may be empty.
    """

def find_lone_hits(
    ranges: npt.NDArray[np.float64],
    angles: npt.NDArray[np.float64],
    sensor: npt.NDArray[np.float64],
    earlier_ranges: npt.NDArray[np.float64],
    earlier_angles: npt.NDArray[np.float64],
    earlier_sensor: npt.NDArray[np.float64],
    range_min: float,
    range_max: float,
) -> npt.NDArray[np.int64]:
    """Indices of the hits that neither a beam beside them nor an earlier scan has seen, shape (N,).

    Poses of the sensors are (x, y, yaw) in one frame, shape (1, 3), or (beams, 3).
    """

def label_components(
    mask: npt.NDArray[np.uint8], diagonal: bool
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int64]]:
    """Labels of the components of set cells, from 1 in the order of their first cells, 0 elsewhere; and their table.

    The table has a row a component: cells, first row, end row, first column, end column.
    """

def mark_gaps(blocked: npt.NDArray[np.uint8], limit: float) -> npt.NDArray[np.uint8]:
    """1 in runs of open cells, in rows, columns and diagonals, shorter than `limit` cells and blocked at both ends."""

def distance_field(
    occupied: npt.NDArray[np.uint8], resolution: float, shift: float, limit: float
) -> npt.NDArray[np.float32]: ...
def field_at(
    field: npt.NDArray[np.float32], resolution: float, limit: float, points: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]: ...
def pick_beams(
    ranges: npt.NDArray[np.float64],
    angles: npt.NDArray[np.float64],
    mount: npt.NDArray[np.float64],
    poses: npt.NDArray[np.float64],
    body: npt.NDArray[np.float64],
    shortest: float,
    longest: float,
    most: int,
    offset: float,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...
def expect_surfaces(
    field: npt.NDArray[np.float32],
    resolution: float,
    limit: float,
    points: npt.NDArray[np.float64],
    pose: npt.NDArray[np.float64],
    counts: npt.NDArray[np.float32],
    means: npt.NDArray[np.float32],
    edge: float,
    offset: float,
    settings: npt.NDArray[np.float64],
) -> npt.NDArray[np.float64]: ...
def learn_surfaces(
    field: npt.NDArray[np.float32],
    resolution: float,
    limit: float,
    points: npt.NDArray[np.float64],
    pose: npt.NDArray[np.float64],
    counts: npt.NDArray[np.float32],
    means: npt.NDArray[np.float32],
    edge: float,
    deepest: float,
    most: float,
) -> None: ...
def move_particles(
    particles: npt.NDArray[np.float64],
    motion: npt.NDArray[np.float64],
    alphas: npt.NDArray[np.float64],
    least: npt.NDArray[np.float64],
    seed: int,
) -> npt.NDArray[np.float64]: ...
def weigh_particles(
    table: npt.NDArray[np.float32],
    resolution: float,
    outside: float,
    particles: npt.NDArray[np.float64],
    points: npt.NDArray[np.float64],
) -> npt.NDArray[np.float64]: ...
def peak_particle(
    particles: npt.NDArray[np.float64], weights: npt.NDArray[np.float64], metres: float, radians: float
) -> npt.NDArray[np.float64]: ...
def resample_particles(
    particles: npt.NDArray[np.float64],
    weights: npt.NDArray[np.float64],
    bins: npt.NDArray[np.float64],
    bound: npt.NDArray[np.float64],
    seed: int,
) -> npt.NDArray[np.float64]: ...
def match_scan(
    field: npt.NDArray[np.float32],
    resolution: float,
    limit: float,
    points: npt.NDArray[np.float64],
    targets: npt.NDArray[np.float64],
    starts: npt.NDArray[np.float64],
    priors: npt.NDArray[np.float64],
    covariances: npt.NDArray[np.float64],
    settings: npt.NDArray[np.float64],
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...
def judge_beams(
    field: npt.NDArray[np.float32],
    resolution: float,
    sensors: npt.NDArray[np.float64],
    points: npt.NDArray[np.float64],
    poses: npt.NDArray[np.float64],
    tolerance: float,
    depth: float,
) -> npt.NDArray[np.uint8]: ...
def search_poses(
    table: npt.NDArray[np.uint8],
    allowed: npt.NDArray[np.uint8],
    resolution: float,
    points: npt.NDArray[np.float64],
    window: npt.NDArray[np.float64],
    settings: npt.NDArray[np.float64],
    most: int,
    most_nodes: int,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], bool]: ...

class SurfaceMap:
    """Surfaces as scans saw them: scans are added, taken away and matched; `cell` is the edge of its cells [m]."""

    def __init__(self, cell: float) -> None: ...
    @property
    def memory(self) -> int:
        """Bytes of its cells."""
    def add(
        self,
        points: npt.NDArray[np.float64],
        normals: npt.NDArray[np.float64],
        pose: npt.NDArray[np.float64],
        sign: int,
    ) -> None:
        """Add points with their normals, seen from a pose, or take them away again (sign -1)."""
    def match(
        self,
        points: npt.NDArray[np.float64],
        normals: npt.NDArray[np.float64],
        starts: npt.NDArray[np.float64],
        prior: npt.NDArray[np.float64],
        covariance: npt.NDArray[np.float64],
        settings: npt.NDArray[np.float64],
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Return poses (K, 3) near starts, their covariances and how they fit (K, 4).

        `settings` are first width, last width and noise [m], most beams that count, iterations. How they fit: the mean
        weight of the points, their rms distance [m], the share that is near a surface, iterations.
        """
    def search(
        self,
        points: npt.NDArray[np.float64],
        centre: npt.NDArray[np.float64],
        reach: npt.NDArray[np.float64],
        sigmas: npt.NDArray[np.float64],
    ) -> tuple[npt.NDArray[np.float64], float]:
        """Return the pose in a window round a centre where most points lie in cells with points, and their share.

        `reach` is how far [m], how far in yaw, and the step of yaw [rad]; `sigmas` how far poses are expected [m, rad].
        """
    def table(self, resolution: float) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.float64]]:
        """Return 255 where points are, 128 beside them, and the lower-left corner of the cells [m]."""

def find_normals(
    points: npt.NDArray[np.float64], sensors: npt.NDArray[np.float64], gap: float, least: float
) -> npt.NDArray[np.float64]: ...
def solve_graph(
    poses: npt.NDArray[np.float64],
    edges: npt.NDArray[np.int32],
    transforms: npt.NDArray[np.float64],
    information: npt.NDArray[np.float64],
    widths: npt.NDArray[np.float64],
    fixed: npt.NDArray[np.uint8],
    iterations: int,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...
def count_beams(
    counts: npt.NDArray[np.int32],
    sensors: npt.NDArray[np.float64],
    points: npt.NDArray[np.float64],
    hits: npt.NDArray[np.uint8],
    corner: npt.NDArray[np.float64],
    resolution: float,
    short_by: float,
    sign: int,
) -> None: ...
def draw_cells(counts: npt.NDArray[np.int32], settings: npt.NDArray[np.float64]) -> npt.NDArray[np.int8]: ...
def polyline_distances(points: npt.NDArray[np.float64], corners: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Distance of each of `points` (N, 2) to the nearest place on a polyline with `corners` (M, 2), M ≥ 1."""

def outline_distances(outlines: npt.NDArray[np.float64], polygons: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Distance of each convex outline, counter-clockwise, to the nearest of some convex polygons; 0 if they overlap.

    Args:
        outlines: Corners, shape (P, N, 2), N ≥ 3.
        polygons: Corners in either sense, also repeated or on one line, shape (Q, M, 2), M ≥ 1.

    Returns:
        Shape (P,).
    """
