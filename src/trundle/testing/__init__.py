"""Conformance checks of agents, planners, controllers, layers, localizers and simulators, built in or third-party."""

from trundle.testing.agent import check_agent
from trundle.testing.conformance import ConformanceError
from trundle.testing.controller import check_controller
from trundle.testing.layer import check_layer
from trundle.testing.localizer import check_localizer
from trundle.testing.planner import check_planner
from trundle.testing.simulator import check_simulator

__all__ = [
    "ConformanceError",
    "check_agent",
    "check_controller",
    "check_layer",
    "check_localizer",
    "check_planner",
    "check_simulator",
]
