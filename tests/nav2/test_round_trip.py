"""Scenarios that are exported to Nav2 and read back are the same."""

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trundle.mission import Scenario
from trundle.mission.setup import Place, make_place
from trundle.nav2 import export_nav2, read_nav2_params
from trundle.nav2.export import draft_params, params_text

DATA = Path(__file__).parent / "data"
FILES = ("carter", "humble", "jazzy", "kilted")
DISTROS = ("humble", "jazzy", "kilted", "lyrical")


def scenario_of(settings, map_file, robot):
    return Scenario.make(map=str(map_file), robot=robot, **settings)


# There and back -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("robot", ["nova_carter", "turtlebot3_waffle"])
@pytest.mark.parametrize("distro", DISTROS)
@pytest.mark.parametrize("name", FILES)
def test_nav2s_own_files_come_back_as_the_same_scenario(name, distro, robot, map_file, tmp_path):
    first = scenario_of(read_nav2_params(DATA / f"{name}.yaml", robot).settings, map_file, robot)
    done = export_nav2(first, tmp_path / "nav2", distro=distro)
    again = read_nav2_params(done.folder / "nav2_params.yaml", robot)
    settings = dict(again.settings)
    if first.localizer is None:  # Nav2 always has AMCL
        assert settings.pop("localizer", None) in (None, {"name": "amcl", "options": {}})
    assert scenario_of(settings, map_file, robot) == first


def number(low, high):
    return st.floats(low, high).map(lambda value: round(value, 4))


PURSUIT = st.fixed_dictionaries(
    {
        "desired_linear_vel": number(0.05, 2.0),
        "lookahead_dist": number(0.5, 2.0),
        "min_lookahead_dist": number(0.1, 0.5),
        "rotate_to_heading_min_angle": number(0.1, 3.0),
        "rotate_to_heading_angular_vel": number(0.1, 3.0),
        "regulated_linear_scaling_min_radius": st.one_of(st.just(0.0), number(0.1, 2.0)),
        "regulated_linear_scaling_min_speed": number(0.0, 1.0),
        "cost_scaling_dist": st.one_of(st.just(0.0), number(0.1, 2.0)),
        "approach_velocity_scaling_dist": number(0.1, 2.0),
        "min_approach_linear_velocity": number(0.01, 0.3),
    }
).map(lambda options: {"name": "regulated_pure_pursuit", "options": options})

MPPI = st.fixed_dictionaries(
    {
        "samples": st.integers(128, 5000),
        "model_dt": st.sampled_from([0.02, 0.05, 0.1]),
        "horizon": st.integers(10, 30).map(lambda tenths: tenths / 10.0),
        "vx_std": number(0.05, 1.0),
        "wz_std": number(0.05, 1.0),
        "vx_max": number(0.1, 2.0),
        "vx_min": number(-1.0, 0.0),
        "wz_max": number(0.1, 3.0),
        "ax_max": number(0.1, 5.0),
        "az_max": number(0.1, 5.0),
        "goal_weight": number(0.0, 9.0),
        "goal_angle_weight": number(0.01, 9.0),
        "threshold_to_consider": number(0.1, 3.0),
        "path_angle_weight": number(0.0, 9.0),
        "prefer_forward_weight": number(0.0, 9.0),
        "twirling_weight": number(0.0, 9.0),
        "constraint_weight": number(0.0, 99.0),
        "repulsion_weight": number(0.0, 9.0),
        "collision_cost": number(1.0, 1000.0),
    }
).map(lambda options: {"name": "mppi", "options": options})

PLANNERS = st.one_of(
    number(0.0, 2.0).map(lambda tolerance: {"name": "least_cost", "options": {"goal_tolerance": tolerance}}),
    number(0.0, 2.0).map(lambda tolerance: {"name": "astar", "options": {"goal_tolerance": tolerance}}),
    st.just({"name": "any_angle", "options": {}}),
    st.fixed_dictionaries(
        {
            "motion_model": st.sampled_from(["dubins", "reeds_shepp"]),
            "minimum_turning_radius": number(0.1, 3.0),
            "reverse_penalty": number(1.0, 9.0),
            "cost_weight": number(0.0, 9.0),
            "goal_tolerance": number(0.0, 1.0),
            "smooth": st.booleans(),
            "max_expansions": st.integers(1, 10**8),
        }
    ).map(lambda options: {"name": "hybrid_astar", "options": options}),
)

LOCALIZERS = st.fixed_dictionaries(
    {},
    optional={
        "min_particles": st.integers(10, 500),
        "max_particles": st.integers(500, 10_000),
        "max_beams": st.integers(10, 1000),
        "alpha1": number(0.0, 1.0),
        "alpha5": number(0.0, 1.0),
        "laser_max_range": number(1.0, 100.0),
        "z_hit": number(0.0, 1.0),
        "z_rand": number(0.01, 1.0),
        "sigma_hit": number(0.01, 1.0),
        "pf_err": number(0.01, 1.0),
        "update_min_d": number(0.0, 1.0),
        "update_min_a": number(0.0, 1.0),
    },
).map(lambda options: {"name": "amcl", "options": options})

OBSTACLES = st.fixed_dictionaries(
    {
        "hits_to_mark": st.just(1),
        "misses_to_clear": st.just(1),
        "obstacle_max_range": number(1.0, 20.0),
        "obstacle_min_range": number(0.0, 0.9),
        "raytrace_max_range": number(1.0, 20.0),
        "raytrace_min_range": number(0.0, 0.9),
        "observation_persistence": st.one_of(st.none(), number(0.1, 5.0)),
        "footprint_clearing_enabled": st.booleans(),
    }
)

MONITORS = st.one_of(
    st.just(False),
    st.fixed_dictionaries(
        {
            "stop_padding": number(0.0, 0.5),
            "slowdown_padding": number(0.01, 1.0),
            "slowdown_ratio": number(0.1, 1.0),
            "time_before_collision": number(0.1, 3.0),
            "simulation_time_step": number(0.01, 0.5),
            "min_points": st.integers(1, 20),
            "source_timeout": number(0.1, 9.0),
        }
    ),
)


@st.composite
def outlines(draw):
    """Convex outlines around base_link: boxes, and corners on an ellipse."""
    if draw(st.booleans()):
        back, front, right, left = (draw(number(0.1, 1.0)) for _ in range(4))
        return [[front, left], [-back, left], [-back, -right], [front, -right]]
    count, long, wide = draw(st.integers(5, 24)), draw(number(0.2, 1.0)), draw(number(0.2, 1.0))
    turns = [2.0 * math.pi * (index + 0.37) / count for index in range(count)]
    return [[round(long * math.cos(turn), 4), round(wide * math.sin(turn), 4)] for turn in turns]


SETTINGS = st.fixed_dictionaries(
    {
        "controller": st.one_of(PURSUIT, MPPI),
        "planner": PLANNERS,
        "smoother": st.one_of(
            st.none(), number(0.1, 2.0).map(lambda r: {"name": "constrained", "options": {"minimum_turning_radius": r}})
        ),
        "assumed": st.fixed_dictionaries(
            {"footprint": outlines(), "limits": st.fixed_dictionaries({"linear_speed": number(0.1, 0.7)})}
        ),
        "inflation_radius": number(0.0, 3.0),
        "cost_scaling_factor": number(0.0, 20.0),
        "unknown": st.sampled_from(["blocked", "free"]),
        "lidar": st.just(True),
        "localizer": LOCALIZERS,
        "layers": st.fixed_dictionaries({"obstacle": OBSTACLES}),
        "collision_monitor": MONITORS,
        "goal_tolerance": number(0.0, 2.0),
        "goal_yaw_tolerance": number(0.0, 3.14),
        "required_movement_radius": number(0.0, 2.0),
        "movement_time_allowance": number(0.0, 99.0),
        "control_frequency": number(1.0, 100.0),
        "recovery": number(0.1, 2.0).map(
            lambda speed: [
                "clear_costmap",
                {"spin": {"angle": 1.57, "speed": speed}},
                {"wait": {"seconds": 5.0}},
                {"back_up": {"distance": 0.3, "speed": 0.15}},
            ]
        ),
    }
)


@pytest.fixture(scope="module")
def place(map_file):
    return make_place(Scenario.make(map=str(map_file)))


@pytest.mark.slow
@given(settings=SETTINGS, distro=st.sampled_from(DISTROS))
def test_what_both_sides_have_comes_back(settings, distro, map_file, place: Place):
    first = scenario_of(settings, map_file, "nova_carter")
    path = map_file.parent / "params.yaml"
    path.write_text(params_text(draft_params(first, place, distro)), encoding="utf-8")
    again = scenario_of(read_nav2_params(path, "nova_carter").settings, map_file, "nova_carter")
    assert again == first
