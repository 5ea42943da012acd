"""Starts trundle's navigator on a robot: ros2 launch trundle_ros navigate.launch.py map:=map.yaml robot:=robot.yaml"""

import shlex

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration

ARGUMENTS = {
    "trundle": ("trundle", "The program; that of a virtual environment is …/bin/trundle"),
    "map": ("", 'The YAML of the map; left out with options:="--localizer slam"'),
    "robot": (None, "The robot: a name, or the YAML or URDF of your own"),
    "start": ("", "Where it stands: X,Y,YAW [m, m, rad]"),
    "options": ("", 'Further options of trundle ros2 navigate, such as "--localizer amcl"'),
}


def start(context):
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    command = [given["trundle"], "ros2", "navigate", *filter(None, [given["map"]]), "--robot", given["robot"]]
    if given["start"]:
        command.append(f"--start={given['start']}")
    return [ExecuteProcess(cmd=[*command, *shlex.split(given["options"])], output="screen", name="trundle")]


def generate_launch_description():
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=text)
        for name, (default, text) in ARGUMENTS.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=start)])
