"""What the localizer amcl makes of beams that end before, and behind, what is on its map."""

from __future__ import annotations

import numpy as np
import pytest

from trundle.geometry import Pose2D
from trundle.localization.amcl.amcl_settings import AmclSettings
from trundle.localization.amcl.beams import Beams
from trundle.localization.amcl.hypotheses import Hypotheses
from trundle.localization.amcl.map_field import MapField
from trundle.maps import OccupancyGrid

MIDDLE = Pose2D(4.0, 4.0, 0.0)


@pytest.mark.parametrize(("others_end", "state"), [(0.4, "localized"), (1.3, "lost")])
def test_beams_through_walls_make_it_lost_and_beams_that_end_too_soon_do_not(others_end, state):
    cells = np.zeros((160, 160), np.uint8)
    cells[:20] = cells[-20:] = 100
    cells[:, :20] = cells[:, -20:] = 100  # a room of 6 by 6 m
    settings = AmclSettings()
    hypotheses = Hypotheses(MapField(OccupancyGrid(cells, 0.05), settings), settings)
    hypotheses.start(MIDDLE, np.diag((1e-6, 1e-6, 1e-6)), confirmed=True)
    angles = np.linspace(-np.pi, np.pi, 60, endpoint=False)
    ways = np.column_stack((np.cos(angles), np.sin(angles)))
    walls = 3.0 / np.abs(ways).max(axis=1)
    walls[np.arange(60) % 5 != 0] *= others_end  # four of five beams
    beams = Beams(ways * walls[:, np.newaxis], np.zeros((60, 2)))
    for _ in range(20):
        hypotheses.compare(beams, 0.1, idea=None, targets=None, wide=False)
    assert hypotheses.main.pose.distance_to(MIDDLE) < 0.05
    assert hypotheses.state == state
