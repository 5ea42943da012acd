"""Crowds that a device of Warp's computes for each robot: the bits of the kernel on the processor.

Warp's own CPU device runs the same kernels where there is no GPU.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from trundle import World
from trundle.errors import InputError, WorldError
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.sim import BatchSimulator, MoverRecording
from trundle.worlds.movers import AlongPath, Crowd, Mover, forklift_body

wp = pytest.importorskip("warp", reason="needs Warp, of the extra gpu")

from trundle.sim.batch.warp import crowds as device_crowds  # noqa: E402 - needs Warp

CARTER = Robot.load("nova_carter")
CARTER = CARTER.model_copy(update={"lidars": {"front": CARTER.lidars["front"].model_copy(update={"beams": 90})}})
HALL = World.generate("warehouse", seed=3, size=(12.0, 9.0), low_objects=False)
GRID = OccupancyGrid.from_world(HALL, z_range=CARTER.z_range)
PERIOD = 0.05
PEOPLE = (Crowd("people", 4, speed=1.4), Crowd("blind", 4, sees_robot=False), Crowd("forklifts", 1, kind="forklift"))
ALONG = AlongPath(((-4.0, 0.0), (4.0, 0.0)), 0.8, repeat="back_and_forth")
CART = Mover("cart", forklift_body(), ALONG, may_cross=True)
ROOM = OccupancyGrid(np.pad(np.zeros((100, 100), np.int8), 2, constant_values=100), 0.05)


def live(*crowds, movers=(), world=HALL, seconds=20.0):
    return MoverRecording.of_world(
        replace(world, movers=(*movers, *crowds)), CARTER, duration_s=seconds, live_crowds=True
    )


def starts(count, seed=0, grid=GRID):
    free = np.argwhere(grid.data == 0)
    rng = np.random.default_rng(seed)
    cells = free[rng.integers(len(free), size=count)]
    return np.column_stack([*grid.cell_to_world(cells[:, 0], cells[:, 1]), rng.uniform(-3.0, 3.0, count)])


def make_both(count, recordings, grid=GRID, **options):
    return [
        BatchSimulator(grid, CARTER, count=count, recordings=recordings, device=where, **options)
        for where in ("cpu", "cuda")
    ]


def assert_same(one, other):
    for name in ("poses", "contacts", "steps", "places"):
        expected = np.ascontiguousarray(getattr(one, name))
        assert np.ascontiguousarray(getattr(other, name).numpy()).tobytes() == expected.tobytes(), name
    for robot in range(one.count):
        assert other.movers(robot).tobytes() == one.movers(robot).tobytes(), f"movers around robot {robot}"
    assert other.scan().numpy().tobytes() == one.scan().tobytes()


@pytest.mark.parametrize("count", [1, 64])
def test_crowds_have_the_bits_of_the_processor(device, count):
    one, other = make_both(count, [live(*PEOPLE, movers=(CART,))], lidar="front")
    rng = np.random.default_rng(4)
    robots, kinds = np.arange(count), set()
    for simulator in (one, other):
        simulator.reset(starts(count), recordings=0, seeds=robots + 2**33)
    assert_same(one, other)
    for turn in range(40):
        commands = rng.uniform((-0.2, -0.6), (0.8, 0.6), (count, 2))
        period = (0.05, 0.2, 0.02)[turn % 3]
        some = None if turn % 4 else robots % 3 != 1  # their clocks differ from then on
        again = rng.permutation(count)[: count // 4] if turn % 10 == 9 else ()
        for simulator in (one, other):
            simulator.step(commands, period, robots=some)
            if len(again):
                simulator.reset(starts(len(again), seed=turn), robots=again, recordings=0, seeds=again * 7 + turn)
        kinds |= set(one.contacts[:, 0].tolist())
        if turn % 5 == 4:
            assert_same(one, other)
    assert count == 1 or kinds == {0, 1, 2}


def test_one_long_step_is_that_of_the_processor(device):
    one, other = make_both(5, [live(*PEOPLE)], lidar="front")
    for simulator in (one, other):
        simulator.reset(starts(5), recordings=0, seeds=3)
        simulator.step((0.3, 0.2), 4.0)
    assert_same(one, other)


def test_substeps_longer_than_a_period_of_crowds_step_them_alike(device):
    one, other = make_both(6, [live(*PEOPLE, movers=(CART,))], lidar="front", timestep=0.13)
    for simulator in (one, other):
        simulator.reset(starts(6), recordings=0, seeds=np.arange(6))
        for _ in range(6):
            simulator.step((0.3, 0.2), 0.26)
    assert_same(one, other)


def test_a_crowd_depends_on_nothing_but_its_own_robot(device):
    recording = live(*PEOPLE)
    together = BatchSimulator(GRID, CARTER, count=24, recordings=[recording], device="cuda")
    backwards = BatchSimulator(GRID, CARTER, count=40, recordings=[recording], device="cuda")
    alone = BatchSimulator(GRID, CARTER, count=1, recordings=[recording], device="cuda")
    order, where = np.arange(24), starts(24)
    for part in np.array_split(order, 3):
        together.reset(where[part], robots=part, recordings=0, seeds=part)
        backwards.reset(where[23 - part], robots=part, recordings=0, seeds=23 - part)
    alone.reset(where[7], recordings=0, seeds=7)
    for step in range(60):
        commands = np.column_stack([np.cos(order + step), np.sin(order * step)])
        together.step(commands, PERIOD)
        backwards.step(np.concatenate([commands[::-1], np.zeros((16, 2))]), PERIOD)
        alone.step(commands[7], PERIOD)
    for robot in order:
        assert np.array_equal(together.movers(robot), backwards.movers(23 - robot))
    assert np.array_equal(together.movers(7), alone.movers(0))
    assert np.array_equal(together.contacts.numpy(), backwards.contacts.numpy()[23::-1])


def test_those_who_are_stuck_go_back_alike(device):
    """A room so full that people block each other and the robot."""
    crowds = Crowd("people", 9, speed=1.2), Crowd("blind", 4, sees_robot=False)
    one, other = make_both(3, [live(*crowds, world=World.from_map(ROOM), seconds=1.0)], ROOM, lidar="front")
    state = other._engine._crowds._state
    around = 0
    for simulator in (one, other):
        simulator.reset((0.6, 0.6, 0.7), recordings=0, seeds=[1, 2, 3])
    for _ in range(60):
        for simulator in (one, other):
            simulator.step((0.02, 0.0), 0.5)
        around += int((state.disc_counts.numpy() > 0).sum())
    assert around > 20
    assert_same(one, other)


def test_who_leaves_the_square_of_its_path_searches_again_alike(device, monkeypatch):
    monkeypatch.setattr(device_crowds, "_WINDOW", device_crowds._LEAST_WINDOW)
    one, other = make_both(4, [live(*PEOPLE)], lidar="front")
    for simulator in (one, other):
        simulator.reset(starts(4), recordings=0, seeds=[5, 6, 7, 8])
        for _ in range(10):
            simulator.step((0.2, 0.1), 1.0)
    assert_same(one, other)


def test_a_crowd_without_room_is_refused_by_robot_and_nothing_is_reset(device):
    small = OccupancyGrid(np.pad(np.zeros((80, 80), np.int8), 2, constant_values=100), 0.05)
    one, other = make_both(3, [live(Crowd("people", 3), world=World.from_map(small))], small)
    where = [(0.6, 0.6, 0.0), (2.1, 2.1, 0.0)]
    texts = []
    for simulator in (one, other):
        simulator.reset((0.6, 0.6, 0.0), recordings=0, seeds=[1, 2, 3])
        simulator.step((0.2, 0.0), PERIOD)
        before, movers = np.array(simulator._host(simulator.poses)), simulator.movers(0)
        with pytest.raises(
            WorldError, match=r"robot 1: the crowd 'people': found no place.*Nothing was reset"
        ) as error:
            simulator.reset(where, robots=[0, 1], recordings=0)
        texts.append(str(error.value))
        assert np.array_equal(simulator._host(simulator.poses), before)
        assert np.array_equal(simulator.movers(0), movers)
        simulator.step((0.2, 0.0), PERIOD)
    assert texts[0] == texts[1]
    for robot in range(3):
        assert np.array_equal(one.movers(robot), other.movers(robot))


def test_recordings_of_all_kinds_share_a_batch(device):
    recorded = MoverRecording.of_world(replace(HALL, movers=(CART,)), CARTER, duration_s=20.0)
    few = live(Crowd("few", 3, seed=2**70), Crowd("more", 2, seed=0))
    one, other = make_both(8, [recorded, live(*PEOPLE, movers=(CART,)), few], lidar="front")
    robots = np.arange(8)
    for simulator in (one, other):
        simulator.reset(starts(8), recordings=robots % 4 - 1, seeds=robots)
        simulator.step((0.1, 0.2), 1.0)
    assert [len(other.movers(robot)) for robot in range(4)] == [0, 1, 10, 5]
    assert_same(one, other)
    for simulator in (one, other):
        simulator.reset(starts(8, seed=2), recordings=2 - robots % 4, seeds=robots)
        simulator.step((0.1, 0.2), 1.0)
    assert_same(one, other)


def test_arrays_of_the_device_start_crowds_too(device):
    one, other = make_both(6, [live(*PEOPLE)], lidar="front")
    given = {"recordings": np.array([0, 0, -1, 0, 0, 0]), "seeds": np.arange(6) * 2**40}
    one.reset(starts(6), **given)
    there = other.poses.device
    on_device = {name: wp.array(values, device=there) for name, values in given.items()}
    other.reset(wp.array(starts(6), device=there), **on_device)
    for _ in range(3):
        one.step((0.3, 0.1), 0.5)
        other.step(wp.array(np.full((6, 2), (0.3, 0.1)), device=there), 0.5)
    assert_same(one, other)


def test_a_bad_command_on_the_device_lets_crowds_stand(device):
    simulator = make_both(3, [live(*PEOPLE)])[1]
    simulator.reset(starts(3), recordings=0)
    before = [simulator.movers(robot) for robot in range(3)]
    commands = np.full((3, 2), 0.2)
    commands[1, 0] = np.nan
    with pytest.raises(InputError, match="command of robot 1 is not finite"):  # noqa: PT012 - a GPU may tell later
        simulator.step(wp.array(commands, device=simulator.poses.device), PERIOD)
        simulator.synchronize()
    assert all(np.array_equal(simulator.movers(robot), before[robot]) for robot in range(3))
    simulator.step((0.2, 0.0), PERIOD)
    simulator.synchronize()
    assert not np.array_equal(simulator.movers(0), before[0])


@pytest.mark.parametrize("free", [10**7, 42 * 10**6], ids=["too little", "too little to search for paths"])
def test_crowds_too_large_for_the_memory_of_a_device_are_refused(device, monkeypatch, free):
    monkeypatch.setattr(device_crowds, "free_memory", lambda _: free)
    with pytest.raises(InputError, match=r"robots among live crowds of 9 members need .* GB.*use fewer robots"):
        BatchSimulator(GRID, CARTER, count=3_000, recordings=[live(*PEOPLE)], device="cuda")
