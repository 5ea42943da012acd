"""`Course`: the goals of a run; what its agent commands on the way to them, and how the run ends."""

from __future__ import annotations

import time as clock
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trundle.errors import InputError, PlanningError, PlanningStoppedError
from trundle.fault import check_result
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.mission.episode import Outcome
from trundle.mission.observers import RunInfo
from trundle.mission.rules import Rules
from trundle.mission.running import endings
from trundle.mission.running.endings import Ending
from trundle.mission.running.episode_maker import AgentTotals
from trundle.mission.running.goal_count import GoalCount
from trundle.mission.running.preparation import allowed_time
from trundle.navigation import Agent, NavigationStatus, Navigator, NavigatorSettings
from trundle.navigation.agents import check_command
from trundle.observation import Estimate, Observation
from trundle.path import Path
from trundle.sim import Contact, RobotState

FARTHEST_PATH_M = 1.5
"""A path that is given begins or passes within this of the robot [m]: half of Nav2's local costmap."""


@dataclass(frozen=True, slots=True)
class Moment:
    """What is known of a run before a control period.

    Attributes:
        state: Of the simulator: the truth.
        observation: What the robot observes.
        estimate: Where it believes to be.
        believed: The same by its localizer; None without one.
        hit: A contact that counts as a collision, or None.
    """

    state: RobotState
    observation: Observation
    estimate: Estimate
    believed: Pose2D | None
    hit: Contact | None


class Course:
    """Gives the agent its goals, counts those that are reached, and says how the run ends.

    Args:
        agent: What drives.
        info: The run, with its first goals and its time limit.
        legs: Lengths of the plans to these goals [m].
        unreachable: Why there is no path to the first goal, or None.
        through: Whether the robot drives through the goals without stopping, but for waypoints with tasks and the last.
        hands_over: Whether the agent has all goals at once, and counts them itself.
        rules: What else ends the run.
        stop_on_contact: Whether a contact ends it.
        extends: Whether another goal, and driving by hand, extend the time limit.
        waits: Whether a run without goals waits for some, and goes on after the last one.

    Attributes:
        totals: What the agent counted for the goals that were left or reached.
        time_limit_s: When the run is stopped [s].
        tick_s: Wall time [s] that the agent took for its last command; 0 while it is driven by hand.
        planning_s: Wall time [s] that it planned since the command before; at first, for the plans before the run.
    """

    def __init__(
        self,
        agent: Agent,
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
        self._agent, self._info, self._rules = agent, info, rules
        self._legs = [path.length for path in legs]
        self._unreachable = unreachable
        self._through, self._hands_over = through, hands_over
        self._at_first = through, hands_over
        self._is_idle = False
        self._stop_on_contact, self._extends, self._waits = stop_on_contact, extends, waits
        checker = getattr(agent, "goal_checker", None) or NavigatorSettings().make_goal_checker()
        self._count = GoalCount(info.goals, checker, through=through)
        self.totals = AgentTotals()
        self.time_limit_s = info.time_limit_s
        self.tick_s, self.planning_s = 0.0, getattr(agent, "planning_time_s", 0.0)
        self._planned_s = 0.0

    @property
    def goals(self) -> tuple[Goal, ...]:
        """All goals, in order."""
        return self._count.goals

    @property
    def reached(self) -> int:
        """How many of them are reached."""
        return self._count.reached

    @property
    def current(self) -> int:
        """Index of the goal that the robot drives to."""
        return self._count.current

    @property
    def is_done(self) -> bool:
        """Whether all goals are reached."""
        return self._count.are_reached

    @property
    def status(self) -> NavigationStatus:
        """What the agent is doing."""
        return self._agent.status

    @property
    def navigator(self) -> Navigator | None:
        """The agent, where it is a navigator."""
        return self._agent if isinstance(self._agent, Navigator) else None

    def need_navigator(self, lack: str) -> Navigator:
        """The navigator that drives.

        Raises:
            InputError: If something else does, which `lack` says of it.
        """
        if self.navigator is None:
            raise InputError(f"the agent of this run, {type(self._agent).__name__}, {lack}")
        return self.navigator

    @property
    def info(self) -> RunInfo:
        """The run, with the goals and the time limit that it has now."""
        if self.goals == self._info.goals and self.time_limit_s == self._info.time_limit_s:
            return self._info
        return replace(self._info, goals=self.goals, time_limit_s=self.time_limit_s, path_length_m=sum(self._legs))

    # Driving --------------------------------------------------------------------------------------------------------

    def next_command(self, now: Moment) -> Twist2D | Ending:
        """Ask the agent for a command; or how the run ends now."""
        if (ending := self._ending_before(now)) is not None:
            return ending
        agent, state, observation = self._agent, now.state, now.observation
        while True:
            command = self._ask(observation, now.estimate)
            status = agent.status
            if self._hands_over:
                if not self._count.count_passed(getattr(agent, "goals_reached", 0), state.pose, now.believed):
                    return endings.elsewhere(agent, state)
                if status is NavigationStatus.ARRIVED and not self._waits:
                    return self._at_goal(now)
            elif status is NavigationStatus.ARRIVED and not self._count.are_reached:
                if not self._count.count(state.pose, now.believed):
                    return endings.elsewhere(agent, state)
                if not self._count.are_reached:
                    self._begin((self._count.next,))
                    observation = replace(observation, scans=())  # the agent has them
                    continue
                if not self._waits:
                    return self._at_goal(now)
            gives_up = status is not NavigationStatus.DRIVING and not (self._waits or self._is_idle)
            if gives_up and (ending := endings.given_up(agent, state)) is not None:
                return ending
            return self._timed_out(state) or check_command(agent, command)

    def _ask(self, observation: Observation, estimate: Estimate) -> object:
        """The agent's command, not checked yet; and the wall times that it took."""
        planned, began = getattr(self._agent, "planning_time_s", 0.0), clock.perf_counter()
        command = self._agent.update(observation, estimate)
        self.tick_s = clock.perf_counter() - began
        self.planning_s = getattr(self._agent, "planning_time_s", 0.0) - planned + self._planned_s
        self._planned_s = 0.0
        return command

    def pass_by_hand(self, now: Moment, dt: float) -> Ending | None:
        """Note that a control period of this length [s] is driven by hand; or how the run ends now."""
        self.tick_s = self.planning_s = 0.0
        if self._extends:
            self.time_limit_s += dt
        return self._ending_before(now) or self._timed_out(now.state)

    def _ending_before(self, now: Moment) -> Ending | None:
        if self._unreachable is not None and now.hit is None:
            return Outcome.NO_PATH, str(self._unreachable)
        if now.hit is not None and self._stop_on_contact:
            return Outcome.COLLIDED, endings.describe_contact(now.hit, now.state.time)
        if not self._waits and (ending := endings.tipped_over(now.state)) is not None:
            return ending
        if self._count.is_near_last(now.state.pose, self._rules.arrival_radius):
            self._count.reached += 1
            return self._at_goal(now)
        return None

    def _at_goal(self, now: Moment) -> Ending:
        return endings.at_goal(now.state, now.estimate.pose if self._count.reached_by_estimate else None)

    def _timed_out(self, state: RobotState) -> Ending | None:
        return endings.timed_out(self.goals, self.time_limit_s) if state.time >= self.time_limit_s - 1e-9 else None

    @property
    def was_complete(self) -> bool:
        """Whether the last search that found no path was complete."""
        error = self._unreachable or getattr(self._agent, "error", None)
        return isinstance(error, PlanningError) and error.complete

    def ended_by_hand(self, why: str) -> Ending:
        """How a run ends that is ended by hand: finished, where it has no other end."""
        return (Outcome.FINISHED if self._waits else Outcome.ABORTED), why

    # Goals ----------------------------------------------------------------------------------------------------------

    def set_goal(self, goal: Goal, state: RobotState, estimate: Estimate, *, append: bool) -> None:
        """Drive to this goal instead of those that are left, or after them.

        Raises:
            InputError: If the agent drives without goals.
            PlanningError: If there is no path to it; the goals stay as they were.
        """
        if not isinstance(self._agent, Navigator) and not self._info.goals:
            raise InputError("the agent of this run drives without goals")
        if not append or self._count.are_reached:
            self._replace((goal,), state, estimate, self._at_first)
            return
        here = self.goals[-1].pose
        leg = self._plan_on(here, goal)
        self._put(len(self.goals), (goal,), leg)
        if self._extends:
            self.time_limit_s += self._allowed(here, (goal,), leg)
        if self._hands_over:
            self.set_again()

    def set_goals(self, goals: Sequence[Goal], state: RobotState, estimate: Estimate, *, through: bool) -> None:
        """Drive to these goals in order instead of those that are left, through them or with a stop at each.

        Raises:
            InputError: If the agent takes one goal at a time, or none.
            PlanningError: If there is no path; the goals stay as they were.
        """
        self.need_navigator("takes one goal at a time")
        self._replace(tuple(goals), state, estimate, (through, True))

    def follow(self, path: Path, state: RobotState, estimate: Estimate) -> None:
        """Follow this path to its end, instead of driving to the goals that are left.

        Raises:
            InputError: If the agent follows no given paths, or the path lies elsewhere.
        """
        navigator = self.need_navigator("follows no given path")
        here = estimate.pose
        off_m = float(np.hypot(path.poses[:, 0] - here.x, path.poses[:, 1] - here.y).min())
        if off_m > FARTHEST_PATH_M:
            raise InputError(
                f"no pose of the path is within {FARTHEST_PATH_M:g} m of the robot at ({here.x:.2f}, {here.y:.2f}): "
                f"the nearest is {off_m:.2f} m away"
            )
        self.totals.add(navigator)
        navigator.follow(path)
        self._through, self._hands_over = self._at_first
        self._put(self.reached, (Goal.of(path.goal),), path)
        self._count.begin_again()
        if self._extends:
            self.time_limit_s = state.time + self._allowed(here, self.goals[self.reached :], path)

    def cancel(self, *, behavior_alone: bool) -> None:
        """Give up the goals that are left and what the agent runs, or only the behavior that it was asked for.

        Raises:
            InputError: If the agent cannot.
        """
        navigator = self.need_navigator("cannot give up its goal")
        if behavior_alone:
            navigator.cancel_behavior()
            return
        self.totals.add(navigator)
        navigator.cancel()
        self._put(self.reached, (), None)
        self._is_idle = True

    def set_again(self) -> None:
        """Give the agent the goals that are left once more: it plans again, and measures its progress from here."""
        left = self.goals[self.reached :]
        navigator = self.navigator
        path = None if navigator is None or not navigator.follows_given else navigator.path_left
        if left and path is not None:
            self._follow_again(path)
        elif left:
            self._begin(left)

    def _follow_again(self, path: Path) -> None:
        navigator = self.need_navigator("follows no given path")
        self.totals.add(navigator)
        self._count.begin_again()
        navigator.follow(path)

    def _replace(self, goals: tuple[Goal, ...], state: RobotState, estimate: Estimate, how: tuple[bool, bool]) -> None:
        """Drive to these goals instead of those that are left; through them, and handed over at once, or not."""
        before, (self._through, self._hands_over) = (self._through, self._hands_over), how
        here = estimate.pose
        leg = self._begin_at(here, goals, before)
        self._put(self.reached, goals, leg)
        if self._extends:
            self.time_limit_s = state.time + self._allowed(here, goals, leg)

    def _put(self, done: int, goals: tuple[Goal, ...], leg: Path | None) -> None:
        """Keep so many goals, and put these after them, of which the plan is known up to the first stop."""
        self._is_idle = False
        self._count.replace((*self.goals[:done], *goals), through=self._through)
        self._legs[done:] = [0.0 if leg is None or k else leg.length for k in range(len(goals))]

    def _allowed(self, here: Pose2D, goals: Sequence[Goal], leg: Path | None) -> float:
        robot = getattr(self._agent, "robot", self._info.robot)
        return allowed_time(self._agent, robot, here, goals, () if leg is None else (leg,))

    def _begin(self, goals: Sequence[Goal]) -> None:
        """Give the agent these goals; only the first one, where it takes one at a time."""
        self.totals.add(self._agent)
        if not self._hands_over:
            self._agent.set_goal(goals[0])
            return
        self._count.begin_again()
        set_goals = getattr(self._agent, "set_goals")  # noqa: B009 - `prepare` has checked that it has that
        set_goals(goals, through=self._through)

    def _begin_at(self, here: Pose2D, goals: Sequence[Goal], before: tuple[bool, bool]) -> Path | None:
        """Give the agent these goals alone, and plan to them from here; None without a plan.

        Raises:
            PlanningError: If there is no path; the agent has its goals back, or the path that it was given, and takes
                them as it did before.
        """
        agent = self._agent
        given = agent.path_left if isinstance(agent, Navigator) and agent.follows_given else None
        self._begin(goals)
        if not isinstance(agent, Navigator):
            return None
        try:
            path = agent.plan(here)
        except PlanningError:
            if agent.waits_to_plan:  # the plan took too long, and is tried again
                return None
            agent.cancel()
            self._through, self._hands_over = before
            if given is not None:
                self._follow_again(given)
            else:
                self.set_again()
            raise
        self._planned_s = agent.planning_time_s
        return path

    def _plan_on(self, here: Pose2D, goal: Goal) -> Path | None:
        """The path of a navigator between two goals; None where there is none yet."""
        agent = self._agent
        if not isinstance(agent, Navigator):
            return None
        try:
            path = agent.planner.plan(agent.costmap, here, goal)
            return check_result(path, Path, agent.planner, "plan")
        except PlanningStoppedError:
            return None
        except PlanningError:
            if agent.has_map:
                raise
            return None
