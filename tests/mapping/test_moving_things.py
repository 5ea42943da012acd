"""People who walk along with the robot are left out of what is matched: the match does not go with them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np
import pytest

from mapping.rooms import ANGLES, cast
from trundle import Mapper, Observation, Pose2D, Robot, Scan, Twist2D
from trundle.mapping.doubtful_scans import MovingThings
from trundle.mapping.nodes import Surface, make_surface

SPEED_M_S, PERIOD_S = 0.8, 0.1


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("nova_carter")


def corridor() -> np.ndarray:
    """Two walls, one with a flat recess for a door every few metres: little tells how far along it the robot is."""
    walls = [(-20.0, -1.2, 60.0, -1.2)]
    x = -20.0
    for door in (-8.0, -1.8, 5.0, 9.0, 16.0, 21.0, 27.5):
        walls += [
            (x, 1.2, door, 1.2),
            (door, 1.2, door, 1.8),
            (door, 1.8, door + 0.9, 1.8),
            (door + 0.9, 1.8, door + 0.9, 1.2),
        ]
        x = door + 0.9
    return np.array([*walls, (x, 1.2, 60.0, 1.2)])


def person(x: float, y: float) -> list[tuple[float, float, float, float]]:
    """An outline of eight sides."""
    turns = np.arange(9) * math.pi / 4
    ring = np.column_stack((x + 0.25 * np.cos(turns), y + 0.25 * np.sin(turns)))
    return [(*a, *b) for a, b in itertools.pairwise(ring)]


def walk(
    count: int, people: tuple[tuple[float, float], ...], own: float = SPEED_M_S
) -> Iterator[tuple[Pose2D, Observation]]:
    """Observations of a robot in the corridor, with people who keep their places beside a robot of the usual speed."""
    walls, rng = corridor(), np.random.default_rng(0)
    for i in range(count):
        pose, at = Pose2D(own * PERIOD_S * i, 0.0), SPEED_M_S * PERIOD_S * i
        sides = [side for x, y in people for side in person(at + x, y)]
        ranges = cast(pose, rng, np.concatenate((walls, np.array(sides).reshape(-1, 4))))
        time = PERIOD_S * i
        scan = Scan("lidar", time, Pose2D(0.0, 0.0), 0.3, ANGLES, ranges, 0.1, 8.0)
        yield pose, Observation(time, Twist2D(own, 0.0), Pose2D(0.95 * pose.x, 0.0, 0.01 * pose.x), (scan,))


PEOPLE = ((1.6, 0.3), (1.9, -0.5), (-1.4, 0.4), (2.6, 0.6), (-1.8, -0.6))


def seen(one: Observation) -> Surface:
    points = one.scans[0].points()
    return make_surface(points, np.zeros_like(points))


def test_a_match_does_not_go_with_people_who_walk_along(robot: Robot) -> None:
    """With their points, the robot seems to stand among them: 20 m off."""
    mapper = Mapper(robot)
    errors = [pose.distance_to(mapper.update(one).pose) for pose, one in walk(250, PEOPLE)]
    assert max(errors) < 0.35


def test_points_on_people_are_left_out_and_all_others_stay(robot: Robot) -> None:
    moving = MovingThings(robot)
    counts = []
    kept = np.zeros((0, 2))
    for _, one in walk(12, PEOPLE):
        surface = seen(one)
        kept = moving.leave_out(surface, one).points
        counts.append(len(surface.points) - len(kept))
    assert counts[0] == 0  # nothing to compare with yet
    assert counts[-1] > 50
    assert (np.abs(kept[:, 1]) > 1.1).all()  # walls; people end 0.85 m from the middle


def test_nothing_is_left_out_where_nothing_moves(robot: Robot) -> None:
    moving = MovingThings(robot)
    for _, one in walk(20, ()):
        surface = seen(one)
        assert len(moving.leave_out(surface, one).points) == len(surface.points)


def test_all_is_kept_where_nearly_all_seems_to_move(robot: Robot) -> None:
    """Posts on all sides move with the robot: its wheels slip, and it stands."""
    moving = MovingThings(robot)
    angles = np.arange(12) * math.pi / 6
    posts = np.array([side for a in angles for side in person(2.0 * math.cos(a), 2.0 * math.sin(a))])
    for i in range(20):
        pose = Pose2D(0.05 * i, 0.0)
        scan = Scan("lidar", PERIOD_S * i, Pose2D(0.0, 0.0), 0.3, ANGLES, cast(Pose2D(0.0, 0.0), None, posts), 0.1, 8.0)
        one = Observation(PERIOD_S * i, Twist2D(0.5, 0.0), pose, (scan,))
        surface = seen(one)
        assert len(surface.points) > 100
        assert len(moving.leave_out(surface, one).points) == len(surface.points)
