"""Controllers: from a path and where the robot is to the next twist; and the checks on the way."""

from trundle.control.controller import Controller, controller_names, create_controller

__all__ = ["Controller", "controller_names", "create_controller"]
