"""Tests of Nav2's parameters as settings of a scenario."""

import math
from pathlib import Path

import numpy as np
import pytest

from trundle.control.pursuit_settings import PursuitSettings
from trundle.errors import InputError
from trundle.maps import OccupancyGrid
from trundle.mission import Scenario
from trundle.nav2 import describe_remarks, read_nav2_params
from trundle.nav2.notes import ROS_OWN
from trundle.nav2.parameters import ParameterFile
from trundle.robots import Robot

DATA = Path(__file__).parent / "data"
FILES = ("carter", "humble", "jazzy", "kilted")

CONTROLLER = """
controller_server:
  ros__parameters:
    controller_plugins: [FollowPath]
    FollowPath:
"""


def read(write, text, robot="nova_carter"):
    return read_nav2_params(write(text), robot)


def controller(write, block):
    found = read(write, CONTROLLER + "".join(f"      {line}\n" for line in block.strip().split("\n")))
    return found.settings["controller"], found


def texts_of(found, name):
    return [remark.text for remark in found.remarks if remark.name.endswith(name)]


@pytest.mark.parametrize("robot", ["nova_carter", "turtlebot3_waffle", None])
@pytest.mark.parametrize("name", FILES)
def test_every_file_makes_a_scenario_whose_navigator_can_be_made(name, robot):
    found = read_nav2_params(DATA / f"{name}.yaml", robot)
    scenario = Scenario.make(
        world="corridors", robot=robot or "nova_carter", backend="kinematic", **{**found.settings, "start": None}
    )
    assert scenario.prepare().navigator.robot.planar.inscribed_radius > 0.0


@pytest.mark.parametrize("name", FILES)
def test_nothing_is_dropped_silently(name):
    """Each parameter of a file is either read, or listed; and what is listed has its line and a reason."""
    file = ParameterFile(DATA / f"{name}.yaml")
    everything = {(node, parameter.name) for node, parameter in file.unread()}
    found = read_nav2_params(DATA / f"{name}.yaml", "nova_carter")
    ignored = {(remark.node, remark.name) for remark in found.remarks if remark.kind == "no counterpart"}
    assert ignored < everything
    assert all(remark.text and (remark.line or "(Nav2's default)" in remark.text) for remark in found.remarks)
    text = "\n".join(describe_remarks(found.remarks))
    assert all(remark.name in text for remark in found.remarks if remark.text != ROS_OWN)
    left = sum(remark.text == ROS_OWN for remark in found.remarks)
    assert text.splitlines()[-1] == f"left to ROS ({ROS_OWN}): {left} parameters"


def test_what_changes_the_motion_comes_first():
    """The controller, how fast it may drive, how it drives; a person reads the first lines."""
    lines = describe_remarks(read_nav2_params(DATA / "carter.yaml", "nova_carter").remarks)
    assert "FollowPath.plugin" in lines[0]
    assert "DWB is replaced by regulated_pure_pursuit" in lines[0]
    nodes = [line.split(": ")[1] for line in lines if line.startswith("line")]
    firsts = [nodes.index(node) for node in ("controller_server", "velocity_smoother", "global_costmap")]
    assert firsts == sorted(firsts)
    assert len(lines) < 30


def test_jazzys_file_says_what_it_says():
    settings = read_nav2_params(DATA / "jazzy.yaml", "turtlebot3_waffle").settings
    assert settings["planner"] == {"name": "least_cost", "options": {"goal_tolerance": 0.5}}
    assert settings["controller"]["name"] == "mppi"
    options = settings["controller"]["options"]
    assert (options["samples"], options["horizon"], options["vx_min"], options["goal_weight"]) == (
        2000,
        2.8,
        -0.35,
        1.0,
    )
    assert (settings["inflation_radius"], settings["cost_scaling_factor"]) == (0.7, 3.0)
    assert (settings["unknown"], settings["unknown_cost"]) == ("costly", 252)
    assert settings["layers"]["obstacle"]["obstacle_max_range"] == 2.5
    assert settings["collision_monitor"]["min_points"] == 6
    assert settings["collision_monitor"]["time_before_collision"] == 1.2
    assert [step["name"] for step in settings["recovery"]] == ["clear_costmap", "spin", "wait", "back_up"]
    radii = np.hypot(*np.transpose(settings["assumed"]["footprint"]))
    assert len(radii) == 16
    assert 0.23 - 1e-9 <= radii.min() <= radii.max() < 0.235, "a circle of 0.22 m, padded by Nav2's 0.01 m"


def test_carters_outline_is_the_local_costmaps_and_its_pose_is_the_start():
    found = read_nav2_params(DATA / "carter.yaml", "nova_carter")
    corners = sorted(map(tuple, found.settings["assumed"]["footprint"]))
    assert corners == [(-0.637, -0.28), (-0.637, 0.28), (0.17, -0.28), (0.17, 0.28)]
    assert "limits" not in found.settings["assumed"], "they are all above the robot's own"
    assert found.settings["start"] == [-6.0, -1.0, 3.14159]
    assert found.settings["unknown"] == "free", "Nav2 does not track unknown space unless it is told to"
    options = found.settings["controller"]["options"]
    assert (options["desired_linear_vel"], options["rotate_to_heading_angular_vel"]) == (1.0, 1.0)
    assert options["lookahead_dist"] == PursuitSettings().lookahead_dist
    assert any("DWB is replaced by" in text for text in texts_of(found, "FollowPath.plugin"))
    assert any("above the robot's own 0.8" in text for text in texts_of(found, "max_velocity"))


def test_an_outline_that_is_the_robots_own_needs_no_setting(write):
    text = 'local_costmap:\n  ros__parameters: {footprint_padding: 0.0, footprint: "%s"}\n'
    own = [list(corner) for corner in Robot.load("nova_carter").footprint]
    assert "assumed" not in read(write, text % own).settings
    assert "assumed" in read_nav2_params(write(text % own)).settings, "without a robot it may be any"


def test_an_outline_that_is_not_convex_becomes_its_hull(write):
    star = "[[0.3, 0.3], [0.0, 0.1], [-0.3, 0.3], [-0.3, -0.3], [0.3, -0.3]]"
    found = read(write, f'local_costmap:\n  ros__parameters: {{footprint_padding: 0.0, footprint: "{star}"}}\n')
    corners = sorted(map(tuple, found.settings["assumed"]["footprint"]))
    assert corners == [(-0.3, -0.3), (-0.3, 0.3), (0.3, -0.3), (0.3, 0.3)]
    assert any("convex hull" in text for text in texts_of(found, "footprint"))


@pytest.mark.parametrize(
    ("footprint", "message"),
    [
        ("'[[1, 2], [3]]'", "must be a list of points"),
        ("'[[0.1, 0.1], [0.2, 0.2]]'", "must have 3 to 64 points"),
        ("'[[1.0, 0.1], [2.0, 0.1], [1.5, 0.4]]'", "no outline around base_link"),
        ("'[[a, b], [c, d], [e, f]]'", "must be a list of points"),
        ("'[[.nan, 0.1], [0.2, 0.2], [0.1, 0.4]]'", "must be a list of points"),
        ("'[[[1, 1]]]'", "must be a list of points"),
        ("'{a: 1}'", "must be a list of points"),
        (f"'{[[math.cos(i), math.sin(i)] for i in range(65)]}'", "must have 3 to 64 points"),
    ],
)
def test_outlines_that_are_none_are_refused_with_their_place(write, footprint, message):
    with pytest.raises(InputError, match=rf"nav2_params.yaml:3:5: local_costmap: footprint .*{message}"):
        read(write, f"local_costmap:\n  ros__parameters:\n    footprint: {footprint}\n")


def test_regulated_pure_pursuit_has_its_parameters_and_nav2s_defaults(write):
    choice, _ = controller(
        write,
        """plugin: nav2_regulated_pure_pursuit_controller::RegulatedPurePursuitController
lookahead_dist: 0.7""",
    )
    assert choice["name"] == "regulated_pure_pursuit"
    assert choice["options"]["lookahead_dist"] == 0.7
    assert choice["options"]["desired_linear_vel"] == 0.5, "Nav2's default, not the robot's limit"


def test_the_slash_of_humble_and_the_name_of_lyrical_are_known(write):
    planner = "planner_server:\n  ros__parameters:\n    GridBased: {plugin: %s, tolerance: 0.3}\n"
    for name in ("nav2_navfn_planner/NavfnPlanner", "nav2_navfn_planner::NavfnPlanner"):
        assert read(write, planner % name).settings["planner"]["options"] == {"goal_tolerance": 0.3}
    for key in ("desired_linear_vel", "max_linear_vel"):
        choice, _ = controller(
            write,
            f"plugin: nav2_regulated_pure_pursuit_controller/RegulatedPurePursuitController\n{key}: 0.4",
        )
        assert choice["options"]["desired_linear_vel"] == 0.4


def test_scaling_that_is_off_is_a_distance_of_0(write):
    choice, _ = controller(
        write,
        """plugin: nav2_regulated_pure_pursuit_controller::RegulatedPurePursuitController
use_cost_regulated_linear_velocity_scaling: false
use_regulated_linear_velocity_scaling: false""",
    )
    assert choice["options"]["cost_scaling_dist"] == 0.0
    assert choice["options"]["regulated_linear_scaling_min_radius"] == 0.0


def test_a_lookahead_that_grows_with_the_speed_is_that_of_the_top_speed(write):
    block = """plugin: nav2_regulated_pure_pursuit_controller::RegulatedPurePursuitController
desired_linear_vel: 0.4
use_velocity_scaled_lookahead_dist: true"""
    choice, found = controller(write, block)
    assert choice["options"]["lookahead_dist"] == pytest.approx(0.6)  # 1.5 s at 0.4 m/s
    assert any("does not grow" in text for text in texts_of(found, "use_velocity_scaled_lookahead_dist"))


def test_a_rotation_shim_gives_way_to_its_primary_controller(write):
    choice, found = controller(
        write,
        """plugin: nav2_rotation_shim_controller::RotationShimController
primary_controller: nav2_regulated_pure_pursuit_controller::RegulatedPurePursuitController
desired_linear_vel: 0.3""",
    )
    assert choice["options"]["desired_linear_vel"] == 0.3
    assert any("primary controller is taken" in text for text in texts_of(found, "FollowPath.plugin"))


@pytest.mark.parametrize(
    ("plugin", "text"),
    [
        ("nav2_graceful_controller::GracefulController", "the graceful controller is replaced by"),
        ("my_package::MyController", "my_package::MyController, which is not known, is replaced by"),
    ],
)
def test_controllers_without_counterpart_are_named(write, plugin, text):
    choice, found = controller(write, f"plugin: {plugin}\nv_linear_max: 0.4")
    assert choice["name"] == "regulated_pure_pursuit"
    assert PursuitSettings(**choice["options"]) == PursuitSettings(desired_linear_vel=0.4)
    assert any(text in given for given in texts_of(found, "FollowPath.plugin"))


def test_weights_keep_their_share_and_critics_that_are_off_weigh_nothing(write):
    choice, _ = controller(
        write,
        """plugin: nav2_mppi_controller::MPPIController
critics: [GoalCritic, PathAngleCritic, PreferForwardCritic, CostCritic]
GoalCritic: {cost_weight: 10.0}
PathAngleCritic: {enabled: false, cost_weight: 4.0}
PreferForwardCritic: {cost_weight: 2.5}
CostCritic: {cost_weight: 7.62}""",
    )
    options = choice["options"]
    assert options["goal_weight"] == 2.0
    assert options["path_angle_weight"] == 0.0
    assert options["prefer_forward_weight"] == 1.0
    assert options["repulsion_weight"] == 8.0
    assert options["goal_angle_weight"] == options["constraint_weight"] == 0.0


@pytest.mark.parametrize(
    ("block", "planner"),
    [
        ("nav2_smac_planner::SmacPlanner2D, cost_travel_multiplier: 0.0", "astar"),
        ("nav2_smac_planner/SmacPlanner2D, cost_travel_multiplier: 2.0", "least_cost"),
        ("nav2_smac_planner/SmacPlannerHybrid, motion_model_for_search: REEDS_SHEPP", "hybrid_astar"),
        ("nav2_smac_planner::SmacPlannerLattice", "hybrid_astar"),
        ("nav2_theta_star_planner/ThetaStarPlanner, w_traversal_cost: 0.0", "any_angle"),
        ("nav2_theta_star_planner::ThetaStarPlanner", "least_cost"),
        ("my_planners::Best", "auto"),
    ],
)
def test_each_planner_has_a_counterpart_or_is_named(write, block, planner):
    name, _, rest = block.partition(", ")
    text = f"planner_server:\n  ros__parameters:\n    GridBased: {{plugin: '{name}'{rest and f', {rest}'}}}\n"
    found = read(write, text)
    assert found.settings["planner"]["name"] == planner
    if planner == "auto":
        assert any("my_planners::Best is not known" in text for text in texts_of(found, "GridBased.plugin"))


def test_a_costmap_without_static_layer_is_driven_without_a_map(write):
    found = read(
        write,
        """global_costmap:
  ros__parameters:
    rolling_window: true
    width: 20
    height: 10
    plugins: [obstacle_layer]
    obstacle_layer: {plugin: "nav2_costmap_2d::ObstacleLayer", observation_sources: scan}
""",
    )
    layers = found.settings["layers"]
    assert (layers["rolling_window"], layers["width"], layers["height"]) == (True, 20.0, 10.0)
    assert found.settings["known_map"] is False
    assert found.settings["inflation_radius"] == 0.0


def test_zones_of_the_collision_monitor_are_widths_around_the_footprint(write):
    text = """local_costmap:
  ros__parameters:
    footprint_padding: 0.0
    footprint: "[[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]]"
    plugins: [scans]
    scans: {plugin: "nav2_costmap_2d::ObstacleLayer", observation_sources: scan}
collision_monitor:
  ros__parameters:
    polygons: [Stop, Slow, Limit]
    Stop: {type: polygon, points: "[[0.5, 0.25], [-0.4, 0.25], [-0.4, -0.25], [0.5, -0.25]]", action_type: stop}
    Slow: {type: circle, radius: 0.8, action_type: slowdown, slowdown_ratio: 0.3, max_points: 4}
    Limit: {type: circle, radius: 0.8, action_type: limit, linear_limit: 0.4}
"""
    found = read(write, text)
    monitor = found.settings["collision_monitor"]
    assert monitor["stop_padding"] == 0.05
    assert monitor["slowdown_padding"] == pytest.approx(0.8 - math.hypot(0.3, 0.2), abs=1e-6)
    assert monitor["slowdown_ratio"] == 0.3
    assert monitor["min_points"] == 4
    assert any("limit zones" in given for given in texts_of(found, "Limit.action_type"))
    with pytest.raises(InputError, match="action_type must be stop, slowdown, approach or limit, got 'halt'"):
        read(write, text.replace("action_type: stop", "action_type: halt"))


def test_a_file_without_monitor_gets_trundles_where_there_are_scans(write):
    jazzy = (DATA / "jazzy.yaml").read_text()
    start, end = jazzy.index("collision_monitor:"), jazzy.index("docking_server:")
    assert read(write, jazzy[:start] + jazzy[end:]).settings["collision_monitor"]["min_points"] == 3
    off = jazzy[:start] + "collision_monitor:\n  ros__parameters: {enabled: false}\n" + jazzy[end:]
    assert read(write, off).settings["collision_monitor"] is False


def test_what_is_missing_is_named_with_its_file(write):
    text = (DATA / "jazzy.yaml").read_text().replace("polygons: [FootprintApproach]", "polygons: [Other]")
    with pytest.raises(InputError, match=r"nav2_params.yaml: collision_monitor: Other.action_type must be .* missing"):
        read(write, text)


def make_masks(folder, yaml=""):
    cells = np.zeros((20, 20), dtype=np.int8)
    cells[5:8, 5:8] = 50
    grid = OccupancyGrid(cells, 0.5)
    grid.save(folder / "mask.yaml", mode="raw")
    path = folder / "mask.yaml"
    path.write_text(path.read_text() + yaml)


FILTER = """global_costmap:
  ros__parameters:
    filters: [zones]
    zones: {plugin: "nav2_costmap_2d::%s", enabled: true, filter_info_topic: /info}
info_server:
  ros__parameters: {type: %s, filter_info_topic: info, mask_topic: mask, base: %s, multiplier: %s}
mask_server:
  ros__parameters: {topic_name: mask, yaml_filename: %s}
"""


def test_masks_are_found_by_their_topics(write, tmp_path):
    make_masks(tmp_path)
    found = read(write, FILTER % ("KeepoutFilter", 0, 0.0, 1.0, "mask.yaml"))
    assert found.settings["keepout"] == str(tmp_path / "mask.yaml")
    make_masks(tmp_path, "type: 1\nbase: 100.0\nmultiplier: -1.0\n")
    found = read(write, FILTER % ("SpeedFilter", 1, 100.0, -1.0, "mask.yaml"))
    assert found.settings["speed_mask"] == str(tmp_path / "mask.yaml")


def test_a_mask_that_is_not_there_or_says_otherwise_is_refused(write, tmp_path):
    missing = FILTER % ("KeepoutFilter", 0, 0.0, 1.0, "$(find-pkg-share maps)/mask.yaml")
    with pytest.raises(InputError, match=r"mask_server: yaml_filename is no file on this machine; .*--keepout"):
        read(write, missing)
    assert "keepout" not in read_nav2_params(write(missing), "nova_carter", given={"keepout"}).settings
    make_masks(tmp_path)
    with pytest.raises(InputError, match="add the lines type: 1, base: 100 and multiplier: -1"):
        read(write, FILTER % ("SpeedFilter", 1, 100.0, -1.0, "mask.yaml"))


def test_limits_below_the_robots_own_hold(write):
    text = """velocity_smoother:
  ros__parameters:
    max_velocity: [0.5, 0.0, 2.0]
    min_velocity: [-0.1, 0.0, -0.4]
    max_accel: [2.0, 0.0, 3.0]
    max_decel: [-1.0, 0.0, -3.0]
"""
    found = read(write, text)
    assert found.settings["assumed"]["limits"] == {
        "linear_speed": 0.5,
        "reverse_speed": 0.1,
        "angular_speed": 0.4,
        "linear_acceleration": 1.0,
        "angular_acceleration": 3.0,
    }
    with pytest.raises(InputError, match="velocity_smoother: max_velocity must be above 0"):
        read(write, text.replace("[0.5, 0.0, 2.0]", "[0.0, 0.0, 2.0]"))


def test_a_key_that_is_given_twice_counts_as_in_ros_with_a_remark(write):
    text = "planner_server:\n  ros__parameters:\n    GridBased.tolerance: 0.5\n    GridBased.tolerance: 0.25\n"
    found = read_nav2_params(write(text))
    (remark,) = [one for one in found.remarks if "given twice" in one.text]
    assert (remark.node, remark.name, remark.value, remark.line) == ("planner_server", "GridBased.tolerance", 0.25, 4)
    assert remark.text == "it is given twice, in lines 3 and 4: line 4 counts, as in ROS"
