"""`Sampler`: what the kernel is given, made of settings and of what the robot may do now."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.control.controller import Intent
from trundle.control.mppi.fields import Window
from trundle.control.mppi.mppi_settings import MppiSettings
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.observation import Track
from trundle.robots import Robot

_BLOCK = 16
_CALM, _AMONG_MOVERS = (0.25, 0.3), (0.3, 0.375)
"""Deviations of speed and turn as shares of the limits: wider ones evade sooner, narrower ones drive smoother."""

_MOST_TURN_RAD = 1.0  # in one step of the model; see MppiSettings
_FORWARD = 1.0  # paths that are driven backwards are not sampled
_UNLIMITED_MPS = 1e6  # the kernel takes no infinity


@dataclass(frozen=True, slots=True)
class Aim:
    """Where the samples are to lead.

    Attributes:
        x, y, yaw: The end of the path, the window's frame [m, m, rad].
        has_yaw: Whether the yaw counts.
        reach: How near the end the straight distance counts instead of the cost to go [m]; 0 where the end is not in
            the window.
    """

    x: float
    y: float
    yaw: float
    has_yaw: bool
    reach: float


@dataclass(frozen=True, slots=True)
class Start:
    """How the robot moves at the start of a tick.

    Attributes:
        pose: Where it is, map frame.
        twist: How it moves.
        change: How it has accelerated since the last tick [m/s², rad/s²].
        speed_limit: [m/s], infinite without one.
        dt: Time for which the command is sent [s].
    """

    pose: Pose2D
    twist: Twist2D
    change: Twist2D
    speed_limit: float
    dt: float


@dataclass(frozen=True, slots=True)
class Answer:
    """What the samples say.

    Attributes:
        command: The first command of their weighted mean.
        free: How many touch nothing that stands.
        blocked: How many do.
        contacts: How many touch something that moves.
        dropped: How many had no finite cost.
    """

    command: Twist2D
    free: int
    blocked: int
    contacts: int
    dropped: int


class Sampler:
    """Draws and rates samples, and remembers the best sequence for the next tick.

    Args:
        robot: What is driven.
        settings: How.
        discs: That cover it, (x, radius) [m].

    Attributes:
        settings: As given.
        steps: Number of steps of a sample.
    """

    def __init__(self, robot: Robot, settings: MppiSettings, discs: FloatArray) -> None:
        self.settings, self._discs = settings, np.ascontiguousarray(discs)
        limits = settings.limits_of(robot)
        self._limits, self._back, self._step_s = limits, limits.reverse_speed or 0.0, settings.step_s(robot)
        self._turn = min(limits.angular_speed, _MOST_TURN_RAD / self._step_s)
        self._deviations, self._wide = (
            (
                v * limits.linear_speed if settings.vx_std is None else settings.vx_std,
                w * limits.angular_speed if settings.wz_std is None else settings.wz_std,
            )
            for v, w in (_CALM, _AMONG_MOVERS)
        )
        samples = _BLOCK * math.ceil(settings.samples / _BLOCK)
        self.steps = settings.steps_of(robot)
        self._kernel = _core.Mppi(samples, self.steps, min(settings.knot_steps, max(1, self.steps // 3)))
        self._critics = _core.MppiCritics(
            collision=settings.collision_cost,
            contact=settings.mover_contact_cost,
            to_go=settings.to_go_weight,
            to_go_end=settings.goal_weight,
            heading=settings.path_angle_weight,
            yaw=settings.goal_angle_weight,
            overshoot=settings.overshoot_weight,
            obstacle=settings.repulsion_weight,
            obstacle_speed=settings.slow_near_weight,
            mover=settings.mover_weight,
            direction=settings.prefer_forward_weight,
            twirl=settings.twirling_weight,
            acceleration=settings.acceleration_weight,
            jerk=settings.jerk_weight,
            speed=settings.constraint_weight,
            obstacle_reach=settings.inflation_radius,
            mover_margin=settings.mover_margin,
            mover_sigmas=settings.mover_sigmas,
            free_heading=settings.max_angle_to_path,
        )
        self.reset(0)

    def reset(self, seed: int) -> None:
        """Start over with no command, and draw by this seed."""
        self._seed = float(seed % 2**52)
        self._controls: npt.NDArray[np.float32] = np.zeros((self.steps, 2), np.float32)
        self._shift = 0.0
        self._window: Window | None = None

    def restart(self, twist: Twist2D) -> None:
        """Forget the best sequence: another controller drove in between."""
        self._controls[:] = (twist.v, twist.w)
        self._shift = 0.0

    def step(
        self, window: Window, to_go: npt.NDArray[np.float32], start: Start, aim: Aim, movers: Sequence[Track]
    ) -> Answer:
        """Rate the samples from here on, and return what their mean does first.

        Args:
            window: Around the robot.
            to_go: Cost to go in it [m].
            start: How the robot moves now.
            aim: Where the samples are to lead.
            movers: What moves, map frame.
        """
        twist, change, speed_limit = start.twist, start.change, start.speed_limit
        settings, limits = self.settings, self._limits
        x, y, yaw = window.pose_in(start.pose)
        forward = min(limits.linear_speed, speed_limit)
        back = min(self._back, speed_limit)
        v_std, w_std = self._wide if movers else self._deviations
        shift, self._shift = self._shift, start.dt / self._step_s
        self._window = window
        v, w, _, _, free, blocked, contacts, dropped, *_ = self._kernel.step(
            state=_core.MppiState(
                x=x, y=y, yaw=yaw, v=twist.v, w=self._within_turn(twist.w), v_rate=change.v, w_rate=change.w
            ),
            controls=self._controls,
            limits=_core.MppiLimits(
                dt=self._step_s,
                v_min=-back,
                v_max=forward,
                w_max=self._turn,
                acceleration=limits.linear_acceleration,
                deceleration=limits.linear_acceleration,
                angular_acceleration=limits.angular_acceleration,
                speed_limit=min(speed_limit, _UNLIMITED_MPS),
            ),
            noise=_core.MppiNoise(v_std=v_std, w_std=w_std, share=settings.best_share, seed=self._seed, shift=shift),
            discs=self._discs,
            window=_core.MppiWindow(
                nearness=window.nearness, to_go=to_go, resolution=window.resolution, unit=window.unit
            ),
            aim=_core.MppiAim(
                x=aim.x,
                y=aim.y,
                yaw=aim.yaw,
                has_yaw=aim.has_yaw,
                reach=max(aim.reach, 0.0),
                fade=settings.threshold_to_consider,
                direction=_FORWARD,
            ),
            movers=_mover_rows(movers, window),
            critics=self._critics,
        )
        command = self._limits.clamp(Twist2D(min(max(v, -back), max(forward, twist.v)), w))
        return Answer(command, free, blocked, contacts, dropped)

    @property
    def intent(self) -> Intent:
        """The commands that it has chosen."""
        return Intent(self._controls.astype(np.float64), self._step_s)

    def _within_turn(self, w: float) -> float:
        most = _MOST_TURN_RAD / self._step_s
        return min(most, max(-most, w))

    def best(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the best samples of the last tick: poses, map frame, shape (N, T, 3), and their costs, shape (N,)."""
        if self._window is None:
            return np.zeros((0, 0, 3)), np.zeros(0)
        poses, costs = self._kernel.rollouts(count)
        return self._window.poses_out(np.asarray(poses, np.float64)), np.asarray(costs, np.float64)


def _mover_rows(movers: Sequence[Track], window: Window) -> FloatArray:
    """Return movers, window frame, shape (M, 7): x, y, vx, vy, radius, variances of position and velocity."""
    rows: list[tuple[float, ...]] = []
    for track in movers:
        x, y = window.to_window(track.x, track.y)
        vx, vy = window.turn_in(track.vx, track.vy)
        position = 0.5 * float(track.covariance[0, 0] + track.covariance[1, 1])
        velocity = 0.5 * float(track.covariance[2, 2] + track.covariance[3, 3])
        rows.append((x, y, vx, vy, track.radius, position, velocity))
    return np.array(rows, np.float64).reshape(-1, 7)
