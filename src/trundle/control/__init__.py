"""Controllers: the next twist from a path and the robot's pose; checks of goal and progress; a collision monitor."""

from trundle.control.checkers import GoalChecker, ProgressChecker
from trundle.control.collision_monitor import CollisionMonitor, MonitorAction, MonitorReport, MonitorSettings
from trundle.control.controller import Controller, ControllerLike, Intent, Rollouts, controller_names, create_controller

__all__ = [
    "CollisionMonitor",
    "Controller",
    "ControllerLike",
    "GoalChecker",
    "Intent",
    "MonitorAction",
    "MonitorReport",
    "MonitorSettings",
    "ProgressChecker",
    "Rollouts",
    "controller_names",
    "create_controller",
]
