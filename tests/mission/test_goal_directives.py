"""Goals and paths of a steered run, and what those who gave them get back."""

import math

import numpy as np
import pytest

from support.sessions import Watch, drive, drive_until
from trundle.errors import BlockedPoseError, InputError, OutsideMapError
from trundle.geometry import Pose2D
from trundle.mission import (
    Cancel,
    ClearObstacles,
    DropBox,
    End,
    FollowPath,
    GivenDirective,
    Pause,
    ReinitializeGlobal,
    RunBehavior,
    Session,
    SetGoal,
    SetGoals,
    SetPose,
    load_directives,
    save_directives,
)
from trundle.navigation import CommandScript, NavigationStatus, Navigator
from trundle.sim import simulate

GOAL, OTHER = (3.0, 4.5), (1.5, 4.5)
CORNER = [(1.5, 1.5, math.pi / 2), (1.5, 4.0, 0.0), (3.0, 4.0, 0.0)]


# Goals ----------------------------------------------------------------------------------------------------------------


def test_who_gives_a_goal_learns_that_it_was_reached(session, steering, watch):
    drive(session, 2)
    steering.put(SetGoal(OTHER), watcher=watch)
    drive_until(session, lambda: watch.ended)
    assert watch.began == [pytest.approx(0.1)]
    assert (watch.results, watch.ended[0].status) == (["succeeded"], NavigationStatus.ARRIVED)
    assert watch.ended[0].time == session.time
    assert session.state.pose.distance_to(Pose2D(*OTHER)) < 0.3


def test_a_second_goal_replaces_the_first(session, steering, watch):
    steering.put(SetGoal(OTHER), watcher=watch)
    drive(session, 20)
    steering.put(SetGoal(GOAL), watcher=(second := Watch()))
    drive_until(session, lambda: second.ended)
    assert (watch.results, second.results) == (["replaced"], ["succeeded"])


def test_a_goal_in_a_wall_is_refused_with_its_error(session, steering, watch):
    steering.put(SetGoal((4.0, 1.0)), watcher=watch)
    drive(session, 1)
    assert (watch.began, watch.ended) == ([], [])
    assert isinstance(watch.refused[0], BlockedPoseError)


def test_a_goal_outside_the_map_is_refused_also_once_something_was_sensed(world, room, carter, start, steering, watch):
    with simulate(world, carter, backend="kinematic", lidar=True) as sim:
        session = Session(sim, Navigator(room, carter), start, None, steering=steering)
        drive(session, 10)
        steering.put(SetGoal((40.0, 1.0)), watcher=watch)
        drive(session, 1)
    assert [type(error) for error in watch.refused] == [OutsideMapError]


def test_a_goal_that_gets_blocked_fails_with_the_reason(kinematic_sim, room, carter, start, steering, watch):
    navigator = Navigator(room, carter, recovery=[])
    session = Session(kinematic_sim, navigator, start, None, steering=steering)
    steering.put(SetGoal((6.5, 1.5)), watcher=watch)
    drive(session, 20)
    blocked = np.full((60, 20), 100, np.int8)
    navigator.static_costmap = navigator.static_costmap.update(slice(60, 120), slice(70, 90), blocked)
    drive_until(session, lambda: watch.ended)
    assert watch.results == ["failed"]
    assert watch.ended[0].status is NavigationStatus.NO_PATH
    assert watch.ended[0].message
    assert session.outcome is None


def test_a_cancelled_goal_is_given_up_and_the_robot_stands(session, steering, watch):
    steering.put(SetGoal(OTHER), watcher=watch)
    drive(session, 40)
    assert abs(session.state.twist.w) + session.state.twist.v > 0.1
    steering.put(Cancel())
    step = drive(session, 30)[-1]
    assert watch.results == ["cancelled"]
    assert (step.status, step.steering.goals, step.path) == (NavigationStatus.IDLE, (), None)
    assert session.state.twist.v == pytest.approx(0.0, abs=1e-3)
    steering.put(Pause())
    session.steer()
    steering.put(Pause(False))
    assert drive(session, 20)[-1].status is NavigationStatus.IDLE
    steering.put(SetGoal(OTHER), watcher=(again := Watch()))
    drive_until(session, lambda: again.ended)
    assert again.results == ["succeeded"]


def test_goals_are_driven_through_without_stopping(session, steering, watch):
    steering.put(SetGoals([(1.5, 3.5), (3.0, 4.5), (6.0, 4.5)]), watcher=watch)
    steps = [session.step()]
    while not watch.ended:
        steps.append(session.step())
    assert watch.results == ["succeeded"]
    speeds = [step.state.twist.v for step in steps if 0 < step.goal < 2]
    assert len(speeds) > 20
    assert min(speeds) > 0.1
    assert steps[-1].steering.goals == ((1.5, 3.5), (3.0, 4.5), (6.0, 4.5))
    steering.put(SetGoals([OTHER, (3.0, 4.5)], through=False), watcher=(stops := Watch()))
    steps = [session.step()]
    while not stops.ended:
        steps.append(session.step())
    assert stops.results == ["succeeded"]
    assert min(step.state.twist.v for step in steps if step.state.pose.distance_to(Pose2D(*OTHER)) < 0.3) < 0.01


def test_refused_goals_leave_those_that_the_run_had(session, steering, watch):
    steering.put(SetGoal(OTHER), watcher=watch)
    drive(session, 10)
    steering.put(SetGoals([GOAL, (4.0, 1.0)]), watcher=(walled := Watch()))
    drive(session, 1)
    assert walled.refused
    assert "goal 2" in str(walled.refused[0])
    drive_until(session, lambda: watch.ended)
    assert watch.results == ["succeeded"]
    assert session.state.pose.distance_to(Pose2D(*OTHER)) < 0.3


def test_tasks_end_with_the_run_and_those_that_wait_are_refused(session, steering, watch):
    steering.put(SetGoal(OTHER), watcher=watch)
    drive(session, 5)
    steering.put(End("enough"))
    steering.put(SetGoal(GOAL), watcher=(late := Watch()))
    assert session.step() is None
    assert (watch.results, watch.ended[0].message) == (["stopped"], "the run has ended: enough")
    steering.refuse_all("the run has ended")
    assert [str(error) for error in late.refused] == ["the run has ended"]


def test_a_run_that_waits_for_goals_has_no_time_limit(session, steering, watch):
    steering.put(SetGoal((1.8, 1.5)), watcher=watch)
    drive_until(session, lambda: watch.ended)
    assert session.step().index > 0
    assert session.finish().time_limit_s == math.inf


# Paths ----------------------------------------------------------------------------------------------------------------


def test_a_path_is_followed_as_it_is(session, steering, watch):
    steering.put(FollowPath(CORNER), watcher=watch)
    steps = [session.step()]
    while not watch.ended:
        steps.append(session.step())
    assert watch.results == ["succeeded"]
    assert {len(step.path) for step in steps} == {3}
    left = [step.distance_remaining for step in steps]
    assert left[1] == pytest.approx(4.0, abs=0.1)
    assert max(np.diff(left)) <= 1e-9
    assert session.state.pose.distance_to(Pose2D(3.0, 4.0)) < 0.3
    assert max(abs(step.state.pose.x - 1.5) for step in steps if step.state.pose.y < 3.0) < 0.15


def test_a_path_is_followed_on_after_a_pause_and_after_a_refused_goal(session, steering, watch):
    steering.put(FollowPath(CORNER), watcher=watch)
    drive(session, 60)
    left = session.step().distance_remaining
    steering.put(Pause())
    session.steer()
    steering.put(Pause(False))
    steering.put(SetGoal((4.0, 1.0)), watcher=(walled := Watch()))
    step = session.step()
    assert walled.refused
    assert step.distance_remaining == pytest.approx(left, abs=0.1)
    drive_until(session, lambda: watch.ended)
    assert watch.results == ["succeeded"]
    assert session.state.pose.distance_to(Pose2D(3.0, 4.0)) < 0.3


def test_a_path_into_a_wall_is_given_up_before_it(session, steering, watch):
    steering.put(FollowPath([(1.5, 1.5, 0.0), (6.0, 1.5, 0.0)]), watcher=watch)
    drive_until(session, lambda: watch.ended)
    assert (watch.results, watch.ended[0].status) == (["failed"], NavigationStatus.STUCK)
    assert session.state.contacts == ()
    assert session.state.pose.x > 2.0


def test_a_path_that_is_elsewhere_is_refused(session, steering, watch):
    steering.put(FollowPath([(6.0, 4.5, 0.0), (6.5, 4.5, 0.0)]), watcher=watch)
    drive(session, 1)
    assert "no pose of the path is within 1.5 m of the robot" in str(watch.refused[0])


@pytest.mark.slow
def test_a_path_waits_for_what_stands_on_it(world, room, carter, start, steering, watch):
    with simulate(world, carter, backend="kinematic", lidar=True) as sim:
        session = Session(sim, Navigator(room, carter), start, None, steering=steering)
        steering.put(FollowPath([(1.5, 1.5, math.pi / 2), (1.5, 5.0, math.pi / 2)]), watcher=watch)
        drive(session, 10)
        steering.put(DropBox(1.5, 4.0, 0.0, (0.6, 0.3, 0.6)))
        steps = drive(session, 200)
        assert watch.ended == []
        assert "obstacle ahead" in steps[-1].message
        assert session.state.contacts == ()
        drive_until(session, lambda: watch.ended)
        assert watch.results == ["failed"]


# Records and refusals -------------------------------------------------------------------------------------------------


def test_these_directives_are_read_as_they_were_written(tmp_path):
    kinds = [SetGoals([(1.0, 2.0), (1, 2, 0.5)], through=False), FollowPath(CORNER), FollowPath(CORNER, [True, False])]
    kinds += [RunBehavior("spin", {"angle": 1.0}), RunBehavior("wait"), Cancel(), Cancel("behavior"), ClearObstacles()]
    kinds += [ClearObstacles("except", 2.0), SetPose((1.0, 2.0, 0.5)), ReinitializeGlobal()]
    kinds += [SetPose((1.0, 2.0, 0.5), np.diag([0.25, 0.25, 0.07]))]
    given = tuple(GivenDirective(k, 0.05 * k, kind) for k, kind in enumerate(kinds))
    save_directives(tmp_path / "directives.json", given)
    assert load_directives(tmp_path / "directives.json") == given


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: SetGoals([]), "give 1 to 1000 goals, got 0"),
        (lambda: SetGoals([(1.0, 2.0)] * 1001), "give 1 to 1000 goals, got 1001"),
        (lambda: SetGoals([(1.0, math.nan)]), "finite numbers"),
        (lambda: SetGoals([(1.0, 2.0)], through=1), "through must be true or false"),
        (lambda: FollowPath([]), "has 1 to 100000 poses, got 0"),
        (lambda: FollowPath([(1.0, 2.0)]), "shape (N, 3)"),
        (lambda: FollowPath([(1.0, 2.0, math.inf)]), "finite poses"),
        (lambda: FollowPath([(1.0, 2.0, 0.0)], [True]), "has 0 legs"),
        (lambda: RunBehavior("spinn"), "Did you mean 'spin'"),
        (lambda: RunBehavior("spin", {"angel": 1.0}), "angel"),
        (lambda: RunBehavior("spin", {"allowance": 0.0}), "allowance must be a positive number"),
        (lambda: RunBehavior("back_up", {"distance": -1.0}), "distance"),
        (lambda: RunBehavior(3), "by its name"),
        (lambda: RunBehavior("spin", 3), "options of a behavior are a mapping"),
        (lambda: Cancel("goal"), "'all' or 'behavior'"),
        (lambda: ClearObstacles("here"), "'all', 'around' or 'except'"),
        (lambda: ClearObstacles("around"), "needs the size"),
        (lambda: ClearObstacles("around", -1.0), "size of the region"),
        (lambda: SetPose((1.0,)), "a pose is"),
        (lambda: SetPose((1.0, 2.0), [1.0, 1.0]), "3 x 3 finite numbers"),
        (lambda: SetPose((1.0, 2.0), np.diag([1.0, 1.0, -1.0])), "not positive semidefinite"),
    ],
)
def test_a_bad_directive_is_one_clear_error(make, message):
    with pytest.raises(InputError) as failed:
        make()
    assert message in str(failed.value)


@pytest.mark.parametrize(
    ("directive", "reason"),
    [
        (SetGoals([GOAL]), "takes one goal at a time"),
        (FollowPath(CORNER), "follows no given path"),
        (RunBehavior("wait"), "runs no behaviors"),
        (Cancel(), "cannot give up its goal"),
        (ClearObstacles(), "has no costmap to clear"),
    ],
)
def test_an_agent_that_is_no_navigator_refuses_them(kinematic_sim, start, steering, directive, reason):
    session = Session(kinematic_sim, CommandScript([(0.1, 0.0, 5.0)]), start, steering=steering)
    said = []
    steering.put(directive, refused=said.append)
    session.step()
    assert reason in said[0]
    assert session.outcome is None
