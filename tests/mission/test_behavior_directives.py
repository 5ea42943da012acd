"""Behaviors, the costmap and the pose of a steered run, and the record of a run with all of them."""

import numpy as np
import pytest

from support.sessions import Watch, drive, drive_until
from trundle.costmap import LETHAL
from trundle.geometry import Pose2D
from trundle.mission import (
    Cancel,
    ClearObstacles,
    DropBox,
    FollowPath,
    Outcome,
    RunBehavior,
    Scenario,
    Session,
    SetGoal,
    SetGoals,
    SetPose,
    Trajectory,
)
from trundle.navigation import NavigationStatus, Navigator
from trundle.record.run_folder import RunFolder
from trundle.sim import simulate

GOAL, OTHER = (3.0, 4.5), (1.5, 4.5)


# Behaviors ------------------------------------------------------------------------------------------------------------


def test_a_behavior_runs_on_its_own(session, steering, watch):
    steering.put(RunBehavior("spin", {"angle": 1.57}), watcher=watch)
    drive_until(session, lambda: watch.ended)
    assert watch.results == ["succeeded"]
    assert session.state.pose.yaw == pytest.approx(1.57, abs=0.1)
    steering.put(RunBehavior("back_up", {"distance": 5.0, "allowance": 1.0}), watcher=(late := Watch()))
    drive_until(session, lambda: late.ended)
    assert (late.results, late.ended[0].message) == (["failed"], "it took longer than 1.0 s")


def test_a_behavior_runs_on_the_way_to_a_goal_and_can_be_cancelled_alone(session, steering, watch):
    steering.put(SetGoal(OTHER), watcher=watch)
    drive(session, 10)
    steering.put(RunBehavior("wait", {"seconds": 30.0}), watcher=(waits := Watch()))
    assert drive(session, 20)[-1].status is NavigationStatus.BEHAVING
    steering.put(RunBehavior("wait", {"seconds": 40.0}), watcher=(longer := Watch()))
    drive(session, 5)
    assert waits.results == ["replaced"]
    steering.put(Cancel("behavior"))
    drive(session, 5)
    assert (longer.results, watch.ended) == (["cancelled"], [])
    drive_until(session, lambda: watch.ended)
    assert watch.results == ["succeeded"]


def test_cancelling_a_behavior_without_a_goal_leaves_the_robot_standing(session, steering, watch):
    steering.put(RunBehavior("spin", {"angle": 6.0}), watcher=watch)
    drive(session, 20)
    steering.put(Cancel("behavior"))
    assert drive(session, 20)[-1].status is NavigationStatus.IDLE
    assert watch.results == ["cancelled"]
    assert session.state.twist.w == pytest.approx(0.0, abs=1e-3)


def test_a_behavior_that_the_collision_monitor_stops_fails(world, room, carter, start, steering, watch):
    with simulate(world, carter, backend="kinematic", lidar=True) as sim:
        session = Session(sim, Navigator(room, carter), start, None, steering=steering)
        steering.put(RunBehavior("drive_on_heading", {"distance": 5.0, "speed": 0.2}), watcher=watch)
        drive_until(session, lambda: watch.ended)
    assert watch.results == ["failed"]
    assert "by the collision monitor: it would touch something" in watch.ended[0].message
    assert session.state.contacts == ()
    assert session.time < 20.0


def test_a_goal_replaces_a_behavior(session, steering, watch):
    steering.put(RunBehavior("wait", {"seconds": 30.0}), watcher=watch)
    drive(session, 5)
    steering.put(SetGoal(OTHER))
    drive(session, 5)
    assert watch.results == ["replaced"]


# The costmap and the pose ---------------------------------------------------------------------------------------------


def found(costmap):
    """Whether the boxes at (1.5, 2.6) and (2.5, 5) are in the costmap."""
    x, y = costmap.cell_to_world(*np.nonzero(costmap.data == LETHAL))
    return [bool((np.hypot(x - at[0], y - at[1]) < 0.3).any()) for at in ((1.5, 2.6), (2.5, 5.0))]


@pytest.mark.parametrize(
    ("region", "near", "far"), [("all", False, False), ("around", False, True), ("except", True, False)]
)
def test_obstacles_are_forgotten_in_a_region(world, room, carter, start, steering, region, near, far):
    with simulate(world, carter, backend="kinematic", lidar=True) as sim:
        navigator = Navigator(room, carter)
        session = Session(sim, navigator, start, None, steering=steering)
        steering.put(DropBox(1.5, 2.6, 0.0, (0.3, 0.3, 0.6)))
        steering.put(DropBox(2.5, 5.0, 0.0, (0.3, 0.3, 0.6)))
        drive(session, 20)
        assert found(navigator.costmap) == [True, True]
        steering.put(ClearObstacles(region, 0.0 if region == "all" else 3.0))
        session.steer()
        assert found(navigator.costmap) == [near, far]
        drive(session, 20)
        assert found(navigator.costmap) == [True, True]


def test_the_pose_of_a_localizer_is_set(kinematic_sim, navigator, start, steering):
    session = Session(kinematic_sim, navigator, start, None, steering=steering, localizer="odometry")
    drive(session, 3)
    steering.put(SetPose((1.0, 2.0, 0.5)))
    session.steer()
    assert session.estimate.pose == Pose2D(1.0, 2.0, 0.5)
    assert session.step().estimate.pose.distance_to(Pose2D(1.0, 2.0)) < 1e-9


def test_the_true_pose_cannot_be_set(session, steering):
    said = []
    steering.put(SetPose((1.0, 2.0, 0.5)), refused=said.append)
    drive(session, 1)
    assert said == ["the robot knows its true pose: there is no localizer whose pose could be set"]


# Records --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_a_run_with_all_of_these_is_repeated_bit_for_bit(backend, room, steering, tmp_path, watch):
    room.save(tmp_path / "room.yaml")
    scenario = Scenario.make(
        map=str(tmp_path / "room.yaml"),
        start=(1.5, 1.5, 0.0),
        goal=GOAL,
        backend=backend,
        lidar=True,
        localizer="odometry",
        seed=3,
    )
    with scenario.build() as mission, RunFolder(tmp_path / "one", scenario=scenario, video=False) as folder:
        session = mission.session(steering=steering, observers=[folder])
        drive(session, 10)
        steering.put(SetGoals([(1.5, 2.5), (1.5, 4.0)]))
        drive(session, 30)
        steering.put(Cancel())
        steering.put(RunBehavior("spin", {"angle": "30deg"}))
        drive(session, 20)
        steering.put(Cancel("behavior"))
        steering.put(SetPose(session.estimate.pose))
        here = session.estimate.pose
        steering.put(FollowPath([here.as_tuple(), (here.x, here.y + 0.5, 1.57)]), watcher=watch)
        steering.put(ClearObstacles("around", 2.0))
        drive(session, 20)
        steering.put(ClearObstacles())
        steering.put(SetGoal(GOAL), by="ann")
        first = session.run()
    assert first.outcome in (Outcome.ARRIVED, Outcome.ARRIVED_BY_ESTIMATE)
    assert watch.results == ["replaced"]
    assert [given.refused for given in first.directives] == [""] * 9
    again = Scenario.load(tmp_path / "one")
    with again.build() as mission:
        second = mission.run()
    for name in Trajectory.columns():
        np.testing.assert_array_equal(getattr(first.trajectory, name), getattr(second.trajectory, name), err_msg=name)
    assert second.directives == first.directives
    assert second.message == first.message
