"""The launch file of an export: Nav2's nodes with its parameters, without other packages than Nav2's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

_Server: TypeAlias = tuple[str, str, str, list[tuple[str, str]]]

_HEAD = '''"""Launches Nav2 with the parameters and the map beside this file, for {robot}: ros2 launch {name}

Written by trundle for ROS 2 {distro}.
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

HERE = Path(__file__).resolve().parent
SERVERS = [
{servers}]
"""Package, executable, node, and its remappings."""

MASKS = {masks}
"""Nodes that serve masks, and the file of each."""


def generate_launch_description():
    simulated = LaunchConfiguration("use_sim_time")
    common = [
        LaunchConfiguration("params_file"),
        {{"use_sim_time": ParameterValue(simulated, value_type=bool)}},
    ]
    files = {{name: str(HERE / file) for name, file in MASKS.items()}}
    files["map_server"] = LaunchConfiguration("map")
    nodes = []
    for package, executable, name, remappings in SERVERS:
        own = [{{"yaml_filename": files[name]}}] if name in files else []
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
            {{
                "use_sim_time": ParameterValue(simulated, value_type=bool),
                "autostart": True,
                "node_names": [server[2] for server in SERVERS],
            }}
        ],
    )
    arguments = [
        DeclareLaunchArgument("use_sim_time", default_value="true", description="Use the simulator's clock"),
        DeclareLaunchArgument("params_file", default_value=str(HERE / "nav2_params.yaml"), description="Parameters"),
        DeclareLaunchArgument("map", default_value=str(HERE / "map.yaml"), description="Map"),
    ]
    return LaunchDescription([*arguments, *nodes, manager])
'''

_TO_NAV = "cmd_vel_nav"


def launch_text(
    name: str, robot: str, distro: str, *, masks: Sequence[str] = (), has_map: bool = True, has_monitor: bool = True
) -> str:
    """Return the text of the launch file.

    Args:
        name: Its own name.
        robot: The robot's name.
        distro: The distribution.
        masks: "keepout" and "speed", for the masks there are.
        has_map: Whether the robot starts with the map: then it is served, and AMCL started.
        has_monitor: Whether the collision monitor stands between the velocity smoother and the robot.
    """
    commands = ("cmd_vel", _TO_NAV)
    servers: list[_Server] = []
    if has_map:
        servers += [("nav2_map_server", "map_server", "map_server", []), ("nav2_amcl", "amcl", "amcl", [])]
    for mask in masks:
        node = f"{mask}_filter_mask_server"
        info = f"{mask}_costmap_filter_info_server"
        servers += [
            ("nav2_map_server", "map_server", node, []),
            ("nav2_map_server", "costmap_filter_info_server", info, []),
        ]
    servers += [
        ("nav2_controller", "controller_server", "controller_server", [commands]),
        ("nav2_smoother", "smoother_server", "smoother_server", []),
        ("nav2_planner", "planner_server", "planner_server", []),
        ("nav2_behaviors", "behavior_server", "behavior_server", [commands]),
        ("nav2_bt_navigator", "bt_navigator", "bt_navigator", []),
        ("nav2_waypoint_follower", "waypoint_follower", "waypoint_follower", []),
    ]
    smoothed = [] if has_monitor else [("cmd_vel_smoothed", "cmd_vel")]
    servers.append(("nav2_velocity_smoother", "velocity_smoother", "velocity_smoother", [commands, *smoothed]))
    if has_monitor:
        servers.append(("nav2_collision_monitor", "collision_monitor", "collision_monitor", []))
    lines = "".join(f"    {_show(server)},\n" for server in servers)
    files = ", ".join(f'"{mask}_filter_mask_server": "{mask}.yaml"' for mask in masks)
    title = " ".join(robot.replace("\\", " ").replace('"', " ").split())
    return _HEAD.format(name=name, robot=title, distro=distro, servers=lines, masks=f"{{{files}}}")


def _show(server: _Server) -> str:
    package, executable, node, remappings = server
    pairs = ", ".join(f'("{old}", "{new}")' for old, new in remappings)
    return f'("{package}", "{executable}", "{node}", [{pairs}])'
