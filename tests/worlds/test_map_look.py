import hashlib

import numpy as np
import pytest

from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, OccupancyCells, Solid
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.sim.mujoco.model import build_spec
from trundle.worlds import World
from trundle.worlds.map_look import ISLAND_COLOR, RISE, WALL_COLOR, as_drawn, drawn_solids, find_islands, shown_bounds
from trundle.worlds.walls import extrude


def office_map():
    """Cells of 10 cm: walls around and within, a table, a cupboard along a wall, and a part that nobody has seen."""
    data = np.full((60, 80), -1, dtype=np.int8)
    data[:40, :60] = 0
    data[0, :60], data[39, :60], data[:40, 0], data[:40, 59] = 100, 100, 100, 100
    data[1:30, 20] = 100
    data[10:16, 30:40] = 100
    data[33:39, 45:52] = 100
    return OccupancyGrid(data, 0.1, Pose2D(1.0, -2.0, 0.3))


def parts(world):
    kinds = {WALL_COLOR: "wall", ISLAND_COLOR: "island"}
    return {solid.name: kinds.get(solid.color, "unknown") for solid in world.solids}


def test_what_stands_between_walls_has_another_colour():
    found = parts(World.from_map(office_map()))
    assert found["map[10:16,30:40]"] == "island"
    assert found["map[33:39,45:52]"] == "island"  # a cupboard, though it touches a wall
    assert found["map[0:1,0:60]"] == "wall"
    assert found["map[1:30,20:21]"] == "wall"
    assert sorted(set(found.values())) == ["island", "unknown", "wall"]


def test_small_areas_are_islands_whatever_the_resolution():
    occupied = np.zeros((30, 30), dtype=bool)
    occupied[2:4, 2:12] = True
    occupied[10, :] = True
    assert find_islands(occupied, 0.1)[2:4, 2:12].all()
    assert not find_islands(occupied, 0.1)[10].any()
    assert not find_islands(occupied, 1.0).any()


def test_what_is_simulated_does_not_depend_on_how_a_map_is_drawn():
    """Names, shapes, poses and kinds of the solids, the simulator's model, and the map are those of before."""
    world = World.from_map(OccupancyGrid(office_map().data, 0.1))
    text = repr([(one.name, one.shape, one.pose, one.kind) for one in world.solids])
    assert hashlib.sha256(text.encode()).hexdigest()[:16] == "4cf2f66c8a1a429d"
    model = build_spec(world, Robot.load("nova_carter")).compile()
    names = {model.geom(index).name for index in range(model.ngeom)}
    assert not any(name.startswith("viewer:") for name in names)
    heights = {solid.name: 2.0 * model.geom(solid.name).size[2] for solid in world.solids}
    assert set(heights.values()) == {1.0}
    band = (0.1, 0.6)
    again = OccupancyGrid.from_world(world, resolution=0.1, z_range=band)
    assert hashlib.sha256(again.data.tobytes()).hexdigest()[:16] == "e1e8c0f4b4d97223"


def test_walls_are_drawn_higher_than_islands_and_unknown_cells_as_a_plate():
    world = World.from_map(office_map(), height=1.5)
    tops = {}
    for solid in world.solids:
        (drawn,) = as_drawn(solid)
        low, high = drawn.solid.bounds()
        assert low[2] == pytest.approx(0.0)
        assert drawn.of_map
        assert drawn.capped == (parts(world)[solid.name] == "wall")
        tops.setdefault(parts(world)[solid.name], set()).add(round(float(high[2]), 6))
    assert tops["wall"] == {round(1.5 * (1.0 + RISE), 6)}
    assert tops["island"] == {1.5}
    assert max(tops["unknown"]) < 0.1


def test_the_cells_of_a_large_map_are_drawn_as_walls_and_islands():
    grid = office_map()
    (solid,) = extrude(grid, most_boxes=1, unknown="free").solids
    walls, islands = as_drawn(solid)
    assert isinstance(walls.solid.shape, OccupancyCells)
    assert isinstance(islands.solid.shape, OccupancyCells)
    assert walls.capped
    assert not islands.capped
    assert np.array_equal(walls.solid.shape.blocked | islands.solid.shape.blocked, solid.shape.blocked)
    assert islands.solid.shape.blocked.sum() == 60 + 49  # the table, and the cupboard with the wall behind it
    assert walls.solid.shape.height > islands.solid.shape.height == solid.shape.height


def test_other_solids_are_drawn_as_they_are():
    solids = (Solid("wall", Box((1.0, 1.0, 2.0)), Pose3D(), kind="wall"), *World.generate("office").solids)
    assert [one.solid for one in drawn_solids(solids)] == list(solids)
    assert not any(one.capped or one.of_map for one in drawn_solids(solids))


def test_a_picture_of_a_map_ends_where_only_unknown_cells_follow():
    grid = office_map()
    low, high = shown_bounds(World.from_map(grid).solids)
    corners = grid.origin.transform_points([(0.0, 0.0), (6.0, 0.0), (0.0, 4.0), (6.0, 4.0)])
    np.testing.assert_allclose(low, [*corners.min(axis=0), 0.0], atol=1e-9)
    np.testing.assert_allclose(high, [*corners.max(axis=0), 1.0], atol=1e-9)
    everything = World.from_map(grid, unknown="free")
    np.testing.assert_array_equal(shown_bounds(everything.solids), everything.bounds)
