import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trundle.errors import InputError, WorldError
from trundle.geometry import Pose2D
from trundle.geometry.solids import Box, OccupancyCells
from trundle.maps import OccupancyGrid
from trundle.worlds import World
from trundle.worlds.walls import extrude, merge_cells

classes = st.builds(
    lambda rows, cols, seed: np.random.default_rng(seed).choice(3, (rows, cols), p=(0.5, 0.3, 0.2)).astype(np.uint8),
    st.integers(1, 12),
    st.integers(1, 12),
    st.integers(0, 2**32 - 1),
)


def grid_of(text, resolution=0.5, origin=Pose2D(0.0, 0.0)):
    """'#' occupied, '?' unknown, '+' 50 %, '.' free; the first line is the top."""
    values = {"#": 100, "?": -1, ".": 0, "+": 50}
    rows = [[values[letter] for letter in line] for line in text.split()]
    return OccupancyGrid(np.array(rows[::-1], dtype=np.int8), resolution, origin)


@given(classes)
def test_rectangles_cover_each_solid_cell_once_with_its_class(cells):
    rectangles = merge_cells(cells, most=1000)
    painted = np.zeros_like(cells)
    for row, row_end, col, col_end, kind in zip(*(column.tolist() for column in rectangles), strict=True):
        assert (painted[row:row_end, col:col_end] == 0).all()
        painted[row:row_end, col:col_end] = kind
    assert np.array_equal(painted, cells)


@given(classes)
def test_the_limit_counts_rectangles(cells):
    count = len(merge_cells(cells, most=1000).kind)
    assert merge_cells(cells, most=count) is not None
    assert count == 0 or merge_cells(cells, most=count - 1) is None


def test_boxes_are_named_after_their_cells_and_lie_over_them():
    world = extrude(grid_of("""..... .##.. .##?? ....."""), height=2.0)
    assert {solid.name: solid.kind for solid in world.solids} == {"map[1:3,1:3]": "wall", "map[1:2,3:5]": "unknown"}
    low, high = world.solids[0].bounds() if world.solids[0].kind == "wall" else world.solids[1].bounds()
    assert low == pytest.approx([0.5, 0.5, 0.0])
    assert high == pytest.approx([1.5, 1.5, 2.0])


def test_only_full_cells_are_solid_as_in_a_costmap():
    assert [solid.name for solid in extrude(grid_of("..+.# +....")).solids] == ["map[1:2,4:5]"]


@pytest.mark.parametrize("most_boxes", [5000, 1])
def test_a_turned_map_turns_its_walls(most_boxes):
    origin = Pose2D(3.0, -1.0, 0.7)
    grid = grid_of("....# .#... ..... ....?", origin=origin)
    world = extrude(grid, most_boxes=most_boxes)
    rows, cols = np.nonzero(grid.data != 0)
    middles = np.column_stack([*grid.cell_to_world(rows, cols), np.full(len(rows), 0.5)])
    found = np.zeros(len(rows), dtype=bool)
    for solid in world.solids:
        local = (middles - np.array(solid.pose.position)) @ solid.pose.rotation()
        if isinstance(solid.shape, OccupancyCells):
            row, col = np.floor(local[:, 1] / 0.5).astype(int), np.floor(local[:, 0] / 0.5).astype(int)
            found |= solid.shape.blocked[row, col]
        else:
            found |= (np.abs(local) <= np.array(solid.shape.size) / 2.0).all(axis=1)
        assert solid.pose.yaw() == pytest.approx(0.7)
    assert found.all()


def test_a_map_of_too_many_boxes_becomes_cells():
    checkers = OccupancyGrid((np.indices((40, 40)).sum(axis=0) % 2 * 100).astype(np.int8), 0.05)
    (solid,) = extrude(checkers, most_boxes=100).solids
    assert isinstance(solid.shape, OccupancyCells)
    assert solid.name == "map"
    assert np.array_equal(solid.shape.blocked, checkers.data == 100)
    assert len(extrude(checkers).solids) == 800


def test_the_seed_lies_in_the_largest_free_area():
    world = extrude(grid_of("...#........ ...#........ ####........ .....#######"))
    ((x, y),) = world.seeds
    assert (math.floor(y / 0.5), math.floor(x / 0.5)) in {(row, col) for row in (1, 2, 3) for col in range(4, 12)}


def test_a_map_file_gives_its_name(tmp_path):
    grid_of("... .#. ...").save(tmp_path / "hall.yaml")
    world = World.from_map(tmp_path / "hall.yaml")
    assert world.name == "hall"
    assert [solid.name for solid in world.solids] == ["map[1:2,1:2]"]


def test_a_map_without_room_is_refused():
    with pytest.raises(WorldError, match="no free cell"):
        extrude(grid_of("## ??"))


def test_a_height_of_nothing_is_refused():
    with pytest.raises(WorldError, match="positive"):
        extrude(grid_of("## .."), height=0.0)


def test_unknown_cells_can_be_free(tmp_path):
    data = np.zeros((4, 6), dtype=np.int8)
    data[:, 0] = 100
    data[:, 5] = -1
    grid = OccupancyGrid(data, 0.5)
    assert {solid.kind for solid in World.from_map(grid).solids} == {"wall", "unknown"}
    world = World.from_map(grid, unknown="free", height=2.5)
    assert [(solid.kind, solid.shape) for solid in world.solids] == [("wall", Box((0.5, 2.0, 2.5)))]
    with pytest.raises(InputError, match="'solid' or 'free'"):
        World.from_map(grid, unknown="maybe")


def test_a_map_is_loaded_as_a_world_with_options(tmp_path):
    data = np.zeros((4, 6), dtype=np.int8)
    data[1, 1] = 100
    OccupancyGrid(data, 0.5).save(tmp_path / "room.yaml")
    world = World.load(tmp_path / "room.yaml", height=0.7)
    assert world.name == "room"
    assert world.bounds[1][2] == pytest.approx(0.7)
