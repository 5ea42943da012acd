"""Tests of writing Nav2's parameters, and of the way there and back."""

import ast
import sys
import types

import numpy as np
import pytest
import yaml

from nav2.make_golden import GOLDEN, SCENARIO, TEXTS
from trundle.errors import InputError
from trundle.maps import KeepoutMask, OccupancyGrid, SpeedMask
from trundle.mission import Scenario
from trundle.nav2 import export_nav2, read_nav2_params
from trundle.robots import Robot

DISTROS = ("humble", "jazzy", "kilted", "lyrical")


def scenario_of(settings, map_file, robot):
    return Scenario.make(map=str(map_file), robot=robot, **settings)


# What is written ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", TEXTS)
def test_the_export_is_as_agreed_on(name, tmp_path):
    export_nav2(Scenario.make(**SCENARIO), tmp_path, distro="jazzy")
    written = (tmp_path / name).read_text(encoding="utf-8")
    assert written == (GOLDEN / name).read_text(encoding="utf-8"), "on purpose? python tests/nav2/make_golden.py"


def leaves(node, path=()):
    if isinstance(node, dict):
        for key, value in node.items():
            yield from leaves(value, (*path, key))
    else:
        yield path, node


@pytest.mark.parametrize("distro", DISTROS)
def test_every_value_is_one_that_ros_reads(distro, tmp_path, map_file):
    """Scalars, or lists of one type: ROS refuses mixed ones, nested ones, and empty ones it cannot type."""
    for controller in ("mppi", "regulated_pure_pursuit"):
        scenario = scenario_of({"lidar": True, "controller": controller}, map_file, "nova_carter")
        done = export_nav2(scenario, tmp_path / controller, distro=distro)
        text = (done.folder / "nav2_params.yaml").read_text(encoding="utf-8")
        for path, value in leaves(yaml.safe_load(text)):
            assert "ros__parameters" in path
            kinds = {type(item) for item in value} if isinstance(value, list) else {type(value)}
            assert len(kinds) == 1, path
            assert kinds <= {bool, int, float, str}, path
        assert "&id" not in text


def test_names_are_those_of_the_distribution(tmp_path, map_file):
    settings = {"lidar": True, "planner": "hybrid_astar"}
    texts = {}
    for distro in DISTROS:
        done = export_nav2(scenario_of(settings, map_file, "nova_carter"), tmp_path / distro, distro=distro)
        texts[distro] = (done.folder / "nav2_params.yaml").read_text(encoding="utf-8")
    assert "plugin: nav2_smac_planner/SmacPlannerHybrid" in texts["humble"]
    assert "plugin: nav2_behaviors/Spin" in texts["humble"]
    assert "progress_checker_plugin: progress_checker" in texts["humble"]
    assert "max_points: 2" in texts["humble"]
    assert "plugin: nav2_smac_planner::SmacPlannerHybrid" in texts["jazzy"]
    assert "min_points: 3" in texts["jazzy"]
    assert "desired_linear_vel" in texts["kilted"]
    assert "max_linear_vel" in texts["lyrical"]
    assert "desired_linear_vel" not in texts["lyrical"]


def test_the_limits_are_the_lower_ones_and_the_outline_the_assumed_one(tmp_path, map_file):
    assumed = {"footprint": [[0.4, 0.3], [-0.7, 0.3], [-0.7, -0.3], [0.4, -0.3]], "limits": {"angular_speed": 0.5}}
    done = export_nav2(scenario_of({"assumed": assumed}, map_file, "nova_carter"), tmp_path)
    nodes = yaml.safe_load((done.folder / "nav2_params.yaml").read_text(encoding="utf-8"))
    own = Robot.load("nova_carter").limits
    assert nodes["velocity_smoother"]["ros__parameters"]["max_velocity"] == [own.linear_speed, 0.0, 0.5]
    local = nodes["local_costmap"]["local_costmap"]["ros__parameters"]
    assert sorted(map(tuple, yaml.safe_load(local["footprint"]))) == sorted(map(tuple, assumed["footprint"]))


def test_the_map_and_the_masks_are_read_back(tmp_path, map_file):
    cells = np.zeros((50, 80), dtype=np.int8)
    cells[10:20, 10:20] = 50
    cells[30:35, 30:35] = 100
    for name, more in (("keepout", ""), ("speed", "type: 2\nbase: 0.1\nmultiplier: 0.005\n")):
        OccupancyGrid(cells, 0.1).save(tmp_path / f"{name}_mask.yaml", mode="raw")
        path = tmp_path / f"{name}_mask.yaml"
        path.write_text(path.read_text() + more)
    masks = {"keepout": str(tmp_path / "keepout_mask.yaml"), "speed_mask": str(tmp_path / "speed_mask.yaml")}
    first = scenario_of(masks, map_file, "nova_carter")
    done = export_nav2(first, tmp_path / "nav2")
    assert {"map.yaml", "keepout.yaml", "speed.yaml"} <= set(done.files)
    grid = OccupancyGrid.load(done.folder / "map.yaml")
    np.testing.assert_array_equal(grid.data, OccupancyGrid.load(map_file).data)
    assert (grid.resolution, grid.origin) == (
        OccupancyGrid.load(map_file).resolution,
        OccupancyGrid.load(map_file).origin,
    )
    np.testing.assert_array_equal(KeepoutMask.load(done.folder / "keepout.yaml").grid.data, cells)
    speed = SpeedMask.load(done.folder / "speed.yaml")
    assert (speed.unit, speed.base, speed.multiplier) == ("absolute", 0.1, 0.005)
    again = read_nav2_params(done.folder / "nav2_params.yaml", "nova_carter").settings
    assert again["keepout"] == str(done.folder / "keepout.yaml")
    assert again["speed_mask"] == str(done.folder / "speed.yaml")


@pytest.mark.parametrize(
    "settings", [{"collision_monitor": False}, {"lidar": True}, {"lidar": True, "known_map": False}]
)
def test_the_launch_file_starts_the_nodes_that_have_parameters(settings, tmp_path, map_file, monkeypatch):
    done = export_nav2(scenario_of(settings, map_file, "nova_carter"), tmp_path)
    text = (done.folder / "nav2.launch.py").read_text(encoding="utf-8")
    ast.parse(text)
    made = launch(text, done.folder / "nav2.launch.py", monkeypatch)
    names = [node["name"] for node in made if "executable" in node]
    assert len(set(names)) == len(names)
    managed = made[-1]["parameters"][0]["node_names"]
    assert [*managed, "lifecycle_manager_navigation"] == names
    assert ("collision_monitor" in names) == ("collision_monitor" not in settings)
    assert ("map_server" in names) == ("amcl" in names) == (settings.get("known_map", True))
    nodes = set(yaml.safe_load((done.folder / "nav2_params.yaml").read_text(encoding="utf-8")))
    costmaps = {"local_costmap", "global_costmap"}  # nodes of the controller and the planner server
    without = {"lifecycle_manager_navigation", "map_server"}
    assert set(names) - without <= nodes
    assert nodes - costmaps - set(names) <= {"collision_monitor", "amcl"}


def test_a_robot_with_lidars_senses_with_all_of_them(tmp_path, map_file):
    """A scenario without lidars knows the true pose; Nav2's robot has nothing but its lidars."""
    done = export_nav2(scenario_of({}, map_file, "nova_carter"), tmp_path)
    nodes = yaml.safe_load((done.folder / "nav2_params.yaml").read_text(encoding="utf-8"))
    for name in ("local_costmap", "global_costmap"):
        layer = nodes[name][name]["ros__parameters"]["obstacle_layer"]
        assert layer["observation_sources"] == "front back"
    assert any("cannot do without" in remark.text for remark in done.remarks)


def launch(text, path, monkeypatch):
    """Run a launch file with stand-ins for ROS's modules; what was made, in order, as keywords."""
    made = []

    def stand_in(*arguments, **keywords):
        made.append(keywords)
        return (arguments, keywords)

    for module, names in {
        "launch": ["LaunchDescription"],
        "launch.actions": ["DeclareLaunchArgument"],
        "launch.substitutions": ["LaunchConfiguration"],
        "launch_ros": [],
        "launch_ros.actions": ["Node"],
        "launch_ros.parameter_descriptions": ["ParameterValue"],
    }.items():
        fake = types.ModuleType(module)
        for name in names:
            setattr(fake, name, stand_in)
        monkeypatch.setitem(sys.modules, module, fake)
    scope = {"__file__": str(path), "__name__": "launch_file"}
    exec(compile(text, str(path), "exec"), scope)
    scope["generate_launch_description"]()
    return [keywords for keywords in made if "executable" in keywords]


# What has no counterpart --------------------------------------------------------------------------------------


def test_each_setting_without_counterpart_is_listed(tmp_path, map_file):
    settings = {
        "lidar": True,
        "replan_interval_s": 1.0,
        "recovery": ["spin=1.0"],
        "layers": {"obstacle": {"hits_to_mark": 3, "clear_static": True}},
        "controller": {"name": "mppi", "options": {"best_share": 0.2, "mover_margin": 0.7, "samples": 500}},
        "planner": {"name": "least_cost", "options": {"max_replans": 3}},
        "unknown": "costly",
        "localizer": "odometry",
    }
    done = export_nav2(scenario_of(settings, map_file, "nova_carter"), tmp_path)
    names = {remark.name for remark in done.remarks}
    assert names >= {
        "replan_interval_s",
        "recovery",
        "layers.obstacle.hits_to_mark",
        "layers.obstacle.clear_static",
        "controller.best_share",
        "controller.mover_margin",
        "planner.max_replans",
        "unknown_cost",
        "localizer",
        "collision_monitor.moving_padding",
    }
    assert "controller.samples" not in names
    text = (tmp_path / "no_counterpart.txt").read_text(encoding="utf-8")
    assert all(name in text for name in names)


def test_the_options_of_amcl_are_those_of_nav2s_and_come_back(tmp_path, map_file):
    options = {"max_particles": 1500, "alpha1": 0.15, "laser_max_range": 9.0, "lost_below": 0.4}
    settings = {"lidar": True, "localizer": {"name": "amcl", "options": options}}
    done = export_nav2(scenario_of(settings, map_file, "nova_carter"), tmp_path)
    amcl = yaml.safe_load((tmp_path / "nav2_params.yaml").read_text())["amcl"]["ros__parameters"]
    assert (amcl["max_particles"], amcl["alpha1"], amcl["laser_max_range"]) == (1500, 0.15, 9.0)
    assert "lost_below" not in amcl
    assert [remark.name for remark in done.remarks if remark.name.startswith("localizer")] == ["localizer.lost_below"]
    back = read_nav2_params(tmp_path / "nav2_params.yaml", "nova_carter").settings["localizer"]
    assert back == {"name": "amcl", "options": {name: options[name] for name in list(options)[:3]}}


@pytest.mark.parametrize("planner", ["auto", "manhattan_astar"])
def test_planners_and_controllers_that_nav2_lacks_are_named(planner, tmp_path, map_file):
    settings = {"planner": planner, "controller": "lookahead"}
    done = export_nav2(scenario_of(settings, map_file, "nova_carter"), tmp_path)
    changed = {remark.name: remark for remark in done.remarks if remark.kind == "changed"}
    assert changed["planner"].value == planner
    assert changed["controller"].value == "lookahead"


def test_what_cannot_be_exported_is_refused(tmp_path, map_file):
    with pytest.raises(InputError, match="distro is one of humble, jazzy"):
        export_nav2(scenario_of({}, map_file, "nova_carter"), tmp_path, distro="foxy")
    with pytest.raises(InputError, match="nova_carter has no lidar 'top'; it has: front, back"):
        export_nav2(scenario_of({"lidar": ["top"]}, map_file, "nova_carter"), tmp_path)
