"""`trundle.simulate(world, robot, lidar=True)` and `trundle.run(sim, navigator, …)` need no further setup."""

import numpy as np

import trundle
from trundle.geometry import Pose3D
from trundle.maps import OccupancyGrid
from trundle.solids import Box, Solid
from trundle.worlds import World


def run_with(lidar):
    cells = np.zeros((120, 200), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    grid = OccupancyGrid(cells, 0.05)
    empty = World.from_map(grid)
    box = Solid("surprise", Box((0.8, 0.8, 1.0)), Pose3D((5.0, 3.0, 0.5)))
    world = World("room", (*empty.solids, box), empty.seeds)
    navigator = trundle.Navigator(grid, "nova_carter")
    with trundle.simulate(world, "nova_carter", backend="kinematic", lidar=lidar) as sim:
        return trundle.run(sim, navigator, (1.5, 3.0, 0.0), (8.5, 3.0))


def test_a_run_with_lidars_avoids_what_is_not_on_the_map():
    episode = run_with(lidar=True)
    assert episode.arrived
    assert episode.metrics.contacts == ()
    assert episode.metrics.monitor_stops is not None


def test_a_run_without_lidars_drives_into_it():
    episode = run_with(lidar=False)
    assert episode.metrics.contacts == ("surprise",)
    assert episode.metrics.monitor_stops is None
