"""Obstacles that move: a motion that is a function of time, or a crowd that walks to random places."""

from trundle.worlds.movers.crowd import Crowd
from trundle.worlds.movers.motion import AlongPath, Motion, PlanarState, Waypoints
from trundle.worlds.movers.mover import Mover, forklift_body, person_body

__all__ = [
    "AlongPath",
    "Crowd",
    "Motion",
    "Mover",
    "PlanarState",
    "Waypoints",
    "forklift_body",
    "person_body",
]
