"""Whether a robot makes room for those who wait for it to pass, and where it drives to for that."""

import numpy as np
import pytest

from support.sensed_rooms import ROBOT, block, grid_of, room
from support.sensed_runs import Run
from trundle.costmap import Costmap
from trundle.geometry import Goal, Pose2D
from trundle.navigation import NavigationStatus, Navigator, NavigatorSettings
from trundle.navigation.planning_limits import PlanningBudget
from trundle.navigation.retreat import find_room
from trundle.observation import Estimate
from trundle.sim import simulate
from trundle.worlds import World
from trundle.worlds.movers import Mover, Waypoints, person_body

GAP = (block("gap_south", 6.0, 0.1, 6.4, 2.5), block("gap_north", 6.0, 3.5, 6.4, 5.9))
"""Two rooms of 6 m with a gap of 1 m between them."""
NOBODY = np.zeros((0, 3))
AT_THE_GAP = Pose2D(4.8, 3.0, 0.0)


@pytest.fixture(scope="module")
def costmap():
    return Costmap.from_grid(grid_of(room(*GAP, width=12.4)), ROBOT)


def test_it_finds_a_place_with_room_beside_the_robot(costmap):
    place = find_room(costmap, AT_THE_GAP, np.array([[6.2, 3.0, 0.3]]))
    assert 1.8 < AT_THE_GAP.distance_to(place.pose) < 3.5
    assert place.x < 6.0  # not past the person
    assert costmap.clearance((place.x, place.y, 0.0))[0] > 0.6


def test_it_may_drive_through_the_gap_where_nobody_is(costmap):
    beyond = find_room(costmap, Pose2D(6.2, 3.0), NOBODY)
    assert min(abs(beyond.x - 6.0), abs(beyond.x - 6.4)) > 0.8


def test_each_place_is_another_one(costmap):
    places = []
    while len(places) < 50 and (place := find_room(costmap, AT_THE_GAP, NOBODY, places)) is not None:
        places.append(place)
    assert 2 < len(places) < 50
    assert all(one.pose.distance_to(other.pose) > 1.5 for k, one in enumerate(places) for other in places[:k])


@pytest.mark.parametrize("pose", [Pose2D(50.0, 3.0), Pose2D(0.7, 0.7)])
def test_there_may_be_no_such_place(pose):
    narrow = Costmap.from_grid(grid_of(room(width=1.4, height=1.4)), ROBOT)
    assert find_room(narrow, pose, NOBODY) is None


def visitor():
    """A person who walks into the gap, stands there, and walks off again after 40 s."""
    stops = [(0.0, 10.0, 3.0), (5.0, 6.2, 3.0), (40.0, 6.2, 3.0), (44.0, 9.0, 3.0), (48.0, 9.0, 5.3)]
    return Mover("visitor", person_body(), Waypoints(stops))


def drive(**settings):
    navigator = Navigator(grid_of(room(*GAP, width=12.4)), ROBOT, settings=NavigatorSettings(**settings))
    world = World("gap", room(*GAP, width=12.4).solids, movers=(visitor(),))
    return navigator, Run(world, navigator, Pose2D(1.5, 3.0), Goal(11.0, 3.0), seconds=120.0)


def test_it_makes_room_for_a_person_who_waits_in_a_gap_and_drives_on_after_that():
    navigator, run = drive()
    assert (navigator.status, run.contact) == (NavigationStatus.ARRIVED, "")
    assert any("to let others pass" in message for message in run.messages)
    away = [np.hypot(pose.x - 6.2, pose.y - 3.0) for pose, time in run.timed if time < 40.0]
    nearest = int(np.argmin(away))
    assert max(away[nearest:]) > away[nearest] + 1.0


def test_a_localizer_that_doubts_for_a_moment_leaves_no_path_to_the_place():
    navigator = Navigator(grid_of(room(*GAP, width=12.4)), ROBOT)
    world = World("gap", room(*GAP, width=12.4).solids, movers=(visitor(),))
    lost_at = None
    goal = Goal(11.0, 3.0)
    navigator.set_goal(goal)
    with simulate(world, ROBOT, backend="kinematic", lidar=True) as sim:
        state = sim.reset(Pose2D(1.5, 3.0))
        while state.time < 40.0 and (lost_at is None or state.time < lost_at + 2.0):
            if lost_at is None and navigator.message.startswith("blocked: driving to"):
                lost_at = state.time
            doubts = lost_at is not None and state.time < lost_at + 1.0
            estimate = Estimate(state.time, state.pose, state="ambiguous" if doubts else "localized")
            state = sim.step(navigator.update(state.observation, estimate), navigator.dt)
            if lost_at is not None and not doubts and navigator.path is not None:
                assert navigator.path.goal.distance_to(goal.pose) < 0.3
    assert lost_at is not None


def test_without_backing_up_among_the_steps_of_recovery_it_stays():
    navigator, run = drive(recovery="replan,drive_clear")
    assert (navigator.status, run.contact) == (NavigationStatus.ARRIVED, "")
    assert not any("to let others pass" in message for message in run.messages)


def test_a_drive_may_search_more_after_the_robot_has_made_room():
    budget = PlanningBudget(None, 900)
    for time in (0.0, 1.0):
        budget.spend(1_000, time, needed=True)
    assert budget.is_spent(2.0)
    budget.allow_more()
    assert not budget.is_spent(2.0)
    budget.reset()
    budget.spend(1, 3.0, needed=True)
    budget.spend(900, 4.0, needed=True)
    assert budget.is_spent(5.0)
