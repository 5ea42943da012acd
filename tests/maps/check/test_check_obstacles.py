import numpy as np
import pytest

from support.planted_faults import grown, plant
from support.planted_maps import EDGE, changed, map_of, redrawn, room, surveyed, warehouse
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.maps import FREE, OCCUPIED, OccupancyGrid
from trundle.maps.check import check_grid
from trundle.worlds import World

KINDS = ("missing_obstacle", "phantom_obstacle")
SMALL = {
    "room": room,
    "cylinders": lambda: World.generate("cylinders", seed=2),
    "corridors": lambda: World.generate("corridors", seed=2, door_widths="1.4,1.1"),
    "maze": lambda: World.generate("maze", seed=2, rows=3, columns=4),
}


def named(report):
    return [finding for finding in report.findings if finding.kind in KINDS]


@pytest.mark.slow
@pytest.mark.parametrize("resolution", [0.05, 0.1])
@pytest.mark.parametrize("name", SMALL)
def test_planted_faults_are_named_and_untouched_maps_are_not(name, resolution):
    world = SMALL[name]()
    grid = OccupancyGrid.from_world(world, resolution=resolution)
    assert check_grid(grid, world=world).findings == ()
    random = np.random.default_rng(7)
    for kind in (*KINDS, *KINDS):
        fault = plant(grid, kind, random)
        report = check_grid(fault.grid, world=world)
        assert fault.is_named(report.findings), (kind, fault.area, report.findings)
        assert report.has_errors


def test_a_missing_obstacle_is_named_with_its_size_and_drawn():
    grid = map_of(room())
    (finding,) = named(check_grid(changed(grid, (-3.5, 0.25, -2.5, 0.95, 0)), world=room()))
    assert (finding.kind, finding.severity) == ("missing_obstacle", "error")
    assert "1 x 0.7 m (0.7 m²)" in finding.message
    assert np.hypot(finding.where[0] + 3.0, finding.where[1] - 0.6) < 0.1
    report = check_grid(changed(grid, (-3.5, 0.25, -2.5, 0.95, 0)), world=room())
    assert np.array_equal(report.corrected.data, grid.data)


def test_a_phantom_is_named_with_its_size_and_left_for_its_maker_to_take_out():
    drawn = changed(map_of(room()), (-1.0, 2.0, 0.0, 3.0, 100))
    report = check_grid(drawn, world=room())
    (finding,) = named(report)
    assert (finding.kind, finding.severity) == ("phantom_obstacle", "error")
    assert "1 x 1 m (1 m²)" in finding.message
    assert report.corrected is None


def test_a_map_that_lies_wrong_is_compared_where_it_belongs():
    grid = map_of(warehouse())
    drawn = changed(grid, (-10.5, 2.5, -9.5, 3.5, 100))
    report = check_grid(redrawn(drawn, drawn.data[:, ::-1]), world=warehouse())
    assert report.kinds() == {"flipped", "phantom_obstacle"}
    # Where it is in the map as the file has it, mirrored about the middle.
    middle = grid.origin.x + grid.shape[1] * EDGE / 2.0
    assert named(report)[0].where == pytest.approx((2.0 * middle + 10.0, 3.0), abs=0.1)


@pytest.mark.slow
def test_walls_that_are_two_cells_off_or_thicker_are_no_findings():
    grid = map_of(room())
    thick = np.where(grown(grid.data == OCCUPIED, 2) & (grid.data == FREE), OCCUPIED, grid.data).astype(np.int8)
    assert named(check_grid(redrawn(grid, thick), world=room())) == []
    thin = np.where(grown(grid.data == FREE, 1) & (grid.data == OCCUPIED), FREE, grid.data).astype(np.int8)
    assert named(check_grid(redrawn(grid, thin), world=room())) == []


def test_an_area_that_lies_along_what_remains_is_one_finding():
    bar = Solid("bar", Box((3.0, 0.1, 1.0)), Pose3D((-2.0, 3.05, 0.5)))
    block = Solid("block", Box((0.8, 0.5, 1.0)), Pose3D((-2.0, 3.35, 0.5)))
    world = World("bar", (*room().solids, bar, block), seeds=((0.0, 2.5),))
    grid = OccupancyGrid.from_world(world, resolution=EDGE)
    (finding,) = named(check_grid(changed(grid, (-3.5, 3.0, -0.5, 3.1, 0)), world=world))
    assert finding.kind == "missing_obstacle"
    assert finding.area_m2 == pytest.approx(0.3)


def test_small_things_and_unknown_cells_are_no_findings():
    grid = map_of(room())
    small = changed(grid, (-1.0, 2.0, -0.75, 2.25, 100), (-3.5, 0.25, -2.5, 0.95, -1))
    assert named(check_grid(small, world=room())) == []


@pytest.mark.slow
def test_many_are_all_listed():
    grid = map_of(warehouse())
    free = grid.data == FREE
    boxes = []
    for x in np.arange(-14.0, 14.0, 1.2):
        for y in (-8.9, -7.5, 0.0, 8.0):
            row, col = grid.world_to_cell(x, y)
            if free[row - 6 : row + 18, col - 6 : col + 18].all():
                boxes.append((x, y, x + 0.5, y + 0.5, 100))
    report = check_grid(changed(grid, *boxes), world=warehouse())
    assert len(boxes) > 21
    assert len(named(report)) == len(boxes)
    assert [finding.area_m2 for finding in named(report)] == pytest.approx([0.25] * len(boxes))


@pytest.mark.slow
def test_a_map_of_other_heights_is_compared_with_those():
    kerb = Solid("kerb", Box((1.5, 1.0, 0.08)), Pose3D((-1.5, 3.5, 0.04)))
    world = World("kerb", (*room().solids, kerb), seeds=((0.0, 2.5),))
    grid = OccupancyGrid.from_world(world, resolution=EDGE)  # from 0.10 m up, above the kerb
    report = check_grid(grid, world=world, z_range=(0.05, 0.9))
    assert named(report) == []
    assert "the map shows heights of 0.1 to 0.62 m, and not of 0.05 to 0.9 m" in report.remarks[0]
    report = check_grid(changed(grid, (2.0, 3.0, 3.0, 4.0, 100)), world=world, z_range=(0.05, 0.9))
    assert [finding.kind for finding in named(report)] == ["phantom_obstacle"]
    full = OccupancyGrid.from_world(world, resolution=EDGE, z_range=(0.05, 0.9))
    lacking = check_grid(changed(full, (-2.25, 3.0, -0.75, 4.0, 0)), world=world, z_range=(0.05, 0.9))
    assert named(lacking) == []
    lacking = check_grid(changed(full, (-1.5, 3.0, -0.75, 4.0, 0)), world=world, z_range=(0.05, 0.9))
    assert [finding.kind for finding in named(lacking)] == ["missing_obstacle"]


def test_without_a_world_nothing_is_said_of_obstacles():
    assert named(check_grid(changed(map_of(room()), (-1.0, 2.0, 0.0, 3.0, 100)))) == []


def test_moved_boxes_in_a_noisy_map_are_named_and_its_noise_is_not():
    survey = surveyed(map_of(warehouse()), 1)
    report = check_grid(survey, world=warehouse())
    assert {finding.kind for finding in named(report)} <= {"phantom_obstacle"}
