"""Conformance checks of what plug-ins add: agents, behaviors, planners, controllers, layers, localizers, simulators."""

from trundle.testing.agent import check_agent
from trundle.testing.behavior import check_behavior
from trundle.testing.conformance import ConformanceError
from trundle.testing.controller import check_controller
from trundle.testing.layer import check_layer
from trundle.testing.localizer import check_localizer
from trundle.testing.planner import check_planner
from trundle.testing.simulator import Tolerances, check_simulator

__all__ = [
    "ConformanceError",
    "Tolerances",
    "check_agent",
    "check_behavior",
    "check_controller",
    "check_layer",
    "check_localizer",
    "check_planner",
    "check_simulator",
]
