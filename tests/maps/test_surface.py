"""A map says where the surfaces of what it shows lie in its occupied cells, and keeps that."""

import warnings

import numpy as np
import pytest

from trundle.errors import MapError
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Cylinder, Solid
from trundle.maps import OccupancyGrid, convert_grid, resample_axis_aligned
from trundle.mission import Scenario
from trundle.worlds import World

CELLS = np.zeros((20, 30), np.int8)
CELLS[5] = 100


def room(*, off=0.0, yaw=0.0):
    """Four walls with their inner faces `off` metres beyond cell borders of 5 cm."""
    walls = (((4.0, 0.2), (0.0, 1.1 + off)), ((4.0, 0.2), (0.0, -1.1 - off)), ((0.2, 2.0), (2.1 + off, 0.0)))
    return World(
        "room",
        tuple(
            Solid(f"wall {i}", Box((*size, 1.0)), Pose3D.planar(Pose2D(x, y, yaw), 0.5) if yaw else Pose3D((x, y, 0.5)))
            for i, (size, (x, y)) in enumerate(walls)
        ),
        seeds=((0.0, 0.0),),
    )


def map_of(world):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return OccupancyGrid.from_world(world, resolution=0.05, bounds=((-3.0, -2.0), (3.0, 2.0)))


@pytest.mark.parametrize(("off", "surface"), [(0.0, "border"), (0.025, "overlap"), (0.001, "overlap")])
def test_walls_on_cell_borders_are_told_from_walls_that_reach_into_cells(off, surface):
    assert map_of(room(off=off)).surface == surface


def test_round_things_reach_into_cells_anywhere():
    world = World("pole", (Solid("pole", Cylinder(0.3, 1.0), Pose3D((0.0, 0.0, 0.5))),), seeds=((1.5, 1.0),))
    assert map_of(world).surface == "overlap"


def test_a_map_of_cell_centres_is_right_on_average():
    grid = OccupancyGrid.from_world(
        room(off=0.02), resolution=0.05, bounds=((-3.0, -2.0), (3.0, 2.0)), coverage="centre"
    )
    assert grid.surface == "border"


@pytest.mark.parametrize("surface", ["border", "overlap", "centre"])
def test_a_file_keeps_the_surface(tmp_path, surface):
    OccupancyGrid(CELLS, 0.05, surface=surface).save(tmp_path / "map.yaml")
    assert ("surface" in (tmp_path / "map.yaml").read_text()) == (surface != "border")
    assert OccupancyGrid.load(tmp_path / "map.yaml").surface == surface


def test_a_wrong_surface_in_a_file_is_one_clear_error(tmp_path):
    OccupancyGrid(CELLS, 0.05, surface="overlap").save(tmp_path / "map.yaml")
    text = (tmp_path / "map.yaml").read_text().replace("overlap", "middle")
    (tmp_path / "map.yaml").write_text(text)
    with pytest.raises(
        MapError, match=r"map.yaml:8:10: surface is 'middle'; it must be one of border, overlap, centre"
    ):
        OccupancyGrid.load(tmp_path / "map.yaml")


def test_a_wrong_surface_is_refused():
    with pytest.raises(MapError, match="surface is 'rim'"):
        OccupancyGrid(CELLS, 0.05, surface="rim")  # type: ignore[arg-type]


def test_derived_maps_keep_the_surface():
    grid = OccupancyGrid(CELLS, 0.05, Pose2D(1.0, 2.0, 0.3), "overlap")
    assert convert_grid(grid, resolution=0.1).grid.surface == "overlap"
    assert convert_grid(grid, crop="content").grid.surface == "overlap"
    assert resample_axis_aligned(grid).surface == "overlap"


def test_a_world_that_is_made_from_a_map_has_its_walls_on_cell_borders(tmp_path):
    cells = np.zeros((80, 80), np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    OccupancyGrid(cells, 0.05, surface="overlap").save(tmp_path / "map.yaml")
    scenario = Scenario(map=str(tmp_path / "map.yaml"), start=(1.0, 1.0, 0.0), goal=(3.0, 3.0))
    with scenario.build() as mission:
        assert mission.grid.surface == "border"
