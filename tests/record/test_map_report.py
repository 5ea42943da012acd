import numpy as np

from support.planted_maps import changed, map_of, room
from trundle.maps.check import check_grid
from trundle.record.colors import WARNING
from trundle.record.map_report import count_by_severity, draw_report


def test_a_report_shows_a_ring_at_each_place_and_a_line_for_each_finding():
    grid = changed(map_of(room()), (-2.5, 3.0, -1.5, 4.0, -1), (2.0, 2.0, 2.05, 2.05, 100))
    report = check_grid(grid)
    assert count_by_severity(report) == "2 warnings"
    picture = np.asarray(draw_report(grid, report, title="room"))
    plain = np.asarray(draw_report(grid, check_grid(map_of(room())), title="room"))
    assert picture.shape[0] > plain.shape[0]
    assert (picture == WARNING).all(axis=2).sum() > 200
    assert not (plain == WARNING).all(axis=2).any()
