"""The robot in PhysX: the contract of every simulator, what it touches, and what a reset and an added solid do."""

import math
import random
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("pxr")

from support.physx import needs_physx
from trundle.errors import InputError, SimulationError, WorldError
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.testing import Tolerances, check_simulator
from trundle.worlds import World
from trundle.worlds.movers import AlongPath, Mover

pytestmark = needs_physx

CARTER, EMPTY, START = Robot.load("nova_carter"), World("empty", ()), Pose2D(0.0, 0.0)
FRONT = float(CARTER.outline[:, 0].max())

TOLERANCES = Tolerances(position_m=0.015, yaw_rad=math.radians(2.0), speed=0.08, wheel_speed=0.06)
"""Wheels of PhysX are cylinders that touch the floor on a line of 4 mm and scrub on it; see docs/simulation.md."""


def box(x, y=0.0, name="box", size=(0.4, 0.4, 0.8)):
    return Solid(name, Box(size), Pose3D((x, y, size[2] / 2.0)))


def drive(sim, periods, command=Twist2D(0.4, 0.0)):
    return [sim.step(command, 0.05) for _ in range(periods)]


def others(state):
    return {contact.other for contact in state.contacts}


@pytest.fixture(scope="module")
def boxes():
    """A simulator among boxes, with lidars."""
    world = World("boxes", (box(2.0), box(0.0, 3.0, "side"), box(-3.0, 0.0, "low", (1.0, 1.0, 0.1))))
    with simulate(world, CARTER, backend="physx", lidar=True) as sim:
        yield sim


@pytest.mark.parametrize("robot", ["nova_carter", "turtlebot3_burger", "turtlebot3_waffle", "jackal"])
def test_it_meets_the_contract_of_every_simulator(robot):
    check_simulator(
        lambda world, machine: simulate(world, machine, backend="physx"),
        robot=robot,
        tolerances=TOLERANCES,
        with_lidars=lambda world, machine: simulate(world, machine, backend="physx", lidar=True),
    )


RUN = """
import sys
from trundle import World
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.sim import simulate

world = World("wall", (Solid("wall", Box((0.2, 4.0, 1.0)), Pose3D((1.0, 0.0, 0.5), (0.97, 0.0, 0.0, 0.243))),))
with simulate(world, "nova_carter", backend="physx") as sim:
    sim.reset(Pose2D(0.0, 0.1, 0.2))
    for step in range(60):
        state = sim.step(Twist2D(0.5, 0.1 * (step % 7 - 3)), 0.05)
print(state.pose, state.twist, state.odometry, state.contacts)
"""


def test_processes_give_the_same_run_to_the_last_bit():
    first, second = (
        subprocess.run([sys.executable, "-c", RUN], capture_output=True, text=True, check=True).stdout for _ in range(2)
    )
    assert first == second
    assert "wall" in first


def test_a_reset_repeats_a_run_to_the_last_bit_whatever_was_before(boxes):
    def random_run(seed):
        draw = random.Random(seed)
        boxes.reset(Pose2D(draw.uniform(0.8, 1.1), draw.uniform(-0.2, 0.2), draw.uniform(-0.3, 0.3)), seed=seed)
        states = drive(boxes, 30)
        for _ in range(3):
            states += drive(boxes, draw.randint(10, 25), Twist2D(draw.uniform(-0.8, 0.8), draw.uniform(-0.7, 0.7)))
        return [(state.pose, state.twist, state.odometry, state.contacts) for state in states]

    seeds = range(6)
    first = [random_run(seed) for seed in seeds]
    assert any(contacts for run in first for *_, contacts in run)
    for seed in reversed(seeds):
        assert random_run(seed) == first[seed]


def test_two_simulators_in_one_process_drive_alike_at_the_same_time(boxes):
    with simulate(boxes.world, CARTER, backend="physx") as other:
        for sim in (boxes, other):
            sim.reset(START)
        pairs = [(boxes.step(Twist2D(0.4, 0.2), 0.05), other.step(Twist2D(0.4, 0.2), 0.05)) for _ in range(20)]
    assert all(one.pose == two.pose for one, two in pairs)


def test_it_ends_beside_mujoco(boxes):
    with simulate(boxes.world, CARTER, backend="mujoco") as reference:
        for sim in (boxes, reference):
            sim.reset(Pose2D(0.0, -1.0))
        ends = [drive(sim, 60, Twist2D(0.3, -0.3))[-1] for sim in (boxes, reference)]
    assert ends[0].pose.distance_to(ends[1].pose) < 0.01
    assert ends[0].odometry.distance_to(ends[0].pose) < 0.01
    assert ends[0].wheel_positions == pytest.approx(ends[1].wheel_positions, rel=0.01)


def test_every_depth_in_a_solid_is_a_contact_and_throws_nothing():
    world = World("block", (box(FRONT + 0.5, size=(1.0, 2.0, 1.0)),))
    with simulate(world, CARTER, backend="physx") as sim:
        for depth in np.linspace(0.01, 2.0 * FRONT, 20):
            state = sim.reset(Pose2D(depth, 0.0))
            assert others(state) == {"box"}
            assert state.pose.distance_to(Pose2D(depth, 0.0)) < 0.1
            last = drive(sim, 10, Twist2D())[-1]
            assert last.pose.distance_to(Pose2D(depth, 0.0)) < 0.1
            assert others(last) in ({"box"}, set())


def test_a_wall_is_named_while_it_is_pushed_and_the_robot_stays(boxes):
    boxes.reset(Pose2D(0.9, 0.0))
    states = drive(boxes, 80, Twist2D(0.8, 0.0))
    first = next(index for index, state in enumerate(states) if state.contacts)
    assert states[first].contacts[0].part == "chassis"
    assert {name for state in states[first:] for name in others(state)} == {"box"}
    assert all(state.pose.x == pytest.approx(1.8 - FRONT, abs=0.05) for state in states[first:])
    assert max(state.tilt for state in states) < 0.02


def test_a_solid_below_the_chassis_is_touched_by_wheels():
    world = World("kerb", (box(1.5, size=(0.5, 3.0, 0.6 * CARTER.body.clearance)),))
    with simulate(world, CARTER, backend="physx") as sim:
        sim.reset(START)
        parts = {contact.part for state in drive(sim, 100) for contact in state.contacts if contact.other == "box"}
    assert parts & {"wheel_left", "wheel_right"}


def test_cells_of_a_map_are_named_as_in_mujoco():
    blocked = np.zeros((40, 40), dtype=bool)
    blocked[:, 30] = True
    world = World("cells", (Solid("map", OccupancyCells(blocked, 0.1, 1.0), Pose3D((-1.0, -2.0, 0.0))),))
    names = []
    for backend in ("physx", "mujoco"):
        with simulate(world, CARTER, backend=backend) as sim:
            sim.reset(Pose2D(1.2, 0.0))
            names.append(next(others(state) for state in drive(sim, 60) if state.contacts))
    assert names[0]
    assert all(name.startswith("map[") and name.endswith(",30]") for name in names[0] | names[1])


def test_lidars_see_what_mujoco_sees(boxes):
    with simulate(boxes.world, CARTER, backend="mujoco", lidar=True) as reference:
        pairs = [sim.reset(Pose2D(0.5, 0.5, 0.7), seed=4).scans for sim in (boxes, reference)]
    assert len(pairs[0]) == len(CARTER.lidars)
    for one, two in zip(*pairs, strict=True):
        assert one.lidar == two.lidar
        assert np.allclose(one.ranges, two.ranges, atol=1e-5)


def test_an_added_solid_is_seen_touched_and_gone_after_a_reset(boxes):
    boxes.reset(Pose2D(0.0, -2.0))
    drive(boxes, 5)
    for x, name in ((1.2, "added"), (3.0, "farther")):
        boxes.add_solid(box(x, -2.0, name))
    with pytest.raises(WorldError, match="added"):
        boxes.add_solid(box(1.2, -2.0, "added"))
    seen = next(state for state in drive(boxes, 4) if state.scans)
    assert seen.scans[0].ranges.min() < 1.2
    assert {name for state in drive(boxes, 60) for name in others(state)} == {"added"}
    assert [solid.name for solid in boxes.world.solids[-2:]] == ["added", "farther"]
    before = len(boxes.world.solids)
    boxes.reset(Pose2D(0.0, -2.0))
    assert len(boxes.world.solids) == before - 2
    states = drive(boxes, 100)
    assert not any(state.contacts for state in states)
    assert states[-1].pose.x > 1.5


def far_mesh(size):
    return Mesh(np.array([[0.0, 0.0, 0.0], [size, 0.0, 0.0], [0.0, size, 0.0]]), np.array([[0, 1, 2]]))


@pytest.mark.parametrize(
    ("shape", "reason"),
    [
        (far_mesh(1e300), "corrupted vertex data"),
        (far_mesh(0.0), "Unable to create triangle mesh"),
        (Box((1e-60, 1.0, 1.0)), "PxGeometry is not valid"),
    ],
)
def test_nothing_stays_of_a_solid_that_physx_refuses(boxes, shape, reason):
    boxes.reset(Pose2D(0.0, -2.0))
    before = boxes.world
    boxes.add_solid(box(1.5, -2.0, "added"))
    for name in ("bad", "bad"):  # a name that was refused is free
        with pytest.raises(WorldError, match=f"PhysX refuses the solid 'bad': .*{reason}"):
            boxes.add_solid(Solid(name, shape, Pose3D((2.0, -2.0, 0.5))))
    assert len(boxes._stage._handles) == 1
    boxes.add_solid(box(3.0, -2.0, "farther"))
    assert [solid.name for solid in boxes.world.solids[len(before.solids) :]] == ["added", "farther"]
    assert {name for state in drive(boxes, 80) for name in others(state)} == {"added"}


def test_a_placed_robot_keeps_its_wheels_time_and_odometry(boxes):
    boxes.reset(START)
    before = drive(boxes, 10)[-1]
    state = boxes.place(Pose2D(-1.0, -2.0, 1.0))
    assert state.pose.as_tuple() == pytest.approx((-1.0, -2.0, 1.0), abs=1e-6)
    assert (state.time, state.wheel_positions) == (before.time, before.wheel_positions)
    assert state.odometry.distance_to(before.odometry) < 1e-9
    assert others(boxes.place(Pose2D(2.0 - FRONT, 0.0))) == {"box"}


def test_every_physics_step_can_be_watched(boxes):
    seen = []
    boxes.reset(START)
    assert boxes.watch_substeps(seen.append)
    state = boxes.step(Twist2D(0.4, 0.3), 0.05)
    boxes.watch_substeps(None)
    assert [substep.time for substep in seen] == pytest.approx([0.005 * index for index in range(1, 11)])
    assert (seen[-1].pose, seen[-1].wheel_positions) == (state.pose, state.wheel_positions)


def test_the_length_of_a_step_is_an_option():
    with simulate(EMPTY, CARTER, backend="physx", physics_dt=0.0025) as sim:
        assert sim.timestep == 0.0025
        state = drive(sim, 60)[-1]
        assert state.time == pytest.approx(3.0)
        assert state.pose.x == pytest.approx(1.17, abs=0.02)
        with pytest.raises(InputError, match="is not a multiple of the physics step"):
            sim.step(Twist2D(), 0.001)


POST = (Solid("pole", Cylinder(0.2, 1.5), Pose3D((0.0, 0.0, 0.75))),)


def test_a_mover_that_starts_in_the_robot_is_a_contact():
    path = AlongPath(((0.2, 0.0), (0.2, 5.0)), 0.5)
    world = World("w", (), seeds=((0.0, -3.0),), movers=(Mover("walker", POST, path),))
    with simulate(world, CARTER, backend="physx") as sim:
        with pytest.warns(UserWarning, match="is on the robot"):
            state = sim.reset(START)
        assert others(state) == {"walker"}
        assert all(math.isfinite(state.pose.x) for state in drive(sim, 20, Twist2D()))
        assert others(sim.reset(Pose2D(0.0, -3.0))) == set()


def test_a_mover_pushes_the_robot_as_fast_as_it_walks():
    path = AlongPath(((FRONT + 0.3, 0.0), (-3.0, 0.0)), 0.5)
    with simulate(World("w", (), movers=(Mover("walker", POST, path),)), CARTER, backend="physx") as sim:
        sim.reset(START)
        states = drive(sim, 60, Twist2D())
    assert {name for state in states for name in others(state)} == {"walker"}
    assert states[-1].pose.distance_to(START) > 0.2
    assert states[-1].movers[0].pose.x == pytest.approx(path.at(3.0).x)


def test_it_is_closed_once_and_for_all():
    sim = simulate(EMPTY, CARTER, backend="physx")
    sim.close()
    sim.close()
    for call in (lambda: sim.reset(START), lambda: sim.step(Twist2D(), 0.05), lambda: sim.place(START)):
        with pytest.raises(SimulationError, match="this simulator was closed"):
            call()
