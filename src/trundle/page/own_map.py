"""The map that a robot makes, as the page draws it while it grows: cells, poses, loops and the largest corrections."""

from __future__ import annotations

from typing import Any

from trundle.maps import OccupancyGrid
from trundle.maps.cells import round_trinary
from trundle.mission.own_map import MapTrack
from trundle.page.encoding import grid_png, pack_array, rounded

_MOST_POSES, _MOST_LOOPS = 20_000, 5_000
"""More would hide the map, and take longer to send than its picture."""


def own_map_of(grid: OccupancyGrid, track: MapTrack | None) -> dict[str, Any]:
    """Return a map as `grid_png` does, with occupied, free and unknown cells alone, and what it comes from.

    Args:
        grid: The map.
        track: Poses, loops and corrections; None where they are not known.

    Returns:
        As `grid_png`, and "poses" (N, 2) [m] and "loops" (M, 4) [m], both ends of each, packed; "corrections" [[x, y,
        metres]].
    """
    # Shares of beams differ from cell to cell, and would make the picture four times as large.
    plain = OccupancyGrid(round_trinary(grid.data), grid.resolution, grid.origin)
    shown: dict[str, Any] = {**grid_png(plain), "poses": None, "loops": None, "corrections": []}
    if track is None:
        return shown
    places = track.poses[:, :2]
    step = -(-len(places) // _MOST_POSES) or 1
    return shown | {
        "poses": pack_array(places[::step], "f4"),
        "loops": pack_array(places[track.loops[-_MOST_LOOPS:]].reshape(-1, 4), "f4"),
        "corrections": [rounded((one.x, one.y, one.moved_m), 3) for one in track.corrections],
    }
