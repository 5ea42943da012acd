"""Poses, twists and outlines: SI units, radians, axes of REP-103 (x forward, y left, z up, yaw to the left)."""

from trundle.geometry.footprint import Footprint, convex_hull, pad_outline, shrink_outline
from trundle.geometry.poses import (
    FloatArray,
    Goal,
    Pose2D,
    Twist2D,
    arc_lengths,
    arc_shares,
    format_pose,
    integrate_twist,
    path_length,
    wrap_angle,
    wrap_angles,
)
from trundle.geometry.poses3d import Pose3D, rotation_matrices

__all__ = [
    "FloatArray",
    "Footprint",
    "Goal",
    "Pose2D",
    "Pose3D",
    "Twist2D",
    "arc_lengths",
    "arc_shares",
    "convex_hull",
    "format_pose",
    "integrate_twist",
    "pad_outline",
    "path_length",
    "rotation_matrices",
    "shrink_outline",
    "wrap_angle",
    "wrap_angles",
]
