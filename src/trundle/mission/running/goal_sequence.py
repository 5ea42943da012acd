"""`GoalSequence`: the goals of a run; what its agent commands on the way to them, and how the run ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from trundle.errors import InputError, PlanningError
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.mission.episode import Outcome
from trundle.mission.fields import Rules
from trundle.mission.observers import RunInfo
from trundle.mission.running import endings
from trundle.mission.running.endings import Ending
from trundle.mission.running.preparation import allowed_time
from trundle.mission.running.robot_stack import RobotStack
from trundle.mission.running.run_log import AgentTotals
from trundle.navigation import AgentReport, NavigationStatus, NavigatorSettings
from trundle.navigation.agents import check_command
from trundle.navigation.goal_queue import tasks_of
from trundle.navigation.state import FINAL
from trundle.path import Path
from trundle.sim import RobotState

FARTHEST_PATH_M = 1.5
"""A path that is given begins or passes within this of the robot [m]: half of Nav2's local costmap."""


STANDING_MPS, STANDING_RADPS = 0.01, 0.02
"""A robot below these speeds stands: it would be stopped within a millimetre."""


class GoalSequence:
    """Gives the agent its goals, counts those that are reached, and says how the run ends.

    Args:
        stack: The robot's software.
        info: The run, with its first goals and its time limit.
        legs: The plans to these goals.
        unreachable: Why there is no path to the first goal, or None.
        through: Whether the robot drives through the goals without stopping, but for waypoints with tasks and the last.
        hands_over: Whether the agent has all goals at once, and counts them itself.
        rules: What else ends the run.
        stop_on_contact: Whether a contact ends it.
        extends: Whether another goal, and driving by hand, extend the time limit.
        waits: Whether a run without goals waits for some, and goes on after the last one.

    Attributes:
        goals: All goals, in order.
        reached: How many of them are reached.
        totals: What the agent counted for the goals that were left or reached.
        time_limit_s: When the run is stopped [s].
        goes_on: Whether the run goes on where its goals are reached or given up; see `WaitAtGoal`.
    """

    def __init__(
        self,
        stack: RobotStack,
        info: RunInfo,
        legs: Sequence[Path],
        unreachable: PlanningError | None,
        *,
        through: bool,
        hands_over: bool,
        rules: Rules,
        stop_on_contact: bool,
        extends: bool,
        waits: bool,
    ) -> None:
        self._stack, self._agent, self._info, self._rules = stack, stack.agent, info, rules
        self._legs = [path.length for path in legs]
        self._unreachable = unreachable
        self._through, self._hands_over = through, hands_over
        self._at_first = through, hands_over
        self._is_idle = False
        self._stop_on_contact, self._extends, self._waits = stop_on_contact, extends, waits
        self._checker = self._agent.info().goal_checker or NavigatorSettings().make_goal_checker()
        self.goals, self.reached = tuple(info.goals), 0
        self._reached_before = 0
        """How many were reached when the agent got those that were left, which it counts from none."""
        self._is_by_estimate = False
        """Whether one of them was reached only by the localizer's estimate."""
        self._planned_s = 0.0
        """Wall time [s] of a plan that was made as a goal was set; the next command has it."""
        self.totals = AgentTotals()
        self.time_limit_s = info.time_limit_s
        self.goes_on = False

    @property
    def current(self) -> int:
        """Index of the goal that the robot drives to; of the last one at the end, whose tasks may still run."""
        return min(self.reached, max(0, len(self.goals) - 1))

    @property
    def is_done(self) -> bool:
        """Whether all goals are reached."""
        return self.reached >= len(self.goals)

    @property
    def info(self) -> RunInfo:
        """The run, with the goals and the time limit that it has now."""
        if self.goals == self._info.goals and self.time_limit_s == self._info.time_limit_s:
            return self._info
        return replace(self._info, goals=self.goals, time_limit_s=self.time_limit_s, path_length_m=sum(self._legs))

    # Driving --------------------------------------------------------------------------------------------------------

    def next_command(self, state: RobotState) -> Twist2D | Ending:
        """Ask the agent for a command; or how the run ends now.

        An agent that has arrived at one of several goals gets the next one, and is asked again at the same time.

        Args:
            state: State of the simulator now: the truth.
        """
        if (ending := self._ending_before(state)) is not None:
            return ending
        stack = self._stack
        observation = stack.observation
        while True:
            command = stack.command(observation)
            stack.planning_s += self._planned_s
            self._planned_s = 0.0
            arrived = stack.report.status is NavigationStatus.ARRIVED
            if self._hands_over:
                if not self._count_passed(stack.report.goals_reached, state.pose):
                    return endings.elsewhere(self._agent, state)
                if arrived and not (self._waits or self.goes_on):
                    return self._at_goal(state)
            elif arrived and not self.is_done:
                if not self._is_at(self.goals[self.reached], state.pose):
                    return endings.elsewhere(self._agent, state)
                self.reached += 1
                if not self.is_done:
                    self._begin((self.goals[self.reached],))
                    observation = replace(observation, scans=())  # the agent has them
                    continue
                if not (self._waits or self.goes_on):
                    return self._at_goal(state)
            is_driving = stack.report.status is NavigationStatus.DRIVING
            may_end = not (is_driving or self._waits or self.goes_on or self._is_idle)
            if may_end and (ending := endings.given_up(stack.report, state)) is not None:
                return ending
            if (ending := self._timed_out(state)) is not None:
                return ending
            return command if isinstance(command, Twist2D) else check_command(self._agent, command)

    def pass_by_hand(self, state: RobotState, dt: float) -> Ending | None:
        """Count a control period of this length [s] that is driven by hand; return how the run ends, if it does."""
        if self._extends:
            self.time_limit_s += dt
        return self._ending_before(state) or self._timed_out(state)

    def _ending_before(self, state: RobotState) -> Ending | None:
        hit = self._stack.log.hit
        if self._unreachable is not None and hit is None:
            return Outcome.NO_PATH, str(self._unreachable)
        if hit is not None and self._stop_on_contact:
            return Outcome.COLLIDED, endings.describe_contact(hit, state.time)
        if state.tilt >= endings.TIPPED_RAD and not self._waits:
            return endings.tipped_over(state)
        radius = self._rules.arrival_radius
        if radius is None or self.goes_on or self.reached + 1 != len(self.goals):
            return None
        if state.pose.distance_to(self.goals[-1].pose) > radius:
            return None
        self.reached += 1
        return self._at_goal(state)

    def _count_passed(self, reached: int, pose: Pose2D) -> bool:
        """Count the goals that the agent has reached or passed; False where it is not at one at which it stops."""
        while self.reached < min(self._reached_before + reached, len(self.goals)):
            goal = self.goals[self.reached]
            is_stop = not self._through or bool(tasks_of(goal)) or self.reached == len(self.goals) - 1
            if is_stop and not self._is_at(goal, pose):
                return False
            self.reached += 1
        return True

    def _is_at(self, goal: Goal, pose: Pose2D) -> bool:
        """Return whether the robot is at a goal, truly or by its estimate; the latter is noted."""
        if self._checker.is_within(pose, goal.pose, any_yaw=goal.yaw_free):
            return True
        believed = self._stack.believed
        if believed is None or not self._checker.is_within(believed, goal.pose, any_yaw=goal.yaw_free):
            return False
        self._is_by_estimate = True
        return True

    def _at_goal(self, state: RobotState) -> Ending:
        return endings.at_goal(state, self._stack.estimate.pose if self._is_by_estimate else None)

    def _timed_out(self, state: RobotState) -> Ending | None:
        if self.goes_on and self._extends:
            return None
        return endings.timed_out(self.goals, self.time_limit_s) if state.time >= self.time_limit_s - 1e-9 else None

    def was_complete(self, report: AgentReport) -> bool:
        """Return whether the last search that found no path was complete, by what the agent reports at the end."""
        error = self._unreachable or report.error
        return isinstance(error, PlanningError) and error.complete

    def ended_by_hand(self, why: str) -> Ending:
        """Return how a run ends that is ended by hand: finished, where it has no other end."""
        return (Outcome.FINISHED if self._waits else Outcome.ABORTED), why

    def arrived_before(self, why: str, state: RobotState) -> Ending | None:
        """Return the end by hand of a run that waited at its last goal; None if the robot is elsewhere."""
        if not (self.goes_on and self.goals and self.is_done) or not self.rests(state):
            return None
        last, places = self.goals[-1], (state.pose, self._stack.believed)
        if not any(self._checker.is_within(at, last.pose, any_yaw=last.yaw_free) for at in places if at is not None):
            return None
        outcome, message = self._at_goal(state)
        return outcome, f"{message}; {why}"

    def rests(self, state: RobotState) -> bool:
        """Return whether the robot stands, and has nothing to do until there is another goal."""
        status, twist = self._stack.report.status, state.twist
        is_over = status in FINAL or (status is NavigationStatus.IDLE and self.is_done)
        return is_over and abs(twist.v) < STANDING_MPS and abs(twist.w) < STANDING_RADPS

    # Goals ----------------------------------------------------------------------------------------------------------

    def set_goal(self, goal: Goal, state: RobotState, *, append: bool) -> None:
        """Drive to this goal instead of those that are left, or after them.

        Raises:
            InputError: If the agent drives without goals.
            PlanningError: If there is no path to it; the goals stay as they were.
        """
        if not self._agent.needs_goal and not self._info.goals:
            raise InputError("the agent of this run drives without goals")
        if not append or self.is_done:
            self._replace((goal,), state, self._at_first)
            return
        here = self.goals[-1].pose
        leg = self._agent.plan_between(here, goal)
        self._put(len(self.goals), (goal,), leg)
        if self._extends:
            self.time_limit_s += self._allowed(here, (goal,), leg)
        if self._hands_over:
            self.set_again()

    def set_goals(self, goals: Sequence[Goal], state: RobotState, *, through: bool) -> None:
        """Drive to these goals in order instead of those that are left, through them or with a stop at each.

        Raises:
            InputError: If the agent takes one goal at a time, or none.
            PlanningError: If there is no path; the goals stay as they were.
        """
        self._replace(tuple(goals), state, (through, True))

    def follow(self, path: Path, state: RobotState) -> None:
        """Follow this path to its end, instead of driving to the goals that are left.

        Raises:
            InputError: If the agent follows no given paths, or the path lies elsewhere.
        """
        here = self._stack.estimate.pose
        off_m = float(np.hypot(path.poses[:, 0] - here.x, path.poses[:, 1] - here.y).min())
        if off_m > FARTHEST_PATH_M:
            raise InputError(
                f"no pose of the path is within {FARTHEST_PATH_M:g} m of the robot at ({here.x:.2f}, {here.y:.2f}): "
                f"the nearest is {off_m:.2f} m away"
            )
        self._follow(path)
        self._through, self._hands_over = self._at_first
        self._put(self.reached, (Goal.of(path.goal),), path)
        self._reached_before = self.reached
        if self._extends:
            self.time_limit_s = state.time + self._allowed(here, self.goals[self.reached :], path)

    def cancel(self) -> None:
        """Give up the goals that are left and what the agent runs.

        Raises:
            InputError: If the agent cannot.
        """
        report = self._agent.report()
        self._agent.cancel()
        self._stack.ask_report()
        self.totals.add(report)
        self._put(self.reached, (), None)
        self._is_idle = True

    def set_again(self) -> None:
        """Give the agent the goals that are left once more: it plans again, and measures its progress from here."""
        left = self.goals[self.reached :]
        if not left:
            return
        path = self._agent.path_left if self._agent.report().follows_given else None
        if path is None:
            self._begin(left)
        else:
            self._follow(path)
            self._reached_before = self.reached

    def _replace(self, goals: tuple[Goal, ...], state: RobotState, how: tuple[bool, bool]) -> None:
        """Drive to these goals instead of those that are left; through them, and handed over at once, or not."""
        before, (self._through, self._hands_over) = (self._through, self._hands_over), how
        here = self._stack.estimate.pose
        try:
            leg = self._begin_at(here, goals, before)
        except BaseException:
            self._through, self._hands_over = before
            raise
        self._put(self.reached, goals, leg)
        if self._extends:
            self.time_limit_s = state.time + self._allowed(here, goals, leg)

    def _put(self, done: int, goals: tuple[Goal, ...], leg: Path | None) -> None:
        """Keep so many goals, and put these after them, of which the plan is known up to the first stop."""
        self._is_idle = False
        self.goals = (*self.goals[:done], *goals)
        self._legs[done:] = [0.0 if leg is None or k else leg.length for k in range(len(goals))]

    def _allowed(self, here: Pose2D, goals: Sequence[Goal], leg: Path | None) -> float:
        return allowed_time(self._agent, self._stack.robot, here, goals, () if leg is None else (leg,))

    def _begin(self, goals: Sequence[Goal]) -> None:
        """Give the agent these goals; only the first one, where it takes one at a time."""
        report = self._agent.report()
        if self._hands_over:
            self._agent.set_goals(goals, through=self._through)
            self._reached_before = self.reached
        else:
            self._agent.set_goal(goals[0])
        self.totals.add(report)
        self._stack.ask_report()

    def _follow(self, path: Path) -> None:
        report = self._agent.report()
        self._agent.follow(path)
        self._stack.ask_report()
        self.totals.add(report)

    def _begin_at(self, here: Pose2D, goals: Sequence[Goal], before: tuple[bool, bool]) -> Path | None:
        """Give the agent these goals alone, and plan to them from here; None without a plan.

        Raises:
            PlanningError: If there is no path; the agent has its goals back, or the path that it was given, and takes
                them as it did before.
        """
        agent = self._agent
        given = agent.path_left if agent.report().follows_given else None
        self._begin(goals)
        try:
            path = agent.plan(here)
        except PlanningError:
            if agent.report().waits_to_plan:  # the plan took too long, and is tried again
                return None
            agent.cancel()
            self._through, self._hands_over = before
            if given is None:
                self.set_again()
            else:
                self._follow(given)
                self._reached_before = self.reached
            raise
        self._stack.ask_report()
        if path is not None:
            self._planned_s = self._stack.report.planning_time_s
        return path
