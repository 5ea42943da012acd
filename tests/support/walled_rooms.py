"""Maps of free rooms with walls."""

import numpy as np

from trundle.maps import OccupancyGrid


def walled_room(*boxes, width=12.0, depth=8.0):
    """A free room with walls of one cell and its lower-left corner at (0, 0), and boxes (x0, y0, x1, y1) [m] in it."""
    data = np.zeros((round(depth / 0.05), round(width / 0.05)), dtype=np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    for x0, y0, x1, y1 in boxes:
        data[round(y0 / 0.05) : round(y1 / 0.05), round(x0 / 0.05) : round(x1 / 0.05)] = 100
    return OccupancyGrid(data, 0.05)
