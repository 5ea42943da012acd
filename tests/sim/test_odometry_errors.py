import math
from itertools import pairwise

import numpy as np
import pytest

from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.robots import Robot
from trundle.sim import Simulator, simulate
from trundle.sim.actuation import Actuation
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.odometry_errors import OdometryErrors
from trundle.worlds import World

EMPTY = World("empty", ())
CARTER = Robot.load("nova_carter")
DT = 0.05


def drive(errors, command, *, periods=200, seed=0, start=Pose2D(0.0, 0.0), lidar=False):
    with errors.simulate(KinematicSimulator(EMPTY, CARTER, lidar=lidar)) as sim:
        states = [sim.reset(start, seed=seed)]
        return states + [sim.step(command, DT) for _ in range(periods)]


def test_without_errors_it_is_the_simulator_itself():
    with KinematicSimulator(EMPTY, CARTER) as sim:
        assert OdometryErrors().simulate(sim) is sim


def test_a_wrapped_simulator_is_still_a_simulator_and_knows_its_world():
    with KinematicSimulator(EMPTY, CARTER) as inner:
        sim = OdometryErrors(scale=0.01).simulate(inner)
        assert isinstance(sim, Simulator)
        assert sim.world is EMPTY
        assert sim.robot is CARTER
        assert sim.inner is inner


@pytest.mark.parametrize("command", [Twist2D(0.5, 0.2), Twist2D(-0.4, 0.0), Twist2D(0.0, 0.5)])
def test_the_motion_stays_as_it_is(command):
    wrong = drive(OdometryErrors(scale=0.05, heading=0.02, slip=0.01), command, seed=3)
    exact = drive(OdometryErrors(), command, seed=3)
    assert [state.pose for state in wrong] == [state.pose for state in exact]
    assert [state.twist for state in wrong] == [state.twist for state in exact]


def test_the_bias_of_scale_goes_either_way_by_seed():
    shares = set()
    for seed in range(8):
        last = drive(OdometryErrors(scale=0.01), Twist2D(0.5, 0.0), seed=seed)[-1]
        shares.add(round(last.odometry.x / last.pose.x, 9))
        assert last.odometry_twist.v / last.twist.v == pytest.approx(last.odometry.x / last.pose.x)
        assert last.observation.twist == last.odometry_twist
        assert last.odometry.yaw == 0.0
    assert shares == {0.99, 1.01}


def test_the_bias_of_heading_counts_per_metre_driven():
    seen = set()
    for seed in range(8):
        last = drive(OdometryErrors(heading="1deg"), Twist2D(0.5, 0.0), seed=seed)[-1]
        seen.add(round(math.degrees(last.odometry.yaw) / last.pose.x, 6))
    assert seen == {-1.0, 1.0}


def test_a_biased_straight_drive_is_an_arc_in_odometry():
    last = drive(OdometryErrors(heading=0.1), Twist2D(0.5, 0.0), periods=400)[-1]
    length, turn = last.pose.x, last.odometry.yaw
    assert abs(turn) == pytest.approx(0.1 * length)
    assert last.odometry.x == pytest.approx(length * math.sin(turn) / turn, rel=1e-4)
    assert last.odometry.y == pytest.approx(length * (1.0 - math.cos(turn)) / turn, rel=1e-4)


def test_driving_back_counts_the_heading_again():
    with OdometryErrors(heading=0.1).simulate(KinematicSimulator(EMPTY, CARTER)) as sim:
        sim.reset(Pose2D(0.0, 0.0))
        for command in (Twist2D(0.5, 0.0), Twist2D(-0.5, 0.0)):
            states = [sim.step(command, DT) for _ in range(100)]
    assert abs(states[-1].odometry.yaw) > 0.4


def test_a_spin_in_place_has_no_bias():
    last = drive(OdometryErrors(scale=0.1, heading=0.1), Twist2D(0.0, 0.5))[-1]
    assert last.odometry.yaw == pytest.approx(last.pose.yaw)


def test_slip_grows_with_the_square_root_of_the_distance():
    slip = 0.01
    ends = []
    for seed in range(300):
        last = drive(OdometryErrors(slip=slip), Twist2D(0.5, 0.0), seed=seed, periods=80)[-1]
        ends.append((last.odometry.x - last.pose.x, last.odometry.yaw))
    far, yaw = np.array(ends).T
    length = last.pose.x
    # Each wheel is off by slip · √length: half of the sum, and the difference over the track.
    assert far.std() == pytest.approx(slip * math.sqrt(length / 2.0), rel=0.15)
    assert yaw.std() == pytest.approx(slip * math.sqrt(2.0 * length) / CARTER.drive.track_width, rel=0.15)
    assert abs(far.mean()) < 4.0 * far.std() / math.sqrt(len(far))


def test_a_random_walk_grows_with_the_square_root_of_the_distance():
    errors = OdometryErrors(walk=0.02, heading_walk=0.01)
    ends = []
    for seed in range(300):
        last = drive(errors, Twist2D(0.5, 0.0), seed=seed, periods=80)[-1]
        ends.append((last.odometry.x - last.pose.x, last.odometry.yaw))
    far, yaw = np.array(ends).T
    root = math.sqrt(last.pose.x)
    assert far.std() == pytest.approx(0.02 * root, rel=0.15)
    assert yaw.std() == pytest.approx(0.01 * root, rel=0.15)


def test_a_robot_that_stands_still_does_not_drift():
    errors = OdometryErrors(scale=0.1, heading=0.1, slip=0.1, walk=0.1, heading_walk=0.1)
    states = drive(errors, Twist2D(0.0, 0.0))
    assert {state.odometry for state in states} == {Pose2D(0.0, 0.0)}


def test_odometry_starts_at_the_pose_of_the_reset():
    start = Pose2D(3.0, -2.0, 2.5)
    assert drive(OdometryErrors(scale=0.1), Twist2D(0.3, 0.1), periods=1, start=start)[0].odometry == start


def test_the_same_seed_gives_the_same_odometry():
    errors = OdometryErrors(scale=0.02, heading=0.02, slip=0.02)
    runs = [[state.odometry for state in drive(errors, Twist2D(0.4, 0.3), seed=seed, periods=40)] for seed in (5, 5, 6)]
    assert runs[0] == runs[1]
    assert runs[0] != runs[2]


def test_a_reset_starts_over():
    errors = OdometryErrors(scale=0.02, slip=0.02)
    with errors.simulate(KinematicSimulator(EMPTY, CARTER)) as sim:
        runs = []
        for _ in range(2):
            sim.reset(Pose2D(0.0, 0.0), seed=4)
            runs.append([sim.step(Twist2D(0.4, 0.3), DT) for _ in range(20)])
    assert runs[0] == runs[1]


def test_twist_and_pose_of_odometry_agree():
    states = drive(OdometryErrors(scale=0.1, heading=0.2, slip=0.01), Twist2D(0.5, 0.3), seed=2)[50:]
    for before, now in pairwise(states):
        moved = before.odometry.inverse() @ now.odometry
        assert math.hypot(moved.x, moved.y) == pytest.approx(now.odometry_twist.v * DT, abs=2e-4)
        assert moved.yaw == pytest.approx(now.odometry_twist.w * DT, abs=1e-9)


def test_errors_add_to_those_of_the_wheels():
    actuation, errors = Actuation(wheel_radius=1.05), OdometryErrors(scale=0.02)
    with errors.simulate(actuation.simulate(KinematicSimulator(EMPTY, CARTER))) as sim:
        sim.reset(Pose2D(0.0, 0.0))
        states = [sim.step(Twist2D(0.5, 0.0), DT) for _ in range(60)]
    share = states[-1].odometry.x * 1.05 / states[-1].pose.x
    assert abs(share - 1.0) == pytest.approx(0.02)


def test_the_noise_of_lidars_is_that_of_the_run_without_errors():
    lidars = {name: lidar.model_copy(update={"noise": 0.01}) for name, lidar in CARTER.lidars.items()}
    robot = CARTER.model_copy(update={"lidars": lidars})
    scans = []
    for errors in (OdometryErrors(), OdometryErrors(scale=0.1, slip=0.1)):
        world = World.generate("maze", seed=1)
        with errors.simulate(KinematicSimulator(world, robot, lidar=True)) as sim:
            sim.reset(Pose2D(0.0, 0.0), seed=3)
            scans.append([scan.ranges for _ in range(4) for scan in sim.step(Twist2D(0.1, 0.0), DT).scans])
    assert all(np.array_equal(one, other) for one, other in zip(*scans, strict=True))


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"scale": -0.01}, "scale"),
        ({"scale": 0.6}, "scale"),
        ({"heading": "70deg"}, "heading"),
        ({"heading": "left"}, "heading"),
        ({"slip": float("nan")}, "slip"),
        ({"speed": 1.0}, "speed"),
    ],
)
def test_errors_out_of_range_are_refused(settings, words):
    with pytest.raises(InputError, match=words):
        OdometryErrors(**settings)


def test_the_yaw_stays_within_a_turn():
    last = drive(OdometryErrors(heading=1.0), Twist2D(0.5, 0.0), periods=400)[-1]
    assert last.odometry.yaw == wrap_angle(last.odometry.yaw)


# Slips ----------------------------------------------------------------------------------------------------------------

SLIPS = {"count": 3, "every": 2.0, "distance": 0.3, "heading": "10deg"}


def off(states):
    """How far the odometry has moved beside the truth, in the frame of the truth: forward [m] and yaw [rad]."""
    moved = (states[0].odometry.inverse() @ states[-1].odometry, states[0].pose.inverse() @ states[-1].pose)
    return moved[0].x - moved[1].x, wrap_angle(moved[0].yaw - moved[1].yaw)


def test_each_slip_counts_its_distance_and_its_heading_and_moves_nothing():
    wrong = drive(OdometryErrors(slips={**SLIPS, "heading": 0.0}), Twist2D(0.5, 0.0), periods=600, seed=3)
    exact = drive(OdometryErrors(), Twist2D(0.5, 0.0), periods=600, seed=3)
    assert [state.pose for state in wrong] == [state.pose for state in exact]
    assert off(wrong) == pytest.approx((0.9, 0.0))
    turning = drive(OdometryErrors(slips={**SLIPS, "count": 1}), Twist2D(0.5, 0.0), periods=600, seed=3)
    assert abs(off(turning)[1]) == pytest.approx(math.radians(10.0))


def test_slips_go_in_the_direction_of_travel():
    errors = OdometryErrors(slips={**SLIPS, "count": 1, "heading": 0.0})
    assert off(drive(errors, Twist2D(-0.4, 0.0), periods=600))[0] == pytest.approx(-0.3)


def test_slips_turn_to_either_side_and_come_at_other_places_by_seed():
    turns, begins = set(), set()
    for seed in range(8):
        states = drive(OdometryErrors(slips={**SLIPS, "count": 1}), Twist2D(0.5, 0.0), seed=seed)
        turns.add(round(math.degrees(off(states)[1])))
        begins.add(next(state.time for state in states if state.odometry != state.pose))
        assert states == drive(OdometryErrors(slips={**SLIPS, "count": 1}), Twist2D(0.5, 0.0), seed=seed)
    assert turns == {-10, 10}
    assert len(begins) > 2


def test_the_twist_tells_that_the_wheels_turn_faster_during_a_slip():
    states = drive(OdometryErrors(slips={**SLIPS, "count": 1}), Twist2D(0.5, 0.0), periods=400)
    faster = [state.odometry_twist.v for state in states[1:] if abs(state.odometry_twist.v - state.twist.v) > 1e-9]
    assert len(faster) == round(1.0 / DT)
    assert max(faster) == pytest.approx(0.8)


def test_a_robot_that_stands_does_not_slip():
    assert off(drive(OdometryErrors(slips={"every": 0.1}), Twist2D(0.0, 0.0), periods=400)) == (0.0, 0.0)


def test_without_a_count_slips_go_on():
    states = drive(OdometryErrors(slips={"every": 1.0, "heading": 0.0}), Twist2D(1.0, 0.0), periods=600)
    assert off(states)[0] > 12 * 0.3


def test_a_number_alone_is_the_count():
    assert OdometryErrors(slips=6) == OdometryErrors(slips={"count": 6})
    assert OdometryErrors(slips=6).slips.heading == pytest.approx(math.radians(10.0), abs=1e-4)


def test_slips_leave_the_other_errors_as_they_are():
    errors = {"scale": 0.02, "heading": 0.01, "slip": 0.01, "walk": 0.01}
    without = drive(OdometryErrors(**errors), Twist2D(0.5, 0.0), periods=15, seed=2)
    with_slips = drive(OdometryErrors(**errors, slips={"every": 50.0}), Twist2D(0.5, 0.0), periods=15, seed=2)
    assert without == with_slips


@pytest.mark.parametrize(
    ("slips", "message"),
    [({"count": -1}, "count"), ({"every": 0.0}, "every"), ({"distance": -0.1}, "distance"), ({"cuont": 3}, "count")],
)
def test_slips_that_cannot_be_are_refused(slips, message):
    with pytest.raises((InputError, ValueError), match=message):
        OdometryErrors(slips=slips)


def test_mujoco_slips_as_the_kinematic_simulator_does():
    with OdometryErrors(slips={**SLIPS, "count": 1, "heading": 0.0}).simulate(
        simulate(EMPTY, CARTER, backend="mujoco")
    ) as sim:
        states = [sim.reset(Pose2D(0.0, 0.0), seed=1)] + [sim.step(Twist2D(0.5, 0.0), DT) for _ in range(200)]
    assert off(states)[0] == pytest.approx(0.3, abs=0.02)
