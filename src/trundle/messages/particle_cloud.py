"""nav2_msgs/ParticleCloud, which rosbags does not bring along: its text, and its bytes from particles."""

from __future__ import annotations

import struct

import numpy as np

from trundle.geometry import FloatArray
from trundle.messages.codec import Codec
from trundle.messages.makers import MessageMaker

PARTICLE_CLOUD = "nav2_msgs/msg/ParticleCloud"

_LINE = "=" * 80
_TEXT = (
    "std_msgs/Header header\nnav2_msgs/Particle[] particles\n"
    f"{_LINE}\nMSG: nav2_msgs/Particle\ngeometry_msgs/Pose pose\nfloat64 weight\n"
)
"""The same in every distribution of Nav2."""

_ENCAPSULATION = 4
"""Bytes before a CDR message; alignment counts from behind them."""

_COUNT = struct.Struct("<I")
"""How many particles follow; where there is none, the message ends with it."""


def learn_particle_cloud(codec: Codec) -> None:
    """Let a codec know the type."""
    codec.register(PARTICLE_CLOUD, _TEXT)


def encode_particles(make: MessageMaker, time: float, particles: FloatArray, frame: str = "map") -> bytes:
    """Return the CDR bytes of particles: at 2,000 of them a message of objects would take longer than the filter.

    Args:
        make: Makes messages; its codec knows the type.
        time: [s].
        particles: (x, y, yaw, weight) [m, rad, 1], shape (N, 4).
        frame: Their frame.
    """
    head = make.codec.encode(make.codec.make(PARTICLE_CLOUD, header=make.header(time, frame), particles=[]))
    if not len(particles):
        return head
    start, body = head[:_ENCAPSULATION], head[_ENCAPSULATION : -_COUNT.size] + _COUNT.pack(len(particles))
    rows = np.zeros((len(particles), 8), dtype="<f8")
    rows[:, :2], rows[:, 7] = particles[:, :2], particles[:, 3]
    rows[:, 5], rows[:, 6] = np.sin(0.5 * particles[:, 2]), np.cos(0.5 * particles[:, 2])
    return start + body + bytes(-len(body) % 8) + rows.tobytes()
