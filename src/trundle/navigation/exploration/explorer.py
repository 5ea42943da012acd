"""`Explorer`: an agent that drives to frontiers until nothing is left to see."""

from __future__ import annotations

import math
from typing import Any, Literal

from trundle.control.latency import Latency
from trundle.errors import PlanningError
from trundle.files.yaml_config import build
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation.agent import Agent, AgentInfo, AgentReport
from trundle.navigation.behaviors import Behavior
from trundle.navigation.command_check import AssistedCommand
from trundle.navigation.exploration.frontiers import (
    ExplorerSettings,
    Frontier,
    GivenUp,
    Targets,
    find_frontiers,
    is_same,
    shows_floor,
)
from trundle.navigation.navigator import Navigator
from trundle.navigation.state import FINAL, NavigationStatus
from trundle.observation import Estimate, Observation
from trundle.path import Path
from trundle.robots import Robot

_MOVED_M = 0.75
"""A goal is set again once its frontier has moved by this much [m]; each makes another plan."""
_BLIND_S = 5.0
"""Without a scan for this long at the start [s], there will be none; so long it also waits for scans of floor."""
_NEARER_M = 0.3
_PATHLESS_S = 1.0
"""A navigator waits for what blocks every path to move away; an explorer looks elsewhere meanwhile [s]."""
_STANDING_S = 5.0
"""So long it stands before what blocks its path, where there is no other [s]: people walk on, other things stay."""
_SHUT_IN = 3
_PLACE_M = 0.5
"""Without a path to so many frontiers from places within this of each other [m], the robot is shut in: it waits."""

_FAILED = {
    NavigationStatus.NO_PATH: "no path",
    NavigationStatus.STUCK: "stuck on the way",
    NavigationStatus.PLANNING_TIMED_OUT: "planning timed out",
}


class Explorer(Agent):
    """Drives with a `Navigator` to where its map ends, and has FINISHED once no frontier is left that it can reach.

    It explores what the navigator's costmap shows as unknown: beside a localizer that makes a map (`slam`), the map;
    otherwise what its scans have seen. Frontiers are chosen by the distance to drive and by what they would show. One
    that cannot be reached is tried again after all others, and then given up, with a reason.

    Args:
        robot: The robot.
        navigator: What drives to frontiers: one without a map. If None, one is made with the defaults.
        settings: Which frontiers count, and when one is given up; or these by keyword.

    Attributes:
        navigator: What drives.
        settings: As given, or the defaults.
        status: DRIVING until it has FINISHED; STUCK where it gets no scans, or these show no floor around it.
        frontiers: The frontiers found last, map frame.
        target: The one that it drives to, or None.
    """

    takes_goals = False

    def __init__(
        self,
        robot: Robot,
        navigator: Navigator | None = None,
        settings: ExplorerSettings | None = None,
        **options: Any,
    ) -> None:
        self.navigator = Navigator(None, robot) if navigator is None else navigator
        base = {} if settings is None else settings.model_dump(exclude_unset=True)
        self.settings = build({**base, **options}, ExplorerSettings)
        self.dt = self.navigator.dt
        self._begin()

    def __repr__(self) -> str:
        return f"Explorer({self.navigator.robot.name}, {self.status.value}, {len(self.frontiers)} frontiers)"

    def _begin(self) -> None:
        self.status = NavigationStatus.IDLE
        self.frontiers: list[Frontier] = []
        self.target: Frontier | None = None
        self._targets = Targets(self.settings)
        self._message = ""
        self._began_s: float | None = None
        self._looks_s = -math.inf
        self._has_scans = False
        self._blind_since: float | None = None
        self._nearest, self._nearest_s = math.inf, 0.0
        self._pathless_s = math.inf
        self._shut_at = Pose2D(0.0, 0.0)
        self._shut_from: list[Frontier] = []
        self._has_waited = False
        self._in_pieces = False

    @property
    def given_up(self) -> tuple[GivenUp, ...]:
        """The frontiers that it has given up and that are still there, each with the reason."""
        return self._targets.given_up(self.frontiers)

    # Driving --------------------------------------------------------------------------------------------------------

    def reset(self, *, seed: int = 0) -> None:
        """Forget what was seen, and explore from the next `update` on."""
        self.navigator.reset(seed=seed)
        self._begin()

    def set_goal(self, goal: Goal, /) -> None:
        """Do nothing: the frontiers say where to drive."""

    def update(self, observation: Observation, estimate: Estimate, /) -> Twist2D:
        """Return the command for the next control period; see `Agent.update`."""
        if self.status in FINAL:
            self.navigator.update(observation, estimate)
            return Twist2D()
        if self._began_s is None:
            self._began_s, self.status = observation.time, NavigationStatus.DRIVING
        self._has_scans = self._has_scans or len(observation.scans) > 0
        command = self.navigator.update(observation, estimate)
        if not self._has_scans:
            if observation.time - self._began_s > _BLIND_S:
                self._end(NavigationStatus.STUCK, "an explorer needs scans: give the robot lidars")
            return Twist2D()
        if estimate.state == "localized":
            self._decide(observation.time, estimate.pose)
        return Twist2D() if self.status in FINAL else command

    def _decide(self, now: float, pose: Pose2D) -> None:
        """Choose where to drive, if it is time to, or the last drive has ended."""
        status, target = self.navigator.status, self.target
        if status is NavigationStatus.BEHAVING:
            return
        ended = target is None or status in FINAL
        if status is NavigationStatus.BLOCKED and self.navigator.error is not None:
            self._pathless_s = min(self._pathless_s, now)
        else:
            self._pathless_s = math.inf
        if pose.distance_to(self._shut_at) > _PLACE_M:
            if len(self._shut_from) >= _SHUT_IN:  # what shut the robot in says nothing of these frontiers
                self._targets.forgive(self._shut_from)
            self._shut_at, self._shut_from, self._has_waited = pose, [], False
        if target is not None and not ended:
            left = math.hypot(pose.x - target.view[0], pose.y - target.view[1])
            if left < self._nearest - _NEARER_M:
                self._nearest, self._nearest_s = left, now
            elif now - self._nearest_s > self.settings.patience:
                ended = self._has_waited = True
                self._targets.refuse(target, f"not reached in {self.settings.patience:g} s: {self._why('blocked')}")
            elif now - self._pathless_s > self._wait_s():
                ended = True
                if not self._is_target_shut_in(target, pose):
                    self._shut_from.append(target)
                self._targets.refuse(target, self._why("no path"))
        if not ended and now - self._looks_s < self.settings.period - 1e-9:
            return
        if ended and now - self._looks_s < 2.5 * self.dt and target is None:
            return
        self._looks_s = now
        if target is not None and status in _FAILED:
            self._has_waited = True
            self._targets.refuse(target, self._why(_FAILED[status]))
        self.frontiers = find_frontiers(self.navigator.costmap, pose, self.settings, in_pieces=self._in_pieces)
        if target is not None and status is NavigationStatus.ARRIVED:
            self._targets.refuse(target, "it shows nothing new from the nearest place", for_good=True)
        if target is not None and not any(is_same(one, target) for one in self.frontiers):
            self._targets.note_vanished(target)
        chosen = self._targets.choose(self.frontiers, target)
        if chosen is None and self.frontiers and not self._in_pieces:
            # In a hall wider than the lidars see, the border may be one line round all that was seen, given up as one.
            self._in_pieces = True
            self.frontiers = find_frontiers(self.navigator.costmap, pose, self.settings, in_pieces=True)
            chosen = self._targets.choose(self.frontiers, target)
        self._take(chosen, now, pose, ended=ended)

    def _is_target_shut_in(self, target: Frontier, pose: Pose2D) -> bool:
        """Return whether the planner's error is about the place that it drives to, and not about where the robot is.

        In an office with narrow rooms, an explorer that waited after three of these, as if it were shut in itself,
        stood for 70 of 420 s.
        """
        at = self.navigator.error.pose if isinstance(self.navigator.error, PlanningError) else None
        return at is not None and math.dist(at[:2], target.view) < math.dist(at[:2], (pose.x, pose.y))

    def _wait_s(self) -> float:
        """Return how long it waits where no path leads to its target."""
        if len(self._shut_from) >= _SHUT_IN and not self._has_waited:
            return math.inf  # until the navigator, or the explorer's patience, has had enough
        return _PATHLESS_S if self.navigator.path is None else _STANDING_S

    def _take(self, chosen: Frontier | None, now: float, pose: Pose2D, *, ended: bool) -> None:
        """Drive to a frontier from now on; end without one."""
        last, self.target = self.target, chosen
        if not self.frontiers and not shows_floor(self.navigator.costmap, pose):
            self._wait_for_floor(now)
            return
        self._blind_since = None
        if chosen is None:
            lost = self.given_up
            left = "nothing is left to see" if not lost else f"{len(lost)} frontiers are given up"
            if len(lost) == 1:
                left = "1 frontier is given up"
            self._end(NavigationStatus.FINISHED, left)
            return
        goal = self.navigator.target
        if ended or last is None or goal is None or math.dist(chosen.view, (goal.x, goal.y)) > _MOVED_M:
            self.navigator.set_goal(*chosen.view)
            self._pathless_s = math.inf
            self._nearest, self._nearest_s = math.hypot(pose.x - chosen.view[0], pose.y - chosen.view[1]), now

    def _wait_for_floor(self, now: float) -> None:
        """Stand while the map shows no floor around the robot, for a while: it says nothing of what is left to see."""
        if self._blind_since is None:
            self._blind_since = now
            self.navigator.cancel()
        if now - self._blind_since > _BLIND_S:
            self._end(NavigationStatus.STUCK, "the lidars see nothing from here: their scans show no floor around it")

    def _why(self, what: str) -> str:
        """Return a failure of the navigator in words, with what it says of it."""
        said = self.navigator.message or (str(self.navigator.error) if self.navigator.error else "")
        return f"{what}: {said}" if said else what

    def _end(self, status: NavigationStatus, message: str) -> None:
        self.status, self._message = status, message
        self.navigator.cancel()

    # What it says of itself -----------------------------------------------------------------------------------------

    def info(self) -> AgentInfo:
        """Return what it is and drives with."""
        return self.navigator.info()

    def report(self, *, rollouts: bool = False) -> AgentReport:
        """Return what it is doing, and why."""
        report = self.navigator.report(rollouts=rollouts)
        message = report.message or self._message
        if self.status in FINAL:
            return report._replace(status=self.status, message=self._message, error=None)
        status = report.status if report.status not in FINAL else self.status
        return report._replace(
            status=self.status if status is NavigationStatus.IDLE else status, message=message, goals_reached=0
        )

    @property
    def path_left(self) -> Path | None:
        """What is left of the path that it follows; None without one."""
        return self.navigator.path_left

    # What it is told ------------------------------------------------------------------------------------------------

    def set_latency(self, latency: Latency) -> None:
        """Take into account from now on how late scans and commands arrive."""
        self.navigator.set_latency(latency)

    def set_map(self, grid: OccupancyGrid, *, corrected: bool) -> None:
        """Take the map that the localizer has made so far."""
        self.navigator.set_map(grid, corrected=corrected)

    def set_sent_command(self, command: Twist2D) -> None:
        """Take what was sent to the robot instead of the last command."""
        self.navigator.set_sent_command(command)

    def assist_teleop(self, command: Twist2D, observation: Observation, estimate: Estimate) -> AssistedCommand:
        """Return what of a command by hand may be sent."""
        self.target = None
        return self.navigator.assist_teleop(command, observation, estimate)

    def run(self, behavior: Behavior) -> None:
        """Run a behavior from the next `update` on, then explore on."""
        self.navigator.run(behavior)

    def cancel_behavior(self) -> None:
        """Stop the behavior that was asked for, if one runs, and explore on."""
        self.navigator.cancel_behavior()

    def clear_obstacles(
        self, region: Literal["all", "around", "except"] = "all", size: float = 0.0, *, at: Pose2D | None = None
    ) -> None:
        """Forget what the scans saw; the map stays."""
        self.navigator.clear_obstacles(region, size, at=at)
