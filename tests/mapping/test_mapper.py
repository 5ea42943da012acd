"""The mapper: closed loops, correct poses, parts, and no growth."""

from __future__ import annotations

import numpy as np
import pytest

from mapping.rooms import SEGMENTS, drive, ring
from trundle import Mapper, Observation, Pose2D, Robot, draw_map
from trundle._core import label_components


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("nova_carter")


@pytest.fixture(scope="module")
def twice_round(robot: Robot) -> tuple[Mapper, list[tuple[Pose2D, Pose2D]]]:
    mapper, pairs = Mapper(robot), []
    mapper.reset(ring(0.0))
    for truth, observation in drive([ring(i / 180) for i in range(360)]):
        pairs.append((truth, mapper.update(observation).pose))
    mapper.finish()
    return mapper, pairs


def test_the_robot_knows_where_it_is_while_the_odometry_drifts(twice_round) -> None:
    _, pairs = twice_round
    errors = [truth.distance_to(found) for truth, found in pairs]
    assert np.mean(errors) < 0.05
    assert max(errors) < 0.15


def test_loops_are_closed_and_the_nodes_lie_where_the_robot_was(twice_round) -> None:
    mapper, pairs = twice_round
    graph = mapper.graph()
    assert (graph.edges[:, 2] == 1).sum() >= 3
    assert mapper.revision > 0
    times = (graph.times / 0.5).round().astype(int)
    errors = [pairs[i][0].distance_to(Pose2D(*pose)) for i, pose in zip(times, graph.poses, strict=True)]
    assert max(errors) < 0.06


def test_the_map_shows_the_walls_where_they_are_one_cell_thick(twice_round) -> None:
    grid = draw_map(twice_round[0].graph(), resolution=0.05)
    assert grid.surface == "centre"
    rows, cols = np.nonzero(grid.data >= 65)
    x = grid.origin.x + (cols + 0.5) * 0.05
    y = grid.origin.y + (rows + 0.5) * 0.05
    a, along = SEGMENTS[:, :2], SEGMENTS[:, 2:] - SEGMENTS[:, :2]
    gap = np.stack((x, y), axis=1)[:, None] - a
    share = np.clip((gap * along).sum(axis=2) / np.square(along).sum(axis=1), 0.0, 1.0)
    distance = np.hypot(*np.moveaxis(gap - share[..., None] * along, 2, 0)).min(axis=1)
    assert (distance < 0.1).mean() > 0.97
    wall = (np.abs(y) < 0.15) & (x > 1.0) & (x < 9.0)
    thickness = np.unique(cols[wall], return_counts=True)[1]
    assert thickness.mean() < 1.15
    assert len(thickness) >= 150


def test_a_robot_that_was_carried_away_starts_a_part_which_is_joined(robot: Robot) -> None:
    mapper = Mapper(robot)
    mapper.reset(ring(0.0))
    for _, observation in drive([ring(i / 180) for i in range(180)]):
        mapper.update(observation)
    mapper.new_part()
    errors = []
    for truth, observation in drive([ring(0.4 + i / 180) for i in range(120)], begin_s=100.0, seed=1):
        errors.append(mapper.update(observation).pose.distance_to(truth))
    assert errors[0] > 1.0
    assert mapper.joined
    assert errors[-1] < 0.1
    assert len(np.unique(mapper.graph().parts)) == 2


@pytest.fixture
def in_two_parts() -> list[Observation]:
    """A drive round three quarters of the rooms, and one from elsewhere, with the odometry from its own start."""
    first = [one for _, one in drive([ring(i / 180) for i in range(140)])]
    return first + [one for _, one in drive([ring(0.4 + i / 180) for i in range(60)], begin_s=100.0, seed=1)]


def test_whoever_sees_the_map_is_told_when_another_part_is_shown_and_when_it_is_joined(
    robot: Robot, in_two_parts: list[Observation]
) -> None:
    mapper, jumps = Mapper(robot), []
    last, seen, origin = None, mapper.revision, None
    for one in in_two_parts:
        if one.time == 100.0:
            mapper.new_part()
        estimate = mapper.update(one)
        if last is not None and last.T_map_odom.distance_to(estimate.T_map_odom) > 0.5:
            jumps.append(one.time)
            assert mapper.revision > seen, one.time
        if origin is not None and mapper.grid().origin.distance_to(origin) > 3.0:
            assert mapper.revision > seen, one.time
        last, seen, origin = estimate, mapper.revision, mapper.grid().origin
    assert len(jumps) == 2
    assert mapper.joined


def test_a_part_whose_loops_do_not_fit_stays_where_it_was(
    robot: Robot, in_two_parts: list[Observation], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("trundle.mapping.mapper.is_true", lambda *_: False)
    monkeypatch.setattr("trundle.mapping.mapper.fits", lambda _: False)
    mapper = Mapper(robot)
    for one in in_two_parts:
        if one.time == 100.0:
            mapper.new_part()
        mapper.update(one)
    graph = mapper.graph()
    assert not (graph.edges[:, 2] == 1).any()
    assert graph.poses[graph.parts == 1][0] == pytest.approx((0.0, 0.0, 0.0))


def test_a_robot_that_is_told_where_it_is_keeps_its_map_and_goes_on_there(robot: Robot) -> None:
    """Told by a hand that is off by 0.3 m and 4 degrees, from an odometry that begins at zero again."""
    mapper = Mapper(robot)
    mapper.reset(ring(0.0))
    for _, observation in drive([ring(i / 180) for i in range(140)]):
        mapper.update(observation)
    nodes, before, revision = len(mapper.graph().times), mapper.grid(), mapper.revision
    mapper.relocate(ring(0.3) @ Pose2D(0.2, -0.22, 0.07), np.diag((0.25, 0.25, 0.0685)))
    assert mapper.revision > revision
    estimates = []
    for truth, observation in drive([ring(0.3 + i / 180) for i in range(60)], begin_s=10.0, seed=1):
        estimates.append((truth, mapper.update(observation)))
        assert len(mapper.graph().times) > nodes
        if len(estimates) == 1:
            known = before.data >= 0
            assert (mapper.grid().data >= 0).sum() > 0.95 * known.sum()
    assert {estimate.state for _, estimate in estimates} == {"localized"}
    first, last = estimates[0], estimates[-1]
    assert first[0].distance_to(first[1].pose) == pytest.approx(0.3, abs=0.05)
    assert first[1].covariance[0, 0] > 0.25
    assert last[0].distance_to(last[1].pose) < 0.1
    assert last[1].covariance[0, 0] < 0.01
    assert mapper.joined


def test_a_robot_that_is_told_again_and_again_where_it_is_makes_no_parts_without_nodes(robot: Robot) -> None:
    mapper = Mapper(robot)
    for _, observation in drive([ring(i / 180) for i in range(5)]):
        mapper.update(observation)
    for _ in range(5):
        mapper.relocate(ring(0.0))
    for _, observation in drive([ring(i / 180) for i in range(5)]):
        mapper.update(observation)
    assert sorted(set(mapper.graph().parts.tolist())) == [0, 1]
    assert draw_map(mapper.graph()) is not None


def test_a_robot_that_is_told_where_it_is_before_its_first_scan_begins_there(robot: Robot) -> None:
    mapper = Mapper(robot)
    mapper.relocate(Pose2D(3.0, -2.0, 0.5))
    _, observation = next(iter(drive([ring(0.0)])))
    assert mapper.update(observation).pose.distance_to(Pose2D(3.0, -2.0)) < 1e-9


def test_the_same_observations_give_the_same_map(robot: Robot) -> None:
    graphs = []
    for _ in range(2):
        mapper = Mapper(robot)
        for _, observation in drive([ring(i / 150) for i in range(190)]):
            mapper.update(observation)
        mapper.finish()
        graphs.append(mapper.graph())
    assert (graphs[0].poses == graphs[1].poses).all()
    assert (graphs[0].edges == graphs[1].edges).all()


def test_a_graph_is_continued(robot: Robot, twice_round) -> None:
    mapper = Mapper.from_graph(twice_round[0].graph(), robot)
    errors = []
    for truth, observation in drive([ring(0.2 + i / 180) for i in range(120)], seed=2):
        errors.append(mapper.update(observation).pose.distance_to(truth))
    assert mapper.joined
    assert errors[-1] < 0.1


def test_the_live_map_follows_corrections(twice_round) -> None:
    mapper, _ = twice_round
    live, final = mapper.grid(), draw_map(mapper.graph())
    assert ((live.data >= 65).sum() / (final.data >= 65).sum()) == pytest.approx(1.0, abs=0.05)


def test_a_robot_that_circles_in_one_place_adds_nothing_more(robot: Robot) -> None:
    mapper, sizes, errors = Mapper(robot), [], []
    mapper.reset(ring(0.0))
    for i, (truth, observation) in enumerate(drive([ring(i / 90) for i in range(90 * 16)])):
        errors.append(mapper.update(observation).pose.distance_to(truth))
        if i % (90 * 4) == 90 * 4 - 1:
            graph = mapper.graph()
            sizes.append((len(graph.times), len(graph.scan_nodes), len(graph.edges)))
    assert sizes[3][0] <= 1.1 * sizes[2][0]
    assert sizes[3][1] <= 1.1 * sizes[2][1]
    assert max(errors) < 0.15


def test_a_robot_that_stands_adds_nothing(robot: Robot) -> None:
    mapper = Mapper(robot)
    for _, observation in drive([ring(0.1)] * 50):
        mapper.update(observation)
    assert len(mapper.graph().times) == 1
    assert len(mapper.graph().scan_nodes) == 1


def test_after_the_end_the_map_is_that_of_the_graph(twice_round) -> None:
    mapper, _ = twice_round
    assert np.array_equal(mapper.grid().data, draw_map(mapper.graph()).data)


def test_free_space_hangs_together_with_where_the_robot_was(twice_round) -> None:
    """What beams that graze a wall leave behind it is not known."""
    cells = draw_map(twice_round[0].graph()).data
    labels, parts = label_components(((cells >= 0) & (cells <= 20)).view(np.uint8), diagonal=False)
    assert len(parts) == 1, f"{len(parts)} pieces of free space, {labels.max()}"
