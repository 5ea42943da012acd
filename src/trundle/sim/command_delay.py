"""`DelayedSimulator`: a simulator whose robot receives its commands late."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

from trundle.geometry import Pose2D, Twist2D
from trundle.sim.simulator import Contact, RobotState, Simulator
from trundle.sim.wrapper import SimulatorWrapper

_TICK_S = 0.005
"""Delays are multiples of this [s], the length of a physics step."""


class DelayedSimulator(SimulatorWrapper):
    """A simulator whose robot receives its commands late; until the first one arrives, it is commanded to stand.

    Args:
        sim: Moves the robot.
        delay_s: Time [s] from a command until the wheels receive it, rounded to 5 ms.
    """

    def __init__(self, sim: Simulator, delay_s: float) -> None:
        super().__init__(sim)
        self._ticks = round(delay_s / _TICK_S)
        self._pending: deque[tuple[int, Twist2D]] = deque()
        self._command = Twist2D()

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame), with no command on its way."""
        self._pending.clear()
        self._command = Twist2D()
        return self._sim.reset(pose, seed=seed)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period; see `Simulator.step`. Commands of earlier periods arrive within it."""
        period = round(dt / _TICK_S)
        self._pending.append((self._ticks, command))
        states: list[RobotState] = []
        done = 0
        while self._pending and self._pending[0][0] < period:
            due, arrived = self._pending.popleft()
            if due > done:
                states.append(self._sim.step(self._command, (due - done) * _TICK_S))
                done = due
            self._command = arrived
        rest = (period - done) * _TICK_S if states else dt
        states.append(self._sim.step(self._command, rest))
        self._pending = deque((due - period, waiting) for due, waiting in self._pending)
        return _join(states)


def _join(states: list[RobotState]) -> RobotState:
    """The last of some states, with the contacts and scans of all."""
    if len(states) == 1:
        return states[0]
    contacts: dict[tuple[str, str], Contact] = {}
    for state in states:
        for contact in state.contacts:
            contacts.setdefault((contact.part, contact.other), contact)
    return replace(
        states[-1],
        contacts=tuple(contacts.values()),
        scans=tuple(scan for state in states for scan in state.scans),
    )
