"""The effect of each wheel on the robot's motion, fitted to travels: the columns of the forward kinematics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np


@dataclass(frozen=True, slots=True)
class Travel:
    """Rotation of two wheels [rad], and of the base its distance along its heading [m] and its rotation [rad]."""

    left: float
    right: float
    forward: float
    turn: float


class Cruise(Protocol):
    """An object with a steady travel."""

    @property
    def cruise(self) -> Travel:
        """The travel in steady motion."""
        ...


@dataclass(frozen=True, slots=True)
class Wheel:
    """The robot's motion per radian of a wheel.

    Attributes:
        forward: Forward [m].
        turn: Counter-clockwise [rad].
    """

    forward: float
    turn: float

    @property
    def radius(self) -> float:
        """Effective radius [m]: with the other wheel held, the middle of the axle moves half as far as the wheel."""
        return 2.0 * abs(self.forward)

    @property
    def track(self) -> float:
        """Effective distance to the other wheel [m]; infinity if it does not turn the robot."""
        return self.radius / abs(self.turn) if self.turn else float("inf")

    @property
    def reversed(self) -> bool:
        """Whether a positive speed drives backward."""
        return self.forward < 0.0

    @property
    def on_left(self) -> bool:
        """Whether it is on the left: driving forward, it then turns the robot clockwise."""
        return self.turn * self.forward < 0.0


def fit_wheels(legs: Sequence[Cruise]) -> tuple[Wheel, Wheel]:
    """Fit the effect of the left and right wheel by least squares over the steady parts of the legs.

    The ratio of the wheels' speeds must differ between legs, as it does between a straight and a spin.
    """
    turned = np.array([[leg.cruise.left, leg.cruise.right] for leg in legs])
    moved = np.array([[leg.cruise.forward, leg.cruise.turn] for leg in legs])
    by_wheel, *_ = np.linalg.lstsq(turned, moved, rcond=None)
    (left_forward, left_turn), (right_forward, right_turn) = by_wheel.tolist()
    return Wheel(left_forward, left_turn), Wheel(right_forward, right_turn)
