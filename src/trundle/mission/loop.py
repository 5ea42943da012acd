"""`run`: drives from a start to a goal, and returns the episode."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Unpack

from trundle.geometry import Pose2D
from trundle.mission.episode import Episode
from trundle.mission.metrics import Measure
from trundle.mission.observers import Observer
from trundle.mission.running.session import Session
from trundle.mission.setup import SessionOptions
from trundle.navigation.agents import AgentLike
from trundle.sim.simulator import SomeSimulator


class RunOptions(SessionOptions, total=False):
    """Keywords of `run`; they are those of `Session`, which says what each of them means."""

    time_limit_s: float | None
    observers: Sequence[Observer]
    seed: int
    stop_on_contact: bool
    name: str
    measure: Measure | None


def run(
    sim: SomeSimulator,
    navigator: AgentLike,
    start: Pose2D | Sequence[float],
    goal: Pose2D | Sequence[float] | Sequence[Pose2D | Sequence[float]] | None,
    **options: Unpack[RunOptions],
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
        options: Keywords of `Session`, such as `time_limit_s`, `observers`, `seed`, `localizer`, `latency`, `monitor`,
            `rules`, `name`, `stop_on_contact` and `through`.

    Returns:
        The episode. Not reaching the goal is an outcome, not an exception.

    Raises:
        InputError: If a pose is not two or three finite numbers, there is no goal, or the time limit is not positive.
        BlockedPoseError: If the robot cannot stand at the start or at a goal.
        OutsideMapError: If the start or a goal is outside the map.
    """
    return Session(sim, navigator, start, goal, **options).run()
