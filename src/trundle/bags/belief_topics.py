"""`BeliefTopics`: what a localizer believes, in the bag of a run: its pose, particles and state, under AMCL's names."""

from __future__ import annotations

import math
from collections.abc import Callable

from trundle.messages.makers import DIAGNOSTICS, POSE, MessageMaker
from trundle.messages.particle_cloud import PARTICLE_CLOUD, encode_particles, learn_particle_cloud
from trundle.messages.qos import LATCHED, SENSOR, Qos
from trundle.mission import Step
from trundle.observation import FloatArray, describe_state, pick_particles

AMCL_POSE, PARTICLES, STATE = "/amcl_pose", "/particle_cloud", "/diagnostics"

MOST_PARTICLES = 200
"""So many particles are written of a cloud: 2,000 would take more than everything else of a run."""

POSE_PERIOD_S = 0.1
PARTICLES_PERIOD_S = 1.0
"""The pose is written at most so often, and the particles and the state; they are also where the state changes."""

_SAME_S = 1e-9

Write = Callable[[str, str, Qos, float, bytes], None]
"""Writes the bytes of a message of a topic, by name, type, QoS and time [s]."""


class BeliefTopics:
    """Writes what a localizer believes; nothing where the robot knows its true pose.

    Args:
        make: Makes the messages.
        write: Writes them.
        frame: The map frame.
    """

    def __init__(self, make: MessageMaker, write: Write, frame: str) -> None:
        self._make, self._write, self._frame = make, write, frame
        self._posed_s = self._clouded_s = -math.inf
        self._said = ""
        self._shown: FloatArray | None = None

    def add(self, step: Step) -> None:
        """Write what is due at the end of a control period."""
        estimate, time = step.estimate, step.state.time
        if estimate is None or estimate.pose is step.state.pose:
            return
        said = describe_state(estimate)
        changes, self._said = said != self._said, said
        make, encode = self._make, self._make.codec.encode
        if changes or time - self._posed_s >= POSE_PERIOD_S - _SAME_S:
            self._posed_s = time
            pose = make.pose_estimate(time, estimate.pose, estimate.covariance, self._frame)
            self._write(AMCL_POSE, POSE, LATCHED, time, encode(pose))
        if not changes and time - self._clouded_s < PARTICLES_PERIOD_S - _SAME_S:
            return
        self._clouded_s = time
        self._write(STATE, DIAGNOSTICS, Qos(10), time, encode(make.diagnosis(time, estimate)))
        if estimate.particles is not None and estimate.particles is not self._shown:
            self._shown = estimate.particles
            learn_particle_cloud(make.codec)
            cloud = pick_particles(estimate.particles, MOST_PARTICLES)
            self._write(PARTICLES, PARTICLE_CLOUD, SENSOR, time, encode_particles(make, time, cloud, self._frame))
