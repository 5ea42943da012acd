"""Navigation: plan, follow, replan and recover behind one call, for any simulator or robot."""

from trundle.control.latency import Latency
from trundle.files.choice import Choice
from trundle.navigation.agent import Agent, AgentInfo, AgentReport
from trundle.navigation.agents import AgentLike, CommandScript, agent_names, create_agent
from trundle.navigation.command_check import AssistedCommand
from trundle.navigation.goal_queue import Waypoint
from trundle.navigation.navigator import Navigator
from trundle.navigation.navigator_settings import NavigatorSettings
from trundle.navigation.state import NavigationStatus

__all__ = [
    "Agent",
    "AgentInfo",
    "AgentLike",
    "AgentReport",
    "AssistedCommand",
    "Choice",
    "CommandScript",
    "Latency",
    "NavigationStatus",
    "Navigator",
    "NavigatorSettings",
    "Waypoint",
    "agent_names",
    "create_agent",
]
