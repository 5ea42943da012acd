"""`OdometryErrors`: how far a robot's odometry is from its motion; and the simulator that reports it so."""

from __future__ import annotations

import math
import zlib
from dataclasses import replace
from typing import Annotated

import numpy as np
from pydantic import BeforeValidator, Field

from trundle.files.yaml_config import Angle, Config, NotNegative, Positive, read_angle
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.sim.simulator import Simulator
from trundle.sim.state import RobotState
from trundle.sim.wrapper import SimulatorWrapper
from trundle.values import check_seed

_STREAM = zlib.crc32(b"odometry")
"""Keeps its random numbers apart from those that the simulator draws with the same seed."""
_SLIP_STREAM = zlib.crc32(b"slips")
_SLIP_S = 1.0
"""How long wheels spin in one slip [s]: of 0.3 m, they turn faster by 0.3 m/s, less than most robots' top speed."""

_HeadingBias = Annotated[
    float,
    BeforeValidator(read_angle, json_schema_input_type=float | str),
    Field(ge=0.0, le=1.0, json_schema_extra={"unit": "rad/m"}),
]
_HeadingWalk = Annotated[
    float,
    BeforeValidator(read_angle, json_schema_input_type=float | str),
    Field(ge=0.0, le=1.0, json_schema_extra={"unit": "rad/√m"}),
]


class Slips(Config):
    """Wheels that spin on the spot now and then: `{count: 6, distance: 0.3, heading: 10deg}`, or the count alone.

    The odometry counts the distance in the direction of travel, and the robot does not drive it. The same holds for the
    heading, to the left or to the right. Each slip takes a second. A robot that stands does not slip.

    Attributes:
        count: The most slips of a run. If None, no limit.
        every: Mean distance from one slip to the next [m]; each is drawn between half of it and one and a half times.
        distance: What the odometry counts too much in one slip [m], 0 to 5.
        heading: By how much one slip turns its heading [rad], 0 to π; text may be degrees. The default is 10°.
    """

    count: Annotated[int, Field(ge=0)] | None = None
    every: Positive = 5.0
    distance: Annotated[NotNegative, Field(le=5.0)] = 0.3
    heading: Annotated[Angle, Field(ge=0.0, le=math.pi)] = 0.1745


def _read_count(value: object) -> object:
    """Take a number alone as the count."""
    return {"count": value} if isinstance(value, int | float) and not isinstance(value, bool) else value


class OdometryErrors(Config):
    """How far the robot's odometry is from its motion: `{scale: 0.01, heading: 1deg, slip: 0.002}`.

    The robot moves as without them. The seed of the run decides in which direction each bias goes.

    Attributes:
        scale: Bias of the distance, as a share of it, 0 to 0.5: at 0.01 the odometry counts 1 % too much or too
            little.
        heading: Bias of the heading per metre driven [rad/m], 0 to 1; text may be degrees: `1deg` is 1° per metre.
        slip: Random error of each wheel's travel [m/√m], 0 to 0.2: its standard deviation after one metre, which grows
            with the square root of the travel. Wheels that slip by different amounts also falsify the heading.
        walk: Random error of the distance [m/√m], 0 to 0.2, which grows likewise.
        heading_walk: Random error of the heading [rad/√m], 0 to 1, likewise; text may be degrees.
        slips: Wheels that spin on the spot now and then: how many times, or `{count: 6, distance: 0.3}`. If None, they
            do not.
    """

    scale: Annotated[float, Field(ge=0.0, le=0.5)] = 0.0
    heading: _HeadingBias = 0.0
    slip: Annotated[float, Field(ge=0.0, le=0.2)] = 0.0
    walk: Annotated[float, Field(ge=0.0, le=0.2)] = 0.0
    heading_walk: _HeadingWalk = 0.0
    slips: Annotated[Slips | None, BeforeValidator(_read_count, json_schema_input_type=int | Slips | None)] = None

    def simulate(self, sim: Simulator) -> Simulator:
        """Wrap a simulator so that its odometry has these errors; the simulator itself where there are none."""
        return sim if self == OdometryErrors() else ErringOdometry(sim, self)


class ErringOdometry(SimulatorWrapper):
    """A simulator whose robot has odometry with errors. The motion, and the same seed's noise of lidars, are unchanged.

    `reset` puts the odometry at the robot's pose; from then on errors accumulate.

    Args:
        sim: Moves the robot.
        errors: The errors.
    """

    def __init__(self, sim: Simulator, errors: OdometryErrors) -> None:
        super().__init__(sim)
        self._errors = errors
        self._draw(0)
        self._counted = self._odometry = Pose2D(0.0, 0.0)

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame), and draw the direction of each bias from the seed."""
        state = self._sim.reset(pose, seed=seed)
        self._draw(check_seed(seed))
        self._counted = self._odometry = state.odometry
        return state

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period; see `Simulator.step`."""
        return self._falsify(self._sim.step(command, dt), dt)

    def _draw(self, seed: int) -> None:
        self._rng = np.random.default_rng([seed, _STREAM])
        signs = self._rng.choice((-1.0, 1.0), size=2)
        self._scale = 1.0 + float(signs[0]) * self._errors.scale
        self._heading = float(signs[1]) * self._errors.heading
        self._spin = None if self._errors.slips is None else _SpinningWheels(self._errors.slips, seed)

    def _falsify(self, state: RobotState, dt: float) -> RobotState:
        """Return the state with the odometry that has the errors of the period."""
        moved = self._counted.inverse() @ state.odometry
        self._counted = state.odometry
        forward, turned = self._slip(moved)
        driven = math.hypot(moved.x, moved.y)
        walked, swung = self._walk(driven)
        forward += walked
        turned += self._heading * driven + swung
        if self._spin is not None:
            spun, spun_yaw = self._spin.count(math.copysign(driven, moved.x), dt)
            forward += spun
            turned += spun_yaw
        # Half of the turn before the motion and half after it: the middle of the arc that was driven.
        half = Pose2D(0.0, 0.0, turned / 2.0)
        step = Pose2D(moved.x * self._scale + forward, moved.y * self._scale, moved.yaw)
        pose = self._odometry @ half @ step @ half
        self._odometry = Pose2D(pose.x, pose.y, wrap_angle(pose.yaw))
        twist = state.twist if state.odometry_twist is None else state.odometry_twist
        wrong = Twist2D(twist.v * self._scale + forward / dt, twist.w + turned / dt)
        return replace(state, odometry=self._odometry, odometry_twist=wrong)

    def _walk(self, driven: float) -> tuple[float, float]:
        """Return random errors of a distance [m]: of itself [m], and of the heading [rad]."""
        errors = self._errors
        if errors.walk == errors.heading_walk == 0.0:  # the random numbers of slip stay what they are
            return 0.0, 0.0
        along, around = self._rng.normal(0.0, math.sqrt(driven), size=2)
        return errors.walk * float(along), errors.heading_walk * float(around)

    def _slip(self, moved: Pose2D) -> tuple[float, float]:
        """Return what the wheels counted without moving the robot: forward [m] and in heading [rad]."""
        noise = self._rng.normal(0.0, 1.0, size=2)
        if self._errors.slip == 0.0:
            return 0.0, 0.0
        track = self._sim.robot.drive.track_width
        distance = math.copysign(math.hypot(moved.x, moved.y), moved.x)
        travels = (distance - moved.yaw * track / 2.0, distance + moved.yaw * track / 2.0)
        left, right = (
            self._errors.slip * math.sqrt(abs(travel)) * float(one) for travel, one in zip(travels, noise, strict=True)
        )
        return (left + right) / 2.0, (right - left) / track


class _SpinningWheels:
    """What wheels that spin on the spot count, at places that the seed decides.

    Args:
        slips: How often and how far.
        seed: The seed.
    """

    def __init__(self, slips: Slips, seed: int) -> None:
        self._slips, self._rng = slips, np.random.default_rng([seed, _SLIP_STREAM])
        self._begun, self._left_s = 0, 0.0
        self._forward = self._turn = 0.0
        self._until = self._draw_gap()

    def count(self, driven: float, dt: float) -> tuple[float, float]:
        """Return what the wheels count in a period of `dt` [s] of this motion: forward [m] and heading [rad]."""
        self._until -= abs(driven)
        if self._until <= 0.0 and self._left_s <= 0.0 and self._slips.count != self._begun:
            self._begun, self._left_s = self._begun + 1, _SLIP_S
            self._until = self._draw_gap()
            self._forward = math.copysign(self._slips.distance, driven)
            self._turn = float(self._rng.choice((-1.0, 1.0))) * self._slips.heading
        share = min(self._left_s, dt) / _SLIP_S
        self._left_s = max(0.0, self._left_s - dt)
        return self._forward * share, self._turn * share

    def _draw_gap(self) -> float:
        return self._slips.every * float(self._rng.uniform(0.5, 1.5))
