"""Mapping: a map and the robot's path from scans and odometry."""

from trundle.mapping.pose_graph import Lidar, PoseGraph

__all__ = ["Lidar", "PoseGraph"]
