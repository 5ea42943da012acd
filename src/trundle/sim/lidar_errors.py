"""`LidarErrors`: what a robot's lidars measure wrongly; and the simulator whose lidars do."""

from __future__ import annotations

import zlib
from dataclasses import replace
from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from trundle.files.yaml_config import Config
from trundle.geometry import Pose2D, Twist2D
from trundle.observation import Scan
from trundle.sim.simulator import Simulator
from trundle.sim.state import RobotState
from trundle.sim.wrapper import SimulatorWrapper
from trundle.values import check_seed

_STREAM = zlib.crc32(b"lidar errors")
_NOISE_STREAM = zlib.crc32(b"lidar noise")

_Share = Annotated[float, Field(ge=0.0, le=1.0)]


class LidarErrors(Config):
    """What the robot's lidars measure wrongly: `{noise: 0.02, dropouts: 0.01, short_returns: 0.01}`.

    The seed of the run decides which beams these are; they are others in each scan.

    Attributes:
        noise: Standard deviation of a range [m], 0 to 10, besides the lidars' own.
        dropouts: Share of the beams, 0 to 1, that have no return, as from black or shiny surfaces; they read infinity.
        short_returns: Share of the beams, 0 to 1, that are returned too soon, as by dust or rain: anywhere between
            `range_min` and what they would have met.
    """

    noise: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0
    dropouts: _Share = 0.0
    short_returns: _Share = 0.0

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.dropouts + self.short_returns > 1.0:
            raise ValueError(
                f"dropouts {self.dropouts:g} and short_returns {self.short_returns:g} are shares of the same beams: "
                "together they may be 1 at most"
            )
        return self

    def simulate(self, sim: Simulator) -> Simulator:
        """Return a simulator whose lidars have these errors; the simulator itself where there are none."""
        return sim if self == LidarErrors() else ErringLidars(sim, self)


class ErringLidars(SimulatorWrapper):
    """A simulator whose lidars measure wrongly. Everything else is unchanged.

    Args:
        sim: Moves the robot and takes the scans.
        errors: The errors.
    """

    def __init__(self, sim: Simulator, errors: LidarErrors) -> None:
        super().__init__(sim)
        self._errors = errors
        self._draw(0)

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame), and draw the errors from the seed."""
        state = self._sim.reset(pose, seed=seed)
        self._draw(check_seed(seed))
        return self._falsify(state)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period; see `Simulator.step`."""
        return self._falsify(self._sim.step(command, dt))

    def _draw(self, seed: int) -> None:
        # Two streams: more noise leaves the beams that drop out the same.
        self._rng = np.random.default_rng([seed, _STREAM])
        self._noise_rng = np.random.default_rng([seed, _NOISE_STREAM])

    def _falsify(self, state: RobotState) -> RobotState:
        if not state.scans:
            return state
        return replace(state, scans=tuple(self._measure(scan) for scan in state.scans))

    def _measure(self, scan: Scan) -> Scan:
        errors, ranges = self._errors, scan.ranges.copy()
        least, most = scan.range_min, scan.range_max
        if errors.noise > 0.0:
            noise = self._noise_rng.normal(0.0, errors.noise, len(ranges))
            hit = np.flatnonzero(np.isfinite(ranges))
            ranges[hit] = np.minimum(np.maximum(ranges[hit] + noise[hit], least), most)
        if (wrong := errors.dropouts + errors.short_returns) > 0.0:
            drawn = self._rng.random(len(ranges))
            beams = np.flatnonzero(drawn < wrong)
            # A beam that measured nothing (NaN), or met something too close, meets nothing sooner.
            early = beams[ranges[beams] > least]
            reach = np.minimum(ranges[early], most)
            share = self._rng.random(len(ranges))[early]
            ranges[early] = least + share * (reach - least)
            ranges[beams[drawn[beams] < errors.dropouts]] = np.inf
        return replace(scan, ranges=ranges)
