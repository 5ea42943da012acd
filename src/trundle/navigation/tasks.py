"""`Tasks`: behaviors that run on their own: one that a program asks for, and those of the waypoint that was reached."""

from __future__ import annotations

from collections.abc import Sequence

from trundle.geometry import Twist2D
from trundle.navigation.behavior_runner import BehaviorRunner
from trundle.navigation.behaviors import Behavior
from trundle.navigation.behaviors.behavior import ASKED_FOR
from trundle.navigation.drive import Now


class Tasks:
    """Runs what was asked for, and then the tasks of the waypoint, in order. The first one that fails ends them all.

    Args:
        runner: Runs each.

    Attributes:
        failure: What failed, and why; empty where nothing did.
    """

    def __init__(self, runner: BehaviorRunner) -> None:
        self._runner = runner
        self.reset()

    def reset(self) -> None:
        """Forget them."""
        self.failure = ""
        self._asked: Behavior | None = None
        self._tasks: list[Behavior] = []
        self._reason = ""
        self._is_running = False

    def ask(self, behavior: Behavior) -> None:
        """Run this one next, before the tasks that are left; one that is running begins again after it."""
        self.failure = ""
        self._asked, self._is_running = behavior, False

    def drop_asked(self) -> None:
        """Do without what was asked for; a task that it interrupted begins again."""
        self.failure = ""
        self._asked, self._is_running = None, False

    def add(self, tasks: Sequence[Behavior], reason: str) -> None:
        """Run these, for this reason."""
        self.failure = ""
        self._tasks, self._reason = list(tasks), reason

    @property
    def is_active(self) -> bool:
        """Whether there is something to run."""
        return self._asked is not None or bool(self._tasks)

    def step(self, now: Now) -> Twist2D | None:
        """The command for the next control period; None when all are done, or one has failed."""
        command = self._runner.step(now) if self._is_running else None
        while command is None:
            if self._is_running and not self._succeeded():
                return None
            if not self.is_active:
                return None
            behavior, reason = (self._asked, ASKED_FOR) if self._asked is not None else (self._tasks[0], self._reason)
            self._is_running = True
            command = self._runner.start(behavior, reason, now, recovery=False)
        return command

    def _succeeded(self) -> bool:
        """Take what has ended off the list; whether it did what it should."""
        run = self._runner.runs[-1]
        self._is_running = False
        if self._asked is not None:
            self._asked = None
        else:
            self._tasks.pop(0)
        if run.result == "succeeded":
            return True
        self._tasks = []
        self.failure = f"{run.behavior} ({run.reason}) failed: {run.message}"
        return False
