from dataclasses import replace

import numpy as np
import pytest

from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D
from trundle.geometry.poses3d import Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.mission import Scenario
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.sim.lidar_errors import LidarErrors
from trundle.sim.wrapper import SimulatorWrapper
from trundle.worlds import World

ROBOT = Robot.load("jackal")
WALL = Solid("wall", Box((0.2, 40.0, 2.0)), Pose3D.planar(5.0, 0.0, 1.0, 0.0))
WORLD = World("wall", (WALL,))


def scans(errors, *, seed=0, periods=40, backend="kinematic"):
    found = []
    with errors.simulate(simulate(WORLD, ROBOT, backend=backend, lidar=True)) as sim:
        sim.reset(Pose2D(0.0, 0.0), seed=seed)
        for _ in range(periods):
            found += sim.step(Twist2D(), 0.05).scans
    return found


def ranges(errors, **options):
    return np.array([scan.ranges for scan in scans(errors, **options)])


def test_without_errors_it_is_the_simulator_itself():
    with simulate(WORLD, ROBOT, backend="kinematic") as sim:
        assert LidarErrors().simulate(sim) is sim


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_a_share_of_the_beams_has_no_return(backend):
    exact, wrong = (ranges(errors, backend=backend) for errors in (LidarErrors(), LidarErrors(dropouts=0.1)))
    hit = np.isfinite(exact)
    assert hit.any()
    lost = hit & np.isinf(wrong)
    assert lost.sum() / hit.sum() == pytest.approx(0.1, abs=0.02)
    np.testing.assert_array_equal(wrong[~lost], exact[~lost])
    assert len({tuple(np.flatnonzero(row)) for row in lost}) > 1  # others in each scan


def test_a_share_of_the_beams_returns_anywhere_before_what_it_would_meet():
    exact, wrong = ranges(LidarErrors()), ranges(LidarErrors(short_returns=0.1))
    short = exact != wrong
    assert short.mean() == pytest.approx(0.1, abs=0.02)
    reach = np.minimum(exact, scans(LidarErrors())[0].range_max)
    least = scans(LidarErrors())[0].range_min
    assert (wrong[short] < reach[short]).all()
    assert (wrong[short] >= least).all()
    share = (wrong[short] - least) / (reach[short] - least)
    assert np.histogram(share, 4, (0.0, 1.0))[0] / share.size == pytest.approx([0.25] * 4, abs=0.04)


def test_noise_spreads_the_ranges_and_leaves_beams_without_a_return():
    exact, wrong = ranges(LidarErrors()), ranges(LidarErrors(noise=0.05))
    hit = np.isfinite(exact)
    inner = exact < 10.0
    assert (wrong[inner] - exact[inner]).std() == pytest.approx(0.05, rel=0.05)
    np.testing.assert_array_equal(np.isfinite(wrong), hit)


def test_the_seed_decides_which_beams():
    errors = LidarErrors(noise=0.02, dropouts=0.05, short_returns=0.05)
    np.testing.assert_array_equal(ranges(errors, seed=4), ranges(errors, seed=4))
    assert (ranges(errors, seed=4) != ranges(errors, seed=5)).any()


def test_more_noise_leaves_the_beams_that_drop_out_the_same():
    few, many = (ranges(LidarErrors(noise=noise, dropouts=0.1)) for noise in (0.01, 0.1))
    np.testing.assert_array_equal(np.isinf(few), np.isinf(many))


def test_beams_without_a_measurement_stay_so():
    class Blind(SimulatorWrapper):
        def step(self, command, dt):
            state = self._sim.step(command, dt)
            return replace(
                state, scans=tuple(replace(scan, ranges=np.full(len(scan.ranges), np.nan)) for scan in state.scans)
            )

    with LidarErrors(noise=0.1, short_returns=1.0).simulate(
        Blind(simulate(WORLD, ROBOT, backend="kinematic", lidar=True))
    ) as sim:
        sim.reset(Pose2D(0.0, 0.0))
        found = [scan for _ in range(10) for scan in sim.step(Twist2D(), 0.05).scans]
    assert found
    assert all(np.isnan(scan.ranges).all() for scan in found)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"dropouts": 1.2}, "dropouts"),
        ({"short_returns": -0.1}, "short_returns"),
        ({"noise": -1.0}, "noise"),
        ({"dropouts": 0.6, "short_returns": 0.6}, "together they may be 1 at most"),
        ({"droputs": 0.1}, "dropouts"),
    ],
)
def test_errors_that_cannot_be_are_refused(given, message):
    with pytest.raises(InputError, match=message):
        Scenario.make(world="maze", lidar=True, lidar_errors=given)


def test_errors_of_lidars_need_lidars():
    with pytest.raises(InputError, match="give lidar: true"):
        Scenario.make(world="maze", lidar_errors={"dropouts": 0.1})


def test_a_scenario_has_them_and_repeats_them(tmp_path):
    scenario = Scenario.make(
        world="maze", robot="jackal", backend="kinematic", lidar=True, lidar_errors={"dropouts": 0.2}, seed=3
    )
    scenario.save(tmp_path / "scenario.yaml")
    lost = []
    for one in (scenario, Scenario.load(tmp_path / "scenario.yaml")):
        with one.build() as mission:
            mission.sim.reset(mission.start, seed=3)
            lost.append([scan.ranges.tolist() for _ in range(5) for scan in mission.sim.step(Twist2D(), 0.05).scans])
    assert lost[0] == lost[1]
    assert np.isinf(lost[0][0]).mean() >= 0.1
