"""`conclude`: the episode of a run that has ended, from its log and from what its agent counted."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from trundle.fault import Fault
from trundle.mission.episode import Episode, Outcome
from trundle.mission.metrics import DroppedBox, Measure, Truth, compute_metrics, near_boxes
from trundle.mission.observers import RunInfo
from trundle.mission.own_map import OwnMap
from trundle.mission.running.control_loop import ControlLoop
from trundle.mission.running.endings import RunEnd
from trundle.mission.running.run_log import AgentTotals, RunLog
from trundle.mission.steering.directives import GivenDirective
from trundle.navigation.behaviors import BehaviorRun
from trundle.worlds import World


def conclude(
    info: RunInfo, log: RunLog, end: RunEnd, loop: ControlLoop | None, *, wall_s: float, measure: Measure | None
) -> Episode:
    """Make the episode of a run that has ended.

    Where its agent's report or the measuring of the surroundings raises, the run ends as an error, without these.

    Args:
        info: What observers got at the start.
        log: Its rows, of which there is one at least.
        end: How it ended; takes what is raised here.
        loop: Its control loop; None where it ended before there was one.
        wall_s: Wall time of the loop [s].
        measure: Measures the surroundings for the metrics; None means that they are not measured.
    """
    totals, behaviors = AgentTotals(), tuple[BehaviorRun, ...]()
    own_map: OwnMap | None = None
    if loop is not None:
        totals = loop.goals.totals
        try:
            report = loop.stack.agent.report()
            totals.add(report)
            behaviors = tuple(report.behaviors)
            own_map = loop.stack.finish_map()
            end.complete = end.complete or loop.goals.was_complete(report)
        except Exception as error:  # noqa: BLE001 - a run ends properly, whatever its plug-ins do
            end.fail(error)

    def make(measure: Measure | None) -> Episode:
        executor = None if loop is None else loop.executor
        return make_episode(
            info if loop is None else loop.goals.info,
            log,
            totals,
            Outcome.ABORTED if end.outcome is None else end.outcome,
            end.message,
            goals_reached=0 if loop is None else loop.goals.reached,
            behaviors=behaviors,
            directives=() if executor is None else tuple(executor.log),
            world=info.world,
            boxes=() if executor is None else executor.boxes,
            wall_s=wall_s,
            measure=measure,
            fault=end.fault,
            complete=end.complete if end.outcome is Outcome.NO_PATH else None,
            own_map=own_map,
        )

    try:
        return make(measure)
    except Exception as error:  # noqa: BLE001 - as above
        end.fail(error)
        return make(None)


def make_episode(
    info: RunInfo,
    log: RunLog,
    totals: AgentTotals,
    outcome: Outcome,
    message: str,
    *,
    goals_reached: int,
    behaviors: tuple[BehaviorRun, ...],
    directives: tuple[GivenDirective, ...],
    world: World | None,
    boxes: Sequence[DroppedBox],
    wall_s: float,
    measure: Measure | None,
    fault: Fault | None = None,
    complete: bool | None = None,
    own_map: OwnMap | None = None,
) -> Episode:
    """Return the episode of a run.

    Args:
        info: What observers got at the start.
        log: Its rows, of which there is one at least.
        totals: What its agent counted.
        outcome: How it ended.
        message: The outcome in words.
        goals_reached: The number of goals reached.
        behaviors: What the agent ran besides following its path.
        directives: What was asked of the run.
        world: The true world at the start, or none where it is not known.
        boxes: What was put into it since.
        wall_s: Wall time of the loop [s].
        measure: Measures the surroundings for the metrics; None means that they are not measured.
        fault: The exception that ended it, or None.
        complete: Whether the search for a path was complete; None unless it ended with `no_path`.
        own_map: The map that the robot has made, or None.
    """
    trajectory = log.trajectory()
    arrived = outcome is Outcome.ARRIVED
    truth = Truth(None, None, "nothing")
    if measure is not None:
        truth = measure(
            trajectory.poses,
            (info.start.as_tuple(), *info.goals),
            info.robot,
            world,
            info.costmap,
            arrived=arrived,
            touched=bool(log.contacts),
        )
        truth = near_boxes(truth, boxes, trajectory.poses, info.robot)
    if world is not None and boxes:
        world = dataclasses.replace(world, solids=(*world.solids, *(box.solid for box in boxes)))
    metrics = compute_metrics(
        trajectory,
        log.paths,
        info.costmap,
        arrived=arrived,
        path_length_m=info.path_length_m,
        planning_s=totals.planning_s,
        replans=totals.replans,
        wall_s=wall_s,
        contacts=tuple(log.contacts),
        standing_contacts=tuple(log.standing_contacts),
        unseen_contacts=log.unseen_contacts(world, info.robot),
        monitor_stops=log.monitor_stops,
        recoveries=sum(ran.recovery for ran in behaviors),
        standing_reasons=totals.standing_reasons,
        lost_s=log.lost_s,
        forgotten_m=log.forgotten_m,
        truth=truth,
    )
    return Episode(
        outcome=outcome,
        message=message,
        metrics=metrics,
        trajectory=trajectory,
        paths=tuple(log.paths),
        start=info.start,
        goals=info.goals,
        goals_reached=goals_reached,
        name=info.name,
        robot=info.robot.name,
        planner=info.planner,
        controller=info.controller,
        seed=info.seed,
        time_limit_s=info.time_limit_s,
        costmap=info.costmap,
        behaviors=behaviors,
        directives=directives,
        fault=fault,
        complete=complete,
        own_map=own_map,
    )
