"""Launches Nav2 with the parameters and the map beside this file, for turtlebot3_waffle: ros2 launch nav2.launch.py

Written by trundle for ROS 2 jazzy.
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

HERE = Path(__file__).resolve().parent
SERVERS = [
    ("nav2_map_server", "map_server", "map_server", []),
    ("nav2_amcl", "amcl", "amcl", []),
    ("nav2_controller", "controller_server", "controller_server", [("cmd_vel", "cmd_vel_nav")]),
    ("nav2_smoother", "smoother_server", "smoother_server", []),
    ("nav2_planner", "planner_server", "planner_server", []),
    ("nav2_behaviors", "behavior_server", "behavior_server", [("cmd_vel", "cmd_vel_nav")]),
    ("nav2_bt_navigator", "bt_navigator", "bt_navigator", []),
    ("nav2_waypoint_follower", "waypoint_follower", "waypoint_follower", []),
    ("nav2_velocity_smoother", "velocity_smoother", "velocity_smoother", [("cmd_vel", "cmd_vel_nav")]),
    ("nav2_collision_monitor", "collision_monitor", "collision_monitor", []),
]
"""Package, executable, node, and its remappings."""

MASKS = {}
"""Nodes that serve masks, and the file of each."""


def generate_launch_description():
    simulated = LaunchConfiguration("use_sim_time")
    common = [
        LaunchConfiguration("params_file"),
        {"use_sim_time": ParameterValue(simulated, value_type=bool)},
    ]
    files = {name: str(HERE / file) for name, file in MASKS.items()}
    files["map_server"] = LaunchConfiguration("map")
    nodes = []
    for package, executable, name, remappings in SERVERS:
        own = [{"yaml_filename": files[name]}] if name in files else []
        nodes.append(
            Node(
                package=package,
                executable=executable,
                name=name,
                output="screen",
                parameters=common + own,
                remappings=remappings,
            )
        )
    manager = Node(
        package="nav2_lifecycle_manager",
        executable="lifecycle_manager",
        name="lifecycle_manager_navigation",
        output="screen",
        parameters=[
            {
                "use_sim_time": ParameterValue(simulated, value_type=bool),
                "autostart": True,
                "node_names": [server[2] for server in SERVERS],
            }
        ],
    )
    arguments = [
        DeclareLaunchArgument("use_sim_time", default_value="true", description="Use the simulator's clock"),
        DeclareLaunchArgument("params_file", default_value=str(HERE / "nav2_params.yaml"), description="Parameters"),
        DeclareLaunchArgument("map", default_value=str(HERE / "map.yaml"), description="Map"),
    ]
    return LaunchDescription([*arguments, *nodes, manager])
