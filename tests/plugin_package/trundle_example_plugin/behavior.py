"""A behavior: turn to the left, then to the right, and back."""

from __future__ import annotations

from trundle.geometry import Twist2D
from trundle.navigation.behaviors import Behavior, BehaviorContext, Spin


class LookAround(Behavior):
    """Made of another behavior."""

    def __init__(self, angle: float = 1.0) -> None:
        self._angle = angle
        self._turns: list[Spin] = []

    @property
    def name(self) -> str:
        return "look_around"

    @property
    def time_allowance(self) -> float:
        return 60.0

    def start(self, context: BehaviorContext) -> None:
        self._turns = [Spin(self._angle), Spin(-2.0 * self._angle), Spin(self._angle)]
        self._turns[0].start(context)

    def update(self, context: BehaviorContext) -> Twist2D | None:
        while self._turns:
            command = self._turns[0].update(context)
            if command is not None:
                return command
            self._turns.pop(0)
            if self._turns:
                self._turns[0].start(context)
        return None
