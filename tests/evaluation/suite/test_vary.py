import numpy as np
import pytest

from trundle.errors import InputError
from trundle.evaluation.suite.vary import Distribution, Vary, apply, move_start
from trundle.geometry import Pose2D
from trundle.mission import Scenario
from trundle.sim.odometry_errors import OdometryErrors

ALL = {
    "friction": {"uniform": [0.5, 1.0]},
    "mass": {"normal": [1.0, 0.05]},
    "wheel_radius": 1.02,
    "latency_s": {"uniform": [0.0, 0.2]},
    "start_pose": {"x": {"normal": [0.0, 0.02]}, "yaw": 0.1},
}


def test_the_same_seed_draws_the_same_values_whatever_else_is_varied():
    drawn = Vary.model_validate(ALL).draw(7)
    assert list(drawn) == ["friction", "mass", "wheel_radius", "latency_s", "start_pose.x", "start_pose.yaw"]
    assert drawn == Vary.model_validate(ALL).draw(7)
    assert drawn["mass"] == Vary.model_validate({"mass": ALL["mass"]}).draw(7)["mass"]
    assert drawn["mass"] != Vary.model_validate(ALL).draw(8)["mass"]
    assert drawn["wheel_radius"] == 1.02


def test_values_are_distributed_as_said():
    vary = Vary.model_validate(ALL)
    drawn = [vary.draw(seed) for seed in range(2000)]
    friction = np.array([values["friction"] for values in drawn])
    mass = np.array([values["mass"] for values in drawn])
    assert friction.min() >= 0.5
    assert friction.max() <= 1.0
    assert friction.mean() == pytest.approx(0.75, abs=0.02)
    assert mass.mean() == pytest.approx(1.0, abs=0.005)
    assert mass.std() == pytest.approx(0.05, abs=0.005)
    assert np.abs(np.corrcoef(friction, mass)[0, 1]) < 0.1


def test_a_normal_value_stays_within_its_support():
    rng = np.random.default_rng(0)
    narrow = Distribution(normal=(1.0, 0.1))
    values = np.array([narrow.draw(rng) for _ in range(50_000)])
    assert values.min() >= narrow.support[0] == pytest.approx(0.6)
    assert values.max() <= narrow.support[1] == pytest.approx(1.4)


def test_nothing_is_drawn_where_nothing_is_varied():
    assert Vary().draw(3) == {}
    assert Vary.model_validate({"start_pose": {}, "latency_s": 0.0}).draw(3) == {}


def test_drawn_values_become_part_of_the_scenario():
    scenario = Scenario.make(world="warehouse", backend={"name": "mujoco", "options": {"lidar": True}})
    varied = apply(scenario, {"friction": 0.6, "track": 1.1, "latency_s": 0.1, "start_pose.x": 1.0})
    assert varied.backend.options == {"lidar": True, "friction": 0.6}
    assert (varied.actuation.track_width, varied.latency.command_delay_s) == (1.1, 0.1)
    assert varied.start is None
    assert apply(scenario, {}) == scenario


def test_drawn_errors_of_odometry_replace_those_that_are_given():
    scenario = Scenario.make(world="warehouse", odometry={"scale": 0.02, "slip": 0.01})
    varied = apply(scenario, {"odometry_scale": 0.03, "odometry_heading": 0.001})
    assert varied.odometry == OdometryErrors(scale=0.03, heading=0.001, slip=0.01)
    assert apply(scenario, {}).odometry == scenario.odometry
    only = apply(Scenario.make(world="warehouse"), {"odometry_slip": 0.005})
    assert only.odometry.slip == 0.005


def test_errors_of_odometry_are_within_what_can_be_simulated():
    with pytest.raises(InputError, match=r"odometry_scale: .* must stay within 0 and 0.5"):
        Vary(odometry_scale={"normal": [0.0, 0.01]})


def test_the_start_is_moved_in_the_map_frame():
    assert move_start(Pose2D(1.0, 2.0, 3.0), {"start_pose.x": 0.5, "start_pose.yaw": 0.5}).as_tuple() == pytest.approx(
        (1.5, 2.0, 3.5 - 2.0 * np.pi)
    )
    start = Pose2D(1.0, 2.0, 3.0)
    assert move_start(start, {"friction": 1.0}) is start


def test_errors_of_the_lidars_are_drawn_beside_those_that_are_given():
    scenario = Scenario.make(world="warehouse", lidar=True, lidar_errors={"short_returns": 0.3})
    drawn = Vary.model_validate({"lidar_noise": {"uniform": [0.01, 0.05]}, "lidar_dropout": 0.02}).draw(5)
    errors = apply(scenario, drawn).lidar_errors
    assert 0.01 <= errors.noise <= 0.05
    assert (errors.dropouts, errors.short_returns) == (0.02, 0.3)


def test_errors_of_the_lidars_need_lidars():
    with pytest.raises(InputError, match=r"lidar_noise can only be varied with simulated lidars: give lidar: true"):
        apply(Scenario.make(world="warehouse"), {"lidar_noise": 0.01})
    with pytest.raises(InputError, match="together they may be 1 at most"):
        apply(Scenario.make(world="warehouse", lidar=True, lidar_errors={"short_returns": 0.9}), {"lidar_dropout": 0.5})


def test_environments_and_suites_vary_the_lidars_within_the_same_bounds():
    for name in ("lidar_noise", "lidar_dropout"):
        with pytest.raises(ValueError, match=f"{name}|out of range"):
            Vary.model_validate({name: -0.1})
