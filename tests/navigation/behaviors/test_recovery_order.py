"""The order of recovery: which step runs when, what is recorded of it, and how a program interrupts it."""

import numpy as np
import pytest

from trundle.control import create_controller
from trundle.costmap import LETHAL
from trundle.errors import InputError, UnknownNameError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation import NavigationStatus, Navigator, NavigatorSettings
from trundle.navigation.behaviors import BackUp, Behavior, ClearCostmap, Spin, Wait
from trundle.observation import Scan
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
ROOM = OccupancyGrid(np.zeros((160, 240), np.int8), 0.05)
BLOCKED, BEHAVING = NavigationStatus.BLOCKED, NavigationStatus.BEHAVING
DRIVING, ARRIVED = NavigationStatus.DRIVING, NavigationStatus.ARRIVED


class Stubborn:
    """A controller that stands for a while wherever it is."""

    def __init__(self, seconds=1000.0):
        self.left_s = seconds

    def reset(self, *, seed=0): ...

    def set_path(self, path): ...

    def set_speed_limit(self, limit): ...

    def compute_velocity(self, pose, twist, costmap, dt):
        self.left_s -= dt
        return Twist2D() if self.left_s > 0.0 else Twist2D(0.5, 0.0)


def drive(navigator, pose=Pose2D(3.0, 4.0), *, seconds=60.0, watch=lambda navigator, time: None):
    """Drive ideally within the limits until the navigator is done; return the last pose."""
    twist, time = Twist2D(), 0.0
    while time < seconds:
        watch(navigator, time)
        command = navigator.update(pose, twist, time=time)
        if navigator.status not in (DRIVING, BLOCKED, BEHAVING):
            break
        twist = navigator.robot.limits.approach(twist, command, navigator.dt)
        pose, time = twist.integrate(pose, navigator.dt), time + navigator.dt
    return pose


def stuck(recovery, **settings):
    """A navigator whose controller never moves, after it gave up."""
    navigator = Navigator(
        ROOM, CARTER, controller=Stubborn(), settings=NavigatorSettings(recovery=recovery, **settings)
    )
    navigator.set_goal(10.0, 4.0)
    drive(navigator)
    assert navigator.status is NavigationStatus.STUCK
    return navigator


def names(navigator):
    return [ran.behavior for ran in navigator.behavior_runs]


def test_a_robot_drives_clear_only_of_what_it_nearly_touches():
    cells = np.zeros((160, 240), np.int8)
    steps = NavigatorSettings(recovery=("drive_clear", "replan"))
    assert NavigatorSettings().recovery[-1].name == "drive_clear"
    for gap, expected in ((0.02, "drive_clear"), (0.3, "replan")):
        front_m = 3.0 + CARTER.outline[:, 0].max()
        cells[60:90, 64:66] = 100  # from x = 3.2 m
        navigator = Navigator(OccupancyGrid(cells, 0.05), CARTER, controller=Stubborn(), settings=steps)
        navigator.set_goal(10.0, 4.0)
        drive(navigator, Pose2D(3.0 + 3.2 - gap - front_m, 4.0), seconds=6.0)
        assert names(navigator)[0] == expected


def test_the_default_replans_and_backs_up_in_turn():
    navigator = stuck(NavigatorSettings().recovery)
    assert names(navigator) == ["replan", "back_up"] * 3
    assert navigator.replans == 6
    for ran in navigator.behavior_runs:
        assert (ran.recovery, ran.result, ran.reason) == (True, "succeeded", "no progress")
    ends = [ran.end_s for ran in navigator.behavior_runs]
    assert ends == sorted(ends)


def test_the_reason_of_a_controller_that_says_one_is_recorded():
    controller = Stubborn()
    controller.reason = "no free sample"
    navigator = Navigator(ROOM, CARTER, controller=controller)
    navigator.set_goal(10.0, 4.0)
    drive(navigator, seconds=3.0)
    assert {ran.reason for ran in navigator.behavior_runs} == {"no free sample"}


def test_the_order_and_the_number_of_tries_are_settings():
    navigator = stuck("wait=0.5,spin=1.57,back_up=0.1", recovery_retries=4)
    assert names(navigator) == ["wait", "spin", "back_up", "wait"]
    assert navigator.replans == 4


def test_without_steps_it_gives_up_at_once():
    assert names(stuck(())) == []
    assert names(stuck("replan", recovery_retries=0)) == []


def walled_in(recovery, gap, **settings):
    """A navigator whose controller never moves, after it gave up, with so much room [m] behind the robot."""
    settings = NavigatorSettings(recovery=recovery, **settings)
    navigator = Navigator(ROOM, CARTER, controller=Stubborn(), settings=settings)
    navigator.static_costmap = navigator.static_costmap.update(slice(60, 100), slice(50, 51), 100)
    navigator.set_goal(10.0, 4.0)
    pose = Pose2D(2.55 - CARTER.outline[:, 0].min() + gap, 4.0)
    return navigator, pose.distance_to(drive(navigator, pose))


def test_where_a_step_fails_the_one_after_it_runs_at_once():
    navigator, _ = walled_in("back_up,spin=1.57", 0.1, recovery_retries=2)
    first, second, *_ = navigator.behavior_runs
    assert (first.behavior, first.result) == ("back_up", "failed")
    assert "blocked at (" in first.message
    assert second.behavior == "spin"
    assert second.begin_s - first.end_s < 0.06


def test_a_step_whose_first_5_cm_collide_is_left_out():
    navigator, _ = walled_in("back_up,replan", 0.055)
    assert set(names(navigator)) == {"replan"}
    # With less room beside its tail than the turn takes, a spin is none of the steps either.
    navigator, moved = walled_in("spin=1.57,wait=0.1", 0.004)
    assert set(names(navigator)) == {"wait"}
    assert moved == 0.0


def test_where_no_step_can_begin_the_robot_stays_where_it_is():
    navigator, moved = walled_in("back_up", 0.055, recovery_retries=2)
    assert navigator.status is NavigationStatus.STUCK
    assert {ran.result for ran in navigator.behavior_runs} == {"failed"}
    assert moved == 0.0


class Pausing(Stubborn):
    """Follows its path, and stands for a second at each place."""

    def __init__(self, places):
        super().__init__(0.0)
        self.places, self.inner = list(places), create_controller("regulated_pure_pursuit", CARTER)

    def set_path(self, path):
        self.inner.set_path(path)

    def compute_velocity(self, pose, twist, costmap, dt):
        if self.places and pose.x > self.places[0]:
            self.places.pop(0)
            self.left_s = 1.0
        self.left_s -= dt
        return Twist2D() if self.left_s > 0.0 else self.inner.compute_velocity(pose, twist, costmap, dt)


def test_progress_begins_the_order_again():
    settings = NavigatorSettings(recovery="wait=0.1,wait=0.3,back_up=0.1")
    navigator = Navigator(ROOM, CARTER, controller=Pausing([4.0, 6.0, 8.0]), settings=settings)
    navigator.set_goal(11.0, 4.0)
    drive(navigator)
    assert navigator.status is ARRIVED
    waits = [ran.end_s - ran.begin_s for ran in navigator.behavior_runs]
    assert len(waits) >= 3
    assert max(waits) < 0.2  # the first step each time


def test_objects_are_taken_as_steps_and_a_users_own_class():
    class Nod(Behavior):
        def start(self, context):
            self.left = 4

        def update(self, context):
            self.left -= 1
            return Twist2D(0.0, 0.2) if self.left else None

    navigator = Navigator(ROOM, CARTER, controller=Stubborn(), recovery=[Nod(), "wait"])
    navigator.set_goal(10.0, 4.0)
    drive(navigator)
    assert names(navigator)[:2] == ["nod", "wait"]


def test_another_planner_is_a_step():
    navigator = stuck([{"replan_with": {"planner": "hybrid_astar"}}], recovery_retries=1)
    assert navigator.path.planner == "hybrid_astar"


def test_an_asked_behavior_interrupts_the_drive_and_then_it_drives_on():
    navigator = Navigator(ROOM, CARTER)
    navigator.set_goal(10.0, 4.0)
    seen = []

    def watch(navigator, time):
        if abs(time - 2.0) < 1e-6:
            navigator.run(Spin(3.0))
        seen.append(navigator.status)

    drive(navigator, watch=watch)
    assert navigator.status is ARRIVED
    assert BEHAVING in seen
    assert [(ran.behavior, ran.reason, ran.result) for ran in navigator.behavior_runs] == [
        ("spin", "asked for", "succeeded")
    ]


@pytest.mark.parametrize(
    ("interrupt", "status", "message"),
    [
        (lambda navigator: navigator.set_goal(8.0, 4.0), DRIVING, "there is another goal"),
        (lambda navigator: navigator.cancel(), NavigationStatus.IDLE, "cancelled"),
        (lambda navigator: navigator.run(Wait(1.0)), BEHAVING, "wait was asked for"),
    ],
)
def test_a_behavior_is_interrupted(interrupt, status, message):
    navigator = Navigator(ROOM, CARTER)
    navigator.run(BackUp(1.0))
    pose, twist = Pose2D(3.0, 4.0), Twist2D()
    for _ in range(20):
        twist = CARTER.limits.approach(twist, navigator.update(pose, twist), navigator.dt)
        pose = twist.integrate(pose, navigator.dt)
    assert navigator.behavior_runs[-1].result == "running"
    interrupt(navigator)
    assert navigator.status is status
    assert (navigator.behavior_runs[0].result, navigator.behavior_runs[0].message) == ("interrupted", message)
    assert navigator.update(pose, twist).v >= 0.0


def test_recovery_is_interrupted_too():
    settings = NavigatorSettings(recovery="back_up=1.0")
    navigator = Navigator(ROOM, CARTER, controller=Stubborn(), settings=settings)
    navigator.set_goal(10.0, 4.0)

    def watch(navigator, time):
        if navigator.behavior_runs and navigator.status is BLOCKED:
            navigator.cancel()

    drive(navigator, watch=watch)
    assert navigator.status is NavigationStatus.IDLE
    assert navigator.behavior_runs[0].result == "interrupted"
    assert navigator.goal is None


def test_a_reset_forgets_what_ran():
    navigator = stuck("replan", recovery_retries=1)
    navigator.reset()
    assert navigator.behavior_runs == ()


def scan_of(time, ranges):
    lidar = CARTER.lidars["front"]
    angles = np.linspace(-np.pi, np.pi, len(ranges), endpoint=False)
    return Scan("front", time, Pose2D(lidar.x, lidar.y, lidar.yaw), lidar.z, angles, ranges, 0.05, 30.0)


def test_clearing_the_costmap_forgets_what_was_seen_and_waits_for_scans():
    navigator = Navigator(ROOM, CARTER)
    here, wall, nothing = Pose2D(3.0, 4.0), np.full(360, np.nan), np.full(360, np.nan)
    wall[170:190] = 2.0
    time = 0.0
    for ranges in [wall] * 10 + [nothing] * 10:
        navigator.update(here, Twist2D(), time=time, scans=[scan_of(time, ranges)])
        time += 0.05
    assert (navigator.costmap.data == LETHAL).any()
    navigator.run(ClearCostmap())
    navigator.update(here, Twist2D(), time=time)
    assert not (navigator.costmap.data == LETHAL).any()
    navigator.update(here, Twist2D(), time=time + 0.05)
    assert navigator.status is BEHAVING  # no scan yet
    for k in range(2, 4):
        navigator.update(here, Twist2D(), time=time + 0.05 * k, scans=[scan_of(time + 0.05 * k, nothing)])
    assert navigator.status is NavigationStatus.FINISHED
    assert not (navigator.costmap.data == LETHAL).any()


def test_clearing_without_new_scans_fails():
    navigator = Navigator(ROOM, CARTER)
    for k in range(3):
        navigator.update((3.0, 4.0, 0.0), Twist2D(), time=0.05 * k, scans=[scan_of(0.05 * k, np.full(360, 2.0))])
    navigator.run(ClearCostmap())
    for k in range(3, 60):
        navigator.update((3.0, 4.0, 0.0), Twist2D(), time=0.05 * k)
    assert navigator.status is NavigationStatus.STUCK
    assert "no scans came in" in navigator.message


def test_bad_steps_are_refused():
    with pytest.raises(UnknownNameError):
        Navigator(ROOM, CARTER, recovery=["bak_up"])
    with pytest.raises(UnknownNameError):
        Navigator(ROOM, CARTER, settings=NavigatorSettings(recovery="bak_up"))
    with pytest.raises(InputError):
        Navigator(ROOM, CARTER, recovery=[3])
    for bad in ({"recovery": 3}, {"recovery": "back_up=1,spinn=2"}, {"recovery": "replan=3"}, {"recovery_retries": -1}):
        with pytest.raises(InputError):
            NavigatorSettings(**bad)


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_behaviors_run_in_a_loop_of_ones_own(backend):
    grid = ROOM
    navigator = Navigator(grid, CARTER)
    with simulate(World.from_map(grid), CARTER, backend=backend) as sim:
        state = sim.reset(Pose2D(6.0, 4.0, 0.0))
        for behavior in (Spin(1.57), BackUp(0.5)):
            navigator.run(behavior)
            while navigator.status is not NavigationStatus.FINISHED:
                state = sim.step(navigator.update(state.pose, state.twist, time=state.time), navigator.dt)
                assert state.time < 30.0
        for _ in range(20):
            state = sim.step(Twist2D(), navigator.dt)
    assert state.pose.distance_to(Pose2D(6.0, 3.5)) < 0.05
    assert abs(state.pose.yaw - 1.57) < 0.06
