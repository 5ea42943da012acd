"""What each wheel does to the robot, fitted to travels: two columns of the forward kinematics, free of any wiring."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np


@dataclass(frozen=True, slots=True)
class Travel:
    """How far two wheels turned [rad], and how far the base went along its own heading [m] and turned [rad]."""

    left: float
    right: float
    forward: float
    turn: float


class Cruise(Protocol):
    """Something with a steady travel."""

    @property
    def cruise(self) -> Travel:
        """The travel while nothing changes."""
        ...


@dataclass(frozen=True, slots=True)
class Wheel:
    """What one radian of a wheel does to the robot.

    Attributes:
        forward: [m].
        turn: Counter-clockwise [rad].
    """

    forward: float
    turn: float

    @property
    def radius(self) -> float:
        """Effective radius [m]: with the other wheel held, the middle of the axle goes half as far as the wheel."""
        return 2.0 * abs(self.forward)

    @property
    def track(self) -> float:
        """Effective distance to the other wheel [m]; infinity where it does not turn the robot."""
        return self.radius / abs(self.turn) if self.turn else float("inf")

    @property
    def reversed(self) -> bool:
        """Whether a positive speed drives backward."""
        return self.forward < 0.0

    @property
    def on_left(self) -> bool:
        """Whether it sits on the left: then it turns the robot clockwise while it drives forward."""
        return self.turn * self.forward < 0.0


def fit_wheels(legs: Sequence[Cruise]) -> tuple[Wheel, Wheel]:
    """Fit what the wheels named left and right do, by least squares over the steady parts of the legs.

    The legs must not all have the wheels turn in the same ratio, as a straight and a spin do not.
    """
    turned = np.array([[leg.cruise.left, leg.cruise.right] for leg in legs])
    moved = np.array([[leg.cruise.forward, leg.cruise.turn] for leg in legs])
    by_wheel, *_ = np.linalg.lstsq(turned, moved, rcond=None)
    (left_forward, left_turn), (right_forward, right_turn) = by_wheel.tolist()
    return Wheel(left_forward, left_turn), Wheel(right_forward, right_turn)
