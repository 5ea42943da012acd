"""Controllers: from a path and where the robot is to the next twist; and the checks on the way."""

from trundle.control.checkers import GoalChecker, ProgressChecker
from trundle.control.controller import Controller, controller_names, create_controller

__all__ = ["Controller", "GoalChecker", "ProgressChecker", "controller_names", "create_controller"]
