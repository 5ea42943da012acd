"""`run`: drives from a start to a goal, and returns the episode."""

from __future__ import annotations

from collections.abc import Sequence

from trundle.control.latency import Latency
from trundle.geometry import Pose2D
from trundle.localization.localizer import LocalizerLike
from trundle.mission.episode import Episode
from trundle.mission.observers import Observer
from trundle.mission.rules import Rules
from trundle.mission.running.monitoring import Monitor
from trundle.mission.running.session import Session
from trundle.mission.truth import Measure, measure_truth
from trundle.navigation.agents import AgentLike
from trundle.sim import Simulator


def run(
    sim: Simulator,
    navigator: AgentLike,
    start: Pose2D | Sequence[float],
    goal: Pose2D | Sequence[float] | Sequence[Pose2D | Sequence[float]] | None,
    *,
    time_limit_s: float | None = None,
    observers: Sequence[Observer] = (),
    seed: int = 0,
    stop_on_contact: bool = True,
    rules: Rules | None = None,
    name: str = "run",
    localizer: LocalizerLike | None = None,
    latency: Latency | None = None,
    monitor: Monitor | bool | None = None,
    through: bool = False,
) -> Episode:
    """Drive a robot from a start to a goal, or through several; `Session` does the same step by step.

    Ctrl-C (KeyboardInterrupt) while it drives ends the run as aborted; the observers still get its end.

    Args:
        sim: What moves the robot.
        navigator: What drives it: a navigator or another agent, whose goal is replaced; or the class or the name of
            one, or a function (observation, estimate); see `AgentLike`.
        start: The start: a pose, (x, y) or (x, y, yaw); map frame.
        goal: The goal: a pose, (x, y) for any yaw, or (x, y, yaw); or a list of these. None for an agent without a
            goal, which drives until it is FINISHED.
        time_limit_s: Simulated time [s] at which the run is stopped; none means 60 s for every goal plus four times
            what the planned paths take at the robot's top speed, or at what a speed mask allows.
        observers: Notified in this order.
        seed: Of the simulator, the navigator and the localizer.
        stop_on_contact: Whether the first contact ends the run. A run with a contact is `collided` either way.
        rules: What else ends the run; None means nothing.
        name: Name of the run.
        localizer: Estimates the robot's pose: a localizer, a class, a function or a name; see `LocalizerLike`. None
            means that the navigator gets the true pose.
        latency: How late scans and commands arrive.
        monitor: The collision monitor that every command passes. None means a `CollisionMonitor` from the first scan
            on, True one from the start, and False none.
        through: Whether the robot drives through the goals without stopping, but for waypoints with tasks and the last.

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
        rules=rules,
        name=name,
        localizer=localizer,
        latency=latency,
        monitor=monitor,
        through=through,
    )


def run_measured(
    sim: Simulator,
    navigator: AgentLike,
    start: Pose2D | Sequence[float],
    goal: Pose2D | Sequence[float] | Sequence[Pose2D | Sequence[float]] | None,
    *,
    time_limit_s: float | None = None,
    observers: Sequence[Observer] = (),
    seed: int = 0,
    stop_on_contact: bool = True,
    rules: Rules | None = None,
    name: str = "run",
    localizer: LocalizerLike | None = None,
    latency: Latency | None = None,
    monitor: Monitor | bool | None = None,
    through: bool = False,
    measure: Measure = measure_truth,
) -> Episode:
    """As `run`, with what measures the surroundings: an evaluation keeps the maps for that."""
    return Session(
        sim,
        navigator,
        start,
        goal,
        localizer=localizer,
        latency=latency,
        monitor=monitor,
        through=through,
        time_limit_s=time_limit_s,
        observers=observers,
        seed=seed,
        stop_on_contact=stop_on_contact,
        rules=rules,
        name=name,
        measure=measure,
    ).run()
