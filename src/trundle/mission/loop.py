"""`run`: the loop in which a navigator drives a simulator and observers are notified."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from trundle.costmap import Costmap
from trundle.errors import PlanningError, ScenarioError, SimulationError
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.mission.episode import Episode, Outcome
from trundle.mission.legs import plan_legs, read_goals
from trundle.mission.metrics import compute_metrics
from trundle.mission.observers import Audience, Observer, RunInfo, Step
from trundle.mission.trajectory import Trajectory
from trundle.mission.truth import Truth, measure_truth
from trundle.navigation import NavigationStatus, Navigator
from trundle.navigation.speed_limiter import fastest_s
from trundle.path import Path
from trundle.robots import Robot
from trundle.sim import RobotState, Simulator, world_of
from trundle.values import as_number, check_kind
from trundle.worlds import World

TIME_PER_GOAL_S = 60.0
SLOWNESS = 4.0


def run(
    sim: Simulator,
    navigator: Navigator,
    start: Pose2D | Sequence[float],
    goal: Pose2D | Sequence[float] | Sequence[Pose2D | Sequence[float]],
    *,
    time_limit_s: float | None = None,
    observers: Sequence[Observer] = (),
    seed: int = 0,
    stop_on_contact: bool = True,
    name: str = "run",
) -> Episode:
    """Drive a robot from a start to a goal, or through several.

    Ctrl-C (KeyboardInterrupt) while it drives ends the run as aborted; the observers still get its end.

    Args:
        sim: What moves the robot.
        navigator: What drives it; a goal that it has is replaced.
        start: The start: a pose, (x, y) or (x, y, yaw); map frame.
        goal: The goal: a pose, (x, y) for any yaw, or (x, y, yaw); or a list of these.
        time_limit_s: Simulated time [s] at which the run is stopped; none means 60 s for every goal plus four times
            what the planned paths take at the robot's top speed, or at what a speed mask allows.
        observers: Notified in this order.
        seed: Of the simulator.
        stop_on_contact: Whether the first contact ends the run. A run with a contact is `collided` either way.
        name: Name of the run.

    Returns:
        The episode. Not reaching the goal is an outcome, not an exception.

    Raises:
        InputError: If a pose is not two or three finite numbers, there is no goal, or the time limit is not positive.
        BlockedPoseError: If the robot cannot stand at the start or at a goal.
        OutsideMapError: If the start or a goal is outside the map.
    """
    return run_measured(
        sim,
        navigator,
        start,
        goal,
        time_limit_s=time_limit_s,
        observers=observers,
        seed=seed,
        stop_on_contact=stop_on_contact,
        name=name,
    )


class Measure(Protocol):
    """Measures a run's surroundings; see `measure_truth`."""

    def __call__(
        self,
        poses: FloatArray,
        ends: Sequence[Sequence[float]],
        robot: Robot,
        world: World | None,
        costmap: Costmap,
        *,
        arrived: bool,
        touched: bool,
    ) -> Truth:
        """Measure it."""
        ...


def run_measured(
    sim: Simulator,
    navigator: Navigator,
    start: Pose2D | Sequence[float],
    goal: Pose2D | Sequence[float] | Sequence[Pose2D | Sequence[float]],
    *,
    time_limit_s: float | None = None,
    observers: Sequence[Observer] = (),
    seed: int = 0,
    stop_on_contact: bool = True,
    name: str = "run",
    measure: Measure = measure_truth,
) -> Episode:
    """As `run`, with what measures the surroundings: an evaluation keeps the maps for that."""
    check_kind(sim, Simulator, "a run's simulator", "trundle.simulate(world, robot) makes one")
    check_kind(navigator, Navigator, "a run's navigator", "Navigator(grid, robot) makes one")
    begin, goals = Pose2D.of(start), read_goals(goal)
    if time_limit_s is not None and not (
        math.isfinite(as_number(time_limit_s, "the time limit")) and time_limit_s > 0.0
    ):
        raise ScenarioError(f"the time limit must be a positive number of seconds, got {time_limit_s}")
    audience = Audience(observers)
    plans, unreachable = plan_legs(navigator, begin, goals)
    planned_m = sum(path.length for path in plans)
    if time_limit_s is None:
        slow = SLOWNESS * sum(fastest_s(path, navigator.robot, navigator.speed_mask) for path in plans)
        time_limit_s = TIME_PER_GOAL_S * len(goals) + slow
    info = RunInfo(
        name=name,
        robot=navigator.robot,
        costmap=navigator.costmap,
        start=begin,
        goals=goals,
        path_length_m=planned_m,
        time_limit_s=time_limit_s,
        dt=navigator.dt,
        planner=navigator.planner_name,
        controller=navigator.controller_name,
        seed=seed,
        speed_mask=navigator.speed_mask,
    )
    return _Drive(sim, navigator, info, audience, measure, stop_on_contact=stop_on_contact).run(unreachable)


class _Drive:
    """One run in progress."""

    def __init__(
        self,
        sim: Simulator,
        navigator: Navigator,
        info: RunInfo,
        audience: Audience,
        measure: Measure,
        *,
        stop_on_contact: bool,
    ) -> None:
        self._sim = sim
        self._navigator = navigator
        self._info = info
        self._audience = audience
        self._measure = measure
        self._stop_on_contact = stop_on_contact
        self._rows: list[tuple[float, ...]] = []
        self._paths: list[Path] = []
        self._contacts: dict[str, None] = {}
        self._reached = 0
        self._planning_s = 0.0
        self._replans = 0

    def run(self, unreachable: PlanningError | None) -> Episode:
        state = self._sim.reset(self._info.start, seed=self._info.seed)
        began = clock.perf_counter()
        try:
            self._audience.on_start(self._info)
            self._record(state, Twist2D())
            outcome, message = self._drive(state, unreachable)
        except KeyboardInterrupt:
            outcome, message = Outcome.ABORTED, "stopped by Ctrl-C"
        except SimulationError as error:
            outcome, message = Outcome.ABORTED, f"the simulator failed: {error}"
        wall_s = clock.perf_counter() - began
        if not self._rows:  # Ctrl-C came before the first one
            self._append(state, Twist2D(), -1)
        self._close_leg()
        if self._contacts and outcome is not Outcome.COLLIDED:
            outcome, message = Outcome.COLLIDED, f"touched {', '.join(self._contacts)} while driving; {message}"
        episode = self._make_episode(outcome, message, wall_s)
        self._audience.on_end(episode)
        return replace(episode, observer_errors=tuple(self._audience.errors))

    def _drive(self, state: RobotState, unreachable: PlanningError | None) -> tuple[Outcome, str]:
        """Step until something ends the run."""
        navigator, goals, dt = self._navigator, self._info.goals, self._info.dt
        if unreachable is not None and not state.contacts:
            return Outcome.NO_PATH, str(unreachable)
        # `plan_legs` left the first goal and its plan in the navigator.
        while True:
            if state.contacts and self._stop_on_contact:
                return Outcome.COLLIDED, _describe_contact(state)
            command = navigator.update(state.pose, state.twist, time=state.time)
            status = navigator.status
            if status is NavigationStatus.ARRIVED:
                if not self._is_there(state.pose):
                    return Outcome.STUCK, f"the navigator says that it arrived, but it is at {_words(state.pose)}"
                self._reached += 1
                if self._reached == len(goals):
                    return Outcome.ARRIVED, f"arrived after {state.time:.1f} s"
                self._close_leg()
                navigator.set_goal(goals[self._reached])
                continue
            if status is NavigationStatus.NO_PATH:
                return Outcome.NO_PATH, str(navigator.error or "no path to the goal was found")
            if status is NavigationStatus.PLANNING_TIMED_OUT:
                return (
                    Outcome.PLANNING_TIMED_OUT,
                    f"planning timed out at {_words(state.pose)}: {navigator.error}",
                )
            if status is NavigationStatus.STUCK:
                return Outcome.STUCK, f"stuck at {_words(state.pose)} after {state.time:.1f} s"
            if state.time >= self._info.time_limit_s - 1e-9:
                return Outcome.TIMED_OUT, f"goal not reached within {self._info.time_limit_s:.1f} s"
            state = self._sim.step(command, dt)
            self._record(state, command)

    def _is_there(self, pose: Pose2D) -> bool:
        """Whether the simulator's true pose is at the goal; the navigator may have been given another one."""
        goal = self._info.goals[self._reached]
        return self._navigator.goal_checker.is_within(pose, goal.pose, any_yaw=goal.yaw_free)

    def _record(self, state: RobotState, command: Twist2D) -> None:
        path = self._navigator.path
        if path is not None and (not self._paths or path is not self._paths[-1]):
            self._paths.append(path)
        self._append(state, command, len(self._paths) - 1 if path is not None else -1)
        for contact in state.contacts:
            self._contacts.setdefault(contact.other)
        step = Step(len(self._rows) - 1, state, command, self._reached, path, self._navigator.status)
        self._audience.on_step(step)

    def _append(self, state: RobotState, command: Twist2D, path: int) -> None:
        self._rows.append(
            (
                state.time,
                *state.pose.as_tuple(),
                state.twist.v,
                state.twist.w,
                command.v,
                command.w,
                *state.odometry.as_tuple(),
                self._reached,
                path,
            )
        )

    def _close_leg(self) -> None:
        """Add up the navigator's planning time and replans for this goal; the next `set_goal` clears them."""
        self._planning_s += self._navigator.planning_time_s
        self._replans += self._navigator.replans

    def _make_episode(self, outcome: Outcome, message: str, wall_s: float) -> Episode:
        info = self._info
        columns = [np.array(column) for column in zip(*self._rows, strict=True)]
        trajectory = Trajectory(**dict(zip(Trajectory.columns(), columns, strict=True)))
        arrived = outcome is Outcome.ARRIVED
        truth = self._measure(
            trajectory.poses,
            (info.start.as_tuple(), *info.goals),
            info.robot,
            world_of(self._sim),
            info.costmap,
            arrived=arrived,
            touched=bool(self._contacts),
        )
        metrics = compute_metrics(
            trajectory,
            self._paths,
            info.costmap,
            arrived=arrived,
            path_length_m=info.path_length_m,
            planning_s=self._planning_s,
            replans=self._replans,
            wall_s=wall_s,
            contacts=tuple(self._contacts),
            truth=truth,
        )
        return Episode(
            outcome=outcome,
            message=message,
            metrics=metrics,
            trajectory=trajectory,
            paths=tuple(self._paths),
            start=info.start,
            goals=info.goals,
            goals_reached=self._reached,
            name=info.name,
            robot=info.robot.name,
            planner=info.planner,
            controller=info.controller,
            seed=info.seed,
            time_limit_s=info.time_limit_s,
            costmap=info.costmap,
        )


def _describe_contact(state: RobotState) -> str:
    contact = state.contacts[0]
    where = f"the {contact.part} touches {contact.other} at ({contact.x:.2f}, {contact.y:.2f})"
    if state.time == 0.0:
        return (
            f"in contact at the start: {where}; start farther from it, or, if it is what the robot stands on, give the "
            "height of its top with --floor-z (floor_z in Python and in a scenario)"
        )
    return f"{where} after {state.time:.1f} s"


def _words(pose: Pose2D) -> str:
    return f"({pose.x:.2f}, {pose.y:.2f}, {pose.yaw:.2f})"
