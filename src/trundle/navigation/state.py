"""What a navigator is doing, `NavigationStatus`; what its parts read, and what they answer with, `Decision`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any, NamedTuple

from trundle.costmap import Costmap
from trundle.errors import PlanningError
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.navigation.progress import FollowedPath
from trundle.observation import Track
from trundle.planning import Planner
from trundle.robots import Robot


class NavigationStatus(StrEnum):
    """What a navigator is doing."""

    IDLE = "idle"
    """It has no goal."""
    DRIVING = "driving"
    """It follows a path to the goal."""
    BLOCKED = "blocked"
    """Every command would cause a contact, or planning takes long; it replans, backs up, or waits to replan."""
    BEHAVING = "behaving"
    """It runs a behavior that it was asked for, or the task of a waypoint."""
    ARRIVED = "arrived"
    """The robot stands at the goal."""
    FINISHED = "finished"
    """All that an agent without a goal had to do, such as a script of commands or a behavior, is done."""
    STUCK = "stuck"
    """The robot made no progress within the time allowance, though there is a path, or a behavior that it was asked for
    failed; it has given up this goal."""
    NO_PATH = "no_path"
    """No path to the goal was found, from the start or from where the robot was blocked; `Navigator.error` says why."""
    PLANNING_TIMED_OUT = "planning_timed_out"
    """Planning missed its deadline three times in a row; whether there is a path is not known."""


FINAL = frozenset(
    {
        NavigationStatus.ARRIVED,
        NavigationStatus.FINISHED,
        NavigationStatus.STUCK,
        NavigationStatus.NO_PATH,
        NavigationStatus.PLANNING_TIMED_OUT,
    }
)
"""The robot stands still until there is another goal."""

_S = NavigationStatus

ANY_STATUS_TO: Mapping[NavigationStatus, str] = {
    _S.IDLE: "`reset` or `cancel`",
    _S.DRIVING: "`set_goal`, `set_goals` or `follow`",
    _S.BEHAVING: "`run`",
}
"""What a program asks for, which changes every status to this one."""

TRANSITIONS: Mapping[tuple[NavigationStatus, NavigationStatus], str] = {
    (_S.DRIVING, _S.BLOCKED): "no progress, or a plan has to wait",
    (_S.DRIVING, _S.BEHAVING): "a waypoint with tasks is reached",
    (_S.BLOCKED, _S.BEHAVING): "a waypoint with tasks is reached",
    (_S.BEHAVING, _S.DRIVING): "the behaviors have ended, or `cancel_behavior`: on to the goal",
    (_S.BLOCKED, _S.DRIVING): "the controller commands a motion again, or the next goal is taken up",
    (_S.BEHAVING, _S.ARRIVED): "the tasks of the last goal have succeeded",
    (_S.DRIVING, _S.ARRIVED): "the robot stands at the last goal",
    (_S.BLOCKED, _S.ARRIVED): "the robot stands at the last goal",
    (_S.BEHAVING, _S.FINISHED): "the behavior has succeeded, or `cancel_behavior`, and there is no goal to drive on to",
    (_S.BEHAVING, _S.IDLE): "`cancel_behavior`, and there is no goal",
    (_S.BEHAVING, _S.STUCK): "a task has failed, or a behavior and there is no goal to drive on to",
    (
        _S.DRIVING,
        _S.STUCK,
    ): "no progress within the time allowance, after all tries of recovery, or not localized for too long; or a task "
    "has failed at once",
    (
        _S.BLOCKED,
        _S.STUCK,
    ): "no progress within the time allowance, after all tries of recovery, or not localized for too long",
    (_S.DRIVING, _S.NO_PATH): "no path, and nothing that was sensed may move away",
    (_S.BLOCKED, _S.NO_PATH): "no path, and the robot has waited or tried for long enough",
    (_S.DRIVING, _S.PLANNING_TIMED_OUT): "the third plan in a row missed its deadline",
    (_S.BLOCKED, _S.PLANNING_TIMED_OUT): "the third plan in a row missed its deadline",
}
"""The event of each other change of status; no other change happens."""


# Snapshots and decisions are made in every control period: a named tuple takes a quarter of the time of a frozen
# dataclass.


class Snapshot(NamedTuple):
    """What a navigator and its behaviors know in one control period.

    Attributes:
        time: Now [s], any origin.
        pose: Where the robot is, map frame; with a delay of commands, where it will be when the next one takes effect.
        twist: How it moves there, base_link.
        costmap: The obstacles, with what the scans saw.
        dt: Length of the control period [s].
        robot: The robot.
        sees: Whether scans have been put into the costmap.
        clear_costmap: Forgets what the scans saw.
        replan: Plans from here to the goal, by the navigator's planner (None) or another one, and follows that path.
            Raises `BehaviorFailedError` if there is no goal or no path. Only a behavior that runs may call it.
        tracks: What the scans show to move, predicted to now, map frame.
    """

    time: float
    pose: Pose2D
    twist: Twist2D
    costmap: Costmap
    dt: float
    robot: Robot
    sees: bool
    clear_costmap: Callable[[], None]
    replan: Callable[[Planner | None], None]
    tracks: tuple[Track, ...] = ()


class Decision(NamedTuple):
    """What a part of a navigator has decided; the navigator applies it. What is left out stays as it is.

    Attributes:
        command: The command for this control period; None where another part is to decide on it.
        status: What the navigator is doing from now on.
        message: What blocks the robot.
        reasons: Why the controller made no progress in this control period; each is counted.
        error: Why there is no path.
        clears_error: Whether the last planning error does not hold any more.
        path: The path to follow from now on.
        ahead: The next goals, up to the next stop.
        first_number: Number of the first of these, from 1.
        replans: How many plans were made after the first one.
        planning_time_s: How long planning took [s].
        planning_expansions: Nodes that were expanded in planning.
        restarts_progress: Whether the time allowance for progress begins again.
    """

    command: Twist2D | None = None
    status: NavigationStatus | None = None
    message: str | None = None
    reasons: tuple[str, ...] = ()
    error: PlanningError | None = None
    clears_error: bool = False
    path: FollowedPath | None = None
    ahead: tuple[Goal, ...] | None = None
    first_number: int = 1
    replans: int = 0
    planning_time_s: float = 0.0
    planning_expansions: int = 0
    restarts_progress: bool = False

    def then(self, later: Decision) -> Decision:
        """Return both in one: where both say something, the later one counts, and numbers add up."""
        if self is NOTHING:
            return later
        if later is NOTHING:
            return self
        decides_error = later.error is not None or later.clears_error
        aims = later if later.ahead is not None else self
        return Decision(
            command=self.command if later.command is None else later.command,
            status=self.status if later.status is None else later.status,
            message=self.message if later.message is None else later.message,
            reasons=self.reasons + later.reasons,
            error=later.error if decides_error else self.error,
            clears_error=later.clears_error if decides_error else self.clears_error,
            path=self.path if later.path is None else later.path,
            ahead=aims.ahead,
            first_number=aims.first_number,
            replans=self.replans + later.replans,
            planning_time_s=self.planning_time_s + later.planning_time_s,
            planning_expansions=self.planning_expansions + later.planning_expansions,
            restarts_progress=self.restarts_progress or later.restarts_progress,
        )


NOTHING = Decision()
"""Everything stays as it is."""


@dataclass(frozen=True, slots=True, eq=False)
class DriveState:
    """What a drive has come to; a navigator replaces it as a whole.

    Attributes:
        status: What the navigator is doing.
        message: What blocks the robot; empty where nothing does.
        error: The last planning error, or None.
        ahead: The goals from the one that it drives to up to the next stop; empty without a goal.
        first_number: Number of the first of these among the goals that were set, from 1.
        replans: Number of plans since the goal was set, after the first.
        planning_time_s: Time spent on planning since then [s].
        planning_expansions: Nodes that were expanded in planning since then.
        standing_reasons: In how many control periods since then the controller made no progress, by its reason.
    """

    status: NavigationStatus = NavigationStatus.IDLE
    message: str = ""
    error: PlanningError | None = None
    ahead: tuple[Goal, ...] = ()
    first_number: int = 1
    replans: int = 0
    planning_time_s: float = 0.0
    planning_expansions: int = 0
    standing_reasons: Mapping[str, int] = field(default_factory=dict[str, int])

    @property
    def target(self) -> Goal | None:
        """The goal that the robot drives to, or None."""
        return self.ahead[0] if self.ahead else None

    @property
    def is_final(self) -> bool:
        """Whether the robot stands until there is another goal."""
        return self.status in FINAL

    def after(self, decision: Decision) -> DriveState:
        """Return the state that a decision leads to; the same one where the decision changes nothing."""
        changes: dict[str, Any] = {}
        if decision.status is not None and decision.status is not self.status:
            changes["status"] = decision.status
        message = self.message if decision.message is None else decision.message
        if decision.reasons:
            counts = dict(self.standing_reasons)
            for reason in decision.reasons:
                counts[reason] = counts.get(reason, 0) + 1
                message = message or reason  # what blocks the path says more, and stays
            changes["standing_reasons"] = counts
        if message != self.message:
            changes["message"] = message
        if decision.error is not None or (decision.clears_error and self.error is not None):
            changes["error"] = decision.error
        if decision.ahead is not None:
            changes["ahead"], changes["first_number"] = decision.ahead, decision.first_number
        if decision.replans:
            changes["replans"] = self.replans + decision.replans
        if decision.planning_time_s or decision.planning_expansions:
            changes["planning_time_s"] = self.planning_time_s + decision.planning_time_s
            changes["planning_expansions"] = self.planning_expansions + decision.planning_expansions
        return replace(self, **changes) if changes else self
