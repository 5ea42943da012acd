from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from support.crowd_oracle import CrowdOracle
from trundle import World
from trundle.errors import InputError, UnknownNameError, WorldError
from trundle.geometry import Pose2D, Pose3D, wrap_angle
from trundle.geometry.solids import Box, OccupancyCells, Solid
from trundle.maps import OccupancyGrid
from trundle.worlds.movers import AlongPath, Crowd, Mover, Waypoints, forklift_body, person_body
from trundle.worlds.movers.mover import radius_of
from trundle.worlds.movers.walk import PERIOD_S, CrowdWalk, RobotMotion

ROBOT = RobotMotion(0.0, 0.0, 0.0, 0.0, 0.6)
HALL = World.generate("warehouse", seed=3, size=(20.0, 14.0))
CROWDS = (Crowd("forklifts", 2, "forklift", sees_robot=False), Crowd("people", 6, speed=1.4))


def walk_of(crowds, solids=HALL.solids, movers=()):
    return CrowdWalk(crowds, movers, solids)


def drive(walk, seed, seconds, robot=ROBOT):
    walk.reset(seed, robot)
    return np.array([walk.at(step * PERIOD_S, robot) for step in range(round(seconds / PERIOD_S))])


def test_the_same_seed_gives_the_same_walk_bit_for_bit_and_another_seed_another():
    walk = walk_of(CROWDS)
    first, second, third = drive(walk, 1, 10.0), drive(walk_of(CROWDS), 1, 10.0), drive(walk, 2, 10.0)
    again = drive(walk, 1, 10.0)
    assert np.array_equal(first, second)
    assert np.array_equal(first, again)
    assert not np.array_equal(first, third)


def test_a_crowd_with_a_seed_of_its_own_does_not_depend_on_the_run():
    crowds = (Crowd("people", 3, seed=5),)
    assert np.array_equal(drive(walk_of(crowds), 1, 3.0), drive(walk_of(crowds), 2, 3.0))


def test_members_keep_off_solids_and_each_other_and_get_somewhere():
    states = drive(walk_of(CROWDS), 4, 30.0)
    radii = np.array([radius_of(crowd.body) for crowd in CROWDS for _ in range(crowd.count)])
    places = states[:, :, :2]
    apart = np.linalg.norm(places[:, :, None] - places[:, None], axis=-1) - radii[:, None] - radii
    apart[:, range(len(radii)), range(len(radii))] = np.inf
    assert apart.min() > -1e-9
    grid = OccupancyGrid.from_world(HALL, resolution=0.05, z_range=(0.05, 1.7))
    free = np.argwhere(grid.data == 100)[:, ::-1] * 0.05 + 0.025 + np.array([grid.origin.x, grid.origin.y])
    for index, radius in enumerate(radii):
        gaps = np.linalg.norm(places[::10, index, None] - free, axis=-1).min(axis=1)
        assert gaps.min() > radius
    walked = np.abs(np.diff(places, axis=0)).sum(axis=(0, 2))
    assert (walked > 3.0).all()


def test_nobody_is_faster_than_the_speed_of_the_crowd_and_velocities_are_those_of_the_motion():
    walk = walk_of(CROWDS)
    states = drive(walk, 4, 20.0)
    speeds = np.hypot(states[..., 3], states[..., 4])
    assert speeds[:, :2].max() <= 1.2 + 1e-9
    assert speeds[:, 2:].max() <= 1.4 + 1e-9
    moved = np.diff(states[..., :3], axis=0) / PERIOD_S
    assert moved == pytest.approx(states[:-1, :, 3:], abs=1e-9)


def test_between_two_steps_they_move_straight():
    walk = walk_of(CROWDS)
    walk.reset(1, ROBOT)
    first = walk.at(1.0, ROBOT)
    middle, last = walk.at(1.02, ROBOT), walk.at(1.05, ROBOT)
    assert middle[:, :3] == pytest.approx(0.6 * first[:, :3] + 0.4 * last[:, :3])


def test_a_forklift_drives_where_it_faces():
    states = drive(walk_of(CROWDS), 4, 20.0)[:, :2]
    fast = np.hypot(states[..., 3], states[..., 4]) > 0.5
    across = np.cos(states[..., 2]) * states[..., 4] - np.sin(states[..., 2]) * states[..., 3]
    assert np.percentile(np.abs(across[fast]), 90) < 0.3


@pytest.mark.slow
def test_those_who_see_the_robot_do_not_touch_it_and_others_do():
    open_floor = Solid("kerb", Box((8.0, 0.2, 0.2)), Pose3D((0.0, 4.1, 0.1)))
    area = (-4.0, -4.0, 4.0, 4.0)
    least = {}
    for sees in (True, False):
        crowd = Crowd("people", 8, sees_robot=sees, area=area)
        states = drive(walk_of((crowd,), (open_floor,)), 3, 40.0)
        least[sees] = np.hypot(states[..., 0], states[..., 1]).min()
    assert least[True] > 0.9 + 0.5 - 1e-6
    assert least[False] < 0.9


def test_those_who_see_a_robot_that_drives_stay_out_of_its_path():
    crowd = Crowd("people", 6, area=(-6.0, -3.0, 6.0, 3.0))
    walk = walk_of((crowd,), ())
    walk.reset(5, RobotMotion(-5.0, 0.0, 0.0, 0.0, 0.6))
    for step in range(400):
        x = -5.0 + 0.5 * step * PERIOD_S
        robot = RobotMotion(x, 0.0, 0.5, 0.0, 0.6)
        states = walk.at(step * PERIOD_S, robot)
        offset = states[:, :2] - (x, 0.0)
        # Who stands still may be reached by the robot; nobody walks into it.
        closing = -(offset * states[:, 3:5]).sum(axis=1)
        near = np.hypot(offset[:, 0], offset[:, 1]) < 1.0
        assert (closing[near] <= 1e-9).all()


def test_crowds_keep_clear_of_movers_at_the_start():
    mover = Mover("cart", forklift_body(), AlongPath(((0.0, 0.0), (2.0, 0.0)), 1.0))
    crowd = Crowd("people", 5, area=(-4.0, -4.0, 4.0, 4.0))
    walk = walk_of((crowd,), (), (mover,))
    for seed in range(20):
        walk.reset(seed, RobotMotion(20.0, 0.0, 0.0, 0.0, 0.5))
        places = walk.at(0.0)[:, :2]
        assert np.hypot(places[:, 0], places[:, 1]).min() > radius_of(mover.parts) + 0.3


def test_a_crowd_is_placed_again_where_the_first_leave_no_room_for_the_last():
    crowd = Crowd("people", 4, area=(0.0, 0.0, 3.2, 0.9))
    walk = walk_of((crowd,), ())
    for seed in range(10):
        walk.reset(seed, RobotMotion(20.0, 0.0, 0.0, 0.0, 0.5))
        places = walk.at(0.0)[:, :2]
        apart = np.linalg.norm(places[:, None] - places, axis=-1)[np.triu_indices(4, 1)]
        assert apart.min() > 2.0 * radius_of(crowd.body)


def test_a_world_without_room_is_refused():
    box = Solid("box", Box((0.5, 0.5, 1.0)), Pose3D((0.0, 0.0, 0.5)))
    with pytest.raises(WorldError, match="no room for one"):
        walk_of((Crowd("people", 1),), (box,))
    with pytest.raises(WorldError, match="give its area"):
        walk_of((Crowd("people", 1),), ())
    with pytest.raises(WorldError, match="found no place for 'people_"):
        walk_of((Crowd("people", 60, area=(0.0, 0.0, 3.0, 3.0)),), ()).reset(0, ROBOT)


def test_a_crowd_that_is_far_too_large_is_refused_with_how_many_have_found_a_place():
    with pytest.raises(WorldError, match=r"clear of the \d+ before it; make the crowd smaller"):
        walk_of((Crowd("people", 1000),)).reset(0, ROBOT)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"count": 0}, "count"),
        ({"count": True}, "count"),
        ({"speed": 0.0}, "speed"),
        ({"speed": math.nan}, "speed"),
        ({"area": (1.0, 0.0, 0.0, 1.0)}, "area"),
        ({"model": "orca"}, "there is no model 'orca'"),
        ({"seed": -1}, "seed"),
        ({"sees_robot": 1}, "sees_robot"),
        ({"name": ""}, "needs a name"),
        ({"parts": (Solid("cells", OccupancyCells(np.ones((2, 2), dtype=bool), 0.1, 1.0)),)}, "cannot move"),
    ],
)
def test_bad_crowds_are_refused(options, words):
    with pytest.raises(WorldError, match=words):
        Crowd(**{"name": "people", "count": 2, **options})


def test_an_unknown_body_offers_the_nearest():
    with pytest.raises(UnknownNameError, match="forklift"):
        Crowd("trucks", 1, "forklfit")


def test_bodies_cross_the_plane_of_a_lidar_and_forks_do_not():
    heights = {part.name: (part.bounds()[0][2], part.bounds()[1][2]) for part in forklift_body()}
    assert heights["body"][0] < 0.418 < heights["body"][1]
    assert heights["fork_left"] == pytest.approx((0.14, 0.20))
    (body, head) = person_body()
    assert body.bounds()[1][2] > 0.418
    assert head.bounds()[1][2] == pytest.approx(1.75)


def test_names_are_unique_among_solids_movers_and_members():
    mover = Mover("people_2", person_body(), Waypoints(((0.0, 0.0, 0.0),)))
    with pytest.raises(WorldError, match="two solids or movers named 'people_2'"):
        World("w", (), movers=(Crowd("people", 3), mover))
    with pytest.raises(WorldError, match="named 'people_2'"):
        World("w", (Solid("people_2", Box((1.0, 1.0, 1.0))),), movers=(mover,))
    with pytest.raises(InputError, match="Mover"):
        World("w", (), movers=("forklift",))  # type: ignore[arg-type]


def test_movers_need_parts_of_different_names():
    motion = Waypoints(((0.0, 0.0, 0.0),))
    with pytest.raises(WorldError, match="at least one solid"):
        Mover("m", (), motion)
    with pytest.raises(WorldError, match="two parts of one name"):
        Mover("m", person_body()[:1] * 2, motion)
    with pytest.raises(InputError, match="Waypoints and AlongPath"):
        Mover("m", person_body(), "circle")  # type: ignore[arg-type]


def test_movers_are_part_of_a_world_and_not_of_its_map_or_bounds():
    moved = replace(HALL, movers=CROWDS)
    assert moved != HALL
    assert "8 movers" in repr(moved)
    assert np.array_equal(moved.bounds, HALL.bounds)
    assert np.array_equal(OccupancyGrid.from_world(moved).data, OccupancyGrid.from_world(HALL).data)


def test_a_forklift_that_sees_a_robot_beside_it_does_not_turn_into_it():
    corners = np.array([(x, y) for x in (-1.0, 0.2) for y in (-0.45, 0.45)])
    least = {}
    for sees in (True, False):
        crowd = Crowd("forklift", 1, kind="forklift", sees_robot=sees, area=(-6.0, -6.0, 6.0, 6.0))
        gaps = []
        for seed in range(6):
            walk = walk_of((crowd,), ())
            walk.reset(seed, RobotMotion(50.0, 50.0, 0.0, 0.0, 0.4))
            x, y, yaw = walk.at(1.0, RobotMotion(50.0, 50.0, 0.0, 0.0, 0.4))[0, :3].tolist()
            # Beside its tail: there it is when the robot comes, and turning swings the tail into it.
            tail = Pose2D(x, y, wrap_angle(yaw)).transform_points([(-0.6, 1.05)])[0].tolist()
            beside = RobotMotion(*tail, 0.0, 0.0, 0.4)
            for step in range(20, 120):
                x, y, yaw = walk.at(step * PERIOD_S, beside)[0, :3].tolist()
                placed = Pose2D(x, y, wrap_angle(yaw)).transform_points(corners)
                gaps.append(np.hypot(placed[:, 0] - beside.x, placed[:, 1] - beside.y).min())
        least[sees] = min(gaps)
    assert least[True] > 0.4
    assert least[False] < 0.4


@pytest.mark.slow
def test_those_who_block_each_other_back_out_of_a_jam():
    stays = []
    for seed in (0, 2, 3):
        world = World.generate("warehouse", seed=seed, low_objects=False, forklifts=6, people=8)
        places = drive(walk_of(world.movers, world.solids), seed, 120.0, ROBOT._replace(x=-100.0))[::20, :6, :2]
        stays += [longest_stay(places[:, index]) for index in range(6)]
    assert np.median(stays) < 13.0  # 15 s where each tries another random place


def test_who_is_pushed_to_and_fro_in_a_jam_is_stuck_as_well():
    crowd = Crowd("people", 1, area=(-6.0, -3.0, 6.0, 3.0))
    walk = CrowdOracle((crowd,), (), ())  # its places are set here, and its steps are the kernel's
    walk.reset(1, ROBOT._replace(x=-100.0))
    goal = walk._goals[0].copy()
    for step in range(80):
        walk._from[0, 0] += 0.04 if step % 2 else -0.04  # 0.8 m/s, and it gets nowhere
        walk._choose_goals(walk._from[:, :2], None)
    assert not np.array_equal(walk._goals[0], goal)


def test_who_waits_for_a_robot_that_closes_a_corridor_walks_away_from_it():
    corridor = (-12.0, -0.6, 12.0, 0.6)
    for seed in range(6):
        crowd = Crowd("people", 1, area=corridor)
        places = drive(walk_of((crowd,), ()), seed, 60.0)[::20, 0, :2]
        assert longest_stay(places) <= 6


def longest_stay(places):
    """Longest time [s] within 0.5 m of one place; places are 1 s apart."""
    longest = 0
    for first in range(len(places)):
        left = np.flatnonzero(np.hypot(*(places[first:] - places[first]).T) > 0.5)
        longest = max(longest, int(left[0]) if len(left) else len(places) - first)
    return longest


CART = Mover("cart", forklift_body(), AlongPath(((0.0, 0.0), (2.0, 0.0)), 1.0, repeat="back_and_forth"))


@pytest.mark.parametrize(
    ("crowds", "movers", "seconds"),
    [
        (CROWDS, (), 15.0),
        ((Crowd("people", 10, speed=1.4), Crowd("forklifts", 3, "forklift")), (CART,), 12.0),
        ((Crowd("people", 30, seed=4),), (), 4.0),
        ((Crowd("people", 6, area=(0.0, 0.0, 3.2, 2.4), sees_robot=False),), (), 4.0),
    ],
    ids=["two crowds", "beside a mover", "dense", "a jam"],
)
def test_the_kernel_walks_as_the_plain_version_in_numpy(crowds, movers, seconds):
    """The forces let rounding grow: in time the two part. Each draw of a goal in these seconds has to be the same."""
    solids = HALL.solids if crowds[0].area is None else ()
    for seed in (0, 1):
        walks = walk_of(crowds, solids, movers), CrowdOracle(crowds, movers, solids)
        for walk in walks:
            walk.reset(seed, ROBOT._replace(x=-8.0))
        for step in range(round(seconds / 0.02)):
            robot = RobotMotion(-8.0 + 0.01 * step, 0.2, 0.5, 0.0, 0.6)
            mine, expected = (walk.at(0.02 * step, robot) for walk in walks)
            assert np.abs(mine - expected).max() < 1e-3


def test_a_route_is_found_again_by_who_has_left_it_and_those_who_are_stuck_go_round_others():
    """Two forklifts in a corridor block each other, and a robot between people and their goals drives them off."""
    crowd = Crowd("forklifts", 2, "forklift", area=(0.0, 0.0, 16.0, 3.4))
    walks = walk_of((crowd,), ()), CrowdOracle((crowd,), (), ())
    for walk in walks:
        walk.reset(2, ROBOT._replace(x=-100.0))
    mine, expected = (
        np.array([walk.at(step * PERIOD_S, ROBOT._replace(x=-100.0)) for step in range(600)]) for walk in walks
    )
    assert np.abs(mine - expected).max() < 1e-6
