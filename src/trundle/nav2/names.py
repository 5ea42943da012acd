"""Names of Nav2's nodes and plugins, and how they differ between distributions."""

from __future__ import annotations

from trundle.messages.codec import Distro

RPP = "nav2_regulated_pure_pursuit_controller::RegulatedPurePursuitController"
MPPI = "nav2_mppi_controller::MPPIController"
DWB = "dwb_core::DWBLocalPlanner"
GRACEFUL = "nav2_graceful_controller::GracefulController"
ROTATION_SHIM = "nav2_rotation_shim_controller::RotationShimController"

NAVFN = "nav2_navfn_planner::NavfnPlanner"
SMAC_2D = "nav2_smac_planner::SmacPlanner2D"
SMAC_HYBRID = "nav2_smac_planner::SmacPlannerHybrid"
SMAC_LATTICE = "nav2_smac_planner::SmacPlannerLattice"
THETA_STAR = "nav2_theta_star_planner::ThetaStarPlanner"

STATIC_LAYER = "nav2_costmap_2d::StaticLayer"
OBSTACLE_LAYER = "nav2_costmap_2d::ObstacleLayer"
VOXEL_LAYER = "nav2_costmap_2d::VoxelLayer"
INFLATION_LAYER = "nav2_costmap_2d::InflationLayer"
KEEPOUT_FILTER = "nav2_costmap_2d::KeepoutFilter"
SPEED_FILTER = "nav2_costmap_2d::SpeedFilter"

CONSTRAINED_SMOOTHER = "nav2_constrained_smoother::ConstrainedSmoother"
SIMPLE_SMOOTHER = "nav2_smoother::SimpleSmoother"

SIMPLE_PROGRESS = "nav2_controller::SimpleProgressChecker"
POSE_PROGRESS = "nav2_controller::PoseProgressChecker"
SIMPLE_GOAL = "nav2_controller::SimpleGoalChecker"
STOPPED_GOAL = "nav2_controller::StoppedGoalChecker"
POSITION_GOAL = "nav2_controller::PositionGoalChecker"

BEHAVIORS = {"spin": "Spin", "backup": "BackUp", "drive_on_heading": "DriveOnHeading", "wait": "Wait"}
"""Plugins of nav2_behaviors by the names that Nav2's behavior trees call them by."""

_SLASHED = (
    "nav2_navfn_planner",
    "nav2_smac_planner",
    "nav2_theta_star_planner",
    "nav2_constrained_smoother",
    "nav2_behaviors",
)
"""Packages whose plugins were named with a slash up to Humble."""


def plain_plugin(name: str) -> str:
    """Return a plugin's name with `::`, as current distributions write it; Humble and older have `/` in some."""
    return name.replace("/", "::", 1) if "::" not in name else name


def plugin_for(name: str, distro: Distro) -> str:
    """Return a plugin's name as a distribution writes it."""
    package = name.partition("::")[0]
    return name.replace("::", "/", 1) if distro == "humble" and package in _SLASHED else name
