"""The bodies of people and forklifts: solids in a mover's frame, with the origin on the floor and x forward."""

from __future__ import annotations

from collections.abc import Callable

from trundle.errors import UnknownNameError
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Color, Cylinder, Solid, Sphere

PERSON_RADIUS, PERSON_HEIGHT = 0.3, 1.75  # [m]
FORK_LOW, FORK_HIGH = 0.14, 0.20  # of the forks above the floor [m]: below the lidars of many robots

_CLOTHES: Color = (0.95, 0.45, 0.10, 1.0)
_SKIN: Color = (0.78, 0.60, 0.46, 1.0)
_YELLOW: Color = (0.95, 0.74, 0.10, 1.0)
_DARK: Color = (0.16, 0.17, 0.19, 1.0)
_WOOD: Color = (0.70, 0.52, 0.32, 1.0)
_STEEL: Color = (0.42, 0.44, 0.47, 1.0)
_HEAD = 0.125  # radius [m]


def person_body(*, radius: float = PERSON_RADIUS, height: float = PERSON_HEIGHT) -> tuple[Solid, ...]:
    """A person: a cylinder with a head.

    Args:
        radius: Of the cylinder [m].
        height: To the top of the head [m]; 0.5 or more.
    """
    shoulders = height - 2.0 * _HEAD
    return (
        Solid("body", Cylinder(radius, shoulders), Pose3D((0.0, 0.0, shoulders / 2.0)), _CLOTHES, "person"),
        Solid("head", Sphere(_HEAD), Pose3D((0.0, 0.0, height - _HEAD)), _SKIN, "person"),
    )


def forklift_body(*, loaded: bool = False) -> tuple[Solid, ...]:
    """A compact forklift, 2.0 m long with its forks and 0.9 m wide, its origin in the middle.

    The forks are from 0.14 to 0.20 m above the floor, and reach 0.8 m beyond what is higher.

    Args:
        loaded: Whether it carries a crate that covers the forks, from just above the floor to a height of 1.1 m.
    """
    fork = (FORK_LOW + FORK_HIGH) / 2.0
    thick = FORK_HIGH - FORK_LOW
    crate = (_box("crate", (0.80, 0.80, 1.05), (0.60, 0.0, 0.575), _WOOD),) if loaded else ()
    return (
        *crate,
        _box("body", (1.08, 0.90, 1.00), (-0.46, 0.0, 0.56), _YELLOW),
        _box("mast", (0.12, 0.80, 1.90), (0.14, 0.0, 1.05), _STEEL),
        _box("roof", (1.00, 0.86, 0.06), (-0.46, 0.0, 2.05), _DARK),
        _box("post_left", (0.06, 0.06, 0.96), (-0.90, 0.38, 1.54), _DARK),
        _box("post_right", (0.06, 0.06, 0.96), (-0.90, -0.38, 1.54), _DARK),
        _box("fork_left", (0.80, 0.12, thick), (0.60, 0.25, fork), _STEEL),
        _box("fork_right", (0.80, 0.12, thick), (0.60, -0.25, fork), _STEEL),
    )


def _box(name: str, size: tuple[float, float, float], at: tuple[float, float, float], color: Color) -> Solid:
    return Solid(name, Box(size), Pose3D(at), color, "forklift")


BODIES: dict[str, Callable[[], tuple[Solid, ...]]] = {"forklift": forklift_body, "person": person_body}


def body_named(name: str) -> tuple[Solid, ...]:
    """The solids of a body by name: "person" or "forklift".

    Raises:
        UnknownNameError: If there is none of that name.
    """
    if name not in BODIES:
        raise UnknownNameError("body of a mover", name, list(BODIES))
    return BODIES[name]()
