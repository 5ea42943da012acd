"""A stand-in for a localizer: the truth with an error, on odometry that drifts."""

from __future__ import annotations

import math

import numpy as np

from trundle.geometry import Pose2D, wrap_angle
from trundle.observation import Estimate, Observation
from trundle.sim.wrapper import SimulatorWrapper


class Watched(SimulatorWrapper):
    """A simulator that keeps the true pose."""

    pose = Pose2D(0.0, 0.0)

    def reset(self, pose, *, seed=0):
        state = super().reset(pose, seed=seed)
        self.pose = state.pose
        return state

    def step(self, command, dt):
        state = super().step(command, dt)
        self.pose = state.pose
        return state


class StandIn:
    """The truth with noise at every scan, and with an offset that changes now and then.

    Args:
        sim: Where the truth is.
        jitter: Standard deviation of x and y [m].
        turn: Standard deviation of the yaw [rad].
        jumps: Sizes of the offsets [m], one after the other.
        every_s: Time from one offset to the next [s].
    """

    def __init__(self, sim: Watched, jitter=0.0, turn=0.0, *, jumps=(), every_s=4.0, seed=0):
        self._sim, self._sigma, self._jumps, self._every_s = sim, (jitter, jitter, turn), list(jumps), every_s
        self._rng = np.random.default_rng(seed)
        self._T_map_odom: Pose2D | None = None
        self._offset, self._next_s = (0.0, 0.0, 0.0), every_s
        self.corrections = 0

    def reset(self, pose, *, seed=0):
        self._T_map_odom = None

    def update(self, observation: Observation) -> Estimate:
        if self._jumps and observation.time >= self._next_s:
            size, way = self._jumps[self.corrections % len(self._jumps)], self._rng.uniform(-math.pi, math.pi)
            self._offset = size * math.cos(way), size * math.sin(way), 0.1 * size
            self._next_s += self._every_s
            self.corrections += 1
        if observation.scans or self._T_map_odom is None:
            x, y, yaw = (self._rng.normal(size=3) * self._sigma + self._offset).tolist()
            true = self._sim.pose
            believed = Pose2D(true.x + x, true.y + y, wrap_angle(true.yaw + yaw))
            self._T_map_odom = believed @ observation.odometry.inverse()
        return Estimate(observation.time, self._T_map_odom @ observation.odometry, None, self._T_map_odom)
