"""AMCL's parameters in Nav2's files become options of trundle's localizer."""

import pytest

from trundle.errors import InputError
from trundle.mission import Scenario
from trundle.nav2 import read_nav2_params


def read(write, text, robot="nova_carter"):
    return read_nav2_params(write(text), robot)


def texts_of(found, name):
    return [remark.text for remark in found.remarks if remark.name.endswith(name)]


# AMCL -----------------------------------------------------------------------------------------------------------------

SENSED = """
local_costmap:
  local_costmap:
    ros__parameters:
      plugins: [obstacle_layer]
      obstacle_layer: {plugin: "nav2_costmap_2d::ObstacleLayer", observation_sources: scan, scan: {topic: scan}}
global_costmap:
  global_costmap:
    ros__parameters:
      plugins: [static_layer]
      static_layer: {plugin: "nav2_costmap_2d::StaticLayer"}
amcl:
  ros__parameters:
"""


def localizer(write, block, sensed=SENSED):
    found = read(write, sensed + "".join(f"    {line}\n" for line in block.strip().split("\n")))
    return found.settings.get("localizer"), found


def test_the_options_of_amcl_that_a_file_gives_are_those_of_the_localizer(write):
    block = """
alpha1: 0.1
alpha5: 0.3
laser_max_range: 12.0
max_beams: 60
max_particles: 3000
min_particles: 400
pf_err: 0.02
pf_z: 0.9
sigma_hit: 0.15
update_min_a: 0.1
update_min_d: 0.2
z_hit: 0.7
z_rand: 0.3
recovery_alpha_fast: 0.1
laser_likelihood_max_dist: 2.0
"""
    made, found = localizer(write, block)
    given = {line.split(": ")[0]: float(line.split(": ")[1]) for line in block.strip().split("\n")}
    assert made == {"name": "amcl", "options": {name: given[name] for name in list(given)[:-2]}}
    assert {remark.name for remark in found.remarks if remark.node == "amcl"} == set(list(given)[-2:])
    scenario = Scenario.make(world="corridors", backend="kinematic", lidar=True, localizer=made)
    with scenario.build() as mission:  # the localizer takes every one of them
        assert mission.session().estimate.state == "localized"


def test_a_file_that_gives_amcl_nothing_leaves_the_localizers_defaults(write):
    made, _ = localizer(write, "use_sim_time: true")
    assert made == {"name": "amcl", "options": {}}


@pytest.mark.parametrize(
    ("block", "options", "said"),
    [
        ("laser_max_range: -1.0", {}, None),
        ("laser_max_range: 1.0e6", {}, None),
        ("z_rand: 0.0", {}, "a beam may always end anywhere"),
        ("max_particles: 200", {"max_particles": 200, "min_particles": 200}, "below Nav2's min_particles"),
        ("robot_model_type: nav2_amcl::OmniMotionModel", {}, "do not drive sideways"),
        ("robot_model_type: nav2_amcl::DifferentialMotionModel", {}, None),
        ("laser_model_type: beam", {}, "a field of distances"),
    ],
)
def test_what_means_something_else_in_trundles_amcl_is_said(write, block, options, said):
    made, found = localizer(write, block)
    assert made == {"name": "amcl", "options": options}
    texts = texts_of(found, block.split(":")[0])
    assert not texts if said is None else said in texts[0]


@pytest.mark.parametrize(
    ("block", "why"),
    [
        ("max_particles: 0", "at least 10"),
        ("max_beams: 100000000", "at most 10000"),
        ("max_particles: 20\nmin_particles: 30", "at least min_particles, 30"),
        ("alpha1: -0.1", "at least 0"),
        ("sigma_hit: .nan", "finite"),
    ],
)
def test_options_of_amcl_out_of_range_are_refused_with_their_line(write, block, why):
    with pytest.raises(InputError, match=rf":\d+.*{why}"):
        localizer(write, block)


def test_without_a_lidar_the_robot_knows_its_true_pose_and_amcls_parameters_are_listed(write):
    made, found = localizer(write, "max_particles: 2000", "amcl:\n  ros__parameters:\n")
    assert made is None
    assert "without a lidar or a map" in texts_of(found, "max_particles")[0]
