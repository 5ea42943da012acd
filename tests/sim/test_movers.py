from __future__ import annotations

import math
import warnings

import numpy as np
import pytest

import trundle
from trundle import Pose2D, World
from trundle.errors import WorldWarning
from trundle.geometry import Pose3D, Twist2D
from trundle.geometry.solids import Box, Cylinder, Solid
from trundle.robots import Robot
from trundle.sim.lidar import crosses_height, unseen_names
from trundle.worlds.movers import AlongPath, Crowd, Mover, Waypoints, forklift_body, person_body
from trundle.worlds.tessellate import box_mesh

ROBOT = Robot.load("nova_carter")
BACKENDS = pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
HALL = (
    Solid("south", Box((20.0, 0.2, 2.0)), Pose3D((0.0, -5.0, 1.0))),
    Solid("north", Box((20.0, 0.2, 2.0)), Pose3D((0.0, 5.0, 1.0))),
)
POST = (Solid("post", Cylinder(0.3, 1.7), Pose3D((0.0, 0.0, 0.85))),)


def world_of(*movers, solids=HALL):
    return World("hall", solids, movers=movers)


def walker(points=((3.0, -2.0), (3.0, 2.0)), speed=1.0, name="bob", parts=None, **options):
    return Mover(name, parts or person_body(), AlongPath(points, speed, **options), "person")


@BACKENDS
def test_movers_are_where_their_motion_says_at_every_step(backend):
    mover = walker()
    with trundle.simulate(world_of(mover), ROBOT, backend=backend) as sim:
        (state,) = sim.reset(Pose2D(0.0, 0.0)).movers
        assert (state.name, state.pose.x, state.pose.y) == ("bob", 3.0, -2.0)
        for _ in range(30):
            now = sim.step(Twist2D(), 0.05)
            (state,) = now.movers
            expected = mover.motion.at(now.time)
            assert state.pose == expected.pose
            assert (state.vx, state.vy, state.w) == expected[3:]


@BACKENDS
def test_a_world_without_movers_has_none(backend):
    with trundle.simulate(world_of(), ROBOT, backend=backend) as sim:
        assert sim.reset(Pose2D(0.0, 0.0)).movers == ()


@BACKENDS
def test_a_mover_that_runs_into_a_robot_is_a_contact_by_its_name(backend):
    front = float(ROBOT.outline[:, 0].max())
    mover = walker(((4.0, 0.0), (-4.0, 0.0)))
    with trundle.simulate(world_of(mover), ROBOT, backend=backend) as sim:
        state = sim.reset(Pose2D(0.0, 0.0))
        while not state.contacts and state.time < 5.0:
            state = sim.step(Twist2D(), 0.05)
        assert {contact.other for contact in state.contacts} == {"bob"}
        assert state.time == pytest.approx(4.0 - front - 0.3, abs=0.06)
        contact = state.contacts[0]
        assert math.hypot(contact.x - front, contact.y) < 0.15


@BACKENDS
def test_a_contact_between_two_control_periods_is_found(backend):
    mover = Mover("dart", POST, Waypoints(((0.0, -3.0, 4.0), (0.05, -3.0, 4.0), (0.15, 3.0, -4.0), (9.0, 3.0, -4.0))))
    with trundle.simulate(world_of(mover), ROBOT, backend=backend) as sim:
        sim.reset(Pose2D(0.0, 0.0))
        state = sim.step(Twist2D(), 0.25)
        assert {contact.other for contact in state.contacts} == {"dart"}


@BACKENDS
def test_lidars_see_a_mover_as_they_see_a_solid_there(backend):
    path = AlongPath(((3.0, -2.0), (3.0, 2.0)), 1.0)
    mesh = Solid("mesh", box_mesh((0.4, 0.3, 1.0)), Pose3D((0.2, 0.0, 0.5)))
    for parts in (forklift_body(), person_body(), POST, (mesh,)):
        with trundle.simulate(world_of(Mover("it", parts, path)), ROBOT, backend=backend, lidar=True) as sim:
            sim.reset(Pose2D(0.0, 0.0), seed=1)
            moving = [sim.step(Twist2D(), 0.1) for _ in range(12)][-1]
        at = moving.movers[0].pose
        frame = Pose3D.planar(at.x, at.y, yaw=at.yaw)
        fixed = [Solid(f"fixed_{part.name}", part.shape, frame @ part.pose) for part in parts]
        with trundle.simulate(world_of(solids=(*HALL, *fixed)), ROBOT, backend=backend, lidar=True) as sim:
            sim.reset(Pose2D(0.0, 0.0), seed=1)
            still = [sim.step(Twist2D(), 0.1) for _ in range(12)][-1]
        assert moving.scans
        for one, other in zip(moving.scans, still.scans, strict=True):
            assert np.isfinite(one.ranges).any()
            off = np.abs(np.nan_to_num(one.ranges, posinf=99.0) - np.nan_to_num(other.ranges, posinf=99.0))
            assert (off > 0.01).sum() <= 4  # beams that graze an edge


@BACKENDS
def test_the_same_seed_gives_the_same_crowd_bit_for_bit(backend):
    world = World.generate("warehouse", seed=1, size=(16.0, 12.0))
    crowd = Crowd("people", 4)
    movers = (crowd, walker(((6.5, -1.0), (6.5, 1.0)), name="eve", repeat="loop"))
    world = World(world.name, world.solids, world.seeds, movers=movers)
    start = Pose2D(*world.seeds[0])
    with trundle.simulate(world, ROBOT, backend=backend) as sim:
        runs = []
        for seed in (3, 3, 4):
            sim.reset(start, seed=seed)
            runs.append([sim.step(Twist2D(0.0, 0.2), 0.05).movers for _ in range(40)])
    assert runs[0] == runs[1]
    assert runs[0] != runs[2]
    assert [state.name for state in runs[0][0]] == ["eve", *crowd.members]


def test_both_simulators_move_a_crowd_that_ignores_the_robot_alike():
    crowd = Crowd("people", 4, sees_robot=False, area=(-5.0, -4.0, 5.0, 4.0))
    runs = []
    for backend in ("kinematic", "mujoco"):
        with trundle.simulate(world_of(crowd), ROBOT, backend=backend) as sim:
            sim.reset(Pose2D(8.0, 0.0), seed=3)
            runs.append([sim.step(Twist2D(), 0.05).movers for _ in range(40)])
    assert runs[0] == runs[1]


@pytest.mark.parametrize("parts", [person_body(), forklift_body()], ids=["person", "forklift"])
@pytest.mark.parametrize("speed", [0.5, 2.0])
def test_a_mover_pushes_a_robot_at_its_speed(parts, speed):
    mover = walker(((-4.5, 0.0), (9.9, 0.0)), speed, parts=parts)
    with trundle.simulate(world_of(mover), ROBOT) as sim:
        sim.reset(Pose2D(0.0, 0.0))
        states = [sim.step(Twist2D(), 0.05) for _ in range(round(7.0 / speed / 0.05))]
        speeds = [state.twist.v for state in states if state.contacts]
        assert np.median(speeds[5:]) == pytest.approx(speed, rel=0.15)
        assert max(speeds) < 2.0 * speed
        assert abs(sim.data.qpos[2]) < 0.1


def test_a_robot_between_a_mover_and_a_wall_is_not_thrown_into_the_air():
    for parts in (person_body(), forklift_body()):
        mover = walker(((7.5, -2.0), (7.5, 10.0)), 1.2, parts=parts)
        with pytest.warns(WorldWarning, match="'bob' of the world 'hall' leaves it"):
            sim = trundle.simulate(world_of(mover), ROBOT)
        with sim:
            sim.reset(Pose2D(7.5, 4.0))
            heights, speeds, names = [], [], set()
            for _ in range(180):
                state = sim.step(Twist2D(), 0.05)
                heights.append(float(sim.data.qpos[2]))
                speeds.append(float(np.abs(sim.data.qvel[:3]).max()))
                names |= {contact.other for contact in state.contacts}
            assert max(heights) < 0.2
            assert max(speeds) < 6.0
            assert "bob" in names
            assert "bob" not in {contact.other for contact in state.contacts}  # it has passed through
            again = sim.reset(Pose2D(7.5, 4.0))
            assert again.movers[0].pose.y == -2.0


@BACKENDS
@pytest.mark.parametrize(
    ("motion", "words"),
    [
        (
            ((0.0, 3.0, 0.0), (9.0, 15.0, 0.0)),
            r"'bob' of the world 'hall' leaves it at 5\.\d s, at \(10\.\d",
        ),
        (((0.0, 12.0, 0.0), (9.0, 3.0, 0.0)), r"starts outside it at 0\.0 s"),
        (((0.0, 3.0, 4.9), (9.0, 3.0, 0.0)), r"starts in 'north' at 0\.0 s, at \(3\.00, 4\.90\)"),
        (((0.0, 3.0, 0.0), (5.0, 3.0, 4.95)), r"passes through 'north' at 4\.7 s"),
    ],
)
def test_motions_that_leave_the_world_or_pass_through_it_are_warned_of(backend, motion, words):
    with pytest.warns(WorldWarning, match=words):
        trundle.simulate(world_of(Mover("bob", POST, Waypoints(motion))), ROBOT, backend=backend).close()


@BACKENDS
def test_a_mover_that_starts_on_the_robot_is_warned_of_and_is_a_contact(backend):
    mover = Mover("bob", POST, Waypoints(((0.0, 3.2, 0.0), (9.0, 5.0, 0.0))))
    with trundle.simulate(world_of(mover), ROBOT, backend=backend) as sim:
        with pytest.warns(WorldWarning, match=r"'bob' is on the robot at 0 s, at"):
            state = sim.reset(Pose2D(3.0, 0.0))
        assert "bob" in {contact.other for contact in state.contacts}


def test_a_motion_within_the_world_causes_no_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        trundle.simulate(world_of(walker(repeat="back_and_forth")), ROBOT, backend="kinematic").close()


def test_what_no_lidar_crosses_is_unseen():
    pallet = Solid("pallet", Box((1.2, 0.8, 0.144)), Pose3D((0.0, 0.0, 0.072)))
    beam = Solid("beam", Box((1.0, 1.0, 0.2)), Pose3D((0.0, 0.0, 2.0)))
    fork = Mover("forks", forklift_body()[5:], Waypoints(((0.0, 5.0, 0.0),)))
    world = world_of(fork, walker(), solids=(*HALL, pallet, beam))
    assert unseen_names(world, ROBOT) == {"pallet", "beam", "forks"}
    assert "north" in unseen_names(world, ROBOT, ())
    assert crosses_height(pallet, 0.1)
    assert not crosses_height(pallet, 0.418)
