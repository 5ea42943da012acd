import re

import numpy as np
import pytest

from support.planted_maps import EDGE, map_of, redrawn, room, same, surveyed, warehouse
from trundle.geometry.solids import Box, Solid
from trundle.maps import OccupancyGrid
from trundle.maps.check import PLACEMENT_KINDS, check_grid, check_map
from trundle.worlds import World


def scaled(grid, across, up):
    """A map with so many times the columns and rows, and the same resolution."""
    rows, cols = grid.shape
    row = np.minimum(((np.arange(round(rows * up)) + 0.5) / up).astype(int), rows - 1)
    col = np.minimum(((np.arange(round(cols * across)) + 0.5) / across).astype(int), cols - 1)
    return redrawn(grid, grid.data[np.ix_(row, col)])


@pytest.mark.parametrize("name", ["office", "maze"])
def test_a_map_that_is_stretched_along_one_axis_is_not_said_to_be_shifted(name):
    world = World.generate(name, seed=3)
    report = check_grid(scaled(map_of(world), 1.03, 1.0), world=world)
    assert "resolution" in report.kinds()
    assert not set(PLACEMENT_KINDS) & report.kinds()
    assert "resolution" not in report.corrected_kinds
    finding = next(finding for finding in report.findings if finding.kind == "resolution")
    assert finding.severity == "error"
    width, height = re.search(r"cells of ([0-9.]+) x ([0-9.]+) m fit", finding.message).groups()
    assert float(width) == pytest.approx(EDGE / 1.03, rel=3e-3)
    assert float(height) == pytest.approx(EDGE, rel=1e-3)
    assert "too long along its width" in finding.message
    assert "moving the origin does not help" in finding.fix


def test_a_stretch_along_the_other_axis_names_that_axis():
    report = check_grid(scaled(map_of(warehouse()), 1.0, 0.96), world=warehouse())
    (finding,) = (finding for finding in report.findings if finding.kind == "resolution")
    assert "too short along its height" in finding.message


@pytest.mark.parametrize("factor", [1.05, 2.0])
def test_cells_of_the_wrong_size_are_reported_with_the_size_that_fits(factor):
    report = check_grid(scaled(map_of(warehouse()), factor, factor), world=warehouse())
    assert not set(PLACEMENT_KINDS) & report.kinds()
    (finding,) = (finding for finding in report.findings if finding.kind == "resolution")
    resolution = float(re.search(r"write resolution: ([0-9.]+)", finding.fix)[1])
    assert resolution == pytest.approx(EDGE / factor, rel=4e-3)
    again = check_grid(OccupancyGrid(scaled(map_of(warehouse()), factor, factor).data, resolution), world=warehouse())
    assert "shifted" in again.kinds() or not again.findings
    assert "resolution" not in again.kinds()


def test_a_stretched_map_may_be_flipped_as_well():
    stretched = scaled(map_of(warehouse()), 1.03, 1.0)
    report = check_grid(redrawn(stretched, stretched.data[::-1]), world=warehouse())
    assert "resolution" in report.kinds()
    assert "shifted" not in report.kinds()


def test_a_noisy_map_is_not_said_to_be_stretched():
    for seed in (3, 4):
        report = check_grid(surveyed(map_of(warehouse()), seed), world=warehouse())
        assert not {"resolution", "mismatch", "negated"} & report.kinds()


@pytest.mark.parametrize("make", [room, warehouse])
def test_a_map_whose_greys_are_exchanged_is_read_the_other_way(make, tmp_path):
    grid = map_of(make())
    grid.save(tmp_path / "map.yaml")
    file = tmp_path / "map.yaml"
    file.write_text(file.read_text().replace("negate: 0", "negate: 1"))
    report = check_map(file, world=make())
    assert [finding.kind for finding in report.findings] == ["negated"]
    assert report.has_errors
    assert "exchange `negate`" in report.findings[0].fix
    assert same(report.corrected, grid)
    assert report.corrected_kinds == ("negated",)
    assert same(report.grid, grid)


def test_a_grid_whose_values_are_exchanged_is_read_the_other_way():
    grid = map_of(room())
    exchanged = np.where(grid.data == -1, -1, 100 - grid.data).astype(np.int8)
    report = check_grid(redrawn(grid, exchanged[:, ::-1]), world=room())
    assert report.kinds() == {"negated", "flipped"}
    assert same(report.corrected, grid)


def test_a_map_that_agrees_nowhere_is_an_error():
    random = np.random.default_rng(5)
    boxes = [
        Solid(f"box {n}", Box((*random.uniform(0.3, 1.5, 2), 1.0)), pose=pose)
        for n, pose in enumerate(map_poses(random, 25))
    ]
    other = World("elsewhere", tuple(boxes), seeds=((30.0, 30.0),))
    report = check_grid(map_of(room()), world=other)
    assert "mismatch" in report.kinds()
    finding = next(finding for finding in report.findings if finding.kind == "mismatch")
    assert finding.severity == "error"
    assert "agrees with the world nowhere" in finding.message
    assert report.unverified == PLACEMENT_KINDS


def map_poses(random, count):
    from trundle.geometry import Pose3D

    return [Pose3D.planar(*random.uniform(0.0, 30.0, 2), 0.5, random.uniform(0.0, 3.0)) for _ in range(count)]


def test_a_world_that_cannot_be_compared_is_said():
    report = check_grid(map_of(room()), world=World("nothing", ()))
    (finding,) = report.findings
    assert (finding.kind, finding.severity) == ("mismatch", "warning")
    assert "the world has no solids" in finding.message
