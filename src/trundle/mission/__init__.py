"""Missions: a scenario is run once, from start to goal, and gives an episode."""

from trundle.fault import Fault
from trundle.geometry import Goal
from trundle.mission.episode import Episode, Metrics, Outcome
from trundle.mission.exploring import Exploration, explore
from trundle.mission.fields import Rules, RunSettings
from trundle.mission.loop import run
from trundle.mission.observers import (
    MonitorReport,
    Observer,
    RolloutObserver,
    RunInfo,
    SteeringReport,
    Step,
    SubstepObserver,
)
from trundle.mission.own_map import Correction, MapTrack, OwnMap
from trundle.mission.run_files import load_directives, save_directives
from trundle.mission.running.robot_stack import Monitor
from trundle.mission.running.session import Session
from trundle.mission.sampling import sample_mission, sample_tight_ends
from trundle.mission.scenario import Mission, Scenario, Setting
from trundle.mission.steering.directives import (
    DropBox,
    End,
    GivenDirective,
    Manual,
    Pause,
    PlaceRobot,
    Release,
    Restart,
    Speed,
    StepOnce,
    WaitAtGoal,
)
from trundle.mission.steering.goal_directives import (
    Cancel,
    ClearObstacles,
    FollowPath,
    ReinitializeGlobal,
    RunBehavior,
    SetGoal,
    SetGoals,
    SetPose,
)
from trundle.mission.steering.live import LiveRun, LiveStatus
from trundle.mission.steering.queue import Steering, TaskEnd, TaskWatcher
from trundle.mission.trajectory import Trajectory

__all__ = [
    "Cancel",
    "ClearObstacles",
    "Correction",
    "DropBox",
    "End",
    "Episode",
    "Exploration",
    "Fault",
    "FollowPath",
    "GivenDirective",
    "Goal",
    "LiveRun",
    "LiveStatus",
    "Manual",
    "MapTrack",
    "Metrics",
    "Mission",
    "Monitor",
    "MonitorReport",
    "Observer",
    "Outcome",
    "OwnMap",
    "Pause",
    "PlaceRobot",
    "ReinitializeGlobal",
    "Release",
    "Restart",
    "RolloutObserver",
    "Rules",
    "RunBehavior",
    "RunInfo",
    "RunSettings",
    "Scenario",
    "Session",
    "SetGoal",
    "SetGoals",
    "SetPose",
    "Setting",
    "Speed",
    "Steering",
    "SteeringReport",
    "Step",
    "StepOnce",
    "SubstepObserver",
    "TaskEnd",
    "TaskWatcher",
    "Trajectory",
    "WaitAtGoal",
    "explore",
    "load_directives",
    "run",
    "sample_mission",
    "sample_tight_ends",
    "save_directives",
]
