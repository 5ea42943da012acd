"""`make_episode`: the episode of a run that has ended, from its log and from what its agent counted."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Sequence

from trundle.fault import Fault
from trundle.mission.episode import Episode, Outcome
from trundle.mission.metrics import compute_metrics
from trundle.mission.observers import RunInfo
from trundle.mission.running.run_log import RunLog
from trundle.mission.steering.directives import GivenDirective
from trundle.mission.truth import DroppedBox, Measure, Truth, near_boxes
from trundle.navigation import Agent
from trundle.navigation.behaviors import BehaviorRun
from trundle.worlds import World


class AgentTotals:
    """What an agent counts for each goal, summed over a run.

    Attributes:
        planning_s: Wall time spent on planning [s].
        replans: Plans beyond the first ones.
        standing_reasons: In how many control periods its controller made no progress, by reason.
    """

    def __init__(self) -> None:
        self.planning_s = 0.0
        self.replans = 0
        self.standing_reasons: Counter[str] = Counter()

    def add(self, agent: Agent) -> None:
        """Add the counts for a goal, at its end: the next `set_goal` clears them."""
        self.planning_s += getattr(agent, "planning_time_s", 0.0)
        self.replans += getattr(agent, "replans", 0)
        self.standing_reasons.update(getattr(agent, "standing_reasons", {}))


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
) -> Episode:
    """The episode of a run.

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
    )
