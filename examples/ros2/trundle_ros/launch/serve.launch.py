"""Starts trundle as a simulator, or in place of Nav2: ros2 launch trundle_ros serve.launch.py source:=map.yaml"""

import shlex

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration

ARGUMENTS = {
    "trundle": ("trundle", "The program; that of a virtual environment is …/bin/trundle"),
    "source": ("warehouse", "A world by name, the YAML of a map or of a scenario, or a world's file"),
    "role": ("simulator", "simulator: others drive by /cmd_vel; navigator: trundle drives, as Nav2 does"),
    "profile": ("plain", "Names of topics and frames: plain, turtlebot3, carter_navigation, or a file"),
    "namespace": ("", "Namespace of all relative names"),
    "options": ("", 'Further options of trundle ros2 serve, such as "--robot jackal --speed 2"'),
}


def start(context):
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    command = [given["trundle"], "ros2", "serve", given["source"]]
    command += ["--role", given["role"], "--profile", given["profile"]]
    if given["namespace"]:
        command += ["--namespace", given["namespace"]]
    return [ExecuteProcess(cmd=[*command, *shlex.split(given["options"])], output="screen", name="trundle")]


def generate_launch_description():
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=text)
        for name, (default, text) in ARGUMENTS.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=start)])
