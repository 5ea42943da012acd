"""`export_nav2`: a folder with which Nav2 drives a robot as trundle does, with its launch file."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import yaml

from trundle.errors import InputError
from trundle.files.writing import make_folder, write_text
from trundle.maps import KeepoutMask, OccupancyGrid, SpeedMask
from trundle.maps.ros_writer import choose_mode, save_map
from trundle.messages.codec import DEFAULT, DISTROS, Distro
from trundle.mission import Scenario
from trundle.mission.setup import Place, make_place
from trundle.nav2.controllers import write_controllers
from trundle.nav2.costmaps import write_costmaps
from trundle.nav2.draft import Block, Draft, note_leftovers
from trundle.nav2.filters import UNIT_NUMBERS
from trundle.nav2.monitor import monitor_of, write_monitor
from trundle.nav2.notes import Remark, describe_remarks
from trundle.nav2.planners import write_planners
from trundle.nav2.servers import write_servers

PARAMS, LAUNCH, REMARKS = "nav2_params.yaml", "nav2.launch.py", "no_counterpart.txt"
MAP, KEEPOUT, SPEED = "map.yaml", "keepout.yaml", "speed.yaml"
"""Files of an export: the map and the masks each have their image beside them."""

_COSTMAPS = ("local_costmap", "global_costmap")


@dataclass(frozen=True, slots=True)
class Nav2Export:
    """What was written.

    Attributes:
        folder: The folder.
        files: The names of the files in it.
        remarks: Every setting that means something else in Nav2, or has no counterpart.
    """

    folder: Path
    files: tuple[str, ...]
    remarks: tuple[Remark, ...]


def export_nav2(scenario: Scenario, folder: str | os.PathLike[str], *, distro: Distro = DEFAULT) -> Nav2Export:
    """Write a scenario's settings as Nav2's parameters, with the map, the masks and a launch file.

    `no_counterpart.txt` has the remarks, one on a line. Files of these names in the folder are replaced.

    Args:
        scenario: The scenario.
        folder: The folder; it is created.
        distro: The distribution whose names are written.

    Raises:
        UnknownNameError: If the scenario names a robot or a world that is not known.
        InputError: If a file or an option of the scenario cannot be used, or there is no such distribution.
        OutputError: If the folder cannot be written to.
    """
    if distro not in DISTROS:
        raise InputError(f"distro is one of {', '.join(DISTROS)}; got {distro!r}")
    place = make_place(scenario)
    draft = draft_params(scenario, place, distro)
    target = make_folder(folder)
    masks = _write_maps(target, scenario, place.grid, place.keepout, place.speed_mask)
    launch = launch_text(
        LAUNCH,
        draft.robot.name,
        distro,
        masks=masks,
        has_map=scenario.known_map,
        has_monitor=monitor_of(draft) is not None,
    )
    lines = describe_remarks(draft.remarks) or ["everything has a counterpart"]
    write_text(target / LAUNCH, launch)
    write_text(target / REMARKS, "\n".join(lines) + "\n")
    write_text(target / PARAMS, params_text(draft))
    files = [PARAMS, *([MAP] if scenario.known_map else []), *(f"{mask}.yaml" for mask in masks), LAUNCH, REMARKS]
    return Nav2Export(target, tuple(files), tuple(draft.remarks))


def draft_params(scenario: Scenario, place: Place, distro: Distro) -> Draft:
    """Make the parameters for a scenario in its place; see `export_nav2` for the errors."""
    draft = Draft(scenario, scenario.assumed_robot(place.robot), distro)
    _check_lidars(draft)
    write_controllers(draft)
    write_planners(draft)
    write_costmaps(draft, place.grid, place.keepout, place.speed_mask)
    write_servers(draft)
    write_monitor(draft)
    note_leftovers(draft)
    return draft


def params_text(draft: Draft) -> str:
    """Return the text of the parameter file: each costmap stands in a namespace named like itself, as Nav2 has it."""
    nodes: dict[str, object] = {}
    for name, parameters in draft.nodes.items():
        block: Block = {"ros__parameters": parameters}
        nodes[name] = {name: block} if name in _COSTMAPS else block
    robot = " ".join(draft.robot.name.split())
    head = (
        f"# Nav2's parameters for ROS 2 {draft.distro.capitalize()}, written by trundle for {robot}.\n"
        f"# {REMARKS} lists what Nav2 does differently, and what it does not have.\n"
    )
    return head + yaml.dump(nodes, Dumper=_Dumper, sort_keys=False, default_flow_style=False, width=1000)


class _Dumper(yaml.SafeDumper):
    """Writes lists of plain values on one line, and nothing as an alias, which ROS does not read."""

    def ignore_aliases(self, data: object) -> bool:
        return True

    def represent_sequence(self, tag: str, sequence: object, flow_style: bool | None = None) -> yaml.SequenceNode:
        return super().represent_sequence(tag, sequence, flow_style=True)  # type: ignore[arg-type]


def _check_lidars(draft: Draft) -> None:
    for name in draft.lidars:
        if name not in draft.robot.lidars:
            lidars = ", ".join(draft.robot.lidars) or "none"
            raise InputError(f"{draft.robot.name} has no lidar {name!r}; it has: {lidars}")


def _write_maps(
    folder: Path, scenario: Scenario, grid: OccupancyGrid, keepout: KeepoutMask | None, speeds: SpeedMask | None
) -> list[str]:
    """Write the map and the masks, and return the names of the masks."""
    if scenario.known_map:
        grid.save(folder / MAP, mode=choose_mode(grid))
    masks: list[str] = []
    if keepout is not None:
        keepout.grid.save(folder / KEEPOUT, mode=choose_mode(keepout.grid))
        masks.append("keepout")
    if speeds is not None:
        path = folder / SPEED
        kind, base, multiplier = UNIT_NUMBERS[speeds.unit], float(speeds.base), float(speeds.multiplier)
        own = f"type: {kind}\nbase: {base!r}\nmultiplier: {multiplier!r}\n"
        save_map(speeds.grid, path, mode=choose_mode(speeds.grid), more=own)
        masks.append("speed")
    return masks


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
