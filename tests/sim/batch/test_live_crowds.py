"""Crowds that the batch computes for each robot: as in the kinematic simulator, whatever the other robots do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from trundle import World
from trundle.errors import InputError, WorldError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.sim import BatchSimulator, MoverRecording
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds.movers import AlongPath, Crowd, Mover, forklift_body

CARTER = Robot.load("nova_carter")
HALL = World.generate("warehouse", seed=3, size=(20.0, 14.0), low_objects=False)
GRID = OccupancyGrid.from_world(HALL, z_range=CARTER.z_range)
PERIOD = 0.05
PEOPLE = (Crowd("people", 7, speed=1.4), Crowd("blind", 15, sees_robot=False), Crowd("forklifts", 1, kind="forklift"))
ALONG = AlongPath(((-7.0, 0.0), (7.0, 0.0)), 0.8, repeat="back_and_forth")
CART = Mover("cart", forklift_body(), ALONG, may_cross=True)


def live(*crowds, movers=(), world=HALL, seconds=20.0):
    return MoverRecording.of_world(
        replace(world, movers=(*movers, *crowds)), CARTER, duration_s=seconds, live_crowds=True
    )


def starts(count, seed=0):
    free = np.argwhere(GRID.data == 0)
    rng = np.random.default_rng(seed)
    cells = free[rng.integers(len(free), size=count)]
    return np.column_stack([*GRID.cell_to_world(cells[:, 0], cells[:, 1]), rng.uniform(-3.0, 3.0, count)])


def test_contacts_and_poses_are_those_of_the_kinematic_simulator():
    world = replace(HALL, movers=(CART, *PEOPLE))
    poses, seeds = starts(4), np.arange(4) + 10
    batch = BatchSimulator(GRID, CARTER, count=4, recordings=[live(*PEOPLE, movers=(CART,))])
    batch.reset(poses, recordings=0, seeds=seeds)
    touched = 0
    for index, (pose, seed) in enumerate(zip(poses, seeds, strict=True)):
        simulator = KinematicSimulator(world, CARTER)
        simulator.reset(Pose2D(*pose), seed=int(seed))
        rng = np.random.default_rng(seed)
        for _ in range(240):
            command = rng.uniform(-0.2, 0.8), rng.uniform(-0.6, 0.6)
            batch.step(command, PERIOD, robots=[index])
            state = simulator.step(Twist2D(*command), PERIOD)
            expected = [(each.pose.x, each.pose.y) for each in state.movers]
            assert batch.movers(index)[:, :2] == pytest.approx(np.array(expected), abs=1e-9)
            people = {each.other for each in state.contacts if not each.other.startswith(("wall", "rack", "shelf"))}
            names = [each.name for each in state.movers]
            kind, first, _, _ = batch.contacts[index]
            if kind == 2:
                assert names[first] in people
                touched += 1
            elif kind == 0:
                assert not people.intersection(names)
    assert touched > 0


def rollout(order, threads, count):
    """The state of the robots of `order` after some steps with their own commands, among live crowds."""
    batch = BatchSimulator(GRID, CARTER, count=count, lidar="front", recordings=[live(*PEOPLE)], threads=threads)
    where = starts(64)
    rows = np.arange(len(order))
    for part in np.array_split(rows, 3):
        batch.reset(where[order[part]], robots=part, recordings=0, seeds=order[part])
    for step in range(60):
        commands = np.zeros((count, 2))
        commands[rows] = np.column_stack([np.cos(order + step), np.sin(order * step)])
        batch.step(commands, PERIOD)
    ranges = batch.scan()
    movers = np.array([batch.movers(int(row)) for row in rows])
    return batch.poses[rows].copy(), batch.contacts[rows].copy(), ranges[rows].copy(), movers


def test_a_crowd_depends_on_nothing_but_its_own_robot():
    order = np.arange(24)
    together = rollout(order, 3, 24)
    alone = [rollout(order[index : index + 1], 1, 1) for index in (0, 7, 23)]
    for index, one in zip((0, 7, 23), alone, strict=True):
        assert all(np.array_equal(each[0], all_of[index]) for each, all_of in zip(one, together, strict=True))
    backwards = rollout(order[::-1].copy(), 1, 40)
    assert all(np.array_equal(each[::-1], all_of) for each, all_of in zip(backwards, together, strict=True))


def test_people_are_seen_by_lidars_where_they_are():
    robot = CARTER.model_copy(update={"lidars": {"front": CARTER.lidars["front"].model_copy(update={"noise": 0.0})}})
    crowd = Crowd("people", 12)
    world = replace(HALL, movers=(crowd,))
    batch = BatchSimulator(GRID, robot, count=1, lidar=True, recordings=[live(crowd)])
    without = BatchSimulator(GRID, robot, count=1, lidar=True)
    simulator = KinematicSimulator(world, robot, lidar=True)
    pose = starts(1, seed=4)[0]
    batch.reset(pose, recordings=0, seeds=3)
    simulator.reset(Pose2D(*pose), seed=3)
    without.reset(pose)
    batch.step((0.0, 0.3), 2.0)
    without.step((0.0, 0.3), 2.0)
    scan = simulator.step(Twist2D(0.0, 0.3), 2.0).scans[0]
    ranges, walls = batch.scan_exactly()[0], without.scan_exactly()[0]
    people = ranges < walls - 1e-6
    assert people.sum() > 10
    assert ranges[people] == pytest.approx(scan.ranges[people], abs=1e-6)


def test_who_sees_the_robot_yields_and_who_does_not_runs_into_it():
    share = {}
    for sees in (True, False):
        batch = BatchSimulator(
            GRID, CARTER, count=32, recordings=[live(Crowd("people", 12, sees_robot=sees), seconds=1.0)]
        )
        batch.reset(starts(32, seed=1), recordings=0, seeds=np.arange(32))
        hit = np.zeros(32, dtype=bool)
        for _ in range(400):
            batch.step((0.0, 0.0), PERIOD)
            hit |= batch.contacts[:, 0] == 2
        share[sees] = hit.mean()
    assert share[True] == 0.0
    assert share[False] > 0.1


def test_a_crowd_without_room_is_refused_by_robot_and_nothing_is_reset():
    small = OccupancyGrid(np.pad(np.zeros((80, 80), np.int8), 2, constant_values=100), 0.05)
    world = World.from_map(small)
    batch = BatchSimulator(small, CARTER, count=3, recordings=[live(Crowd("people", 3), world=world)])
    batch.reset((0.6, 0.6, 0.0), recordings=0, seeds=[1, 2, 3])
    batch.step((0.2, 0.0), PERIOD)
    before, movers = batch.poses.copy(), batch.movers(0)
    with pytest.raises(WorldError, match=r"robot 1: the crowd 'people': found no place.*Nothing was reset"):
        batch.reset([(0.6, 0.6, 0.0), (2.1, 2.1, 0.0)], robots=[0, 1], recordings=0)
    assert np.array_equal(batch.poses, before)
    assert np.array_equal(batch.movers(0), movers)
    batch.step((0.2, 0.0), PERIOD)


def test_live_crowds_count_among_the_movers_of_a_recording():
    with pytest.raises(InputError, match="200 movers for 6000 s are 24,000,200 samples, more than"):
        live(Crowd("people", 200), seconds=6000.0)


def test_recordings_with_and_without_live_crowds_share_a_batch():
    recorded = MoverRecording.of_world(replace(HALL, movers=(CART,)), CARTER, duration_s=20.0)
    batch = BatchSimulator(GRID, CARTER, count=3, recordings=[recorded, live(*PEOPLE, movers=(CART,))])
    batch.reset(starts(3), recordings=[0, 1, -1])
    batch.step((0.0, 0.0), 1.0)
    assert [len(batch.movers(robot)) for robot in range(3)] == [1, 24, 0]
    assert batch.movers(0)[0] == pytest.approx(batch.movers(1)[0])
    batch.reset(starts(3), recordings=[-1, 0, 1])
    assert [len(batch.movers(robot)) for robot in range(3)] == [0, 1, 24]
    with pytest.raises(InputError, match="a robot is a number from 0 to 2"):
        batch.movers(3)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda _: {"crowds": "people"}, "crowds must be"),
        (lambda good: {"outlines": good.outlines[1:], "tracks": good.tracks[1:]}, "4 movers has crowds of 4"),
        (lambda good: {"crowds": good.crowds._replace(movers=good.crowds.movers * np.nan)}, r"shape \(steps, 1, 4\)"),
    ],
)
def test_bad_live_crowds_of_a_recording_are_named(change, text):
    good = live(Crowd("people", 4), movers=(CART,))
    with pytest.raises(InputError, match=text):
        replace(good, **change(good))
