import numpy as np
import pytest

from trundle._core import BinaryGrid, walk_corners

MAP = np.zeros((3, 4), np.uint8)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((MAP, 6, "auto"), "connectivity"),
        ((MAP, 8, "dijkstra"), "no such method"),
        ((np.zeros((0, 4), np.uint8), 8, "auto"), "no cells"),
    ],
)
def test_a_map_that_cannot_be_is_refused(arguments, words):
    with pytest.raises(ValueError, match=words):
        BinaryGrid(*arguments)


@pytest.mark.parametrize("array", [np.zeros((3, 4)), np.zeros(3, np.uint8), None])
def test_an_array_of_another_kind_is_refused(array):
    with pytest.raises(TypeError):
        BinaryGrid(array, 8, "auto")


@pytest.mark.parametrize(("row", "col"), [(-1, 0), (0, -1), (2, 0), (0, 3), (2**62, 0)])
def test_an_update_outside_is_refused(row, col):
    with pytest.raises(ValueError, match="outside"):
        BinaryGrid(MAP, 8, "auto").update(row, col, np.ones((2, 2), np.uint8))


@pytest.mark.parametrize(("goals", "threads"), [([[0, 0], [1, 1]], 1), ([[0]], 1), ([[0, 0]], 0)])
def test_a_batch_that_cannot_be_is_refused(goals, threads):
    with pytest.raises(ValueError, match=r"need|threads"):
        BinaryGrid(MAP, 8, "auto").find_paths(np.zeros((1, 2), np.int64), np.array(goals), threads, None, None)


def test_corners_are_walked_cell_by_cell():
    corners = np.array([[5, 5], [3, 7], [3, 4], [3, 4], [4, 4]], np.int32)
    cells = [[5, 5], [4, 6], [3, 7], [3, 6], [3, 5], [3, 4], [4, 4]]
    assert walk_corners(corners).tolist() == cells
    assert walk_corners(corners[:1]).tolist() == [[5, 5]]
    assert walk_corners(corners[:0]).shape == (0, 2)
    with pytest.raises(ValueError, match="straight nor diagonal"):
        walk_corners(np.array([[0, 0], [1, 2]], np.int32))
    with pytest.raises(ValueError, match="shape"):
        walk_corners(np.zeros((2, 3), np.int32))
