"""`SimulationControl`: pauses, steps and restarts the simulation, and places the robot; `StepAction`: steps it."""

from __future__ import annotations

import math
import threading
import time as clock
from collections.abc import Callable
from typing import Any, Literal, TypeAlias

from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.mission import End, Pause, PlaceRobot, Restart, Session, StepOnce
from trundle.mission.steering.directives import Directive
from trundle.ros2.actions import ActionGoal
from trundle.ros2.role import BridgeContext

SimulationState: TypeAlias = Literal["stopped", "playing", "paused", "quitting"]

MOST_STEPS = 100_000
"""Control periods that a service steps at once; an action steps as many as it is asked for."""

_BY = "ros2"
_TAKES_S = 5.0
"""How long a run may take to apply a directive [s]: a period of a busy simulator is far shorter."""

_LOOK_S = 0.005

_REPORTS = 1000
"""An action reports at most so often, however many steps it takes."""

_OK, _FAILED = 1, 4


class ControlError(InputError):
    """What cannot be done in the present state of the simulation; the message says why."""


class SimulationControl:
    """Steers the run for services; its methods return when what they ask for is done.

    They are called in the listening thread, and handle the topics' messages while they wait.

    Args:
        context: The bridge.
    """

    def __init__(self, context: BridgeContext) -> None:
        self._context = context
        self._stopped_at: int | None = None
        self._quits = False

    @property
    def session(self) -> Session:
        """The present run.

        Raises:
            ControlError: If the first run has not begun.
        """
        session = self._context.session
        if session is None:
            raise ControlError("the first run has not begun")
        return session

    @property
    def is_paused(self) -> bool:
        """Whether the simulated time stands until somebody lets it go on."""
        report = self.session.steering
        return report is not None and report.paused

    @property
    def state(self) -> SimulationState:
        """What the simulation does now."""
        if self._quits or (self.session.outcome is not None and self.session.restart is None):
            return "quitting"
        if not self.is_paused:
            return "playing"
        return "stopped" if self._stopped_at == self._context.periods.count else "paused"

    def play(self) -> None:
        """Resume the simulated time."""
        self._do(Pause(False))

    def pause(self) -> None:
        """Pause the simulated time; a stopped simulation becomes paused."""
        self._stopped_at = None
        self._do(Pause(True))

    def stop(self) -> None:
        """Begin again, and let the time stand at the beginning."""
        self.reset(from_zero=True, paused=True)
        self._stopped_at = self._context.periods.count

    def quit(self) -> None:
        """End the run, and with it the bridge."""
        self._quits = True
        self._context.driver.steering.put(End("asked to quit over ROS 2"), by=_BY)

    def step(self, periods: int) -> None:
        """Drive so many control periods of a paused simulation, as fast as it can.

        Raises:
            ControlError: If it is not paused, they are too many, or the run ends.
        """
        if not self.is_paused:
            raise ControlError("the simulation is not paused: pause it first")
        if not 1 <= periods <= MOST_STEPS:
            raise ControlError(
                f"a service steps 1 to {MOST_STEPS} control periods at once, got {periods}; use the action"
            )
        done = threading.Event()
        counter, session = self._context.periods, self.session
        counter.expect(counter.count + periods, done.set)
        self._do(StepOnce(periods))
        self._wait(done, lambda: session.outcome is not None)
        if not done.is_set():
            raise ControlError("the run ended before all steps were driven")

    def reset(self, *, from_zero: bool = False, paused: bool | None = None) -> None:
        """Begin the run again: the robot and everything that moves where they were, without what was added.

        Args:
            from_zero: Let the clock begin at 0, too; else it goes on.
            paused: Whether it is paused then. If None, it stays as it is.

        Raises:
            ControlError: If the next run does not begin in time.
        """
        counter, steering = self._context.periods, self._context.driver.steering
        paused = self.is_paused if paused is None else paused
        runs = counter.runs
        if from_zero:
            self._context.clock.start_over()
        run = steering.run
        steering.put(Restart(), by=_BY, run=run)
        if paused:
            steering.put(Pause(True), by=_BY, run=run + 1)
        self._wait(None, lambda: counter.runs > runs and self.is_paused == paused, _TAKES_S)
        if counter.runs == runs:
            raise ControlError(f"the run did not begin again within {_TAKES_S:g} s")

    def reset_time(self) -> None:
        """Restart the clock at 0; the run goes on as it is."""
        self._context.clock.offset -= self._context.clock.now
        self._context.clock.now = 0.0

    def place(self, pose: Pose2D) -> None:
        """Put the robot somewhere else in the map frame, at rest.

        Raises:
            ControlError: If it would touch something there, or the simulator cannot do it.
        """
        self._do(PlaceRobot(*pose.as_tuple()))

    def _do(self, directive: Directive) -> None:
        """Give a directive, and wait until it was applied."""
        done, refused = threading.Event(), list[str]()

        def refuse(why: str) -> None:
            refused.append(why)
            done.set()

        self._context.driver.steering.put(directive, by=_BY, refused=refuse, applied=done.set)
        self._wait(done, lambda: False, _TAKES_S)
        if not done.is_set():
            raise ControlError(f"the run did not take it within {_TAKES_S:g} s")
        if refused:
            raise ControlError(refused[0])

    def _wait(self, event: threading.Event | None, over: Callable[[], bool], timeout_s: float = math.inf) -> None:
        """Wait for an event, until something is over, or for so long [s]; handle the topics' messages meanwhile."""
        wire, event = self._context.wire, threading.Event() if event is None else event
        until = clock.monotonic() + timeout_s
        while not (event.wait(_LOOK_S) or over() or wire.is_closing or clock.monotonic() > until):
            wire.take_topics()


class StepAction:
    """Steps as often as a goal asks for, and reports after each step; after a thousandth of them, if they are more.

    Args:
        context: The bridge.
        control: Steers the run.
        result: Makes a simulation_interfaces/Result from its code and message.
    """

    def __init__(self, context: BridgeContext, control: SimulationControl, result: Callable[[int, str], Any]) -> None:
        self._context, self._control, self._result = context, control, result
        self._goal: ActionGoal | None = None
        self._done = self._steps = 0
        self._asked, self._reached = 0, False
        context.wire.every_round(self._go_on)

    @property
    def is_busy(self) -> bool:
        """Whether a goal is carried out."""
        return self._goal is not None

    def accepts(self, request: Any) -> bool:
        """Return whether no other goal is carried out."""
        return self._goal is None

    def accepted(self, goal: ActionGoal) -> None:
        """Begin to step."""
        if not self._control.is_paused:
            goal.abort(result=self._result(_FAILED, "the simulation is not paused: pause it first"))
            return
        self._goal, self._done, self._steps = goal, 0, int(goal.request.steps)
        self._ask()

    def cancel(self, goal: ActionGoal) -> bool:
        """Stop after the steps that are under way, and return whether this goal is carried out."""
        return goal is self._goal

    def _ask(self) -> None:
        """Step as many periods as are reported at once, or end the goal if all are driven."""
        goal, left = self._goal, self._steps - self._done
        if goal is None:
            return
        if left <= 0:
            self._goal = None
            goal.succeed(result=self._result(_OK, ""))
            return
        periods = self._context.periods
        self._asked = min(left, max(1, self._steps // _REPORTS), 1_000_000)
        self._reached = False
        periods.expect(periods.count + self._asked, self._stepped)
        self._context.driver.steering.put(StepOnce(self._asked), by=_BY)

    def _stepped(self) -> None:
        self._reached = True
        self._context.wire.wake()

    def _go_on(self) -> None:
        goal = self._goal
        if goal is None:
            return
        if self._control.session.outcome is not None:
            self._goal = None
            goal.abort(result=self._result(_FAILED, "the run ended before all steps were driven"))
            return
        if goal.cancel_requested:
            self._goal = None
            self._context.driver.steering.put(Pause(True), by=_BY)
            goal.canceled(result=self._result(_FAILED, f"cancelled after {self._done} steps"))
            return
        if self._reached:
            self._done += self._asked
            goal.publish_feedback(completed_steps=self._done, remaining_steps=self._steps - self._done)
            self._ask()
