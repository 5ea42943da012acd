"""A solid is put into the world of a running simulator."""

import pytest

from trundle.errors import InputError, SimulationError, WorldError
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot
from trundle.sim import add_solid, simulate
from trundle.sim.actuation import Actuation
from trundle.worlds import World
from trundle.worlds.movers import Crowd

CARTER = Robot.load("nova_carter")
POSTS = World("posts", tuple(Solid(f"post {x}", Box((0.2, 0.2, 1.0)), Pose3D((x, 4.0, 0.5))) for x in (-4.0, 4.0)))
START, AHEAD = Pose2D(0.0, 0.0), Twist2D(0.5, 0.0)
BACKENDS = ("kinematic", "mujoco")


def box(x, y=0.0, name="box"):
    return Solid(name, Box((0.4, 0.4, 0.8)), Pose3D((x, y, 0.4)))


def drive(sim, periods, command=AHEAD):
    return [sim.step(command, 0.05) for _ in range(periods)]


def nearest(state):
    """What the front lidar sees nearest [m]."""
    return state.scans[0].ranges.min()


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_solid_far_away_changes_nothing_of_the_motion(backend):
    with simulate(POSTS, CARTER, backend=backend) as one, simulate(POSTS, CARTER, backend=backend) as other:
        for sim in (one, other):
            sim.reset(START)
            drive(sim, 20)
        add_solid(one, box(30.0, 30.0))
        for a, b in zip(drive(one, 20), drive(other, 20), strict=True):
            assert (a.time, a.contacts) == (b.time, b.contacts)
            assert a.pose.distance_to(b.pose) < 1e-6
            assert a.wheel_positions.left == pytest.approx(b.wheel_positions.left, abs=1e-6)
            assert a.odometry.distance_to(b.odometry) < 1e-6


@pytest.mark.parametrize("backend", BACKENDS)
def test_it_is_seen_and_touched_until_the_next_reset(backend):
    with simulate(POSTS, CARTER, backend=backend, lidar=True) as sim:
        sim.reset(START)
        before = next(state for state in reversed(drive(sim, 10)) if state.scans)
        assert nearest(before) > 4.0
        add_solid(sim, box(2.0))
        seen = next(state for state in drive(sim, 4) if state.scans)
        assert nearest(seen) < 2.0
        assert sim.world.solids[-1].name == "box"
        touched = {contact.other for state in drive(sim, 60) for contact in state.contacts}
        assert touched == {"box"}
        sim.reset(START)
        assert sim.world is POSTS
        assert all(state.contacts == () for state in drive(sim, 70))


@pytest.mark.parametrize("backend", BACKENDS)
def test_movers_go_on_as_they_were(backend):
    world = World("crowd", POSTS.solids, movers=(Crowd("people", 3, sees_robot=False, area=(-3.0, 1.0, 3.0, 3.5)),))
    with simulate(world, CARTER, backend=backend) as one, simulate(world, CARTER, backend=backend) as other:
        for sim in (one, other):
            sim.reset(START, seed=2)
            drive(sim, 20)
        add_solid(one, box(3.0, -3.0))
        assert drive(one, 20)[-1].movers == drive(other, 20)[-1].movers


def test_a_wrapper_passes_it_on():
    with simulate(POSTS, CARTER, backend="kinematic") as inner:
        sim = Actuation(wheel_radius=1.02).simulate(inner)
        sim.reset(START)
        add_solid(sim, box(2.0))
        assert sim.world is inner.world
        assert len(inner.world.solids) == 3


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_name_that_is_taken_and_a_closed_simulator_are_errors(backend):
    with simulate(POSTS, CARTER, backend=backend) as sim:
        with pytest.raises(WorldError, match=r"two solids named 'post -4\.0'"):
            add_solid(sim, box(2.0, name="post -4.0"))
        assert sim.world is POSTS
    with pytest.raises(SimulationError, match="closed"):
        add_solid(sim, box(2.0))


def test_a_simulator_that_cannot_says_so():
    class Fixed:
        robot = CARTER

    with pytest.raises(InputError, match="Fixed cannot put anything into its world during a run"):
        add_solid(Fixed(), box(2.0))
