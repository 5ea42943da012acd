"""`GoalQueue`: the goals of a drive with their tasks, and the behaviors that a program asks for."""

from __future__ import annotations

from collections.abc import Sequence

from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.navigation.behavior_runner import BehaviorRunner
from trundle.navigation.behaviors import Behavior
from trundle.navigation.behaviors.behavior import ASKED_FOR
from trundle.navigation.drive import Drive, Now
from trundle.navigation.recovery import Recovery
from trundle.navigation.replanner import Replanner
from trundle.navigation.status import FINAL, NavigationStatus
from trundle.navigation.waypoint import Route, tasks_of

_STAND = Twist2D()


class Agenda:
    """Says which goals are next, and runs the tasks of each goal and what is asked for in between.

    Args:
        drive: The drive, whose status and next goals it keeps.
        runner: Runs behaviors.
        replanner: Plans to the next goals.
        recovery: Starts over at each of them.
    """

    def __init__(self, drive: Drive, runner: BehaviorRunner, replanner: Replanner, recovery: Recovery) -> None:
        self._drive, self._runner, self._replanner, self._recovery = drive, runner, replanner, recovery
        self._tasks = Tasks(runner)
        self.begin(None)

    def begin(self, route: Route | None) -> None:
        """Start over with these goals."""
        self._tasks.reset()
        self._resumes = self._is_at_stop = False
        self._route = route
        if route is not None:
            self._aim(route)

    @property
    def goals(self) -> tuple[Goal, ...]:
        """All goals, in order."""
        return () if self._route is None else self._route.goals

    @property
    def goals_reached(self) -> int:
        """How many of them were reached or passed."""
        return 0 if self._route is None else self._route.index + self._is_at_stop

    def _aim(self, route: Route) -> None:
        """Drive to the next goals of a route."""
        drive = self._drive
        drive.ahead, drive.target, drive.first_number = route.ahead, route.ahead[0], route.index + 1

    # Behaviors ------------------------------------------------------------------------------------------------------

    def ask(self, behavior: Behavior) -> None:
        """Run a behavior next; one that runs is interrupted."""
        drive = self._drive
        if drive.status is not NavigationStatus.BEHAVING:
            self._resumes = drive.target is not None and drive.status not in FINAL
        self._runner.interrupt(f"{behavior.name} was asked for")
        self._tasks.ask(behavior)
        drive.status = NavigationStatus.BEHAVING

    def drop(self) -> None:
        """End what was asked for, and drive on to the goal."""
        drive = self._drive
        if drive.status is not NavigationStatus.BEHAVING:
            return
        self._runner.interrupt("cancelled")
        self._tasks.drop_asked()
        if self._tasks.is_active:
            return
        if self._resumes and not self._is_at_stop:
            self._drive_on()
        else:
            drive.status = NavigationStatus.IDLE if drive.target is None else NavigationStatus.FINISHED

    def run_tasks(self, now: Now) -> Twist2D | None:
        """The command of the task that is running; None where there is none, or the last one has ended."""
        if not self._tasks.is_active:
            return None
        command = self._tasks.step(now)
        if command is None:
            self._end_tasks()
        return command

    def _end_tasks(self) -> None:
        """Drive on to the next goal, or say how a behavior without one ended."""
        drive, failure = self._drive, self._tasks.failure
        drive.message = failure
        if self._is_at_stop and not failure:
            self._leave_stop()
        elif self._resumes and not self._is_at_stop:
            self._drive_on()
        else:
            drive.status = NavigationStatus.STUCK if failure else NavigationStatus.FINISHED

    def _drive_on(self) -> None:
        """Plan again, as the robot is somewhere else or has another goal."""
        self._drive.status = NavigationStatus.DRIVING
        self._drive.progress_checker.reset()
        if not self._replanner.is_given:
            self._replanner.drop_path()
        self._recovery.reset()

    # Goals ----------------------------------------------------------------------------------------------------------

    def pass_goals(self, pose: Pose2D) -> None:
        """Count the goals that the robot drives through as it passes them."""
        drive, route = self._drive, self._route
        while (
            route is not None
            and len(drive.ahead) > 1
            and pose.distance_to(drive.ahead[0].pose) <= drive.settings.through_tolerance
        ):
            route.advance()
            self._aim(route)
            self._replanner.pass_goal()

    def stop_at_goal(self, now: Now) -> Twist2D:
        """Run the tasks of the goal that is reached, or drive on to the next one."""
        drive = self._drive
        self._runner.interrupt("the goal is reached")
        self._is_at_stop = True
        tasks = () if drive.target is None else tasks_of(drive.target)
        if not tasks:
            self._leave_stop()
            return _STAND
        drive.status = NavigationStatus.BEHAVING
        self._tasks.add(tasks, f"task of goal {drive.first_number}")
        return self.run_tasks(now) or _STAND

    def _leave_stop(self) -> None:
        """Drive to the next goals, or say that the last one is reached."""
        if self._route is None or not self._route.advance():
            self._drive.status = NavigationStatus.ARRIVED
            return
        self._is_at_stop = False
        self._aim(self._route)
        self._replanner.budget.reset()
        self._drive_on()


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
