"""`Drive`, what a drive to a goal has come to, and `Now`, where its robot is in this control period."""

from __future__ import annotations

import math
from dataclasses import dataclass

from trundle.control import Controller, GoalChecker, ProgressChecker
from trundle.costmap import Costmap
from trundle.errors import PlanningError
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.navigation.navigator_settings import NavigatorSettings
from trundle.navigation.status import NavigationStatus
from trundle.observation import Track
from trundle.planning import Planner, Smoother


@dataclass(frozen=True, slots=True)
class Now:
    """Where the robot is now, how it moves, and what it drives on.

    Attributes:
        time: [s], any origin.
        pose: Map frame.
        twist: base_link.
        costmap: With what the scans saw.
    """

    time: float
    pose: Pose2D
    twist: Twist2D
    costmap: Costmap


class Drive:
    """The state of a drive that a navigator shares with what plans and recovers for it; see `Navigator`."""

    planner: Planner
    controller: Controller

    def __init__(self, settings: NavigatorSettings) -> None:
        self.settings = settings
        self.goal_checker: GoalChecker = settings.make_goal_checker()
        self.progress_checker: ProgressChecker = settings.make_progress_checker()
        self.smoother: Smoother | None = None
        self.status = NavigationStatus.IDLE
        self.tracks: tuple[Track, ...] = ()
        Drive._begin(self, None)

    def _begin(self, target: Goal | None) -> None:
        """Start over with this goal; the status stays."""
        self.target: Goal | None = target
        self.ahead: tuple[Goal, ...] = () if target is None else (target,)
        self.first_number = 1
        self.message = ""
        self.error: PlanningError | None = None
        self.planning_time_s = 0.0
        self.planning_expansions = 0
        self.replans = 0
        self.standing_reasons: dict[str, int] = {}
        self.speed_limit = math.inf
        self.progress_checker.reset()


def count_reason(drive: Drive, reason: str) -> None:
    """Count, and say, why the controller makes no progress in this control period; "" where it does."""
    if reason:
        drive.standing_reasons[reason] = drive.standing_reasons.get(reason, 0) + 1
        drive.message = drive.message or reason
