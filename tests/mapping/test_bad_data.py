"""Data that no robot gives: steps of many metres, ranges of kilometres, maps beyond memory."""

from __future__ import annotations

import numpy as np
import pytest

from mapping.rooms import ANGLES, cast, ring
from trundle import Mapper, Observation, Pose2D, Robot, Scan, Twist2D, draw_map
from trundle.errors import InputError, SensorWarning
from trundle.mapping import move_pose_graph


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("nova_carter")


def mapped(robot: Robot, odometry: list[tuple[float, float]], *, far: float | None = None) -> Mapper:
    """A mapper after scans from one place, at these positions of the odometry, minutes apart."""
    mapper, ranges, range_max = Mapper(robot), cast(ring(0.1)), 30.0
    if far is not None:
        ranges, range_max = np.where(np.arange(len(ANGLES)) % 4 == 0, far, ranges), 2.0 * far
    for i, (x, y) in enumerate(odometry):
        at = 120.0 * i
        scan = Scan("laser", at, Pose2D(0.0, 0.0), 0.3, ANGLES, ranges, 0.05, range_max)
        mapper.update(Observation(at, Twist2D(0.0, 0.0), Pose2D(x, y), (scan,)))
    mapper.finish()
    return mapper


@pytest.mark.parametrize("step", [9.0, 50.0])
def test_a_step_of_many_metres_between_two_scans_is_searched_in_a_bounded_window(robot: Robot, step: float) -> None:
    graph = mapped(robot, [(step * i, 0.0) for i in range(6)]).graph()
    assert np.isfinite(graph.poses).all()
    assert len(set(graph.parts.tolist())) == 1


@pytest.mark.filterwarnings("ignore:the odometry jumped")
def test_a_step_of_hundreds_of_metres_begins_a_part(robot: Robot) -> None:
    graph = mapped(robot, [(0.0, 0.0), (0.5, 0.0), (9e5, 0.0), (9e5 + 0.5, 0.0)]).graph()
    assert sorted(set(graph.parts.tolist())) == [0, 1]
    assert np.abs(graph.poses[:, :2]).max() < 100.0


def carry(mapper: Mapper) -> list[str]:
    """The states of the estimates while a robot drives, is carried away unnoticed by its odometry, and drives on."""
    states, odometry, at = [], Pose2D(0.0, 0.0), 0.0
    for poses in ([ring(i / 180) for i in range(60)], [ring(i / 180) for i in range(110, 117)]):
        last = poses[0]
        for pose in poses:
            odometry, last, at = odometry @ (last.inverse() @ pose), pose, at + 0.5
            scan = Scan("laser", at, Pose2D(0.0, 0.0), 0.3, ANGLES, cast(pose), 0.05, 30.0)
            states.append(mapper.update(Observation(at, Twist2D(0.0, 0.0), odometry, (scan,))).state)
    return states


def test_a_robot_that_was_carried_away_without_its_odometry_begins_a_part_says_so_and_is_lost(robot: Robot) -> None:
    mapper = Mapper(robot)
    with pytest.warns(SensorWarning, match="the robot was carried away, or its odometry has failed; another part"):
        states = carry(mapper)
    assert states == ["localized"] * 62 + ["lost"] * 5
    assert not mapper.joined
    graph = mapper.graph()
    assert set(graph.parts.tolist()) == {0, 1}
    second = graph.poses[graph.parts == 1]
    assert 0 < len(second) == (np.hypot(second[:, 0], second[:, 1]) < 3.0).sum()  # it begins at its own origin


def test_ranges_of_kilometres_are_beams_that_met_nothing(robot: Robot) -> None:
    mapper = mapped(robot, [(0.0, 0.0), (0.5, 0.0)], far=9e4)
    assert max(mapper.grid().shape) < 11_000
    assert max(draw_map(mapper.graph()).shape) < 11_000


def test_a_map_beyond_memory_is_refused_with_its_size_before_anything_is_drawn(robot: Robot) -> None:
    graph = mapped(robot, [(60.0 * i, 60.0 * i) for i in range(12)]).graph()
    spread = move_pose_graph(graph, Pose2D(0.0, 0.0))
    spread.poses[:, :2] *= 50.0
    with pytest.raises(InputError, match=r"the map would be \d+ x \d+ m, .* million cells; use a coarser resolution"):
        draw_map(spread, resolution=0.01)


def test_an_origin_beyond_the_earth_is_refused(robot: Robot) -> None:
    graph = mapped(robot, [(0.0, 0.0)]).graph()
    with pytest.raises(InputError, match="x of the pose graph's origin must be a number from -1e"):
        move_pose_graph(graph, Pose2D(1e9, 0.0))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda robot: Mapper(robot).grid(resolution=0), "resolution must be a number from 0.005 to 10 m, got 0"),
        (lambda robot: Mapper(robot).grid(resolution=float("nan")), "resolution must be a number .* got nan"),
        (lambda robot: Mapper(robot, max_range="x"), "max_range, .* must be a number of 0.01 or more m, got 'x'"),
        (lambda robot: Mapper(robot, max_range=0.0), "max_range, or None for the lidar's own, must be a number"),
        (lambda robot: Mapper(robot, seed="x"), "seed must be an integer .* got 'x'"),
        (lambda robot: Mapper(robot).update(None), "an observation must be of type Observation, got NoneType"),
        (lambda robot: Mapper.from_graph(3, robot), "a pose graph must be of type PoseGraph, got int"),
        (lambda robot: Mapper(robot).relocate("here"), "pose"),
    ],
)
def test_wrong_arguments_are_refused_with_what_is_allowed(robot: Robot, call, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call(robot)
