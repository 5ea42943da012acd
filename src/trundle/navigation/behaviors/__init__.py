"""Behaviors: back up, spin, wait and other steps of recovery, which also run on their own and as tasks of waypoints."""

from trundle.navigation.behaviors.behavior import (
    Behavior,
    BehaviorContext,
    BehaviorResult,
    BehaviorRun,
    ClearCostmap,
    Replan,
    ReplanWith,
    Wait,
    behavior_names,
    create_behavior,
    describe_behaviors,
)
from trundle.navigation.behaviors.motions import BackUp, DriveClear, DriveOnHeading, Spin

__all__ = [
    "BackUp",
    "Behavior",
    "BehaviorContext",
    "BehaviorResult",
    "BehaviorRun",
    "ClearCostmap",
    "DriveClear",
    "DriveOnHeading",
    "Replan",
    "ReplanWith",
    "Spin",
    "Wait",
    "behavior_names",
    "create_behavior",
    "describe_behaviors",
]
