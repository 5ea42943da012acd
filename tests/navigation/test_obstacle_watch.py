import itertools
import math

from trundle.geometry import Pose2D
from trundle.navigation.obstacle_watch import LONG_DETOUR_M, PLAN_EVERY_S, SELDOM_S, STAND_OFF_M, ObstacleWatch


def test_a_short_detour_is_taken_at_once_and_a_long_one_after_the_wait():
    watch = ObstacleWatch(wait_s=2.0, patience_s=20.0)
    watch.see(5.0)
    assert watch.takes(10.0 + LONG_DETOUR_M, 10.0, 5.0)
    assert not watch.takes(10.1 + LONG_DETOUR_M, 10.0, 6.9)
    assert watch.takes(10.1 + LONG_DETOUR_M, 10.0, 7.0)


def test_plans_become_rare_while_they_fail():
    watch = ObstacleWatch(wait_s=2.0, patience_s=100.0)
    watch.see(0.0)
    times = []
    for tick in range(600):
        if watch.may_plan(tick * 0.05):
            times.append(tick * 0.05)
            watch.fail()
    gaps = [round(later - earlier, 2) for earlier, later in itertools.pairwise(times)]
    assert gaps[:3] == [2 * PLAN_EVERY_S, 4 * PLAN_EVERY_S, SELDOM_S]
    assert set(gaps[2:]) == {SELDOM_S}


def test_it_gives_up_where_the_robot_stands_for_too_long():
    watch = ObstacleWatch(wait_s=2.0, patience_s=20.0)
    given_up = []
    for time, x in ((0.0, 0.0), (20.0, 0.3), (20.1, 0.0), (21.0, 0.6), (41.0, 0.6), (41.1, 0.6)):
        watch.follow(Pose2D(x, 0.0), time)
        given_up.append(watch.gives_up)
    assert given_up == [False, False, True, False, False, True]
    watch.reset()
    assert not watch.gives_up
    watch.see(50.0)
    watch.clear()
    assert not watch.is_blocked


def test_it_is_more_patient_beside_what_was_seen_to_move():
    watch = ObstacleWatch(wait_s=2.0, patience_s=20.0, mover_patience_s=60.0)
    given_up = []
    for time, beside in ((0.0, False), (21.0, False), (21.1, True), (59.0, True), (60.1, True)):
        watch.follow(Pose2D(0.0, 0.0), time)
        watch.beside_mover = beside
        given_up.append(watch.gives_up)
    assert given_up == [False, True, False, False, True]


def test_it_backs_up_after_the_wait_and_then_seldom():
    watch = ObstacleWatch(wait_s=2.0, patience_s=100.0)
    watch.see(0.0)
    assert [time for time in range(15) if watch.backs_up(float(time))] == [2, 7, 12]


def test_only_a_robot_that_stands_may_search_for_long_and_seldom():
    watch = ObstacleWatch(wait_s=2.0, patience_s=1000.0)
    watch.see(0.0)
    assert not watch.is_thorough(0.0, stands=False)
    assert watch.is_thorough(0.0, stands=True)
    assert not watch.is_thorough(9.9, stands=True)
    assert watch.is_thorough(10.0, stands=True)
    watch.clear()
    watch.see(10.5)
    assert watch.is_thorough(10.5, stands=True)


def test_the_last_plan_before_it_gives_up_may_search_for_long():
    watch = ObstacleWatch(wait_s=2.0, patience_s=20.0)
    watch.see(0.0)
    assert watch.is_thorough(0.0, stands=True)
    watch.follow(Pose2D(0.0, 0.0), 0.0)
    watch.follow(Pose2D(0.0, 0.0), 20.1)
    assert watch.gives_up
    assert watch.is_thorough(0.1, stands=True)


def test_only_what_moves_and_blocks_the_path_is_left_room():
    watch = ObstacleWatch(wait_s=2.0, patience_s=20.0)
    watch.see(0.0, 3.0)
    assert watch.room_m == math.inf
    watch.by_mover = True
    assert watch.room_m == 3.0 - STAND_OFF_M
    watch.see(0.1, 0.5)
    assert watch.room_m == 0.5 - STAND_OFF_M
    watch.see(0.2)
    assert watch.room_m == math.inf
    watch.see(0.3, 1.0)
    watch.clear()
    assert watch.room_m == math.inf


def test_it_is_more_patient_while_what_was_seen_to_move_blocks_the_path():
    watch = ObstacleWatch(wait_s=2.0, patience_s=20.0, mover_patience_s=60.0)
    watch.follow(Pose2D(0.0, 0.0), 0.0)
    watch.see(0.0)
    watch.by_mover = True
    watch.follow(Pose2D(0.0, 0.0), 59.0)
    assert not watch.gives_up
    watch.follow(Pose2D(0.0, 0.0), 60.1)
    assert watch.gives_up
    watch.follow(Pose2D(1.0, 0.0), 70.0)
    watch.follow(Pose2D(1.0, 0.0), 100.0)
    assert not watch.gives_up
    watch.clear()
    assert watch.gives_up


def test_patience_with_what_moves_is_never_less_than_with_anything_else():
    watch = ObstacleWatch(wait_s=2.0, patience_s=20.0, mover_patience_s=5.0)
    watch.by_mover = True
    watch.follow(Pose2D(0.0, 0.0), 0.0)
    watch.follow(Pose2D(0.0, 0.0), 19.0)
    assert not watch.gives_up
