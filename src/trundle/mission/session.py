"""`Session`: one run that can be stepped, in which an agent drives a simulator and observers are notified."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Sequence
from dataclasses import replace
from typing import Self

from trundle.control import CollisionMonitor
from trundle.errors import ScenarioError, SimulationError
from trundle.geometry import Pose2D, Twist2D
from trundle.latency import Latency
from trundle.localization import Localizer, create_localizer
from trundle.mission import endings
from trundle.mission.episode import Episode, Outcome
from trundle.mission.episode_maker import AgentTotals, make_episode
from trundle.mission.goal_count import GoalCount
from trundle.mission.legs import read_goals
from trundle.mission.monitoring import Monitor
from trundle.mission.observers import Audience, MonitorReport, Observer, RunInfo, Step
from trundle.mission.preparation import allowed_time, describe_run, prepare
from trundle.mission.rules import Rules
from trundle.mission.run_log import RunLog
from trundle.mission.scan_mail import ScanMail, report_latency
from trundle.mission.truth import Measure, measure_truth
from trundle.navigation import Agent, NavigationStatus, Navigator, NavigatorSettings
from trundle.navigation.agent import CONTROL_PERIOD_S
from trundle.navigation.waypoint import tasks_of
from trundle.observation import Estimate, Observation
from trundle.path import Path
from trundle.robots import Robot
from trundle.sim import RobotState, Simulator, world_of
from trundle.sim.command_delay import DelayedSimulator
from trundle.sim.simulator import watch_substeps
from trundle.values import as_number, check_kind

_AT_ODOM_ORIGIN = Pose2D(0.0, 0.0)


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
        agent: What drives it; a goal that it has is replaced.
        start: The start: a pose, (x, y) or (x, y, yaw); map frame.
        goal: The goal: a pose, (x, y) for any yaw, or (x, y, yaw); or a list of these. None for an agent without a
            goal, not a navigator, which drives until it is FINISHED.
        localizer: Estimates the robot's pose: a localizer, or the name of one. None means that the agent gets the true
            pose.
        latency: How late scans and commands arrive; reported to the agent by `set_latency`, if it has that.
        monitor: The collision monitor that every command passes. None means a `CollisionMonitor` from the first scan
            on, True one from the start, and False none.
        time_limit_s: Simulated time [s] at which the run is stopped; none means 60 s for every goal plus four times
            what the planned paths take at the robot's top speed, or at what a speed mask allows, and what the tasks of
            waypoints may take. Without a goal it means no limit.
        observers: Notified in this order.
        seed: Of the simulator, the agent and the localizer.
        stop_on_contact: Whether the first contact ends the run. A run with a contact is `collided` either way.
        rules: What else ends the run; None means nothing.
        name: Name of the run.
        measure: Measures the surroundings for the metrics; None means that they are not measured.
        through: Whether the robot drives through the goals without stopping, but for waypoints with tasks and the last.

    Raises:
        InputError: If a pose is not two or three finite numbers, there is no goal in the list, or the time limit is not
            positive.
        BlockedPoseError: If the robot cannot stand at the start or at a goal.
        OutsideMapError: If the start or a goal is outside the map.
    """

    def __init__(
        self,
        sim: Simulator,
        agent: Agent,
        start: Pose2D | Sequence[float],
        goal: Pose2D | Sequence[float] | Sequence[Pose2D | Sequence[float]] | None = None,
        *,
        localizer: str | Localizer | None = None,
        latency: Latency | None = None,
        monitor: Monitor | bool | None = None,
        time_limit_s: float | None = None,
        observers: Sequence[Observer] = (),
        seed: int = 0,
        stop_on_contact: bool = True,
        rules: Rules | None = None,
        name: str = "run",
        measure: Measure | None = measure_truth,
        through: bool = False,
    ) -> None:
        check_kind(sim, Simulator, "a run's simulator", "trundle.simulate(world, robot) makes one")
        check_kind(agent, Agent, "a run's agent", "Navigator(grid, robot) makes one")
        aimless = goal is None and not isinstance(agent, Navigator)
        begin, goals = Pose2D.of(start), () if aimless else read_goals(goal)
        if time_limit_s is not None and not (
            math.isfinite(as_number(time_limit_s, "the time limit")) and time_limit_s > 0.0
        ):
            raise ScenarioError(f"the time limit must be a positive number of seconds, got {time_limit_s}")
        self._audience = Audience(observers)
        self._agent = agent
        self._stop_on_contact = stop_on_contact
        self._measure = measure
        latency = Latency() if latency is None else latency
        check_kind(latency, Latency, "a run's latency", "Latency(scan_age_s=0.1) makes one")
        self._sim = DelayedSimulator(sim, latency.command_delay_s) if latency.command_delay_s > 0.0 else sim
        self._backend = sim
        self._mail = ScanMail(latency.scan_age_s) if latency.scan_age_s > 0.0 else None
        robot: Robot = getattr(agent, "robot", sim.robot)
        self._monitor = monitor if monitor is not None and not isinstance(monitor, bool) else None
        self._waits_for_scans = monitor is None
        if monitor is True:
            self._monitor = CollisionMonitor(robot)
        self._localizer = (
            None if localizer is None else create_localizer(localizer, getattr(agent, "grid", None), robot)
        )
        agent.reset(seed=seed)
        self._latency = latency
        report_latency(agent, latency)
        report_latency(self._monitor, latency)
        self._hands_over_goals = through or any(tasks_of(goal) for goal in goals)
        paths, self._unreachable = prepare(agent, begin, goals, through=through if self._hands_over_goals else None)
        if time_limit_s is None:
            time_limit_s = allowed_time(agent, robot, begin, goals, paths)
        self._info = describe_run(
            agent, robot, name, begin, goals, paths, time_limit_s=time_limit_s, seed=seed, world=world_of(sim)
        )
        checker = getattr(agent, "goal_checker", None) or NavigatorSettings().make_goal_checker()
        self._goals = GoalCount(goals, checker, through=through)
        self._rules = Rules() if rules is None else rules
        self._log = RunLog(every_contact=self._rules.every_contact)
        self._totals = AgentTotals()
        self._wall_s = 0.0
        self._tick_s, self._planning_s = 0.0, getattr(agent, "planning_time_s", 0.0)
        self._outcome: Outcome | None = None
        self._message = ""
        self._error: BaseException | None = None
        self._episode: Episode | None = None
        self._last: Step | None = None
        self._returns_steps = True
        self._start()

    def __repr__(self) -> str:
        doing = "running" if self._outcome is None else self._outcome.value
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
        return self._state

    @property
    def estimate(self) -> Estimate:
        """Where the robot believes to be now."""
        return self._estimate

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._state.time

    @property
    def dt(self) -> float:
        """Length of the next control period [s]."""
        return getattr(self._agent, "dt", CONTROL_PERIOD_S)

    @property
    def outcome(self) -> Outcome | None:
        """How the run ended; None while it is running."""
        return self._outcome

    @property
    def message(self) -> str:
        """The outcome in words; empty while the run is running."""
        return self._message

    @property
    def error(self) -> BaseException | None:
        """What aborted the run: a KeyboardInterrupt or a SimulationError; None otherwise."""
        return self._error

    # Running --------------------------------------------------------------------------------------------------------

    def _start(self) -> None:
        if self._monitor is not None:
            self._monitor.reset()
        self._watches = self._audience.wants_substeps and watch_substeps(self._backend, self._audience.on_substep)
        if self._localizer is not None:
            self._localizer.reset(self._info.start, seed=self._info.seed)
        self._state = self._sim.reset(self._info.start, seed=self._info.seed)
        self._began = clock.perf_counter()
        self._observe()
        try:
            self._audience.on_start(self._info)
            self._record(Twist2D(), Twist2D(), None)
        except KeyboardInterrupt as error:
            self._end(Outcome.ABORTED, "stopped by Ctrl-C", error)

    def step(self) -> Step | None:
        """Drive one control period.

        Ctrl-C (KeyboardInterrupt) and a simulator that fails end the run as aborted; see `error`.

        Returns:
            What observers get, too; None when the run has ended, and nothing moved.
        """
        return self._last if self._advance() else None

    def run(self) -> Episode:
        """Drive until the run has ended, and return the episode."""
        self._returns_steps = False
        try:
            while self._advance():
                pass
        except KeyboardInterrupt:  # between two periods
            return self.finish("stopped by Ctrl-C")
        return self.finish()

    def _advance(self) -> bool:
        """Drive one control period; whether it did."""
        if self._outcome is not None:
            return False
        try:
            command = self._decide()
            if command is not None:
                self._drive(command)
                return True
        except KeyboardInterrupt as error:
            self._end(Outcome.ABORTED, "stopped by Ctrl-C", error)
        except SimulationError as error:
            self._end(Outcome.ABORTED, f"the simulator failed: {error}", error)
        return False

    def finish(self, why: str = "ended from outside") -> Episode:
        """End the run and notify the observers, once; later calls return the same episode.

        Args:
            why: For the message, where the run had not ended: its outcome is aborted then.
        """
        if self._episode is None:
            if self._outcome is None:
                self._end(Outcome.ABORTED, why)
            episode = self._make_episode()
            self._episode = episode
            self._audience.on_end(episode)
            self._episode = replace(episode, observer_errors=tuple(self._audience.errors))
        return self._episode

    def _drive(self, command: Twist2D) -> None:
        report, sent, seen = None, command, self._observation
        if self._waits_for_scans and seen.scans:
            self._monitor, self._waits_for_scans = CollisionMonitor(self._info.robot), False
            report_latency(self._monitor, self._latency)
        if self._monitor is not None:
            if callable(set_intent := getattr(self._monitor, "set_intent", None)):
                set_intent(getattr(self._agent, "intent", None))
            report = self._monitor.check(command, seen.twist, seen.scans, seen.time, seen.odometry)
            self._log.add_report(report)
            sent = report.command
            if sent != command and callable(report_sent := getattr(self._agent, "set_sent_command", None)):
                report_sent(sent)
        self._state = self._sim.step(sent, getattr(self._agent, "dt", CONTROL_PERIOD_S))
        self._observe()
        self._record(command, sent, report)

    def _observe(self) -> None:
        """Take what the robot observes now, and estimate where it is."""
        state = self._state
        observation = state.observation
        if self._mail is not None:
            observation = replace(observation, scans=self._mail.deliver(state.time, observation.scans))
        self._observation = observation
        self._estimate = (
            Estimate(state.time, state.pose, None, _AT_ODOM_ORIGIN)
            if self._localizer is None
            else self._localizer.update(observation)
        )

    def _record(self, command: Twist2D, sent: Twist2D, report: MonitorReport | None) -> None:
        agent, log = self._agent, self._log
        path: Path | None = getattr(agent, "path", None)
        goal = self._goals.current
        log.add(self._state, sent, self._estimate, goal, path)
        if not (self._returns_steps or self._audience):
            return
        self._last = step = Step(
            len(log) - 1,
            self._state,
            command,
            goal,
            path,
            agent.status,
            sent,
            self._observation,
            self._estimate,
            getattr(agent, "costmap", None),
            report,
            getattr(agent, "tracks", ()),
            getattr(agent, "rollouts", None) if self._returns_steps or self._audience.wants_rollouts else None,
            getattr(agent, "message", None) or "",
            getattr(agent, "behavior_runs", ()),
            self._tick_s,
            self._planning_s,
        )
        self._audience.on_step(step)

    # Ending ---------------------------------------------------------------------------------------------------------

    def _decide(self) -> Twist2D | None:
        """Ask the agent for a command; None where the run ends now."""
        state, log, agent = self._state, self._log, self._agent
        if self._unreachable is not None and log.hit is None:
            return self._end(Outcome.NO_PATH, str(self._unreachable))
        if log.hit is not None and self._stop_on_contact:
            return self._end(Outcome.COLLIDED, endings.describe_contact(log.hit, state.time))
        if self._goals.is_near_last(state.pose, self._rules.arrival_radius):
            self._goals.reached += 1
            return self._end_at_goal()
        observation = self._observation
        while True:
            command = self._ask_agent(observation)
            status = agent.status
            if self._hands_over_goals:
                if not self._goals.count_passed(getattr(agent, "goals_reached", 0), state.pose, self._believed):
                    return self._end_elsewhere()
                if status is NavigationStatus.ARRIVED:
                    return self._end_at_goal()
            elif status is NavigationStatus.ARRIVED and self._info.goals:
                if not self._count_goal():
                    return None
                self._totals.add(agent)
                agent.set_goal(self._goals.next)
                observation = replace(observation, scans=())  # the agent has them
                continue
            if status is not NavigationStatus.DRIVING and self._has_given_up():
                return None
            if state.time >= self._info.time_limit_s - 1e-9:
                return self._end(*endings.timed_out(self._info))
            return command

    def _ask_agent(self, observation: Observation) -> Twist2D:
        """The agent's command, with the wall times that it took for it."""
        agent = self._agent
        planned, began = getattr(agent, "planning_time_s", 0.0), clock.perf_counter()
        command = agent.update(observation, self._estimate)
        self._tick_s = clock.perf_counter() - began
        self._planning_s = getattr(agent, "planning_time_s", 0.0) - planned
        return command

    def _count_goal(self) -> bool:
        """Count a goal at which the agent has arrived; whether there is another one, to which it drives on."""
        if not self._goals.count(self._state.pose, self._believed):
            self._end_elsewhere()
        elif self._goals.are_reached:
            self._end_at_goal()
        return self._outcome is None

    def _end_at_goal(self) -> None:
        estimate = self._estimate.pose if self._goals.reached_by_estimate else None
        self._end(*endings.at_goal(self._state, estimate))

    def _end_elsewhere(self) -> None:
        self._end(*endings.elsewhere(self._agent, self._state))

    def _has_given_up(self) -> bool:
        """End the run if the agent does not drive on."""
        if (ending := endings.given_up(self._agent, self._state)) is not None:
            self._end(*ending)
        return self._outcome is not None

    @property
    def _believed(self) -> Pose2D | None:
        """Where the localizer believes the robot to be; none without one."""
        return None if self._localizer is None else self._estimate.pose

    def _end(self, outcome: Outcome, message: str, error: BaseException | None = None) -> None:
        self._wall_s = clock.perf_counter() - self._began
        if self._watches:
            watch_substeps(self._backend, None)
        contacts = self._log.contacts
        if contacts and outcome is not Outcome.COLLIDED:
            outcome, message = Outcome.COLLIDED, f"touched {', '.join(contacts)} while driving; {message}"
        self._outcome, self._message, self._error = outcome, message, error

    def _make_episode(self) -> Episode:
        if not len(self._log):  # Ctrl-C came before the first row
            self._log.add(self._state, Twist2D(), self._estimate, 0, None)
        self._totals.add(self._agent)
        outcome = Outcome.ABORTED if self._outcome is None else self._outcome
        return make_episode(
            self._info,
            self._log,
            self._totals,
            outcome,
            self._message,
            goals_reached=self._goals.reached,
            behaviors=tuple(getattr(self._agent, "behavior_runs", ())),
            world=world_of(self._sim),
            wall_s=self._wall_s,
            measure=self._measure,
        )
