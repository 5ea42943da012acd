"""Mapping: a map and the robot's path from scans and odometry."""

from trundle.mapping.drawing import draw_map
from trundle.mapping.mapper import Mapper
from trundle.mapping.pose_graph import Lidar, PoseGraph

__all__ = ["Lidar", "Mapper", "PoseGraph", "draw_map"]
