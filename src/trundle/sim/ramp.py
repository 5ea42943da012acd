"""Limiting commands in every simulator: the robot's limits, applied at each physics step."""

from __future__ import annotations

import logging
import math
from typing import NamedTuple

import numpy as np

from trundle.errors import InputError
from trundle.geometry import FloatArray, Twist2D
from trundle.robots import Robot
from trundle.values import as_number

_log = logging.getLogger(__name__)

_ROUNDING = 1e-6
"""Commands above the limits by less than this [m/s, rad/s] are not reported."""


class Motion(NamedTuple):
    """The command for one physics step: v [m/s], w [rad/s], and its wheels' speeds [rad/s]."""

    v: float
    w: float
    left: float
    right: float


LONGEST_PERIOD_S = 3600.0
_MOST_STEPS = 10_000_000
"""Longest plausible control period."""


class CommandRamp:
    """Limits commands to a robot's limits: as `Limits.approach` does, then each wheel's speed.

    The first command that is clipped is logged as a warning.

    Args:
        robot: The robot.
        timestep: Physics timestep [s].
    """

    def __init__(self, robot: Robot, timestep: float) -> None:
        self._limits = robot.limits
        self._drive = robot.drive
        self._name = robot.name
        self._reported = False
        self._timestep = timestep
        self._linear_step = robot.limits.linear_acceleration * timestep
        self._angular_step = robot.limits.angular_acceleration * timestep
        self.reset()

    def reset(self) -> None:
        """Restart from rest."""
        self._v = 0.0
        self._w = 0.0
        self._motion = Motion(0.0, 0.0, 0.0, 0.0)

    def advance(self, command: object, steps: int) -> list[Motion]:
        """Return the motion of each of the next physics steps under this command.

        Once it is constant, the same object is repeated.

        Raises:
            InputError: If the command is not a `Twist2D`.
        """
        target = self.clamp(command)
        radius, track, most = self._drive.wheel_radius, self._drive.track_width, self._drive.max_wheel_speed
        motions: list[Motion] = []
        linear, angular = self._linear_step, self._angular_step
        for step in range(steps):
            if self._v == target.v and self._w == target.w:
                return motions + [self._motion] * (steps - step)
            short, turn = target.v - self._v, target.w - self._w  # compared, as min and max take longer than all else
            self._v = v = self._v + (linear if short > linear else -linear if short < -linear else short)
            self._w = w = self._w + (angular if turn > angular else -angular if turn < -angular else turn)
            across = w * track / 2.0
            left, right = (v - across) / radius, (v + across) / radius
            if most is not None and (abs(left) > most or abs(right) > most):
                self._report_wheels(left, right, most)
                left, right = min(most, max(-most, left)), min(most, max(-most, right))
                v, w = radius * (left + right) / 2.0, radius * (right - left) / track
            self._motion = Motion(v, w, left, right)
            motions.append(self._motion)
        return motions

    def clamp(self, command: object) -> Twist2D:
        """Return the command within the robot's greatest speeds, which the ramp leads to.

        Raises:
            InputError: If it is not a `Twist2D`.
        """
        if not isinstance(command, Twist2D):
            raise InputError(f"a command must be a Twist2D, got {command!r}")
        target = self._limits.clamp(command)
        if not self._reported and abs(target.v - command.v) + abs(target.w - command.w) > _ROUNDING:
            self._report(f"({command.v:g} m/s, {command.w:g} rad/s)", f"({target.v:g} m/s, {target.w:g} rad/s)")
        return target

    @property
    def numbers(self) -> FloatArray:
        """The limits and the timestep as `drive_period` needs them to drive as `advance` does, shape (9,)."""
        limits, drive = self._limits, self._drive
        back = limits.linear_speed if limits.reverse_speed is None else limits.reverse_speed
        most = math.inf if drive.max_wheel_speed is None else drive.max_wheel_speed
        speeds = limits.linear_speed, back, limits.angular_speed
        return np.array(
            [
                *speeds,
                self._linear_step,
                self._angular_step,
                drive.wheel_radius,
                drive.track_width,
                most,
                self._timestep,
            ],
            np.float64,
        )

    def note_cut(self, command: Twist2D, ramped: FloatArray) -> None:
        """Report, once, what `drive_period` has cut: of a command, or of what the ramp asked, (v, w), shape (N, 2)."""
        if self._reported:
            return
        self.clamp(command)
        radius, track, most = self._drive.wheel_radius, self._drive.track_width, self._drive.max_wheel_speed
        if most is None:
            return
        for v, w in ramped.tolist():
            across = w * track / 2.0
            left, right = (v - across) / radius, (v + across) / radius
            if abs(left) > most or abs(right) > most:
                self._report_wheels(left, right, most)

    def _report_wheels(self, left: float, right: float, most: float) -> None:
        if not self._reported:
            fastest = f"({left:.3g}, {right:.3g}) rad/s of the wheels"
            self._report(fastest, f"{most:g} rad/s, the drive's max_wheel_speed")

    def _report(self, asked: str, given: str) -> None:
        """Log once that commands are clipped."""
        self._reported = True
        _log.warning(
            "a command of %s is above the limits of %s and is clipped to %s; further ones are clipped silently",
            asked,
            self._name,
            given,
        )


def count_steps(dt: float, timestep: float) -> int:
    """Return the number of physics steps in a control period.

    Raises:
        InputError: If `dt` [s] is not a positive multiple of `timestep` [s], longer than an hour, or of more than ten
            million steps. It is not rounded, because time would drift.
    """
    steps = round(dt / timestep) if 0.0 < as_number(dt, "a control period") <= LONGEST_PERIOD_S else 0
    if steps < 1 or abs(steps * timestep - dt) > 1e-9 * max(1.0, steps):
        raise InputError(
            f"a control period of {dt} s is not a multiple of the physics step of {timestep} s; "
            f"use one of at most {LONGEST_PERIOD_S:g} s, or make the simulator with a timestep that divides it"
        )
    if steps > _MOST_STEPS:
        raise InputError(
            f"a control period of {dt:g} s has {steps:,} physics steps of {timestep:g} s, more than {_MOST_STEPS:,}; "
            "use a shorter one"
        )
    return steps
