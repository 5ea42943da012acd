import math
import re

import numpy as np
import pytest

from support.planted_maps import (
    EDGE,
    changed,
    long_room,
    map_of,
    moved,
    redrawn,
    room,
    round_room,
    same,
    square_room,
    surveyed,
    turned,
    warehouse,
)
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.maps.check import PLACEMENT_KINDS, check_grid
from trundle.worlds import World

WORLDS = pytest.mark.parametrize("make", [room, warehouse])


@WORLDS
def test_a_good_map_raises_nothing(make):
    report = check_grid(map_of(make()), world=make())
    assert report.findings == ()
    assert (report.unverified, report.ambiguous, report.corrected) == ((), (), None)


def test_without_a_world_the_place_is_unverified():
    report = check_grid(redrawn(map_of(room()), map_of(room()).data[::-1]))
    assert report.findings == ()
    assert report.unverified == PLACEMENT_KINDS
    assert report.corrected is None


@WORLDS
@pytest.mark.parametrize(
    ("plant", "kinds", "words"),
    [
        (lambda data: data[::-1], {"flipped"}, "top and bottom"),
        (lambda data: data[:, ::-1], {"flipped"}, "left and right"),
        (lambda data: np.rot90(data, 1), {"rotated"}, "turned by 90°"),
        (lambda data: np.rot90(data, 2), {"rotated"}, "turned by 180°"),
        (lambda data: np.rot90(data, 3), {"rotated"}, "turned by 270°"),
        (lambda data: data.T, {"flipped", "rotated"}, "along a diagonal"),
    ],
)
def test_an_image_that_lies_wrong_is_found_and_put_right(make, plant, kinds, words):
    grid = map_of(make())
    report = check_grid(redrawn(grid, plant(grid.data)), world=make())
    assert report.kinds() == kinds
    assert all(words in finding.message and finding.severity == "error" for finding in report.findings)
    assert report.corrected is not None
    assert same(report.corrected, grid)
    assert set(report.corrected_kinds) == kinds


def test_the_yaw_that_is_offered_does_put_a_rotated_image_right():
    grid = map_of(room())
    for turns in (1, 2, 3):
        turned = redrawn(grid, np.rot90(grid.data, turns))
        fix = check_grid(turned, world=room()).findings[0].fix
        x, y, yaw = (float(number) for number in fix.split("origin: [")[-1].split("]")[0].split(","))
        again = check_grid(OccupancyGrid(turned.data, EDGE, Pose2D(x, y, yaw)), world=room())
        assert again.kinds() == {"yaw_ignored"}


@WORLDS
@pytest.mark.parametrize("offset", [(1, 0), (0, -1), (7, -4), (60, 25), (3.5, 0.5)])
def test_a_shifted_map_is_found_with_its_offset(make, offset):
    grid = map_of(make())
    report = check_grid(moved(grid, *offset), world=make())
    assert report.kinds() == {"shifted"}
    assert f"({-offset[0]:+g}, {-offset[1]:+g}) cells" in report.findings[0].message
    assert same(report.corrected, grid)


@WORLDS
@pytest.mark.parametrize("offset", [(0.5, 0.5), (-0.5, 0.5), (0.5, 0.0)])
def test_half_a_cell_is_found(make, offset):
    grid = map_of(make())
    report = check_grid(moved(grid, *offset), world=make())
    assert report.kinds() == {"half_cell"}
    assert same(report.corrected, grid)


def test_a_rotated_map_that_is_half_a_cell_off_is_both():
    grid = map_of(room())
    report = check_grid(moved(redrawn(grid, np.rot90(grid.data)), 0.5, 0.5), world=room())
    assert report.kinds() == {"rotated", "half_cell"}
    assert same(report.corrected, grid)


@pytest.mark.parametrize("offset", [2.6, -0.6, 11.4])
def test_any_offset_is_found_to_an_eighth_of_a_cell(offset):
    grid = map_of(room())
    report = check_grid(moved(grid, offset, 0.0), world=room())
    assert report.kinds() == {"half_cell" if abs(offset) < 1 else "shifted"}
    assert abs(report.corrected.origin.x - grid.origin.x) <= 0.126 * EDGE


def test_a_quarter_of_a_cell_is_nothing():
    assert check_grid(moved(map_of(room()), 0.25, -0.2), world=room()).findings == ()


def test_a_map_is_found_although_parts_of_it_are_wrong():
    grid = changed(map_of(warehouse()), (-12.0, -4.0, -9.0, -2.0, -1), (8.0, 8.5, 9.0, 9.0, 100))
    noisy = grid.data.copy()
    noisy[np.random.default_rng(0).random(noisy.shape) < 0.01] = 100
    report = check_grid(moved(redrawn(grid, noisy[:, ::-1]), 4.0, 0.0), world=warehouse())
    assert {"flipped", "shifted"} <= report.kinds()
    assert report.corrected.origin == map_of(warehouse()).origin


def test_a_part_of_the_world_is_found_where_it_is():
    grid = map_of(warehouse())
    part = OccupancyGrid(grid.data[:220, 40:400], EDGE, Pose2D(grid.origin.x + 40 * EDGE + 0.15, grid.origin.y - 0.1))
    report = check_grid(part, world=warehouse())
    shifted = next(finding for finding in report.findings if finding.kind == "shifted")
    assert "(-3, +2) cells" in shifted.message


def test_a_turned_map_is_compared_where_it_lies():
    grid = map_of(room())
    corner = Pose2D(grid.origin.x, grid.origin.y + grid.shape[0] * EDGE, -math.pi / 2)
    turned = OccupancyGrid(np.rot90(grid.data, -1), EDGE, corner)
    report = check_grid(turned, world=room())
    assert report.kinds() == {"yaw_ignored"}
    assert same(report.corrected, grid)


@pytest.mark.parametrize("plant", [lambda data: data, lambda data: data[::-1], lambda data: np.rot90(data)])
def test_in_a_symmetric_world_nothing_is_claimed(plant):
    grid = map_of(square_room())
    report = check_grid(redrawn(grid, plant(grid.data)), world=square_room())
    assert report.findings == ()
    assert set(report.ambiguous) == {"flipped", "rotated"}
    assert report.corrected is None
    assert "looks the same in" in report.remarks[0]


def test_in_a_symmetric_world_a_wrong_map_is_not_put_right_by_guess():
    grid = map_of(long_room())
    report = check_grid(redrawn(grid, np.rot90(grid.data)), world=long_room())
    assert report.kinds() == {"rotated"}
    assert "rotated" in report.ambiguous
    assert report.corrected is None
    assert "nothing is corrected automatically" in report.findings[0].fix


def test_in_a_symmetric_world_a_shift_is_certain():
    grid = map_of(square_room())
    report = check_grid(moved(grid, 3, 2), world=square_room())
    assert report.kinds() == {"shifted"}
    assert same(report.corrected, grid)


@pytest.mark.slow
def test_a_map_of_another_world_is_unverified():
    report = check_grid(map_of(room()), world=World.generate("warehouse", seed=7))
    assert not {*PLACEMENT_KINDS} & report.kinds()
    assert report.unverified == PLACEMENT_KINDS


@pytest.mark.slow
def test_cells_of_another_size_are_found():
    grid = map_of(room())
    report = check_grid(OccupancyGrid(grid.data, 0.1, grid.origin), world=room())
    assert report.kinds() == {"resolution"}
    assert report.has_errors
    assert "0.05" in report.findings[0].message


def test_a_world_or_a_map_with_nothing_in_it_is_unverified():
    assert check_grid(map_of(room()), world=World("nothing", ())).unverified == PLACEMENT_KINDS
    empty = redrawn(map_of(room()), np.zeros((20, 20), dtype=np.int8))
    assert check_grid(empty, world=room()).unverified == PLACEMENT_KINDS


# Turned by any angle ------------------------------------------------------------------------------------------------


def reported_turn(report):
    """The angle [°], counter-clockwise, that a report says to turn the map by, and about what."""
    (finding,) = (finding for finding in report.findings if finding.kind == "rotated")
    assert finding.severity == "error"
    number, direction, about = re.search(r"turned ([0-9.]+)° (\S+) about (.*) \(agreement", finding.message).groups()
    return float(number) * {"clockwise": -1.0, "counter-clockwise": 1.0}[direction], about


def placement(report):
    return report.kinds() & set(PLACEMENT_KINDS)


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [2.0, -7.0, 44.0])
def test_a_map_turned_by_any_angle_is_found_and_put_right(degrees):
    report = check_grid(turned(map_of(room()), degrees), world=room())
    assert placement(report) == {"rotated"}
    angle, about = reported_turn(report)
    assert abs(angle + degrees) <= 0.1
    assert about in ("its middle", "the map frame's origin")
    assert report.corrected.origin.yaw == 0.0
    again = check_grid(report.corrected, world=room())
    assert not {*PLACEMENT_KINDS, "yaw_ignored"} & again.kinds()
    assert again.unverified == ()


@pytest.mark.slow
def test_the_origin_that_is_offered_puts_a_turned_map_right():
    wrong = turned(map_of(room()), -7.0)
    fix = next(finding.fix for finding in check_grid(wrong, world=room()).findings if finding.kind == "rotated")
    x, y, yaw = (float(number) for number in re.search(r"origin: \[(.*?)\]", fix)[1].split(","))
    report = check_grid(OccupancyGrid(wrong.data, EDGE, Pose2D(x, y, yaw)), world=room())
    assert placement(report) == set()
    assert "yaw_ignored" in report.kinds()


def test_a_wrong_yaw_in_the_file_is_taken_out_again():
    grid = map_of(room())
    report = check_grid(OccupancyGrid(grid.data, EDGE, Pose2D(grid.origin.x, grid.origin.y, 0.3)), world=room())
    assert report.kinds() == {"rotated", "yaw_ignored"}
    angle, about = reported_turn(report)
    assert abs(angle + math.degrees(0.3)) <= 0.05
    assert about == "its lower-left corner"
    assert report.corrected.origin.yaw == 0.0
    assert math.dist(report.corrected.origin.as_tuple(), grid.origin.as_tuple()) <= 0.25 * EDGE
    assert np.array_equal(report.corrected.data, grid.data)


def test_a_turned_map_can_be_flipped_and_shifted_as_well():
    wrong = turned(map_of(room()), 12.0, right=2.0, up=-1.0)
    report = check_grid(redrawn(wrong, wrong.data[::-1]), world=room())
    assert placement(report) == {"flipped", "rotated", "shifted"}
    assert placement(check_grid(report.corrected, world=room())) == set()


@pytest.mark.slow
@WORLDS
def test_a_noisy_map_of_a_part_with_moved_things_is_found_at_its_angle(make):
    report = check_grid(turned(surveyed(map_of(make()), 1), -12.0, right=1.0, up=0.6), world=make())
    assert placement(report) == {"rotated", "shifted"}
    assert abs(reported_turn(report)[0] - 12.0) <= 0.15
    assert placement(check_grid(report.corrected, world=make())) == set()


@pytest.mark.parametrize("name", ["warehouse", "office", "maze", "cylinders", "corridors", "lot"])
def test_a_noisy_map_of_a_part_that_lies_right_raises_nothing(name):
    world = World.generate(name, seed=1)
    report = check_grid(surveyed(map_of(world), 2), world=world)
    assert placement(report) == set()
    assert report.unverified == ()


def test_what_a_noisy_map_lacks_is_filled_with_its_walls():
    survey = surveyed(map_of(warehouse()), 1)
    report = check_grid(redrawn(survey, survey.data[::-1]), world=warehouse())
    assert {"flipped", "unseen", "leak"} <= report.kinds()
    again = check_grid(report.corrected, world=warehouse()).kinds()
    assert not again & {*PLACEMENT_KINDS, "unseen", "leak", "unknown_hole"}


def test_a_turned_map_of_a_round_room_is_not_put_right_by_guess():
    report = check_grid(turned(map_of(round_room()), 20.0), world=round_room())
    assert placement(report) == {"rotated"}
    assert "rotated" in report.ambiguous
    assert "nothing is corrected automatically" in report.findings[0].fix
    assert report.corrected is None or "rotated" not in report.corrected_kinds


def test_a_map_of_one_occupied_cell_is_not_compared():
    data = np.zeros((100, 100), dtype=np.int8)
    data[50, 50] = 100
    (finding,) = [one for one in check_grid(OccupancyGrid(data, EDGE), world=room()).findings if one.kind == "mismatch"]
    assert "the map has 1 occupied cells, too few to tell its place by" in finding.message
