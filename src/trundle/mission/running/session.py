"""`Session`: one run that can be stepped, in which an agent drives a simulator and observers are notified."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Self

from trundle.control.latency import Latency
from trundle.errors import PlanningError, ScenarioError, SimulationError, TrundleError
from trundle.fault import is_of_plugin, note_folder
from trundle.geometry import Pose2D, Twist2D
from trundle.localization import create_localizer
from trundle.localization.localizer import LocalizerLike
from trundle.mission.episode import Episode, Outcome
from trundle.mission.fields import Rules, StartError
from trundle.mission.metrics import Measure, measure_truth
from trundle.mission.observers import Observer, Observers, RunInfo, SteeringReport, Step
from trundle.mission.running.control_loop import ControlLoop
from trundle.mission.running.endings import Ending, RunEnd
from trundle.mission.running.episode_maker import conclude
from trundle.mission.running.goal_sequence import GoalSequence
from trundle.mission.running.preparation import (
    allowed_time,
    delay_commands,
    describe_early,
    describe_run,
    prepare,
    read_goals,
    standing_at,
)
from trundle.mission.running.robot_stack import RobotStack, SomeMonitor
from trundle.mission.running.run_log import RunLog
from trundle.mission.steering.directive_executor import DirectiveExecutor
from trundle.mission.steering.directives import GivenDirective, Restart
from trundle.mission.steering.queue import Steering
from trundle.navigation import Agent
from trundle.navigation.agent import CONTROL_PERIOD_S
from trundle.navigation.agents import AgentLike, create_agent
from trundle.navigation.goal_queue import tasks_of
from trundle.observation import Estimate
from trundle.sim import RobotState
from trundle.sim.simulator import SomeSimulator, as_simulator
from trundle.values import as_number, check_kind, check_number


class Session:
    """One run in progress. `trundle.run` steps one to its end; step it yourself to see or change things in between.

    The run starts when the session is made: the agent plans, the simulator is reset, and observers get the start. Then
    every `step` is one control period: the agent gets what the robot observes and estimates, its command passes the
    collision monitor, and the simulator moves the robot. Use it in a `with` block, which ends the run; the simulator is
    not closed.

        with trundle.Session(sim, navigator, start, goal) as session:
            while (step := session.step()) is not None:
                print(step.state.pose, step.estimate.pose)
        episode = session.finish()

    Args:
        sim: What moves the robot.
        agent: What drives it: a navigator or another agent, whose goal is replaced; or the class or the name of one, or
            a function (observation, estimate); see `AgentLike`.
        start: The start: a pose, (x, y) or (x, y, yaw); map frame.
        goal: The goal: a pose, (x, y) for any yaw, or (x, y, yaw); or a list of these. None for an agent without a
            goal, not a navigator, which drives until it is FINISHED.
        localizer: Estimates the robot's pose: a localizer, a class, a function or a name; see `LocalizerLike`. None
            means that the agent gets the true pose.
        start_error: How far the start that the localizer is told is from the true one. None means not at all.
        latency: How late scans and commands arrive; reported to the agent by `set_latency`.
        monitor: The collision monitor that every command passes. None means a `CollisionMonitor` from the first scan
            on, True one from the start, and False none.
        time_limit_s: Simulated time [s] at which the run is stopped. If None, 60 s for every goal plus four times
            what the planned paths take at the robot's top speed, or at what a speed mask allows, and what the tasks of
            waypoints may take. A path that is planned after a first scan counts as four straight lines. Without a goal
            it means no limit.
        observers: Notified in this order.
        seed: Seed of the simulator, the agent and the localizer.
        stop_on_contact: Whether the first contact ends the run. A run with a contact is `collided` either way.
        rules: What else ends the run; None means nothing.
        name: Name of the run.
        measure: Measures the surroundings for the metrics; None means that they are not measured.
        through: Whether the robot drives through the goals without stopping, but for waypoints with tasks and the last.
        steering: Where directives come from, which are applied between two steps; none takes no directives. With it, a
            navigator needs no goal: it waits for one, and the run goes on after it, until a directive ends it.
        directives: Directives of an earlier run, which are given again after as many control periods as then.
        keeps_s: How much of the run the episode has at its end [s], the last so many seconds, with the last ten
            thousand directives: for runs without an end. None means all of it.

    Raises:
        InputError: If a pose is not two or three finite numbers, there is no goal in the list, or the time limit is not
            positive.
        BlockedPoseError: If the robot cannot stand at the start or at a goal.
        OutsideMapError: If the start or a goal is outside the map.
    """

    def __init__(
        self,
        sim: SomeSimulator,
        agent: AgentLike,
        start: Pose2D | Sequence[float],
        goal: Pose2D | Sequence[float] | Sequence[Pose2D | Sequence[float]] | None = None,
        *,
        localizer: LocalizerLike | None = None,
        start_error: StartError | None = None,
        latency: Latency | None = None,
        monitor: SomeMonitor | bool | None = None,
        time_limit_s: float | None = None,
        observers: Sequence[Observer] = (),
        seed: int = 0,
        stop_on_contact: bool = True,
        rules: Rules | None = None,
        name: str = "run",
        measure: Measure | None = measure_truth,
        through: bool = False,
        steering: Steering | None = None,
        directives: Sequence[GivenDirective] = (),
        keeps_s: float | None = None,
    ) -> None:
        sim = as_simulator(sim, "a run's simulator")
        is_steered = steering is not None or bool(directives)
        needs_goal = isinstance(agent, Agent) and agent.needs_goal
        waits = goal is None and needs_goal and is_steered
        begin, goals = Pose2D.of(start), () if goal is None and (waits or not needs_goal) else read_goals(goal)
        if time_limit_s is not None and not 0.0 < as_number(time_limit_s, "the time limit") < math.inf:
            raise ScenarioError(f"the time limit must be a positive number of seconds, got {time_limit_s}")
        latency = Latency() if latency is None else latency
        check_kind(latency, Latency, "a run's latency", "Latency(scan_age_s=0.1) makes one")
        rules = Rules() if rules is None else rules
        self._dt = agent.dt if isinstance(agent, Agent) else CONTROL_PERIOD_S
        most_rows = None
        if keeps_s is not None:
            most_rows = 1 + math.ceil(check_number("keeps_s", keeps_s, 0.0, 1e9, "s") / self._dt)
        self._observers = Observers(observers)
        self._measure = measure
        self._log = RunLog(every_contact=rules.every_contact, most_rows=most_rows)
        self._first = standing_at(begin)
        self._wall_s = 0.0
        self._loop: ControlLoop | None = None
        self._act = ControlLoop.steer_and_drive if is_steered else ControlLoop.drive
        self._ended = RunEnd((agent, localizer, monitor, sim))
        self._episode: Episode | None = None
        self._info = describe_early(agent, sim.robot, name, begin, goals, time_limit_s, seed, sim.world)
        try:
            # From here on plug-ins are called: whatever one raises ends the run as any other, with an episode.
            driver = create_agent(agent, sim.robot)
            about = driver.info()
            self._ended.parts += about.plugins
            robot = sim.robot if about.robot is None else about.robot
            moved, latency = delay_commands(sim, latency, driver.dt)
            locates = None if localizer is None else create_localizer(localizer, about.grid, robot)
            stack = RobotStack(
                driver,
                robot,
                localizer=locates,
                monitor=monitor,
                latency=latency,
                log=self._log,
                start_error=start_error,
            )
            stack.check_goals(goals)
            driver.reset(seed=seed)
            driver.set_latency(latency)
            hands_over = through or any(tasks_of(goal) for goal in goals)
            paths, unreachable = prepare(
                driver,
                begin,
                goals,
                through=through if hands_over else None,
                knows_start=start_error is None,
            )
            limit_s = allowed_time(driver, robot, begin, goals, paths) if time_limit_s is None else time_limit_s
            self._info = describe_run(
                driver.info(), driver.dt, sim.robot, name, begin, goals, paths, limit_s, seed, sim.world, locates
            )
            sequence = GoalSequence(
                stack,
                self._info,
                paths,
                unreachable,
                through=through,
                hands_over=hands_over,
                rules=rules,
                stop_on_contact=stop_on_contact,
                extends=time_limit_s is None and not waits,
                waits=waits,
            )
            loop = self._loop = ControlLoop(moved, sim, stack, sequence, self._observers)
            if is_steered:
                loop.executor = DirectiveExecutor(sequence, stack, sim, steering, directives, loop.place)
                if keeps_s is not None:
                    loop.executor.keep_last()
            loop.state, stack.estimate = self._first
            loop.begin(self._info)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt) and self._observers.has_begun:
                self.abort(error)
            else:
                self._end_early(error)
                raise

    def __repr__(self) -> str:
        doing = "running" if self._ended.outcome is None else self._ended.outcome.value
        return f"Session({self._info.name!r}, {doing}, {self.time:.2f} s)"

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.finish()

    @property
    def info(self) -> RunInfo:
        """What observers got before the first step."""
        return self._info

    @property
    def state(self) -> RobotState:
        """State of the simulator now: the truth."""
        return self._first[0] if self._loop is None else self._loop.state

    @property
    def estimate(self) -> Estimate:
        """Where the robot believes to be now."""
        return self._first[1] if self._loop is None else self._loop.stack.estimate

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.state.time

    @property
    def dt(self) -> float:
        """Length of the next control period [s]."""
        return self._dt if self._loop is None else self._loop.dt

    @property
    def outcome(self) -> Outcome | None:
        """How the run ended; None while it is running."""
        return self._ended.outcome

    @property
    def message(self) -> str:
        """The outcome in words; empty while the run is running."""
        return self._ended.message

    @property
    def error(self) -> BaseException | None:
        """What ended the run: a KeyboardInterrupt, a SimulationError, or what a plug-in raised; None otherwise."""
        return self._ended.error

    @property
    def steering(self) -> SteeringReport | None:
        """How the run is steered now; None where it takes no directives."""
        return None if self._executor is None else self._executor.report

    @property
    def directives(self) -> tuple[GivenDirective, ...]:
        """The directives that were given so far; `Session(directives=…)` gives them again."""
        return () if self._executor is None else tuple(self._executor.log)

    @property
    def restart(self) -> Restart | None:
        """The directive that ended the run so that it starts again; None where none did."""
        return None if self._executor is None else self._executor.restart

    @property
    def _executor(self) -> DirectiveExecutor | None:
        return self._loop and self._loop.executor

    # Running --------------------------------------------------------------------------------------------------------

    def step(self) -> Step | None:
        """Drive one control period.

        Ctrl-C (KeyboardInterrupt) and a simulator that fails end the run as aborted; see `error`.

        Returns:
            What observers get, too; None when the run has ended, and nothing moved.

        Raises:
            BaseException: What a plug-in raised; the run has ended as `error`, and observers were notified.
        """
        return self._loop.last if self._attempt(self._act) and self._loop is not None else None

    def steer(self) -> bool:
        """Apply the directives that are due; `step` does so first, and waits while the run is paused.

        Returns:
            Whether the next control period may be driven now: neither is the run paused, nor has it ended.

        Raises:
            BaseException: As `step`.
        """
        return self._attempt(ControlLoop.steer) and self._loop is not None and not self._loop.is_held

    def drive(self) -> Step | None:
        """Drive one control period as things stand: `step` without directives; for a loop that calls `steer`."""
        return self._loop.last if self._attempt(ControlLoop.drive) and self._loop is not None else None

    def run(self) -> Episode:
        """Drive until the run has ended, and return the episode.

        Raises:
            BaseException: As `step`.
        """
        if self._loop is not None:
            self._loop.returns_steps = False
        try:
            while self._attempt(self._act):
                pass
        except KeyboardInterrupt as error:  # between two periods
            self.abort(error)
        return self.conclude()

    def _attempt(self, act: Callable[[ControlLoop], Ending | None]) -> bool:
        """Call a part of the run, and return whether the run goes on; an exception ends it."""
        if self._ended.outcome is not None or self._loop is None:
            return False
        try:
            if (ending := act(self._loop)) is not None:
                self._end(*ending)
        except BaseException as error:  # noqa: BLE001 - whatever it is, the run ends properly
            self._end_by(error)
        if self._ended.fault is not None:
            self.conclude()
        return self._ended.outcome is None

    # Ending ---------------------------------------------------------------------------------------------------------

    def finish(self, why: str = "ended from outside") -> Episode:
        """End the run and notify the observers, once; later calls return the same episode.

        Args:
            why: For the message, where the run had not ended: its outcome is aborted then.
        """
        if self._episode is None:
            if self._ended.outcome is None:
                self._end(Outcome.ABORTED, why)
            if not len(self._log):  # it ended before the first row
                self._log.add(self.state, Twist2D(), self.estimate, 0, None)
            end, measure = self._ended, self._measure
            episode = conclude(self._info, self._log, end, self._loop, wall_s=self._wall_s, measure=measure)
            self._episode = episode
            self._observers.on_end(episode)
            self._episode = replace(episode, observer_errors=tuple(self._observers.errors))
        return self._episode

    def conclude(self) -> Episode:
        """Finish the run, and return its episode; for a loop that drives it to its end.

        Raises:
            BaseException: What ended it as `error`.
        """
        episode = self.finish()
        if self._ended.fault is not None and self._ended.error is not None:
            self._note_folder(self._ended.error)
            raise self._ended.error
        return episode

    def abort(self, error: KeyboardInterrupt) -> None:
        """End the run as aborted by Ctrl-C, or arrived, unless it has ended; `error` has this interrupt then."""
        if self._ended.outcome is None:
            ending = self._ended.explain(error)
            self._end(*((self._loop and self._loop.goals.arrived_before(ending[1], self.state)) or ending), error)

    def _end(self, outcome: Outcome, message: str, error: BaseException | None = None) -> None:
        if self._loop is not None:
            self._wall_s = clock.perf_counter() - self._loop.began_s
        self._ended.put(outcome, message, error, self._log.contacts)
        try:
            if self._loop is not None:
                self._loop.stop(self._ended.message, self._ended.fault)
        except Exception as problem:  # noqa: BLE001 - a run ends properly, whatever its plug-ins do
            self._ended.fail(problem)

    def _end_by(self, error: BaseException) -> None:
        """End the run by what was raised; no path is a result, of which nothing is raised again."""
        self._end(*self._ended.explain(error), None if isinstance(error, PlanningError) else error)

    def _end_early(self, error: BaseException) -> None:
        """End a run before its first step; one that was refused, or stopped by Ctrl-C, has not even begun."""
        refused = isinstance(error, TrundleError) and not isinstance(error, SimulationError) and not is_of_plugin(error)
        if isinstance(error, KeyboardInterrupt) or (refused and not self._observers.has_begun):
            return
        self._end_by(error)
        if not self._observers.has_begun:
            self._observers.on_start(self._info)
        self.finish()
        self._note_folder(error)

    def _note_folder(self, error: BaseException) -> None:
        if (folder := self._observers.folder) is not None:
            note_folder(error, folder)
