"""`record_failure`: the folder of a run whose plug-in raised before there was a session."""

from __future__ import annotations

import math
import os
from pathlib import Path

from trundle.fault import find_fault, note_folder
from trundle.geometry import Pose2D, Twist2D
from trundle.mission import Episode, Outcome, RunInfo, Scenario
from trundle.mission.goal_fields import make_goal
from trundle.mission.running.episode_maker import AgentTotals, make_episode
from trundle.mission.running.preparation import describe_run, standing_at
from trundle.mission.running.run_log import RunLog
from trundle.navigation import AgentInfo
from trundle.navigation.agent import CONTROL_PERIOD_S
from trundle.record.run_folder import RunFolder
from trundle.robots import Robot


def record_failure(
    error: BaseException,
    scenario: Scenario,
    out: str | os.PathLike[str] | None = None,
    *,
    overwrite: bool = False,
    page: bool = True,
) -> Path:
    """Write the folder of a run that an exception ended before it began, and note it in the exception.

    Args:
        error: What a plug-in raised, such as the constructor of a planner.
        scenario: What was to be run.
        out: The folder; None means a new one under runs.
        overwrite: Replace an existing run in it.
        page: Whether to write report.html.

    Returns:
        The folder.

    Raises:
        OutputError: If it cannot be written.
    """
    with RunFolder(
        out, name=scenario.title, overwrite=overwrite, scenario=scenario, page=page, overlay=False, video=False
    ) as folder:
        episode, info = _failed_episode(error, scenario)
        folder.on_start(info)
        folder.on_end(episode)
    note_folder(error, folder.path)
    return folder.path


def _failed_episode(error: BaseException, scenario: Scenario) -> tuple[Episode, RunInfo]:
    start = Pose2D(0.0, 0.0) if scenario.start is None else Pose2D.of(scenario.start)
    given = scenario.goals if scenario.goals is not None else () if scenario.goal is None else (scenario.goal,)
    info = describe_run(
        AgentInfo(scenario.controller.name, scenario.planner.name),
        CONTROL_PERIOD_S,
        Robot.load(scenario.robot),
        scenario.title,
        start,
        tuple(make_goal(goal) for goal in given),
        (),
        math.inf if scenario.time_limit_s is None else scenario.time_limit_s,
        scenario.seed,
        None,
    )
    log = RunLog()
    state, estimate = standing_at(start)
    log.add(state, Twist2D(), estimate, 0, None)
    fault = find_fault(error)
    episode = make_episode(
        info,
        log,
        AgentTotals(),
        Outcome.ERROR,
        str(fault),
        goals_reached=0,
        behaviors=(),
        directives=(),
        world=None,
        boxes=(),
        wall_s=0.0,
        measure=None,
        fault=fault,
    )
    return episode, info
