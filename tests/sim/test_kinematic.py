import math

import pytest

from trundle.errors import InputError, SimulationError
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World

EMPTY = World("empty", ())
CARTER = Robot.load("nova_carter")


def test_a_straight_run_has_the_length_of_its_ramp():
    with KinematicSimulator(EMPTY, CARTER) as simulator:
        for _ in range(100):
            state = simulator.step(Twist2D(0.5, 0.0), 0.05)
    # 0.2 s of speeding up at 2.5 m/s², each step of 5 ms at its end's speed.
    assert state.pose.x == pytest.approx(5.0 * 0.5 - 0.5 * 0.2 / 2.0 + 0.5 * 0.005 / 2.0)
    assert (state.pose.y, state.pose.yaw) == (0.0, 0.0)
    assert state.time == pytest.approx(5.0)
    assert state.wheel_positions.left == pytest.approx(state.pose.x / 0.14)


def test_an_arc_closes_on_its_circle():
    with KinematicSimulator(EMPTY, CARTER) as simulator:
        while simulator.step(Twist2D(0.5, 0.5), 0.05).twist != Twist2D(0.5, 0.5):
            pass
        start = simulator.step(Twist2D(0.5, 0.5), 0.05).pose
        centre = start @ Pose2D(0.0, 1.0)
        for _ in range(300):
            pose = simulator.step(Twist2D(0.5, 0.5), 0.05).pose
            assert pose.distance_to(centre) == pytest.approx(1.0, abs=1e-9)
            assert -math.pi < pose.yaw <= math.pi


def test_it_drives_on_through_what_it_touches():
    wall = Solid("wall", Box((0.1, 4.0, 1.0)), Pose3D((1.0, 0.0, 0.5)))
    with KinematicSimulator(World("w", (wall,)), CARTER) as simulator:
        states = [simulator.step(Twist2D(0.5, 0.0), 0.05) for _ in range(100)]
    touching = [bool(state.contacts) for state in states]
    assert not touching[0]
    assert not touching[-1]
    first = touching.index(True)
    assert states[first].pose.x + 0.14 == pytest.approx(0.95, abs=0.03)
    assert states[-1].pose.x > 2.0


def test_odometry_is_the_pose():
    with KinematicSimulator(EMPTY, CARTER) as simulator:
        simulator.reset(Pose2D(1.0, 2.0, 3.0))
        state = simulator.step(Twist2D(0.5, 0.5), 0.05)
    assert state.odometry == state.pose


def test_a_closed_one_is_of_no_more_use():
    simulator = KinematicSimulator(EMPTY, CARTER)
    simulator.close()
    with pytest.raises(SimulationError, match="was closed"):
        simulator.reset(Pose2D(0.0, 0.0))


def test_a_timestep_out_of_range_is_refused():
    with pytest.raises(InputError, match=r"timestep 0\.0 s is out of range"):
        KinematicSimulator(EMPTY, CARTER, timestep=0.0)


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_the_last_physics_step_has_the_wheels_of_the_state(backend):
    steps = []
    with simulate(World("empty", ()), Robot.load("nova_carter"), backend=backend) as sim:
        sim.reset(Pose2D(0.0, 0.0))
        sim.on_substep = steps.append
        for _ in range(5):
            state = sim.step(Twist2D(0.5, 0.3), 0.05)
    assert len(steps) == 50
    assert steps[-1].wheel_positions == pytest.approx(state.wheel_positions)
    assert steps[-1].wheel_speeds == pytest.approx(state.wheel_speeds)
    assert steps[-1].pose == state.pose
