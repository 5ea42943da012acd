"""What a navigator does about a map that changes, zones to keep out of, and limits of speed."""

import math

import numpy as np
import pytest

from support.walled_rooms import walled_room
from trundle.control import create_controller
from trundle.costmap import LETHAL, Costmap
from trundle.errors import BlockedPoseError, InputError, MapError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import KeepoutMask, OccupancyGrid, SpeedMask
from trundle.navigation import NavigationStatus, Navigator, NavigatorSettings
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")


def box(costmap, x0, y0, x1, y1, value=100):
    """The costmap with a box [m] of occupancy."""
    (row, row_end), (col, col_end) = costmap.world_to_cell(np.array([x0, x1]), np.array([y0, y1]))
    return costmap.update(slice(int(row), int(row_end)), slice(int(col), int(col_end)), value)


def zone(value, x0, y0, x1, y1, resolution=0.1):
    """A mask of one zone [m]."""
    shape = round((y1 - y0) / resolution), round((x1 - x0) / resolution)
    return OccupancyGrid(np.full(shape, value, dtype=np.int8), resolution, Pose2D(x0, y0))


def drive(navigator, pose, *, seconds=90.0, watch=lambda navigator, pose, twist: None):
    """Drive ideally within the robot's limits until the navigator is done; return poses and speeds."""
    twist, poses, speeds = Twist2D(), [pose], [0.0]
    for _ in range(round(seconds / navigator.dt)):
        watch(navigator, pose, twist)
        command = navigator.update(pose, twist)
        for _ in range(5):
            twist = navigator.robot.limits.approach(twist, command, navigator.dt / 5)
            pose = twist.integrate(pose, navigator.dt / 5)
            poses.append(pose)
            speeds.append(abs(twist.v))
        if navigator.status not in (NavigationStatus.DRIVING, NavigationStatus.BLOCKED):
            break
    return np.array([pose.as_tuple() for pose in poses]), np.array(speeds)


def test_a_path_that_a_changed_map_blocks_is_replanned_at_the_next_update():
    navigator = Navigator(walled_room(), CARTER)
    navigator.set_goal(10.5, 4.0)
    navigator.update((1.5, 4.0, 0.0), Twist2D())
    straight = navigator.path
    navigator.static_costmap = box(navigator.static_costmap, 6.0, 3.0, 6.5, 5.0)
    navigator.update((1.5, 4.0, 0.0), Twist2D())
    assert navigator.path is not straight
    assert navigator.replans == 1
    poses, _ = drive(navigator, Pose2D(1.5, 4.0, 0.0))
    assert navigator.status is NavigationStatus.ARRIVED
    assert not navigator.costmap.footprint_collides(poses).any()


def test_a_change_beside_the_path_or_behind_the_robot_plans_nothing():
    navigator = Navigator(walled_room(), CARTER)
    navigator.set_goal(10.5, 4.0)
    navigator.update((1.5, 4.0, 0.0), Twist2D())
    path = navigator.path
    for x in np.arange(1.5, 6.0, 0.05):
        navigator.update((float(x), 4.0, 0.0), Twist2D(1.0, 0.0))
    navigator.static_costmap = box(navigator.static_costmap, 6.0, 6.0, 6.5, 7.0)
    navigator.update((6.0, 4.0, 0.0), Twist2D(1.0, 0.0))
    navigator.static_costmap = box(navigator.static_costmap, 2.0, 3.5, 2.5, 4.5)
    navigator.update((6.05, 4.0, 0.0), Twist2D(1.0, 0.0))
    assert navigator.path is path
    assert navigator.replans == 0


def test_where_no_other_path_is_left_it_stops_in_front_and_goes_on_when_it_is_freed():
    navigator = Navigator(walled_room(), CARTER)
    navigator.set_goal(10.5, 4.0)
    free = navigator.costmap
    closed = box(free, 7.0, 0.0, 7.5, 8.0)
    farthest = 0.0

    def watch(navigator, pose, twist):
        nonlocal farthest
        if pose.x > 3.0 and farthest == 0.0:
            navigator.static_costmap = closed
        if navigator.costmap is closed:
            farthest = max(farthest, pose.x)
            if farthest > 6.0 and abs(twist.v) < 1e-6:
                navigator.static_costmap = free

    drive(navigator, Pose2D(1.5, 4.0, 0.0), watch=watch)
    assert navigator.status is NavigationStatus.ARRIVED
    assert 6.0 < farthest < 7.0 - CARTER.outline[:, 0].max()
    assert navigator.replans >= 1


def flips(margin):
    """How often the robot switches between two paths round a block whose costs differ only by noise."""
    grid = walled_room()
    navigator = Navigator(grid, CARTER, settings=NavigatorSettings(replan_interval_s=0.5, replan_margin=margin))
    base = box(navigator.costmap, 5.0, 2.6, 7.0, 5.4)
    # A speck near one of the paths, then near the other, that costs a little.
    noisy = [box(base, 5.95, y, 6.05, y + 0.1) for y in (0.9, 7.0)]
    navigator.static_costmap = base
    navigator.set_goal(10.5, 4.0, 0.0)
    sides, paths, count = [], [], 0

    def watch(navigator, pose, twist):
        nonlocal count
        count += 1
        navigator.static_costmap = noisy[count // 10 % 2]
        path = navigator.path
        if path is not None and (not paths or path is not paths[-1]):
            paths.append(path)
            middle = path.poses[np.argmin(np.abs(path.poses[:, 0] - 6.0)), 1]
            if pose.x < 4.0:
                sides.append(middle > 4.0)

    drive(navigator, Pose2D(1.0, 4.0, 0.0), watch=watch)
    if margin > 0.0:
        assert navigator.status is NavigationStatus.ARRIVED
    assert navigator.replans > 3
    return int(np.count_nonzero(np.diff(np.array(sides, dtype=int))))


def test_replanning_does_not_oscillate_between_equal_cost_paths():
    assert flips(0.1) == 0
    assert flips(0.0) > 0  # Without a margin the noise decides: the robot may get stuck.


def test_a_path_that_becomes_much_cheaper_is_taken():
    navigator = Navigator(walled_room(), CARTER, settings=NavigatorSettings(replan_interval_s=0.5))
    free = navigator.costmap
    navigator.static_costmap = box(free, 5.0, 0.0, 5.5, 6.0)
    navigator.set_goal(10.5, 1.5, 0.0)
    navigator.update((1.5, 1.5, 0.0), Twist2D())
    detour = navigator.path
    assert detour is not None
    navigator.static_costmap = free
    for _ in range(11):
        navigator.update((1.5, 1.5, 0.0), Twist2D())
    assert navigator.path is not None
    assert navigator.path.length < 0.9 * detour.length


@pytest.mark.parametrize("options", [{"replan_interval_s": 0.0}, {"replan_margin": 1.0}, {"replan_margin": -0.1}])
def test_options_of_replanning_out_of_range_are_refused(options):
    with pytest.raises(InputError, match=next(iter(options))):
        NavigatorSettings(**options)


def test_it_drives_around_a_zone_to_keep_out_of():
    keepout = KeepoutMask(zone(100, 5.0, 2.0, 7.03, 6.01))
    navigator = Navigator(walled_room(), CARTER, keepout=keepout)
    navigator.set_goal(10.5, 4.0, 0.0)
    poses, _ = drive(navigator, Pose2D(1.5, 4.0, 0.0))
    assert navigator.status is NavigationStatus.ARRIVED
    zone_alone = Costmap.from_grid(
        OccupancyGrid(np.zeros((160, 240), dtype=np.int8), 0.05), CARTER, 0.0, keepout=keepout
    )
    assert (zone_alone.data == LETHAL).any()
    assert not zone_alone.footprint_collides(poses).any()


def test_a_goal_in_a_zone_to_keep_out_of_is_named_as_such():
    navigator = Navigator(walled_room(), CARTER, keepout=KeepoutMask(zone(100, 5.0, 2.0, 7.0, 6.0)))
    navigator.set_goal(6.0, 4.0)
    with pytest.raises(BlockedPoseError, match="the keep-out mask keeps the robot out"):
        navigator.plan((1.5, 4.0, 0.0))


def test_a_keepout_mask_for_a_finished_costmap_is_refused():
    with pytest.raises(InputError, match="from_grid"):
        Navigator(Costmap.from_grid(walled_room(), CARTER), CARTER, keepout=KeepoutMask(walled_room()))


@pytest.mark.parametrize("controller", ["regulated_pure_pursuit", "lookahead"])
@pytest.mark.parametrize(
    ("mask", "limit"),
    [
        (SpeedMask(zone(30, 5.0, 0.0, 8.0, 8.0)), 0.3 * CARTER.limits.linear_speed),
        (SpeedMask(zone(20, 5.0, 0.0, 8.0, 8.0), "absolute", multiplier=0.01), 0.2),
    ],
)
def test_it_never_exceeds_the_limit_in_a_zone_and_drives_fast_before_and_after(mask, limit, controller):
    navigator = Navigator(walled_room(), CARTER, speed_mask=mask, controller=controller)
    navigator.set_goal(11.0, 4.0)
    poses, speeds = drive(navigator, Pose2D(1.0, 4.0, 0.0))
    assert navigator.status is NavigationStatus.ARRIVED
    inside = (poses[:, 0] >= 5.0) & (poses[:, 0] < 8.0)
    assert inside.sum() > 50
    assert speeds[inside].max() <= limit + 1e-6
    assert np.median(speeds[inside]) > 0.9 * limit
    assert speeds[poses[:, 0] < 5.0].max() > 1.5 * limit
    assert speeds[poses[:, 0] >= 8.0].max() > 1.5 * limit


def test_a_robot_that_brakes_badly_begins_early():
    limits = CARTER.limits.model_copy(update={"linear_acceleration": 0.3})
    robot = CARTER.model_copy(update={"limits": limits})
    # From 0.8 to 0.2 m/s with half of 0.3 m/s² takes 2 m.
    mask = SpeedMask(zone(20, 7.0, 0.0, 9.0, 8.0), "absolute", multiplier=0.01)
    navigator = Navigator(walled_room(), robot, speed_mask=mask)
    navigator.set_goal(11.0, 4.0)
    poses, speeds = drive(navigator, Pose2D(1.0, 4.0, 0.0))
    assert navigator.status is NavigationStatus.ARRIVED
    inside = (poses[:, 0] >= 7.0) & (poses[:, 0] < 9.0)
    assert speeds[inside].max() <= 0.2 + 1e-6
    fast = poses[speeds > 0.78, 0]
    assert len(fast) > 0
    assert 4.3 < fast.max() < 5.2


def test_a_limit_round_a_corner_holds_as_soon_as_the_robot_is_there():
    # The path turns into the zone; there is no zone straight ahead.
    grid = walled_room()
    data = grid.data.copy()
    data[60:, 60:] = 100
    mask = SpeedMask(zone(10, 0.0, 4.0, 3.0, 8.0))
    navigator = Navigator(OccupancyGrid(data, 0.05), CARTER, speed_mask=mask)
    navigator.set_goal(1.5, 6.5)
    poses, speeds = drive(navigator, Pose2D(10.0, 1.5, math.pi))
    assert navigator.status is NavigationStatus.ARRIVED
    inside = poses[:, 1] >= 4.0
    assert inside.any()
    assert speeds[inside].max() <= 0.1 * CARTER.limits.linear_speed + 1e-6


def test_the_limit_is_handed_to_the_controller():
    limits = []

    class Recorder:
        def set_path(self, path):
            pass

        def set_speed_limit(self, limit):
            limits.append(limit)

        def compute_velocity(self, pose, twist, costmap, dt):
            return Twist2D(1.0, 0.5)

    mask = SpeedMask(zone(20, 5.0, 0.0, 8.0, 8.0), "absolute", multiplier=0.01)
    navigator = Navigator(walled_room(), CARTER, speed_mask=mask, controller=Recorder())
    navigator.set_goal(11.0, 4.0)
    command = navigator.update((6.0, 4.0, 0.0), Twist2D())
    assert limits == [pytest.approx(0.2)]
    assert navigator.speed_limit == limits[0]
    # A command that is too fast is slowed on its arc.
    assert (command.v, command.w) == pytest.approx((0.2, 0.1))
    navigator.set_goal(11.0, 4.0)
    navigator.update((9.0, 4.0, 0.0), Twist2D())
    assert limits[-1] == math.inf


def test_regulated_pure_pursuit_keeps_a_limit_until_it_is_lifted():
    navigator = Navigator(walled_room(), CARTER)
    navigator.set_goal(10.5, 4.0)
    path = navigator.plan((1.5, 4.0, 0.0))
    controller = create_controller("regulated_pure_pursuit", CARTER)
    controller.set_path(path)
    controller.set_speed_limit(0.2)
    pose = Pose2D(2.0, 4.0, 0.0)
    fast = Twist2D(0.6, 0.0)
    assert controller.compute_velocity(pose, fast, navigator.costmap, 0.05).v == pytest.approx(0.2)
    controller.set_speed_limit(math.inf)
    assert controller.compute_velocity(pose, fast, navigator.costmap, 0.05).v > 0.5


def test_a_speed_mask_beside_the_map_is_refused():
    with pytest.raises(MapError, match="does not overlap the map"):
        Navigator(walled_room(), CARTER, speed_mask=SpeedMask(zone(50, 20.0, 0.0, 21.0, 1.0)))


def test_masks_are_read_from_their_files(tmp_path):
    zone(100, 5.0, 2.0, 7.0, 6.0).save(tmp_path / "keepout.yaml")
    zone(50, 1.0, 1.0, 3.0, 3.0).save(tmp_path / "speed.yaml", mode="raw")
    navigator = Navigator(walled_room(), CARTER, keepout=tmp_path / "keepout.yaml", speed_mask=tmp_path / "speed.yaml")
    assert navigator.costmap.cost_at(6.0, 4.0) == LETHAL
    assert navigator.speed_mask is not None
    assert navigator.speed_mask.limit_at(2.0, 2.0, 1.0) == 0.5
