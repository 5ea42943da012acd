"""`StepAction`: the action SimulateSteps, which steps a paused simulation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from trundle.mission import Pause, StepOnce
from trundle.ros2.actions import ActionGoal
from trundle.ros2.role import BridgeContext
from trundle.ros2.simulation.control import SimulationControl

_BY = "ros2"
_REPORTS = 1000
_OK, _FAILED = 1, 4


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
        """Whether no other goal is carried out."""
        return self._goal is None

    def accepted(self, goal: ActionGoal) -> None:
        """Begin to step."""
        if not self._control.is_paused:
            goal.abort(result=self._result(_FAILED, "the simulation is not paused: pause it first"))
            return
        self._goal, self._done, self._steps = goal, 0, int(goal.request.steps)
        self._ask()

    def cancel(self, goal: ActionGoal) -> bool:
        """Stop after the steps that are under way."""
        return goal is self._goal

    def _ask(self) -> None:
        """Step as many as are reported at once; or end the goal, where none are left."""
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
