"""What the tests of the command line share."""

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid


@dataclass(frozen=True)
class Done:
    """A finished command: its exit code and what it printed."""

    code: int
    out: str
    err: str

    @property
    def json(self):
        """The one JSON value on stdout."""
        return json.loads(self.out)


Trundle = Callable[..., Done]

_STOPPED = """
import os, sys
from trundle.cli import main
from trundle.sim.kinematic import KinematicSimulator

number, left, step = int(sys.argv.pop(1)), 100, KinematicSimulator.step

def step_or_stop(*given):
    global left
    left -= 1
    if left == 0:
        os.kill(os.getpid(), number)
    return step(*given)

KinematicSimulator.step = step_or_stop
main()
"""


def stopped(number: int, *arguments: str) -> list[str]:
    """The command of a `trundle` that gets a signal in its hundredth control period, on the kinematic simulator."""
    return [sys.executable, "-c", _STOPPED, str(int(number)), *arguments, "--backend=kinematic"]


def room(width_m: float = 8.0, depth_m: float = 5.0, door_m: float | None = None) -> OccupancyGrid:
    """A walled room with its lower-left corner at (-1, -1); with a door, a wall across it that has a gap so wide."""
    rows, cols = round(depth_m / 0.05), round(width_m / 0.05)
    data = np.zeros((rows, cols), dtype=np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    if door_m is not None:
        half = round(door_m / 0.1)
        data[: rows // 2 - half, cols // 2] = data[rows // 2 + half :, cols // 2] = 100
    return OccupancyGrid(data, 0.05, Pose2D(-1.0, -1.0))
