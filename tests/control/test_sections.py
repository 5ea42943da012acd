import math

import numpy as np
import pytest

from trundle.control.sections import Section, cut_sections, path_vertices
from trundle.path import Path

LEFT = math.pi / 2


def test_points_on_a_straight_are_no_vertices():
    path = Path(np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]))
    assert [(vertex.x, vertex.turn) for vertex in path_vertices(path)] == [(0.0, 0.0), (3.0, 0.0)]


def test_each_bend_and_both_ends_carry_their_turn():
    path = Path(np.array([[0, 0, LEFT], [0, 0, 0], [2, 0, 0], [2, 0, LEFT], [2, 2, LEFT], [2, 2, math.pi]]))
    assert [vertex.turn for vertex in path_vertices(path)] == pytest.approx([-LEFT, LEFT, LEFT])


def test_a_turn_the_long_way_round_keeps_its_direction():
    yaws = np.linspace(0.0, 1.5 * math.pi, 7)
    poses = [[0, 0, yaw] for yaw in yaws] + [[0, -1, -LEFT]]
    assert path_vertices(Path(np.array(poses)))[0].turn == pytest.approx(1.5 * math.pi)


def test_a_path_at_one_place_is_one_vertex_with_the_whole_turn():
    vertices = path_vertices(Path(np.array([[1, 1, 0], [1, 1, 1.0]])))
    assert [(vertex.x, vertex.turn) for vertex in vertices] == [(1.0, pytest.approx(1.0))]


def test_a_finely_sampled_circle_turns_once_round_in_all():
    turn = np.linspace(0.0, 2 * math.pi, 100_001)
    poses = np.column_stack([np.cos(turn), np.sin(turn), turn + LEFT])
    vertices = path_vertices(Path(poses))
    assert sum(vertex.turn for vertex in vertices) == pytest.approx(2 * math.pi, abs=1e-3)


def test_sections_end_at_stops_and_meet_there():
    path = Path(np.array([[0, 0, 0], [2, 0, 0], [2, 2, LEFT], [4, 2, 0]]))
    vertices = path_vertices(path)
    first, second = cut_sections(vertices, [False, True, False, True])
    assert first.points == [(0.0, 0.0), (2.0, 0.0)]
    assert first.end_turn == pytest.approx(LEFT)
    assert second.points == [(2.0, 0.0), (2.0, 2.0), (4.0, 2.0)]
    assert second.length == pytest.approx(4.0)


def test_a_section_gives_points_along_itself_and_straight_on_past_its_end():
    section = Section([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)], 0.0)
    assert section.point_at(1.0) == pytest.approx((1.0, 0.0))
    assert section.point_at(3.0) == pytest.approx((2.0, 1.0))
    assert section.point_at(5.0) == pytest.approx((2.0, 3.0))
    assert section.heading_at(3.0) == pytest.approx(LEFT)


def test_projection_moves_forward_only_and_within_its_window():
    section = Section([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)], 0.0)
    assert section.project(1.0, 0.3, 0.0, 5.0) == pytest.approx(1.0)
    assert section.project(1.0, 0.3, 1.5, 5.0) == pytest.approx(1.5)
    assert section.project(2.5, 1.5, 0.0, 1.0) == pytest.approx(1.0)


def test_where_the_robot_changes_direction_there_is_a_vertex_and_a_section_ends():
    path = Path(np.array([[0, 0, 0], [2, 0, 0], [1, 0, 0], [0.5, 0, 0]]), backward=np.array([False, True, True]))
    vertices = path_vertices(path)
    assert [(vertex.x, vertex.turn, vertex.backward) for vertex in vertices] == [
        (0.0, 0.0, False),
        (2.0, pytest.approx(0.0), True),
        (0.5, pytest.approx(0.0), False),
    ]
    there, back = cut_sections(vertices, [False] * 3)
    assert (there.backward, there.length) == (False, 2.0)
    assert (back.backward, back.length) == (True, 1.5)
    assert back.headings == [pytest.approx(math.pi)]


def test_turns_of_a_path_driven_backwards_are_the_robots():
    # Backwards to the left behind it, then a turn in place to face back along its path.
    path = Path(
        np.array([[0, 0, 0], [-1, 0, 0], [-2, 1, -LEFT / 2], [-2, 1, LEFT]]), backward=np.array([True, True, False])
    )
    assert [vertex.turn for vertex in path_vertices(path)] == pytest.approx([0.0, -LEFT / 2, 1.5 * LEFT])
