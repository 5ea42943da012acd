import numpy as np
import pytest

from support.planted_maps import EDGE, changed, map_of, redrawn, room, warehouse
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.maps.check import areas, check_grid
from trundle.robots import Robot
from trundle.worlds import World

WORLDS = pytest.mark.parametrize("make", [room, warehouse])
NOVA = Robot.load("nova_carter")


def only(report, kind):
    """The finding of a map with one."""
    assert [finding.kind for finding in report.findings] == [kind]
    return report.findings[0]


def near(finding, x, y, within=0.3):
    return np.hypot(finding.where[0] - x, finding.where[1] - y) <= within


# A free place in each of the two maps.
PLACES = pytest.mark.parametrize(("make", "x", "y"), [(room, -2.0, 3.5), (warehouse, -10.0, 3.0)])


@WORLDS
def test_a_good_map_raises_nothing(make):
    grid = map_of(make())
    assert check_grid(grid).findings == ()
    robot = Robot.load("turtlebot3_burger")
    assert check_grid(grid, world=make(), robot=robot, start=make().seeds[0]).findings == ()


def test_the_warehouse_has_room_for_nova_carter():
    assert check_grid(map_of(warehouse()), robot=NOVA).findings == ()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["warehouse", "office", "maze", "cylinders", "corridors", "lot"])
def test_a_good_map_of_any_world_raises_nothing(name):
    world = World.generate(name, seed=1)
    grid = map_of(world)
    for robot in (None, NOVA, Robot.load("turtlebot3_burger")):
        report = check_grid(grid, world=world, robot=robot)
        assert [finding for finding in report.findings if finding.severity != "info"] == []
        assert report.corrected is None
    assert check_grid(grid, world=world).findings == ()


@PLACES
def test_a_hole_is_found(make, x, y):
    grid = changed(map_of(make()), (x - 0.4, y - 0.3, x + 0.4, y + 0.3, -1))
    finding = only(check_grid(grid), "unknown_hole")
    assert near(finding, x, y)
    assert "0.48 m²" in finding.message
    report = check_grid(grid, world=make())
    assert np.array_equal(report.corrected.data, map_of(make()).data)


def test_a_hole_beside_a_wall_is_found_and_the_inside_of_a_thing_is_none():
    grid = changed(map_of(room()), (0.0, 4.5, 0.5, 5.0, -1), (-3.4, 0.35, -2.6, 0.85, -1))
    assert near(only(check_grid(grid), "unknown_hole"), 0.25, 4.75)


def test_a_large_part_that_was_never_seen_is_found():
    grid = map_of(room())
    finding = only(check_grid(changed(grid, (1.1, 0.0, 4.0, 5.0, -1))), "unseen")
    assert near(finding, 2.5, 2.5)
    assert only(check_grid(changed(grid, (1.1, 0.0, 4.0, 5.0, -1)), world=room()), "unseen").where == finding.where


def test_a_map_that_ends_in_the_open_is_unseen_there():
    grid = map_of(warehouse())
    cut = grid.data.copy()
    cut[:, 400:] = -1
    kinds = check_grid(redrawn(grid, cut)).kinds()
    assert "unseen" in kinds
    report = check_grid(redrawn(grid, cut), world=warehouse())
    assert "unseen" in report.kinds()
    assert np.array_equal(report.corrected.data, grid.data)


@pytest.mark.parametrize("margin", [0, 20])
@pytest.mark.parametrize("outside", [-1, 0])
def test_a_leak_is_found_where_it_is(margin, outside):
    grid = map_of(room())
    data = np.pad(grid.data, margin, constant_values=outside)
    wide = OccupancyGrid(data, EDGE, Pose2D(grid.origin.x - margin * EDGE, grid.origin.y - margin * EDGE))
    leaking = changed(wide, (-1.0, 5.0, -0.6, 5.2, 0))
    found = [finding for finding in check_grid(leaking).findings if finding.kind == "leak"]
    assert len(found) == 1
    assert near(found[0], -0.8, 5.1, within=0.5)
    assert found[0].severity == "warning"
    assert "0.40 m" in found[0].message or outside == 0


def test_a_leak_is_closed_with_the_worlds_wall():
    grid = map_of(room())
    report = check_grid(changed(grid, (-1.0, 5.0, -0.6, 5.2, 0)), world=room())
    assert only(report, "leak").fix == "draw the wall that the world has there"
    assert np.array_equal(report.corrected.data, grid.data)


def test_an_open_place_is_no_error():
    data = np.zeros((100, 140), dtype=np.int8)
    data[40:45, 60:70] = 100
    finding = only(check_grid(OccupancyGrid(data, EDGE)), "leak")
    assert finding.severity == "info"
    assert "no outer wall" in finding.message


@PLACES
def test_an_island_is_found(make, x, y):
    ring = (x - 0.6, y - 0.6, x + 0.6, y + 0.6, 100)
    grid = changed(map_of(make()), ring, (x - 0.5, y - 0.5, x + 0.5, y + 0.5, 0))
    finding = only(check_grid(grid), "island")
    assert near(finding, x, y)
    assert "1 m²" in finding.message


@PLACES
def test_speckles_are_found(make, x, y):
    grid = map_of(make())
    for cells, value in ((1, 100), (2, 100), (1, -1)):
        speck = changed(grid, (x, y, x + cells * EDGE, y + EDGE, value))
        finding = only(check_grid(speck), "speckle")
        assert near(finding, x, y)
        report = check_grid(speck, world=make())
        assert np.array_equal(report.corrected.data, grid.data)


def test_a_speck_that_the_world_has_is_none():
    from support.planted_maps import block

    post = World("post", (*room().solids, block("post", -2.0, 3.5, 0.02, 0.02)), seeds=room().seeds)
    grid = OccupancyGrid.from_world(post, resolution=EDGE)
    assert check_grid(grid).kinds() == {"speckle"}
    assert check_grid(grid, world=post).findings == ()


def test_free_specks_become_unknown():
    grid = changed(map_of(room()), (-3.0, 0.6, -2.95, 0.65, 0))
    report = check_grid(grid)
    assert only(report, "speckle").severity == "info"
    row, col = grid.world_to_cell(-2.975, 0.625)
    assert report.corrected.data[row, col] == -1


def test_many_findings_of_a_kind_are_all_listed():
    data = map_of(warehouse()).data.copy()
    row, col = map_of(warehouse()).world_to_cell(-10.0, 2.0)
    data[row : row + 60 : 6, col : col + 30 : 5] = 100
    findings = check_grid(redrawn(map_of(warehouse()), data)).findings
    assert len(findings) == 60
    assert {finding.kind for finding in findings} == {"speckle"}


def test_findings_beyond_the_most_of_a_kind_are_counted_in_one(monkeypatch):
    monkeypatch.setattr(areas, "MOST_A_KIND", 20)
    data = map_of(warehouse()).data.copy()
    row, col = map_of(warehouse()).world_to_cell(-10.0, 2.0)
    data[row : row + 60 : 6, col : col + 30 : 5] = 100
    findings = check_grid(redrawn(map_of(warehouse()), data)).findings
    assert len(findings) == 21
    assert findings[-1].message.startswith("40 more specks")


# Doors and detours ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("gap", [0.2, 0.45])
def test_a_door_that_is_too_narrow_is_found_with_its_width(gap):
    grid = changed(map_of(room()), (0.9, 2.0 + gap, 1.1, 3.0, 100))
    finding = only(check_grid(grid, robot=NOVA), "narrow_door")
    assert f"door of {gap:.2f} m" in finding.message
    assert "0.50 m wide" in finding.message
    assert finding.severity == "warning"
    assert near(finding, 1.0, 2.0 + gap / 2, within=0.1)


def test_a_door_that_is_just_wide_enough_is_none():
    assert check_grid(changed(map_of(room()), (0.9, 2.5, 1.1, 3.0, 100)), robot=NOVA).findings == ()
    assert check_grid(changed(map_of(room()), (0.9, 2.2, 1.1, 3.0, 100))).findings == ()


def test_a_narrow_aisle_has_a_detour():
    grid = map_of(warehouse())
    # An aisle between two rows of racks, nearly closed.
    finding = only(check_grid(changed(grid, (-4.2, 2.5, -4.0, 4.2, 100)), robot=NOVA), "narrow_door")
    assert finding.severity == "info"
    assert "there is a detour" in finding.message


def test_a_slanted_door_is_measured():
    rows, cols = np.indices((160, 160))
    along, across = (rows + cols) / np.sqrt(2.0), (rows - cols) / np.sqrt(2.0)
    data = np.zeros((160, 160), dtype=np.int8)
    data[(np.abs(along - 113) < 3) & (np.abs(across) > 4.0)] = 100
    data[[0, -1], :] = data[:, [0, -1]] = 100
    finding = only(check_grid(OccupancyGrid(data, EDGE), robot=NOVA), "narrow_door")
    width = float(finding.message.split("door of ")[1].split(" m")[0])
    assert abs(width - 0.4) <= 0.06
    assert near(finding, 4.0, 4.0)


def test_start_and_goal_in_different_rooms_are_reported():
    grid = changed(map_of(room()), (0.9, 2.2, 1.1, 3.0, 100))
    finding = check_grid(grid, robot=NOVA, start=(-1.0, 3.0), goals=[(2.5, 2.5)]).findings[0]
    assert finding.kind == "disconnected"
    assert finding.severity == "error"
    assert finding.where == (2.5, 2.5)
    assert check_grid(grid, start=(-1.0, 3.0), goals=[(2.5, 2.5)]).findings == ()
    assert check_grid(map_of(room()), robot=NOVA, start=(-1.0, 3.0), goals=[(2.5, 2.5)]).findings == ()


@pytest.mark.parametrize(
    ("start", "words"),
    [
        ((30.0, 0.0), "outside the map"),
        ((-3.0, 0.6), "in an obstacle"),
        ((-2.0, 3.5), "in unknown space"),
        ((-3.97, 3.0), "too near to a wall"),
    ],
)
def test_a_start_that_is_no_place_is_reported(start, words):
    grid = changed(map_of(room()), (-2.4, 3.1, -1.6, 3.9, -1))
    finding = check_grid(grid, robot=NOVA, start=start).findings[0]
    assert finding.kind == "disconnected"
    assert words in finding.message


def test_a_start_on_an_island_is_reported():
    grid = changed(map_of(room()), (-2.6, 2.9, -1.4, 4.1, 100), (-2.5, 3.0, -1.5, 4.0, 0))
    kinds = [finding.kind for finding in check_grid(grid, start=(-2.0, 3.5)).findings]
    assert kinds == ["disconnected", "island"]
