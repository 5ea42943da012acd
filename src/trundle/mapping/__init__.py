"""Mapping: a map and the robot's path from scans and odometry."""

from trundle.mapping.drawing import draw_map
from trundle.mapping.mapper import Mapper
from trundle.mapping.merging import merge_pose_graphs, move_pose_graph
from trundle.mapping.pose_graph import Lidar, PoseGraph
from trundle.mapping.pose_graph_file import load_pose_graph, save_pose_graph

__all__ = [
    "Lidar",
    "Mapper",
    "PoseGraph",
    "draw_map",
    "load_pose_graph",
    "merge_pose_graphs",
    "move_pose_graph",
    "save_pose_graph",
]
