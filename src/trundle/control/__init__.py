"""Controllers: the next twist from a path and the robot's pose; and checks of goal and progress."""

from trundle.control.checkers import GoalChecker, ProgressChecker
from trundle.control.controller import Controller, controller_names, create_controller

__all__ = ["Controller", "GoalChecker", "ProgressChecker", "controller_names", "create_controller"]
