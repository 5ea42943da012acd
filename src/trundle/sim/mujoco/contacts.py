"""Which contacts of a MuJoCo state count, under which names."""

from __future__ import annotations

import math

import mujoco
import numpy as np

from trundle.geometry import Pose2D
from trundle.sim.mujoco.world_parts import FLOOR, solid_of
from trundle.sim.simulator import Contact
from trundle.solids import OccupancyCells, Solid
from trundle.worlds import World


class ContactReader:
    """Reads the robot's contacts with everything but the floor.

    Args:
        model: The compiled world and robot.
        world: What the model was built from.
    """

    def __init__(self, model: mujoco.MjModel, world: World) -> None:
        self._model = model
        self._floor = model.geom(FLOOR).id
        self._cells = {
            solid.name: (solid, solid.shape) for solid in world.solids if isinstance(solid.shape, OccupancyCells)
        }

    def read(self, data: mujoco.MjData, touched: dict[tuple[str, str], Contact]) -> None:
        """Add what the robot touches now to `touched`, by part and solid; the first place of each pair stays."""
        pairs = data.contact.geom.tolist()
        for index, pair in enumerate(pairs):
            if self._floor in pair:
                continue
            own, other = sorted(pair, key=lambda geom: self._model.geom_bodyid[geom] == 0)
            x, y, _ = data.contact.pos[index].tolist()
            part = self._model.geom(own).name.removeprefix("robot:")
            name = solid_of(self._model.geom(other).name)
            if name in self._cells:
                solid, cells = self._cells[name]
                name = f"{name}[{','.join(map(str, nearest_blocked_cell(solid, cells, x, y)))}]"
            touched.setdefault((part, name), Contact(part, name, x, y))


def nearest_blocked_cell(solid: Solid, cells: OccupancyCells, x: float, y: float) -> tuple[int, int]:
    """The blocked cell (row, col) nearest to a point [m] in the map frame, of the point's cell and its neighbours."""
    origin = Pose2D(solid.pose.position[0], solid.pose.position[1], solid.pose.yaw())
    local = origin.inverse() @ Pose2D(x, y)
    along, across = local.x / cells.resolution, local.y / cells.resolution
    rows, cols = cells.blocked.shape
    row = min(max(math.floor(across), 0), rows - 1)
    col = min(max(math.floor(along), 0), cols - 1)
    low_row, low_col = max(row - 1, 0), max(col - 1, 0)
    near = np.argwhere(cells.blocked[low_row : row + 2, low_col : col + 2]) + np.array([low_row, low_col])
    if len(near) == 0:
        return row, col
    best = near[np.argmin(np.hypot(near[:, 0] + 0.5 - across, near[:, 1] + 0.5 - along))]
    return int(best[0]), int(best[1])
