"""Frontiers of a map, which of them is next, and the agent that drives to them."""

import math

import numpy as np
import pytest

from support.sensed_rooms import ROBOT
from trundle.costmap import CostmapSettings
from trundle.errors import InputError, NoPathError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation import NavigationStatus, Navigator
from trundle.navigation.agents import create_agent
from trundle.navigation.exploration import Explorer, ExplorerSettings, Frontier, find_frontiers
from trundle.navigation.exploration.frontiers import Targets, shows_floor
from trundle.observation import Estimate, Observation, Scan
from trundle.sim import simulate
from trundle.worlds import World

EDGE = 0.05


def costmap_of(cells):
    return CostmapSettings(unknown="costly").make_costmap(OccupancyGrid(np.asarray(cells, np.int8), EDGE), ROBOT)


def half_room():
    """A room of 10 x 6 m, of which the left half is seen."""
    cells = np.zeros((120, 200), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[1:-1, 100:] = -1
    cells[:, 100:][cells[:, 100:] == 100] = -1
    return cells


def frontier(x=0.0, y=0.0, *, distance=1.0, gain=1.0):
    return Frontier(x, y, 1.0, (x, y), distance, gain)


# Frontiers ------------------------------------------------------------------------------------------------------------


def test_the_border_of_a_half_seen_room_is_one_frontier():
    (found,) = find_frontiers(costmap_of(half_room()), Pose2D(1.5, 3.0))
    assert (found.x, found.y) == pytest.approx((4.975, 3.0), abs=0.06)
    assert found.length == pytest.approx(5.9, abs=0.1)
    assert math.dist(found.view, (found.x, found.y)) < 1.0
    assert found.distance == pytest.approx(3.5, abs=0.5)
    assert 5.0 < found.gain < 30.0


def test_a_room_that_is_seen_has_none():
    cells = half_room()
    cells[1:-1, 100:-1] = 0
    cells[[0, -1], :] = cells[:, -1] = 100
    assert find_frontiers(costmap_of(cells), Pose2D(1.5, 3.0)) == []


def test_specks_between_beams_and_gaps_in_walls_are_none():
    cells = half_room()
    cells[1:-1, 100:-1] = 0
    cells[[0, -1], :] = cells[:, -1] = 100
    cells[40:44, 60:64] = -1  # 0.04 m²
    wider = np.full((160, 240), -1, np.int8)
    wider[20:140, 20:220] = cells
    wider[60:65, 219] = 0  # 0.25 m of the east wall were never hit
    costmap = CostmapSettings(unknown="costly").make_costmap(OccupancyGrid(wider, EDGE, Pose2D(-1.0, -1.0)), ROBOT)
    assert find_frontiers(costmap, Pose2D(1.5, 3.0)) == []


@pytest.mark.parametrize(("rows", "is_found"), [((50, 56), True), ((115, 119), False)])
def test_an_area_that_was_not_seen_counts_where_it_blocks_the_floor(rows, is_found):
    cells = half_room()
    cells[1:-1, 100:-1] = 0
    cells[[0, -1], :] = cells[:, -1] = 100
    cells[rows[0] : rows[1], 90:102] = -1  # amid the room, or beside the wall, where no robot fits
    found = find_frontiers(costmap_of(cells), Pose2D(1.5, 3.0))
    assert len(found) == is_found
    assert not find_frontiers(costmap_of(cells), Pose2D(1.5, 3.0), ExplorerSettings(least_opening=5.0))


def test_what_lies_behind_a_wall_cannot_be_looked_at():
    cells = half_room()
    cells[:, 60] = 100
    assert find_frontiers(costmap_of(cells), Pose2D(1.5, 3.0)) == []


def test_a_long_frontier_is_looked_at_from_its_ends_where_its_middle_is_behind_a_wall():
    cells = np.zeros((240, 200), np.int8)  # 12 x 10 m, the right half unknown
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[:, 100:] = -1
    cells[30:210, 97] = 100  # between wall and border the robot does not fit
    (found,) = find_frontiers(costmap_of(cells), Pose2D(1.5, 6.0))
    assert found.length == pytest.approx(11.9, abs=0.1)
    assert abs(found.y - 6.0) > 3.0
    assert math.dist(found.view, (found.x, found.y)) < 3.0


def test_a_robot_beside_the_map_finds_none():
    assert find_frontiers(costmap_of(half_room()), Pose2D(50.0, 3.0)) == []


# Targets --------------------------------------------------------------------------------------------------------------


def test_a_border_right_round_the_robot_comes_in_pieces_that_stay_where_the_map_grows():
    def found(free_m, margin, in_pieces=True):
        """Of a free square of this size, middle at (0, 0), with so many unknown cells round it."""
        half = round(0.5 * free_m / EDGE)
        cells = np.full((2 * (half + margin),) * 2, -1, np.int8)
        cells[margin:-margin, margin:-margin] = 0
        corner = -EDGE * (half + margin)
        grid = OccupancyGrid(cells, EDGE, Pose2D(corner, corner))
        costmap = CostmapSettings(unknown="costly").make_costmap(grid, ROBOT)
        return find_frontiers(costmap, Pose2D(0.1, 0.1), ExplorerSettings(view_range=4.0), in_pieces=in_pieces)

    frontiers = found(20.0, 60)
    places = np.array([(one.x, one.y) for one in frontiers])
    assert len(frontiers) >= 8
    assert max(one.length for one in frontiers) <= 16.5
    assert sum(one.length for one in frontiers) == pytest.approx(4 * 20.0, rel=0.05)
    assert places.min(axis=0) == pytest.approx((-9.97, -9.97), abs=0.06)
    assert places.max(axis=0) == pytest.approx((9.97, 9.97), abs=0.06)
    assert np.array([(one.x, one.y) for one in found(20.0, 75)]) == pytest.approx(places)
    (short,) = found(3.5, 60)
    assert short.length == pytest.approx(4 * 3.5, rel=0.1)
    (whole,) = found(20.0, 60, in_pieces=False)
    assert whole.length == pytest.approx(4 * 20.0, rel=0.05)


def test_near_frontiers_and_those_that_show_much_come_first():
    targets = Targets(ExplorerSettings())
    near, far, rich = frontier(5.0, distance=2.0), frontier(9.0, distance=8.0), frontier(20.0, distance=8.0, gain=50.0)
    assert targets.choose([far, near], None) is near
    assert targets.choose([near, rich], None) is rich
    assert Targets(ExplorerSettings(gain_exponent=0.0)).choose([near, rich], None) is near


def test_the_robot_does_not_turn_away_for_little():
    targets = Targets(ExplorerSettings())
    one, other = frontier(5.0, distance=3.0), frontier(9.0, distance=2.5)
    assert targets.choose([one, other], None) is other
    assert targets.choose([one, other], one) is one


def test_a_refused_frontier_is_tried_again_after_the_others_and_then_given_up():
    targets = Targets(ExplorerSettings(tries=2))
    near, far = frontier(1.0, distance=1.0), frontier(9.0, distance=9.0)
    targets.refuse(near, "no path")
    assert targets.choose([near, far], None) is far
    assert targets.choose([near], None) is near
    targets.refuse(near, "stuck")
    assert targets.choose([near], None) is None
    assert [(one.x, one.reason) for one in targets.given_up([near])] == [(1.0, "stuck")]
    assert targets.given_up([]) == ()


def test_a_frontier_that_comes_back_again_and_again_is_given_up():
    targets = Targets(ExplorerSettings())
    for _ in range(3):
        targets.note_vanished(frontier(1.0))
    assert targets.choose([frontier(1.0)], None) is not None
    targets.note_vanished(frontier(1.0))
    assert targets.choose([frontier(1.0)], None) is None


# The agent ------------------------------------------------------------------------------------------------------------


def two_rooms():
    """Two rooms with a door of 1.4 m between them."""
    cells = np.zeros((100, 200), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[:36, 100:102] = cells[64:, 100:102] = 100
    return World.from_map(OccupancyGrid(cells, EDGE))


def explore(world, controller="regulated_pure_pursuit", limit_s=150.0):
    explorer = Explorer(ROBOT, Navigator(None, ROBOT, controller=controller))
    with simulate(world, ROBOT, backend="kinematic", lidar=True) as sim:
        state = sim.reset(Pose2D(2.0, 2.5))
        while explorer.status not in (NavigationStatus.FINISHED, NavigationStatus.STUCK) and state.time < limit_s:
            command = explorer.update(state.observation, Estimate(state.time, state.pose))
            state = sim.step(command, explorer.dt)
            assert not state.contacts
    return explorer, state


@pytest.mark.parametrize("controller", ["regulated_pure_pursuit", "mppi"])
def test_two_rooms_are_explored_to_the_end(controller):
    explorer, _ = explore(two_rooms(), controller)
    assert explorer.status is NavigationStatus.FINISHED
    assert explorer.given_up == ()
    costmap = explorer.navigator.costmap
    x, y = np.meshgrid(np.arange(0.5, 9.6, 0.25), np.arange(0.5, 4.6, 0.25))
    row, col = costmap.world_to_cell(x, y)
    assert costmap.unknown_cells[row, col].mean() < 0.01
    assert explorer.report().message == "nothing is left to see"


def test_without_scans_it_is_stuck_and_says_why():
    explorer = Explorer(ROBOT)
    for step in range(200):
        observation = Observation(0.05 * step, Twist2D(), Pose2D(0.0, 0.0))
        assert explorer.update(observation, Estimate(observation.time, Pose2D(0.0, 0.0))) == Twist2D()
    assert explorer.status is NavigationStatus.STUCK
    assert "needs scans" in explorer.report().message


def scans_of(ranges, seconds, explorer, pose):
    """Let an explorer see the same ranges from one place, until it ends or the time is over."""
    angles = np.linspace(-math.pi, math.pi, len(ranges), endpoint=False)
    for k in range(round(seconds / 0.1)):
        at = 0.1 * k
        scan = Scan("lidar", at, Pose2D(0.0, 0.0), 0.3, angles, ranges, 0.1, 10.0)
        command = explorer.update(Observation(at, Twist2D(), pose, (scan,)), Estimate(at, pose))
        if explorer.status in (NavigationStatus.FINISHED, NavigationStatus.STUCK):
            return at
        assert command == Twist2D()
    return None


def test_a_robot_whose_scans_show_no_floor_has_not_finished_and_is_stuck_after_a_while():
    explorer = Explorer(ROBOT, Navigator(None, ROBOT, layers=False, tracking=False))
    assert scans_of(np.full(90, np.nan), 10.0, explorer, Pose2D(0.0, 0.0)) == pytest.approx(5.1, abs=0.6)
    assert explorer.status is NavigationStatus.STUCK
    assert explorer.report().message.startswith("the lidars see nothing from here")


def test_a_robot_beside_the_map_has_not_finished():
    explorer = Explorer(ROBOT, Navigator(None, ROBOT, layers=False, tracking=False))
    explorer.set_map(OccupancyGrid(np.full((20, 20), -1, np.int8), EDGE), corrected=False)
    assert scans_of(np.full(90, np.nan), 10.0, explorer, Pose2D(30.0, -20.0)) is not None
    assert explorer.status is NavigationStatus.STUCK


def test_floor_is_seen_where_the_robot_can_drive_on_it():
    costmap = costmap_of(half_room())
    assert shows_floor(costmap, Pose2D(1.5, 3.0))
    assert not shows_floor(costmap, Pose2D(8.5, 3.0))
    assert not shows_floor(costmap, Pose2D(50.0, 3.0))


def test_a_reset_begins_anew():
    explorer, _ = explore(two_rooms(), limit_s=5.0)
    explorer.reset(seed=1)
    assert (explorer.status, explorer.frontiers, explorer.target) == (NavigationStatus.IDLE, [], None)


def test_options_come_by_name_and_are_checked():
    made = create_agent("explorer", ROBOT, least_frontier=0.8)
    assert made.settings.least_frontier == 0.8
    with pytest.raises(InputError, match="least_frontier"):
        create_agent("explorer", ROBOT, least_frontier=-1.0)
    with pytest.raises(InputError, match="unknown"):
        create_agent("explorer", ROBOT, frontier=1.0)


# Shut in --------------------------------------------------------------------------------------------------------------


class ShutIn:
    """A navigator that finds no path anywhere."""

    robot, dt, path, message, target = ROBOT, 0.5, None, "", None
    status, error = NavigationStatus.BLOCKED, NoPathError("none found")
    costmap = None

    def __init__(self):
        self.goals = []

    def set_goal(self, x, y):
        self.goals.append((x, y))
        self.target = Pose2D(x, y)

    def update(self, observation, estimate):
        return Twist2D()


def observe(explorer, seconds, x=0.0, *, begin=0.0):
    scan = Scan("lidar", 0.0, Pose2D(0.0, 0.0), 0.3, np.zeros(1), np.ones(1), 0.1, 10.0)
    for k in range(round(seconds / 0.5)):
        at = begin + 0.5 * k
        observation = Observation(at, Twist2D(), Pose2D(x, 0.0), (scan,))
        explorer.update(observation, Estimate(at, Pose2D(x, 0.0), np.zeros((3, 3)), Pose2D(0.0, 0.0), "localized"))


def test_an_explorer_that_is_shut_in_waits_and_does_not_give_all_frontiers_up(monkeypatch):
    frontiers = [frontier(5.0 * k, 10.0, gain=20.0 - k) for k in range(8)]
    monkeypatch.setattr("trundle.navigation.exploration.explorer.find_frontiers", lambda *_, **__: frontiers)
    navigator = ShutIn()
    explorer = Explorer(ROBOT, navigator)
    observe(explorer, 20.0)
    assert len(navigator.goals) == 4
    assert len(explorer.given_up) == 3
    navigator.status = NavigationStatus.DRIVING
    observe(explorer, 1.0, 1.0, begin=20.0)
    assert explorer.given_up == ()


def test_an_explorer_does_not_wait_where_its_targets_are_shut_in(monkeypatch):
    frontiers = [frontier(5.0 * k, 10.0, gain=20.0 - k) for k in range(8)]
    monkeypatch.setattr("trundle.navigation.exploration.explorer.find_frontiers", lambda *_, **__: frontiers)
    navigator = ShutIn()
    explorer = Explorer(ROBOT, navigator)
    set_goal = navigator.set_goal

    def refuse_goal(x, y):
        set_goal(x, y)
        navigator.error = NoPathError("the footprint gets to the goal from nowhere", pose=(x, y, 0.0))

    navigator.set_goal = refuse_goal
    observe(explorer, 16.0)
    assert len(navigator.goals) >= 8


def test_an_explorer_that_is_shut_in_for_good_ends(monkeypatch):
    frontiers = [frontier(5.0 * k, 10.0, gain=20.0 - k) for k in range(8)]
    monkeypatch.setattr("trundle.navigation.exploration.explorer.find_frontiers", lambda *_, **__: frontiers)
    explorer = Explorer(ROBOT, ShutIn())
    explorer.navigator.cancel = lambda: None
    observe(explorer, 120.0)
    assert explorer.status is NavigationStatus.FINISHED
    assert len(explorer.given_up) == 8


def test_a_failed_try_is_taken_back_once():
    targets, near, far = Targets(ExplorerSettings(tries=2)), frontier(), frontier(9.0, distance=9.0)
    targets.refuse(near, "no path")
    assert targets.choose([near, far], None) is far
    targets.forgive([near])
    assert targets.choose([near, far], None) is near
    targets.refuse(near, "no path")
    targets.forgive([near])
    assert targets.choose([near, far], None) is far


def test_what_was_refused_for_good_is_not_taken_back():
    targets, near, far = Targets(ExplorerSettings(tries=2)), frontier(), frontier(9.0, distance=9.0)
    targets.refuse(near, "looked at 4 times, and unknown again", for_good=True)
    targets.forgive([near])
    assert targets.choose([near, far], None) is far
    assert len(targets.given_up([near, far])) == 1
