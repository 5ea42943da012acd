"""A small map."""

import numpy as np
import pytest

from trundle.maps import OccupancyGrid


@pytest.fixture(scope="session")
def room():
    """A walled room of 8 by 6 m with its lower-left corner at the map's origin, and a block from the south."""
    data = np.zeros((120, 160), dtype=np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    data[:60, 72:88] = 100
    return OccupancyGrid(data, 0.05)
