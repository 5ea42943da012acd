"""`Waypoint`, a goal with tasks; `Route`, goals in order; and `GoalQueue`, which drives through them and runs tasks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Self, cast

from trundle.errors import InputError
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.navigation.behaviors import Behavior
from trundle.navigation.behaviors.behavior import ASKED_FOR, check_behavior_kind
from trundle.navigation.recovery import BehaviorRunner, Recovery
from trundle.navigation.replanner import Replanner
from trundle.navigation.state import NOTHING, Decision, DriveState, NavigationStatus, Snapshot


class Waypoint(Goal):
    """A goal where the robot stops, and runs tasks before it drives on: `Waypoint(5, 3, tasks=[Wait(2), Spin(1.57)])`.

    A waypoint is a `Goal`: equal to the tuple (x, y, yaw), or (x, y) for any yaw.

    Attributes:
        tasks: Behaviors, run in this order when the goal is reached.
    """

    tasks: tuple[Behavior, ...]

    def __new__(cls, x: float, y: float, yaw: float | None = None, *, tasks: Iterable[Behavior] = ()) -> Self:
        """Check the numbers and the tasks.

        Args:
            x: [m], map frame.
            y: [m], map frame.
            yaw: [rad]; None for any.
            tasks: Behaviors, run in this order when the goal is reached.

        Raises:
            InputError: If a number is NaN or infinite, or a task is no behavior.
        """
        made = super().__new__(cls, x, y, yaw)
        made.tasks = tuple(tasks)
        for task in made.tasks:
            check_behavior_kind(task)
        return made

    def __repr__(self) -> str:
        return f"{super().__repr__()[:-1]}, tasks={list(self.tasks)})".replace("Goal(", "Waypoint(", 1)


def tasks_of(goal: Goal) -> tuple[Behavior, ...]:
    """Return the tasks of a waypoint; another goal has none."""
    return goal.tasks if isinstance(goal, Waypoint) else ()


class Route:
    """Goals in order, and how far the robot has come.

    Args:
        goals: The goals.
        through: Whether the robot drives through them without stopping, but for waypoints with tasks and the last.

    Attributes:
        goals: The same.
        index: Index of the goal that it drives to.

    Raises:
        InputError: If there is no goal, or one is no pose.
    """

    def __init__(self, goals: Sequence[Pose2D | Sequence[float]], *, through: bool = False) -> None:
        if isinstance(goals, str | Pose2D) or not isinstance(cast("object", goals), Iterable):
            raise InputError(f"goals are a list of poses, [(5.0, 3.5), (8.0, 1.0, 1.57)]; got {goals!r}")
        self.goals = tuple(Goal.of(goal) for goal in goals)
        if not self.goals:
            raise InputError("give at least one goal")
        self._through = through
        self.index = 0

    def is_stop(self, index: int) -> bool:
        """Return whether the robot stops at this goal."""
        return not self._through or index == len(self.goals) - 1 or bool(tasks_of(self.goals[index]))

    @property
    def ahead(self) -> tuple[Goal, ...]:
        """The goals from the one that it drives to up to the next stop."""
        end = next(index for index in range(self.index, len(self.goals)) if self.is_stop(index))
        return self.goals[self.index : end + 1]

    def advance(self) -> bool:
        """Drive to the next goal from now on; False if this was the last one."""
        if self.index == len(self.goals) - 1:
            return False
        self.index += 1
        return True

    def describe(self, index: int) -> str:
        """Return a goal in words, such as "goal 2 of 4 (5.00, 3.50)"."""
        goal = self.goals[index]
        return f"goal {index + 1} of {len(self.goals)} ({goal.x:.2f}, {goal.y:.2f})"


_STAND = Twist2D()


class GoalQueue:
    """Says which goals are next, and runs the tasks of each goal and what is asked for in between.

    Args:
        runner: Runs behaviors.
        replanner: Plans to the next goals.
        recovery: Starts over at each of them.
        through_tolerance: A goal that the robot drives through is passed within this distance [m].
    """

    def __init__(
        self, runner: BehaviorRunner, replanner: Replanner, recovery: Recovery, through_tolerance: float
    ) -> None:
        self._runner, self._replanner, self._recovery = runner, replanner, recovery
        self._through_tolerance = through_tolerance
        self._tasks = _Tasks(runner)
        self.begin(None)

    def begin(self, route: Route | None) -> None:
        """Start over with these goals."""
        self._tasks.reset()
        self._resumes = self._is_at_stop = False
        self._route = route

    @property
    def goals(self) -> tuple[Goal, ...]:
        """All goals, in order."""
        return () if self._route is None else self._route.goals

    @property
    def goals_reached(self) -> int:
        """How many of them were reached or passed."""
        return 0 if self._route is None else self._route.index + self._is_at_stop

    # Behaviors ------------------------------------------------------------------------------------------------------

    @property
    def has_tasks(self) -> bool:
        """Whether there is a behavior to run that was asked for, or a task of the goal that was reached."""
        return self._tasks.is_active

    def ask(self, behavior: Behavior, state: DriveState) -> Decision:
        """Run a behavior next; one that runs is interrupted."""
        if state.status is not NavigationStatus.BEHAVING:
            self._resumes = state.target is not None and not state.is_final
        self._runner.interrupt(f"{behavior.name} was asked for")
        self._tasks.ask(behavior)
        return Decision(status=NavigationStatus.BEHAVING)

    def drop(self, state: DriveState) -> Decision:
        """End what was asked for, and drive on to the goal."""
        if state.status is not NavigationStatus.BEHAVING:
            return NOTHING
        self._runner.interrupt("cancelled")
        self._tasks.ask(None)
        if self._tasks.is_active:
            return NOTHING
        if self._resumes and not self._is_at_stop:
            return self._drive_on()
        return Decision(status=NavigationStatus.IDLE if state.target is None else NavigationStatus.FINISHED)

    def run_tasks(self, now: Snapshot, state: DriveState) -> Decision:
        """Run the next task; the decision has its command, and none where the last task has ended."""
        ran = self._tasks.step(now, state)
        if ran.command is None:
            return ran.then(self._end_tasks())
        return ran if ran.status is None else ran._replace(status=None)  # also where it has planned, it is BEHAVING

    def _end_tasks(self) -> Decision:
        """Drive on to the next goal, or say how a behavior without one ended."""
        failure = self._tasks.failure
        said = Decision(message=failure)
        if self._is_at_stop and not failure:
            return said.then(self._leave_stop())
        if self._resumes and not self._is_at_stop:
            return said.then(self._drive_on())
        return Decision(message=failure, status=NavigationStatus.STUCK if failure else NavigationStatus.FINISHED)

    def _drive_on(self) -> Decision:
        """Plan again, as the robot is somewhere else or has another goal."""
        if not self._replanner.is_given:
            self._replanner.drop_path()
        self._recovery.reset()
        return Decision(status=NavigationStatus.DRIVING, restarts_progress=True)

    # Goals ----------------------------------------------------------------------------------------------------------

    def pass_goals(self, pose: Pose2D, state: DriveState) -> Decision:
        """Count the goals that the robot drives through as it passes them."""
        route, ahead = self._route, state.ahead
        while route is not None and len(ahead) > 1 and pose.distance_to(ahead[0].pose) <= self._through_tolerance:
            route.advance()
            ahead = route.ahead
            self._replanner.pass_goal()
        return NOTHING if route is None or ahead is state.ahead else _aim(route)

    def stop_at_goal(self, now: Snapshot, state: DriveState) -> Decision:
        """Run the tasks of the goal that is reached, or drive on to the next one."""
        self._runner.interrupt("the goal is reached")
        self._is_at_stop = True
        tasks = () if state.target is None else tasks_of(state.target)
        if not tasks:
            return self._leave_stop().then(Decision(_STAND))
        self._tasks.add(tasks, f"task of goal {state.first_number}")
        began = Decision(_STAND, status=NavigationStatus.BEHAVING)
        return began.then(self.run_tasks(now, state.after(began)))

    def _leave_stop(self) -> Decision:
        """Drive to the next goals, or say that the last one is reached."""
        if self._route is None or not self._route.advance():
            return Decision(status=NavigationStatus.ARRIVED)
        self._is_at_stop = False
        self._replanner.budget.reset()
        return _aim(self._route).then(self._drive_on())


def _aim(route: Route) -> Decision:
    """Drive to the next goals of a route."""
    return Decision(ahead=route.ahead, first_number=route.index + 1)


class _Tasks:
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

    def ask(self, behavior: Behavior | None) -> None:
        """Run this one next, before the tasks that are left; one that is running begins again after it.

        If None, what was asked for before is left out, and a task that it interrupted begins again.
        """
        self.failure = ""
        self._asked, self._is_running = behavior, False

    def add(self, tasks: Sequence[Behavior], reason: str) -> None:
        """Run these, for this reason."""
        self.failure = ""
        self._tasks, self._reason = list(tasks), reason

    @property
    def is_active(self) -> bool:
        """Whether there is something to run."""
        return self._asked is not None or bool(self._tasks)

    def step(self, now: Snapshot, state: DriveState) -> Decision:
        """Run the current task; the decision has the next command, or none when all are done or one has failed."""
        ran = self._runner.step(now, state) if self._is_running else NOTHING
        while ran.command is None:
            if self._is_running and not self._take_result():
                return ran
            if not self.is_active:
                return ran
            behavior, reason = (self._asked, ASKED_FOR) if self._asked is not None else (self._tasks[0], self._reason)
            self._is_running = True
            ran = ran.then(self._runner.start(behavior, reason, now, state.after(ran), recovery=False))
        return ran

    def _take_result(self) -> bool:
        """Remove the behavior that has ended from the list; return whether it succeeded."""
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
