"""`SteeringReport`: what observers of a steered run get about its steering."""

from __future__ import annotations

from dataclasses import dataclass

from trundle.geometry import Goal, Twist2D


@dataclass(frozen=True, slots=True)
class SteeringReport:
    """How a run was steered in one control period.

    Attributes:
        paused: Whether the run was paused, and drove a single step.
        manual: The command by hand, before any check; None where the agent drove.
        held_back: What kept the command by hand from being sent as it was, such as "an obstacle on the map"; empty
            where nothing did.
        by: Who drove by hand; empty where the agent drove.
        speed: How fast the run is to pass, relative to real time.
        goals: All goals now, in order, those reached included.
        boxes: Number of boxes that were dropped so far.
    """

    paused: bool
    manual: Twist2D | None
    held_back: str
    by: str
    speed: float
    goals: tuple[Goal, ...]
    boxes: int = 0
