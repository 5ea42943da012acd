"""`Joint`: a joint of a robot, whatever file it comes from; beside `joints`, as the reader of USD needs it, too."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Joint:
    """One joint.

    Attributes:
        name: Its name; MJCF allows it to be empty.
        type: One of `TYPES`.
        axis: Unit vector in the child body's frame (MJCF) or the joint's frame (URDF; both frames are the same); None
            for a type without an axis.
        limits: Lower and upper position [rad or m], or None.
        parent: Name of the body or link that it is on.
        child: Name of the body or link that it moves.
        drives: Whether an actuator moves it.
    """

    name: str
    type: str
    axis: tuple[float, float, float] | None
    limits: tuple[float, float] | None
    parent: str
    child: str
    drives: bool
