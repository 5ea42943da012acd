"""The launch files start trundle with options that it has; ROS's launch is stood in for."""

from __future__ import annotations

import runpy
import subprocess
import sys
import types
from pathlib import Path
from xml.etree import ElementTree

import pytest

PACKAGE = Path(__file__).parents[2] / "examples" / "ros2" / "trundle_ros"


@pytest.fixture
def launch(monkeypatch):
    """Runs a launch file with values for its arguments, and returns the command that it starts."""

    class Value:
        def __init__(self, name):
            self.name = name

        def perform(self, context):
            return context[self.name]

    def module(name, **content):
        made = types.ModuleType(name)
        for key, value in content.items():
            setattr(made, key, value)
        monkeypatch.setitem(sys.modules, name, made)

    module("launch", LaunchDescription=list)
    module(
        "launch.actions",
        DeclareLaunchArgument=lambda name, **options: (name, options["default_value"], options["description"]),
        ExecuteProcess=lambda cmd, **options: cmd,
        OpaqueFunction=lambda function: function,
    )
    module("launch.substitutions", LaunchConfiguration=Value)

    def launch(file, **given):
        *arguments, start = runpy.run_path(str(PACKAGE / "launch" / file))["generate_launch_description"]()
        values = {name: default for name, default, _ in arguments if default is not None} | given
        assert {name for name, _, _ in arguments} == set(values), "an argument without a value"
        (command,) = start(values)
        return command

    return launch


def options_of(*verb):
    command = [sys.executable, "-m", "trundle", "ros2", *verb, "--help"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def test_serve_is_started_with_its_options(launch):
    command = launch("serve.launch.py", source="map.yaml", namespace="r1", options="--robot jackal --speed 2")
    assert command[:4] == ["trundle", "ros2", "serve", "map.yaml"]
    assert command[-6:] == ["--namespace", "r1", "--robot", "jackal", "--speed", "2"]
    known = options_of("serve")
    assert all(option in known for option in command if option.startswith("--"))


def test_serve_has_defaults_for_all_arguments(launch):
    assert launch("serve.launch.py")[3:] == ["warehouse", "--role", "simulator", "--profile", "plain"]


def test_navigate_is_started_with_a_map_and_a_robot(launch):
    command = launch("navigate.launch.py", map="map.yaml", robot="robot.yaml", start="-1,2,0.5")
    assert command == ["trundle", "ros2", "navigate", "map.yaml", "--robot", "robot.yaml", "--start=-1,2,0.5"]


def test_navigate_is_started_without_a_map_that_slam_makes(launch):
    command = launch("navigate.launch.py", robot="robot.yaml", options="--localizer slam --save-map map.yaml")
    assert command[3:] == ["--robot", "robot.yaml", "--localizer", "slam", "--save-map", "map.yaml"]


def test_the_package_installs_its_launch_files():
    package = ElementTree.parse(PACKAGE / "package.xml").getroot()
    name = package.findtext("name")
    assert f"project({name} " in (PACKAGE / "CMakeLists.txt").read_text()
    assert package.findtext("license") == "Apache-2.0"
