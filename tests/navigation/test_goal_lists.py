"""Several goals: stops with tasks, and poses that the robot drives through without stopping."""

import math
import pickle

import numpy as np
import pytest

from support.walled_rooms import walled_room
from trundle.control import create_controller
from trundle.errors import BlockedPoseError, InputError, PlanningError
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.navigation import Choice, NavigationStatus, Navigator, NavigatorSettings, Waypoint
from trundle.navigation.behaviors import DriveOnHeading, Spin, Wait
from trundle.planning import PathCheck
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
ARRIVED, BEHAVING = NavigationStatus.ARRIVED, NavigationStatus.BEHAVING
START = Pose2D(1.5, 4.0, 0.0)
BENT = [(4.0, 4.6), (6.5, 3.8), (9.0, 4.6), (10.8, 4.0)]
CORNERS = [(6.0, 4.0), (6.0, 6.5), (10.0, 6.5)]


class Drive:
    """An ideal drive from START, with what was seen on the way."""

    def __init__(self, navigator, *, seconds=120.0, watch=lambda navigator, pose, time: None):
        pose, twist, time = START, Twist2D(), 0.0
        self.poses, self.speeds, self.statuses, self.reached = [pose], [0.0], [], []
        while time < seconds:
            watch(navigator, pose, time)
            command = navigator.update(pose, twist, time=time)
            self.statuses.append(navigator.status)
            self.reached.append(navigator.goals_reached)
            if navigator.status in (ARRIVED, NavigationStatus.STUCK, NavigationStatus.NO_PATH):
                break
            for _ in range(5):
                twist = CARTER.limits.approach(twist, command, navigator.dt / 5)
                pose = twist.integrate(pose, navigator.dt / 5)
            time += navigator.dt
            self.poses.append(pose)
            self.speeds.append(twist.v)
        self.time, self.pose = time, pose

    def speed_at(self, x, y):
        """The speed where it comes closest to a point, and how close that is [m]."""
        distances = [math.hypot(pose.x - x, pose.y - y) for pose in self.poses]
        nearest = int(np.argmin(distances))
        return self.speeds[nearest], distances[nearest]


@pytest.mark.parametrize("planner", ["auto", "least_cost", "any_angle", "astar", "hybrid_astar"])
def test_it_drives_through_poses_without_stopping(planner):
    navigator = Navigator(walled_room(), CARTER, planner=planner)
    navigator.set_goals(BENT, through=True)
    drive = Drive(navigator)
    assert navigator.status is ARRIVED
    assert drive.pose.distance_to(Pose2D(*BENT[-1])) <= 0.25
    for x, y in BENT[:-1]:
        speed, distance = drive.speed_at(x, y)
        assert speed > 0.5
        assert distance <= navigator.settings.through_tolerance
    assert drive.reached == sorted(drive.reached)
    assert set(drive.reached) == {0, 1, 2, 3, 4}
    assert navigator.replans == 0


def test_corners_at_poses_are_rounded_where_there_is_room():
    navigator = Navigator(walled_room(), CARTER, planner="least_cost")
    navigator.set_goals(CORNERS, through=True)
    drive = Drive(navigator)
    assert navigator.status is ARRIVED
    for x, y in CORNERS[:-1]:
        speed, distance = drive.speed_at(x, y)
        assert speed > 0.2
        assert distance <= 0.5
    stopped = Navigator(walled_room(), CARTER, planner="least_cost")
    stopped.set_goals(CORNERS)
    assert Drive(stopped).time > drive.time + 3.0


def test_the_whole_path_is_free_where_corners_are_tight():
    grid = walled_room((6.9, 0.0, 9.0, 5.5), (0.0, 5.1, 5.1, 8.0))
    navigator = Navigator(grid, CARTER, planner="least_cost")
    navigator.set_goals([(6.0, 4.2), (6.0, 6.6), (10.0, 6.6)], through=True)
    path = navigator.plan(START)
    assert PathCheck(path).first_hit(navigator.costmap) is None
    drive = Drive(navigator)
    assert navigator.status is ARRIVED
    assert not navigator.costmap.footprint_collides(np.array([pose.as_tuple() for pose in drive.poses])).any()


def test_without_through_it_stops_at_each():
    navigator = Navigator(walled_room(), CARTER)
    navigator.set_goals(BENT)
    drive = Drive(navigator)
    assert navigator.status is ARRIVED
    for x, y in BENT[:-1]:
        near = [
            speed
            for pose, speed in zip(drive.poses, drive.speeds, strict=True)
            if math.hypot(pose.x - x, pose.y - y) <= 0.25
        ]
        assert min(near) <= 0.02


def test_one_that_is_bent_back_by_its_yaw_is_passed_with_it():
    navigator = Navigator(walled_room(), CARTER, planner="hybrid_astar")
    navigator.set_goals([(6.0, 4.0, 1.57), (10.0, 6.0)], through=True)
    drive = Drive(navigator)
    assert navigator.status is ARRIVED
    nearest = min(drive.poses, key=lambda pose: pose.distance_to(Pose2D(6.0, 4.0)))
    assert abs(nearest.yaw - 1.57) < 0.8


def test_a_replan_keeps_the_poses_that_are_left():
    navigator = Navigator(walled_room(), CARTER)
    navigator.set_goals(BENT, through=True)

    def watch(navigator, pose, time):
        if pose.x > 5.0 and navigator.replans == 0:
            (row, row_end), (col, col_end) = navigator.costmap.world_to_cell(np.array([7.4, 7.8]), np.array([3.7, 4.7]))
            navigator.static_costmap = navigator.static_costmap.update(
                slice(int(row), int(row_end)), slice(int(col), int(col_end)), 100
            )

    drive = Drive(navigator, watch=watch)
    assert navigator.status is ARRIVED
    assert navigator.replans >= 1
    for x, y in BENT[1:-1]:
        assert drive.speed_at(x, y)[1] <= 0.5


class Astray:
    """A controller that cuts the second corner, then follows its path."""

    def __init__(self):
        self.inner = create_controller("regulated_pure_pursuit", CARTER)

    def reset(self, *, seed=0): ...

    def set_path(self, path):
        self.inner.set_path(path)

    def set_speed_limit(self, limit): ...

    def compute_velocity(self, pose, twist, costmap, dt):
        if pose.x < 7.0 and pose.y < 4.3:
            return Twist2D(0.6, 0.0)
        return self.inner.compute_velocity(pose, twist, costmap, dt)


def test_a_pose_that_was_missed_is_driven_to_again():
    navigator = Navigator(walled_room(), CARTER, controller=Astray())
    navigator.set_goals([(5.0, 5.2), (10.0, 5.2)], through=True)
    drive = Drive(navigator)
    assert navigator.status is ARRIVED
    assert drive.speed_at(5.0, 5.2)[1] <= 0.5


@pytest.mark.parametrize("through", [False, True])
def test_the_goal_that_cannot_be_reached_is_named(through):
    navigator = Navigator(walled_room((8.0, 3.0, 10.0, 5.0)), CARTER)
    navigator.set_goals([(4.0, 4.0), (9.0, 4.0), (10.8, 6.0)], through=through)
    if through:
        with pytest.raises(BlockedPoseError, match=r"goal 2: .*\(9"):
            navigator.plan(START)
    drive = Drive(navigator)
    assert navigator.status is NavigationStatus.NO_PATH
    assert isinstance(navigator.error, PlanningError)
    assert drive.reached[-1] == (0 if through else 1)


def test_tasks_run_in_order_and_then_it_drives_on():
    navigator = Navigator(walled_room(), CARTER)
    navigator.set_goals(
        [
            Waypoint(4.0, 4.0, tasks=[Wait(1.0), Spin(1.57)]),
            (6.0, 4.0),
            Waypoint(8.0, 4.0, 0.0, tasks=[Spin(heading=3.0)]),
        ],
        through=True,
    )
    drive = Drive(navigator)
    assert navigator.status is ARRIVED
    assert [(ran.behavior, ran.reason, ran.result) for ran in navigator.behavior_runs] == [
        ("wait", "task of goal 1", "succeeded"),
        ("spin", "task of goal 1", "succeeded"),
        ("spin", "task of goal 3", "succeeded"),
    ]
    assert abs(drive.pose.yaw - 3.0) < 0.06
    assert drive.speed_at(6.0, 4.0)[0] > 0.5
    assert drive.reached[-1] == 3


def test_a_task_that_fails_ends_the_drive_and_says_which():
    navigator = Navigator(walled_room((6.0, 3.0, 6.5, 5.0)), CARTER)
    navigator.set_goals([Waypoint(4.5, 4.0, 0.0, tasks=[DriveOnHeading(3.0, speed=0.5)]), (10.0, 4.0)])
    Drive(navigator)
    assert navigator.status is NavigationStatus.STUCK
    assert navigator.message.startswith("drive_on_heading (task of goal 1) failed: blocked at (")
    assert navigator.goals_reached == 1


def test_another_goal_forgets_the_list():
    navigator = Navigator(walled_room(), CARTER)
    navigator.set_goals(BENT, through=True)
    navigator.set_goal(3.0, 4.0)
    assert navigator.goals == (Goal(3.0, 4.0),)
    drive = Drive(navigator)
    assert navigator.status is ARRIVED
    assert drive.pose.x < 3.3


def test_a_waypoint_is_a_goal():
    waypoint = Waypoint(1.0, 2.0, 0.5, tasks=[Wait(1.0)])
    assert waypoint == (1.0, 2.0, 0.5) == Goal(1.0, 2.0, 0.5)
    assert Goal.of(waypoint) is waypoint
    assert repr(waypoint) == "Waypoint(x=1.0, y=2.0, yaw=0.5, tasks=[Wait(1)])"
    assert Waypoint(1.0, 2.0).yaw_free
    assert Waypoint(1.0, 2.0).tasks == ()
    assert pickle.loads(pickle.dumps(waypoint)).tasks[0].seconds == 1.0


@pytest.mark.parametrize(
    "make",
    [
        lambda navigator: navigator.set_goals([]),
        lambda navigator: navigator.set_goals([(1.0, math.nan)]),
        lambda navigator: navigator.set_goals([(1.0,)]),
        lambda navigator: navigator.set_goals(3.0),
        lambda navigator: navigator.set_goals(Pose2D(1.0, 1.0)),
        lambda navigator: Waypoint(1.0, 2.0, tasks=[Wait]),
        lambda navigator: Waypoint(1.0, 2.0, tasks=["wait"]),
        lambda navigator: Waypoint(1.0, math.inf),
        lambda navigator: NavigatorSettings(through_tolerance=0.0),
    ],
)
def test_bad_goals_are_refused(make):
    with pytest.raises(InputError):
        make(Navigator(walled_room(), CARTER))


def test_it_drives_through_poses_in_mujoco():
    grid = walled_room()
    navigator = Navigator(grid, CARTER)
    with simulate(World.from_map(grid), CARTER, backend="mujoco") as sim:
        state = sim.reset(START)
        navigator.set_goals(BENT, through=True)
        slowest = {}
        while navigator.status is not ARRIVED:
            state = sim.step(navigator.update(state.pose, state.twist, time=state.time), navigator.dt)
            assert state.time < 60.0
            for x, y in BENT[:-1]:
                if math.hypot(state.pose.x - x, state.pose.y - y) < 0.4:
                    slowest[x, y] = min(slowest.get((x, y), math.inf), state.twist.v)
    assert len(slowest) == 3
    assert min(slowest.values()) > 0.4


@pytest.mark.parametrize("seed", [0, 2, 3, 5])
def test_mppi_drives_through_random_poses_without_a_contact(seed):
    """Whatever the poses: each is passed in order within the tolerance, and the footprint touches nothing."""
    rng = np.random.default_rng(seed)
    grid = walled_room(*((x, y, x + 0.5, y + 0.5) for x, y in rng.uniform((3.0, 1.0), (10.0, 6.5), (4, 2))))
    navigator = Navigator(grid, CARTER, controller=Choice(name="mppi", options={"samples": 512}))
    free = navigator.costmap
    goals: list[tuple[float, float]] = []
    while len(goals) < 4:
        x, y = rng.uniform((1.0, 1.0), (11.0, 7.0))
        far = math.dist((x, y), goals[-1] if goals else (START.x, START.y)) > 2.0
        if far and free.clearance(np.array([(x, y, yaw) for yaw in np.arange(16) * math.pi / 8.0])).min() > 0.15:
            goals.append((float(x), float(y)))
    assert not free.footprint_collides(START.as_tuple())[0]
    navigator.set_goals(goals, through=True)
    drive = Drive(navigator)
    assert navigator.status is ARRIVED
    assert not free.footprint_collides(np.array([pose.as_tuple() for pose in drive.poses])).any()
    passed = [
        math.dist(drive.poses[drive.reached.index(number)].as_tuple()[:2], goals[number - 1]) for number in (1, 2, 3)
    ]
    assert max(passed) <= navigator.settings.through_tolerance + 1e-9
