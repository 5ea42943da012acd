"""Missions: a scenario is run once, from start to goal, and gives an episode."""

from trundle.geometry import Goal
from trundle.mission.episode import Episode, Metrics, Outcome
from trundle.mission.fields import RunSettings
from trundle.mission.loop import run
from trundle.mission.monitoring import Monitor
from trundle.mission.observers import MonitorReport, Observer, RunInfo, Step
from trundle.mission.rules import Rules
from trundle.mission.sampling import sample_mission, sample_tight_ends
from trundle.mission.scenario import Mission, Scenario, Setting
from trundle.mission.session import Session
from trundle.mission.trajectory import Trajectory

__all__ = [
    "Episode",
    "Goal",
    "Metrics",
    "Mission",
    "Monitor",
    "MonitorReport",
    "Observer",
    "Outcome",
    "Rules",
    "RunInfo",
    "RunSettings",
    "Scenario",
    "Session",
    "Setting",
    "Step",
    "Trajectory",
    "run",
    "sample_mission",
    "sample_tight_ends",
]
