"""`SimulatorWrapper`: a simulator around another one; `DelayedSimulator`: one whose robot gets its commands late."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import replace

from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D
from trundle.geometry.solids import Solid
from trundle.robots import Robot
from trundle.sim.ramp import count_steps
from trundle.sim.simulator import Simulator, SomeSimulator, as_simulator
from trundle.sim.state import Contact, RobotState, Substep
from trundle.values import check_number
from trundle.worlds import World


class SimulatorWrapper(Simulator):
    """Passes everything on to another simulator; derived classes change some of it.

    Args:
        sim: Moves the robot.
    """

    def __init__(self, sim: SomeSimulator) -> None:
        self._sim = as_simulator(sim)

    @property
    def inner(self) -> Simulator:
        """The other simulator."""
        return self._sim

    @property
    def robot(self) -> Robot:
        """The simulated robot."""
        return self._sim.robot

    @property
    def world(self) -> World | None:
        """The world that it moves through; see `Simulator.world`."""
        return self._sim.world

    @property
    def timestep(self) -> float | None:
        """Length of a physics step [s]; see `Simulator.timestep`."""
        return self._sim.timestep

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame); see `Simulator.reset`."""
        return self._sim.reset(pose, seed=seed)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period; see `Simulator.step`."""
        return self._sim.step(command, dt)

    def watch_substeps(self, watch: Callable[[Substep], None] | None) -> bool:
        """Let the simulator report every physics step; see `Simulator.watch_substeps`."""
        return self._sim.watch_substeps(watch)

    def add_solid(self, solid: Solid) -> None:
        """Put a solid into the simulator's world; see `Simulator.add_solid`."""
        self._sim.add_solid(solid)

    def place(self, pose: Pose2D) -> RobotState:
        """Put the simulator's robot somewhere else; see `Simulator.place`."""
        return self._sim.place(pose)

    def close(self) -> None:
        """Close the simulator."""
        self._sim.close()


_ROUNDING = 1e-6
"""A delay that exceeds a whole number of steps by less than this share of a step is that number."""


class DelayedSimulator(SimulatorWrapper):
    """A simulator whose robot receives its commands late; until the first one arrives, it is commanded to stand.

    A command takes effect at the first physics step at or after its time plus the delay. If the simulator does not say
    how long its steps are (`Simulator.timestep`), or they do not divide the control period, that is the first control
    period.

    Args:
        sim: Moves the robot.
        delay_s: Time [s] from a command until the wheels receive it.
    """

    def __init__(self, sim: SomeSimulator, delay_s: float) -> None:
        super().__init__(sim)
        self._delay_s = delay_s
        self._pending: deque[tuple[float, Twist2D]] = deque()
        """Commands on their way, the oldest first: how long they still take [s], from the end of the last period."""
        self._command = Twist2D()

    def delay_in(self, period_s: float) -> float:
        """How long after it was sent a command takes effect [s], where it is sent at the start of a control period.

        Args:
            period_s: Length of the control periods [s].
        """
        step_s, _ = self._steps_in(period_s)
        steps = _steps_until(self._delay_s, step_s)
        return self._delay_s if abs(steps * step_s - self._delay_s) <= _ROUNDING * step_s else steps * step_s

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame), with no command on its way."""
        self._pending.clear()
        self._command = Twist2D()
        return self._sim.reset(pose, seed=seed)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period; see `Simulator.step`. Commands of earlier periods arrive within it."""
        step_s, steps = self._steps_in(dt)
        self._pending.append((self._delay_s, command))
        states: list[RobotState] = []
        done = 0
        while self._pending and (due := _steps_until(self._pending[0][0], step_s)) < steps:
            if due > done:
                states.append(self._sim.step(self._command, (due - done) * step_s))
                done = due
            self._command = self._pending.popleft()[1]
        rest = (steps - done) * step_s if states else dt
        states.append(self._sim.step(self._command, rest))
        self._pending = deque((left_s - dt, waiting) for left_s, waiting in self._pending)
        return _join(states)

    def _steps_in(self, dt: float) -> tuple[float, int]:
        """Return the length [s] and number of the steps of a control period at which a command can take effect."""
        timestep = self._sim.timestep
        if timestep is None:
            return dt, 1
        step_s = check_number("the timestep of a simulator", timestep, 1e-6, 10.0, "s")
        try:
            return step_s, count_steps(dt, step_s)
        except InputError:
            return dt, 1


def _steps_until(delay_s: float, step_s: float) -> int:
    """Return after how many steps a delay is over."""
    return max(0, math.ceil(delay_s / step_s - _ROUNDING))


def _join(states: list[RobotState]) -> RobotState:
    """Return the last of some states, with the contacts and scans of all."""
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
