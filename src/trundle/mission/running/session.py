"""`Session`: one run that can be stepped, in which an agent drives a simulator and observers are notified."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Self, cast

from trundle.control.latency import Latency
from trundle.errors import PlanningError, ScenarioError, SimulationError, TrundleError
from trundle.fault import Fault, find_fault, is_of_plugin, keep_fault, note_folder, text_of
from trundle.geometry import Pose2D, Twist2D
from trundle.localization.localizer import LocalizerLike
from trundle.mission.episode import Episode, Outcome
from trundle.mission.legs import read_goals
from trundle.mission.observers import Audience, MonitorReport, Observer, RunInfo, Step
from trundle.mission.rules import Rules
from trundle.mission.running.course import Course, Moment
from trundle.mission.running.endings import Ending
from trundle.mission.running.episode_maker import AgentTotals, make_episode
from trundle.mission.running.gate import Gate
from trundle.mission.running.monitoring import Monitor
from trundle.mission.running.preparation import allowed_time, describe_early, describe_run, prepare, standing_at
from trundle.mission.running.run_log import RunLog
from trundle.mission.running.scan_mail import report_latency
from trundle.mission.running.senses import Senses
from trundle.mission.steering.directives import GivenDirective, Restart
from trundle.mission.steering.helm import Helm
from trundle.mission.steering.queue import Steering
from trundle.mission.steering.report import SteeringReport
from trundle.mission.truth import Measure, measure_truth
from trundle.navigation import Agent, Navigator
from trundle.navigation.agent import CONTROL_PERIOD_S
from trundle.navigation.agents import AgentLike, create_agent
from trundle.navigation.behaviors import BehaviorRun
from trundle.navigation.waypoint import tasks_of
from trundle.observation import Estimate
from trundle.path import Path
from trundle.robots import Robot
from trundle.sim import RobotState, Simulator, place_robot, world_of
from trundle.sim.command_delay import DelayedSimulator
from trundle.sim.simulator import watch_substeps
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
        steering: Where directives come from, which are applied between two steps; none takes no directives. With it, a
            navigator needs no goal: it waits for one, and the run goes on after it, until a directive ends it.
        directives: Those of an earlier run, which are given again after as many control periods as then.
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
        sim: Simulator,
        agent: AgentLike,
        start: Pose2D | Sequence[float],
        goal: Pose2D | Sequence[float] | Sequence[Pose2D | Sequence[float]] | None = None,
        *,
        localizer: LocalizerLike | None = None,
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
        steering: Steering | None = None,
        directives: Sequence[GivenDirective] = (),
        keeps_s: float | None = None,
    ) -> None:
        check_kind(sim, Simulator, "a run's simulator", "trundle.simulate(world, robot) makes one")
        is_steered = steering is not None or bool(directives)
        waits = goal is None and isinstance(agent, Navigator) and is_steered
        aimless = goal is None and (waits or not isinstance(agent, Navigator))
        begin, goals = Pose2D.of(start), () if aimless else read_goals(goal)
        if time_limit_s is not None and not (
            math.isfinite(as_number(time_limit_s, "the time limit")) and time_limit_s > 0.0
        ):
            raise ScenarioError(f"the time limit must be a positive number of seconds, got {time_limit_s}")
        latency = Latency() if latency is None else latency
        check_kind(latency, Latency, "a run's latency", "Latency(scan_age_s=0.1) makes one")
        rules = Rules() if rules is None else rules
        self._audience = Audience(observers)
        self._agent = cast("Agent", agent)  # made of it below: what is raised there ends the run properly
        self._measure = measure
        self._sim = sim
        self._backend = sim
        most_rows = None
        if keeps_s is not None:
            most_rows = 1 + math.ceil(check_number("keeps_s", keeps_s, 0.0, 1e9, "s") / self.dt)
        self._log = RunLog(every_contact=rules.every_contact, most_rows=most_rows)
        self._state, self._estimate = standing_at(begin)
        self._began, self._wall_s = clock.perf_counter(), 0.0
        self._watches = False
        self._helm: Helm | None = None
        self._outcome: Outcome | None = None
        self._message = ""
        self._error: BaseException | None = None
        self._fault: Fault | None = None
        self._was_complete = False
        self._episode: Episode | None = None
        self._last: Step | None = None
        self._returns_steps = True
        self._parts: tuple[object, ...] = (agent, localizer, monitor, sim)
        self._info = describe_early(
            self._agent, sim.robot, name, begin, goals, time_limit_s=time_limit_s, seed=seed, world=world_of(sim)
        )
        try:
            made = self._agent = create_agent(agent, sim.robot)
            self._sim, latency = _delay_commands(sim, latency, getattr(made, "dt", CONTROL_PERIOD_S))
            robot: Robot = getattr(made, "robot", sim.robot)
            self._gate = Gate(monitor, robot, latency)
            self._senses = Senses(localizer, getattr(made, "grid", None), robot, latency)
            made.reset(seed=seed)
            report_latency(made, latency)
            hands_over = through or any(tasks_of(goal) for goal in goals)
            paths, unreachable = prepare(made, begin, goals, through=through if hands_over else None)
            extends = time_limit_s is None and not waits
            if time_limit_s is None:
                time_limit_s = allowed_time(made, robot, begin, goals, paths)
            self._info = describe_run(
                made, sim.robot, name, begin, goals, paths, time_limit_s=time_limit_s, seed=seed, world=world_of(sim)
            )
            self._course = Course(
                made,
                self._info,
                paths,
                unreachable,
                through=through,
                hands_over=hands_over,
                rules=rules,
                stop_on_contact=stop_on_contact,
                extends=extends,
                waits=waits,
            )
            if is_steered:
                self._helm = Helm(self._course, sim, robot, steering, directives, self._relocate, self._place)
                if keeps_s is not None:
                    self._helm.keep_last()
            self._start()
        except BaseException as error:
            self._end_early(error)
            raise

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
        """What ended the run: a KeyboardInterrupt, a SimulationError, or what a plug-in raised; None otherwise."""
        return self._error

    @property
    def steering(self) -> SteeringReport | None:
        """How the run is steered now; None where it takes no directives."""
        return None if self._helm is None else self._helm.report

    @property
    def directives(self) -> tuple[GivenDirective, ...]:
        """The directives that were given so far; `Session(directives=…)` gives them again."""
        return () if self._helm is None else tuple(self._helm.log)

    @property
    def restart(self) -> Restart | None:
        """The directive that ended the run so that it starts again; None where none did."""
        return None if self._helm is None else self._helm.restart

    # Running --------------------------------------------------------------------------------------------------------

    def _start(self) -> None:
        self._gate.reset()
        self._watches = self._audience.wants_substeps and watch_substeps(self._backend, self._audience.on_substep)
        self._senses.reset(self._info.start, seed=self._info.seed)
        self._state = self._sim.reset(self._info.start, seed=self._info.seed)
        self._began = clock.perf_counter()
        self._observation, self._estimate = self._senses.observe(self._state)
        if self._helm is not None:
            self._helm.begin()
        try:
            self._audience.on_start(self._info)
            self._record(Twist2D(), Twist2D(), None)
        except KeyboardInterrupt as error:
            self.abort(error)

    def step(self) -> Step | None:
        """Drive one control period.

        Ctrl-C (KeyboardInterrupt) and a simulator that fails end the run as aborted; see `error`.

        Returns:
            What observers get, too; None when the run has ended, and nothing moved.

        Raises:
            BaseException: What a plug-in raised; the run has ended as `error`, and observers were notified.
        """
        return self._last if self._attempt(self._drive_when_steered) else None

    def steer(self) -> bool:
        """Apply the directives that are due; `step` does so first, and waits while the run is paused.

        Returns:
            Whether the next control period may be driven now: neither is the run paused, nor has it ended.

        Raises:
            BaseException: As `step`.
        """
        return self._attempt(self._steer)

    def run(self) -> Episode:
        """Drive until the run has ended, and return the episode.

        Raises:
            BaseException: As `step`.
        """
        self._returns_steps = False
        try:
            while self._attempt(self._drive_when_steered):
                pass
        except KeyboardInterrupt as error:  # between two periods
            self.abort(error)
        return self.conclude()

    def abort(self, error: KeyboardInterrupt) -> None:
        """End the run as aborted by Ctrl-C, unless it has ended; `error` has this interrupt then."""
        if self._outcome is None:
            self._end(Outcome.ABORTED, "stopped by Ctrl-C", error)

    def drive(self) -> Step | None:
        """Drive one control period as things stand: `step` without directives; for a loop that calls `steer`."""
        return self._last if self._attempt(self._drive) else None

    def _attempt(self, act: Callable[[], bool]) -> bool:
        """Do something of the run; what it raises ends the run."""
        if self._outcome is not None:
            return False
        goes_on = False
        try:
            goes_on = act()
        except BaseException as error:  # noqa: BLE001 - whatever it is, the run ends properly
            self._end_by(error)
        if self._fault is not None:
            self.conclude()
        return goes_on

    def _steer(self) -> bool:
        helm = self._helm
        if helm is None:
            return True
        helm.steer(len(self._log) - 1, self._state, self._estimate)
        if helm.ending is not None:
            self._end(*helm.ending)
        return self._outcome is None and not helm.is_held

    def _drive_when_steered(self) -> bool:
        while not self._steer():
            if self._helm is None or self._outcome is not None:
                return False
            self._helm.wait()
        return self._drive()

    def finish(self, why: str = "ended from outside") -> Episode:
        """End the run and notify the observers, once; later calls return the same episode.

        Args:
            why: For the message, where the run had not ended: its outcome is aborted then.
        """
        if self._episode is None:
            if self._outcome is None:
                self._end(Outcome.ABORTED, why)
            episode = self._episode = self._make_episode()
            self._audience.on_end(episode)
            self._episode = replace(episode, observer_errors=tuple(self._audience.errors))
        return self._episode

    def conclude(self) -> Episode:
        """Finish the run, and return its episode; for a loop that drives it to its end.

        Raises:
            BaseException: What ended it as `error`.
        """
        episode = self.finish()
        if self._fault is not None and self._error is not None:
            self._note_folder(self._error)
            raise self._error
        return episode

    def _drive(self) -> bool:
        """Drive one control period; whether it did."""
        helm = self._helm
        driver = None if helm is None or helm.manual is None else helm
        asked = self._course.next_command(self._moment) if driver is None else self._drive_by_hand(driver)
        if not isinstance(asked, Twist2D):
            self._end(*asked)
            return False
        report = self._gate.check(asked, self._observation, self._agent, by_hand=driver is not None)
        if report is not None:
            self._log.add_report(report)
        sent = asked if report is None else report.command
        self._state = self._sim.step(sent, self.dt)
        self._observation, self._estimate = self._senses.observe(self._state)
        self._record(asked, sent, report)
        return True

    def _drive_by_hand(self, helm: Helm) -> Twist2D | Ending:
        """What of the command by hand passes the agent's stop check; or how the run ends now."""
        ending = self._course.pass_by_hand(self._moment, self.dt)
        return helm.assist(self._agent, self._observation, self._estimate) if ending is None else ending

    def _relocate(self, pose: Pose2D) -> Estimate:
        """Tell the localizer where the robot is now."""
        self._estimate = self._senses.relocate(pose, self._observation, seed=self._info.seed)
        return self._estimate

    def _place(self, pose: Pose2D) -> tuple[RobotState, Estimate]:
        """Put the robot somewhere else, at rest; its odometry does not notice."""
        placed = place_robot(self._backend, pose)
        self._state = replace(placed, odometry=self._state.odometry, odometry_twist=None)
        self._observation, self._estimate = self._senses.place(self._state, self._observation, self._estimate)
        return self._state, self._estimate

    @property
    def _moment(self) -> Moment:
        believed = self._senses.believed(self._estimate)
        return Moment(self._state, self._observation, self._estimate, believed, self._log.hit)

    def _record(self, command: Twist2D, sent: Twist2D, report: MonitorReport | None) -> None:
        agent, log = self._agent, self._log
        path: Path | None = getattr(agent, "path", None)
        goal = self._course.current
        log.add(self._state, sent, self._estimate, goal, path)
        steering = None if self._helm is None else self._helm.finish_period(command, report, self.time)
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
            self._course.tick_s,
            self._course.planning_s,
            steering,
            getattr(agent, "distance_remaining", None),
        )
        self._audience.on_step(step)

    # Ending ---------------------------------------------------------------------------------------------------------

    def _end(self, outcome: Outcome, message: str, error: BaseException | None = None) -> None:
        self._wall_s = clock.perf_counter() - self._began
        contacts = self._log.contacts
        if contacts and outcome not in (Outcome.COLLIDED, Outcome.ERROR):
            outcome, message = Outcome.COLLIDED, f"touched {', '.join(contacts)} while driving; {message}"
        self._outcome, self._message, self._error = outcome, message, error
        try:
            if self._watches:
                watch_substeps(self._backend, None)
            if self._helm is not None:
                self._helm.stop(f"the run has ended: {message}", self.time, self._fault)
        except Exception as problem:  # noqa: BLE001 - a run ends properly, whatever its plug-ins do
            self._fail(problem)

    def _end_by(self, error: BaseException) -> None:
        """End the run by what was raised."""
        if isinstance(error, KeyboardInterrupt):
            self.abort(error)
        elif isinstance(error, SimulationError):
            self._end(Outcome.ABORTED, f"the simulator failed: {text_of(error)}", error)
        elif isinstance(error, PlanningError):
            self._was_complete = error.complete
            self._end(Outcome.NO_PATH, text_of(error))
        else:
            self._fail(error)

    def _fail(self, error: BaseException) -> None:
        """End the run by an exception, unless another one has ended it."""
        if self._fault is not None:
            return
        agent, parts = self._agent, self._parts
        if isinstance(agent, Navigator):
            parts = (*parts, agent.controller, agent.planner, agent.smoother, agent.goal_checker)
        self._fault = find_fault(error, parts)
        keep_fault(error, self._fault)
        self._end(Outcome.ERROR, str(self._fault), error)

    def _end_early(self, error: BaseException) -> None:
        """End a run before its first step; one that was refused, or stopped by Ctrl-C, has not even begun."""
        refused = isinstance(error, TrundleError) and not isinstance(error, SimulationError) and not is_of_plugin(error)
        if isinstance(error, KeyboardInterrupt) or (refused and not self._audience.has_begun):
            return
        self._end_by(error)
        if not self._audience.has_begun:
            self._audience.on_start(self._info)
        self.finish()
        self._note_folder(error)

    def _note_folder(self, error: BaseException) -> None:
        folder = self._audience.folder
        if folder is not None:
            note_folder(error, folder)

    def _make_episode(self) -> Episode:
        if not len(self._log):  # it ended before the first row
            self._log.add(self._state, Twist2D(), self._estimate, 0, None)
        behaviors: tuple[BehaviorRun, ...] = ()
        course = getattr(self, "_course", None)
        totals = AgentTotals() if course is None else course.totals
        try:
            if course is not None:
                totals.add(self._agent)
                behaviors = tuple(getattr(self._agent, "behavior_runs", ()))
                self._was_complete = self._was_complete or course.was_complete
        except Exception as error:  # noqa: BLE001 - as in _end
            self._fail(error)
        try:
            return self._compute_episode(course, totals, behaviors, self._measure)
        except Exception as error:  # noqa: BLE001 - as in _end
            self._fail(error)
            return self._compute_episode(course, totals, behaviors, None)

    def _compute_episode(
        self, course: Course | None, totals: AgentTotals, behaviors: tuple[BehaviorRun, ...], measure: Measure | None
    ) -> Episode:
        return make_episode(
            self._info if course is None else course.info,
            self._log,
            totals,
            Outcome.ABORTED if self._outcome is None else self._outcome,
            self._message,
            goals_reached=0 if course is None else course.reached,
            behaviors=behaviors,
            directives=self.directives,
            world=self._info.world,
            boxes=() if self._helm is None else self._helm.boxes,
            wall_s=self._wall_s,
            measure=measure,
            fault=self._fault,
            complete=self._was_complete if self._outcome is Outcome.NO_PATH else None,
        )


def _delay_commands(sim: Simulator, latency: Latency, period_s: float) -> tuple[Simulator, Latency]:
    """The simulator with late commands, and the latency with the delay that they have there: a number of its steps."""
    if latency.command_delay_s <= 0.0:
        return sim, latency
    delayed = DelayedSimulator(sim, latency.command_delay_s)
    return delayed, latency.model_copy(update={"command_delay_s": delayed.delay_in(period_s)})
