"""`OdometryErrors`: how far a robot's odometry is from its motion; and the simulator that reports it so."""

from __future__ import annotations

import math
import zlib
from dataclasses import replace
from typing import Annotated

import numpy as np
from pydantic import BeforeValidator, Field

from trundle.files.config_fields import read_angle
from trundle.files.yaml_config import Config
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.sim.simulator import Simulator
from trundle.sim.state import RobotState
from trundle.sim.wrapper import SimulatorWrapper
from trundle.values import check_seed

_STREAM = zlib.crc32(b"odometry")
"""Keeps its random numbers apart from those that the simulator draws with the same seed."""

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
    """

    scale: Annotated[float, Field(ge=0.0, le=0.5)] = 0.0
    heading: _HeadingBias = 0.0
    slip: Annotated[float, Field(ge=0.0, le=0.2)] = 0.0
    walk: Annotated[float, Field(ge=0.0, le=0.2)] = 0.0
    heading_walk: _HeadingWalk = 0.0

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

    def _falsify(self, state: RobotState, dt: float) -> RobotState:
        """The state with the odometry that has the errors of the period."""
        moved = self._counted.inverse() @ state.odometry
        self._counted = state.odometry
        forward, turned = self._slip(moved)
        driven = math.hypot(moved.x, moved.y)
        walked, swung = self._walk(driven)
        forward += walked
        turned += self._heading * driven + swung
        # Half of the turn before the motion and half after it: the middle of the arc that was driven.
        half = Pose2D(0.0, 0.0, turned / 2.0)
        step = Pose2D(moved.x * self._scale + forward, moved.y * self._scale, moved.yaw)
        pose = self._odometry @ half @ step @ half
        self._odometry = Pose2D(pose.x, pose.y, wrap_angle(pose.yaw))
        twist = state.twist if state.odometry_twist is None else state.odometry_twist
        wrong = Twist2D(twist.v * self._scale + forward / dt, twist.w + turned / dt)
        return replace(state, odometry=self._odometry, odometry_twist=wrong)

    def _walk(self, driven: float) -> tuple[float, float]:
        """Random errors of a distance [m]: of itself [m], and of the heading [rad]."""
        errors = self._errors
        if errors.walk == errors.heading_walk == 0.0:  # the random numbers of slip stay what they are
            return 0.0, 0.0
        along, around = self._rng.normal(0.0, math.sqrt(driven), size=2)
        return errors.walk * float(along), errors.heading_walk * float(around)

    def _slip(self, moved: Pose2D) -> tuple[float, float]:
        """What the wheels counted without moving the robot: forward [m] and in heading [rad]."""
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
