import numpy as np

from support.planted_maps import changed, map_of, room
from trundle.maps.check import check_grid
from trundle.pictures.colors import BAD, GOOD, WARNING
from trundle.pictures.figure import plain
from trundle.record.map_report import count_by_severity, draw_report
from trundle.worlds import World


def test_a_report_shows_a_ring_at_each_place_and_a_line_for_each_finding():
    grid = changed(map_of(room()), (-2.5, 3.0, -1.5, 4.0, -1), (2.0, 2.0, 2.05, 2.05, 100))
    report = check_grid(grid)
    assert count_by_severity(report) == "2 warnings"
    picture = np.asarray(draw_report(grid, report, title="room"))
    clean = np.asarray(draw_report(grid, check_grid(map_of(room())), title="room"))
    assert picture.shape[0] > clean.shape[0]
    assert (picture == WARNING).all(axis=2).sum() > 200
    assert not (clean == WARNING).all(axis=2).any()


def test_findings_of_one_kind_share_a_line():
    grid = map_of(room())
    one = changed(grid, (2.0, 2.0, 2.05, 2.05, 100))
    many = changed(one, (2.5, 2.0, 2.55, 2.05, 100), (-2.0, 3.0, -1.95, 3.05, 100), (-2.0, 4.0, -1.95, 4.05, 100))
    few, more = (draw_report(made, check_grid(made), title="room") for made in (one, many))
    assert few.size == more.size
    ringed = [(np.asarray(picture) == WARNING).all(axis=2).sum() for picture in (few, more)]
    assert ringed[1] > 2 * ringed[0]


def test_a_map_that_agrees_with_its_world_nowhere_is_not_shown_in_green():
    grid = map_of(room())
    report = check_grid(grid, world=World.generate("office", seed=1))
    assert "mismatch" in report.kinds()
    picture = np.asarray(draw_report(grid, report, title="room"))
    assert (picture == BAD).all(axis=2).any()
    assert not (picture == GOOD).all(axis=2).any()


def test_all_of_a_findings_letters_can_be_drawn():
    assert plain("0.48 m² at 90°") == "0.48 m2 at 90°"
