"""`check_layer` accepts the obstacle layer and names what is wrong with others."""

import numpy as np
import pytest

from trundle.costmap import LayeredCostmap, MapWindow, ObstacleLayer, ObstacleLayerSettings
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate
from trundle.robots import Robot
from trundle.testing import ConformanceError, check_layer


@pytest.mark.parametrize(
    "settings",
    [
        None,
        ObstacleLayerSettings(hits_to_mark=1, misses_to_clear=1, clear_static=True),
        ObstacleLayerSettings(observation_persistence=0.1, footprint_clearing_enabled=False),
    ],
)
def test_the_obstacle_layer_passes(settings):
    check_layer(lambda robot: ObstacleLayer(robot, settings))
    check_layer(lambda robot: ObstacleLayer(robot, settings, keep_within=6.0), robot=Robot.load("nova_carter"))


class Silent(ObstacleLayer):
    def update(self, scans, estimate):
        super().update(scans, estimate)


class Forgetless(ObstacleLayer):
    def reset(self):
        self._placer.reset()
        self._last = self._frame = None


class Careless(ObstacleLayer):
    def paint(self, part):
        super().paint(part)
        part.cells[3, 3] = 100


class Odd(ObstacleLayer):
    def paint(self, part):
        part.cells[:] = 7


class Sharing(ObstacleLayer):
    count = 0

    def update(self, scans, estimate):
        type(self).count += 1
        return super().update(scans, estimate)

    def paint(self, part):
        super().paint(part)
        part.cells[0, 0] = 0 if self.count else -1


class Timeless(ObstacleLayer):
    def update(self, scans, estimate):
        try:
            return super().update(scans, estimate)
        except ValueError:
            return None


class Spoiling(ObstacleLayer):
    def update(self, scans, estimate):
        window = super().update(scans, estimate)
        for scan in scans:
            scan.ranges.flags.writeable = True
            scan.ranges[:] = 1.0
        return window


class Pointless(ObstacleLayer):
    def obstacles(self):
        return np.zeros(3)


@pytest.mark.parametrize(
    ("layer", "message"),
    [
        (Silent, "returns None must change nothing"),
        (Forgetless, "after a reset"),
        (Careless, "where kept is not 0"),
        (Odd, "found: .*7"),
        (Sharing, "share nothing"),
        (Timeless, "does not increase"),
        (Spoiling, "modify scans"),
        (Pointless, "shape"),
        (lambda robot: object(), "needs reset"),
    ],
)
def test_a_layer_that_breaks_the_contract_is_named(layer, message):
    with pytest.raises(ConformanceError, match=message):
        check_layer(layer)


def test_a_robot_without_a_lidar_cannot_check_a_layer():
    with pytest.raises(ConformanceError, match="has none"):
        check_layer(ObstacleLayer, robot=Robot.load("nova_carter").model_copy(update={"lidars": {}}))


class Fence:
    """A layer of somebody else's: a line that is always there."""

    def __init__(self):
        self.reset()

    def reset(self):
        self._new = True

    def update(self, scans, estimate):
        changed, self._new = self._new, False
        return MapWindow(1.0, -1.0, 1.0, 1.0) if changed else None

    def paint(self, part):
        points = part.pose.inverse().transform_points(self.obstacles()) / part.resolution
        col, row = np.floor(points).astype(int).T
        inside = (row >= 0) & (col >= 0) & (row < part.cells.shape[0]) & (col < part.cells.shape[1])
        part.cells[row[inside], col[inside]] = 100

    def obstacles(self):
        return np.column_stack([np.full(41, 1.0), np.linspace(-1, 1, 41)])


def test_a_further_layer_is_painted_into_the_costmap():
    grid = OccupancyGrid(np.zeros((120, 120), np.int8), 0.05, Pose2D(-3.0, -3.0))
    layered = LayeredCostmap(grid, Robot.load("nova_carter"), extra_layers=[Fence()])
    layered.update([], Estimate(0.0, Pose2D(-1.0, 0.0)))
    assert layered.sensed.sum() >= 25
    assert len(layered.obstacles()) >= 41
