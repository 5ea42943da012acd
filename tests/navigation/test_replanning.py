"""A robot in MuJoCo between two paths of equal cost, on a map that keeps changing."""

import numpy as np
import pytest

from support.walled_rooms import walled_room
from trundle.mission import Outcome, run
from trundle.navigation import Navigator, NavigatorSettings
from trundle.sim import simulate
from trundle.worlds import World


class Flicker:
    """Puts new specks near both paths every quarter of a second, and records on which side each path passes."""

    def __init__(self, navigator):
        self.navigator, self.base = navigator, navigator.costmap
        self.rng = np.random.default_rng(1)
        self.paths, self.above = [], []

    def on_start(self, info):
        pass

    def on_step(self, step):
        if step.index % 5 == 0:
            costmap = self.base
            for _ in range(6):
                col, row = int(self.rng.integers(60, 180)), int(self.rng.choice([8, 14, 144, 150]))
                costmap = costmap.update(slice(row, row + 2), slice(col, col + 2), 100)
            self.navigator.static_costmap = costmap
        new = step.path is not None and (not self.paths or step.path is not self.paths[-1])
        if new and step.state.pose.x < 10.0:  # over the last few centimetres any path is cheaper by the margin
            self.paths.append(step.path)
            poses = step.path.poses
            if step.state.pose.x < 5.0:
                self.above.append(bool(poses[np.argmin(abs(poses[:, 0] - 6.0)), 1] > 4.0))

    def on_end(self, episode):
        pass


def flips(planner, margin):
    """How often the robot changes sides before the block, and how many paths it takes."""
    grid = walled_room((5.0, 2.6, 7.0, 5.4))
    navigator = Navigator(
        grid, "nova_carter", planner=planner, settings=NavigatorSettings(replan_interval_s=0.5, replan_margin=margin)
    )
    flicker = Flicker(navigator)
    with simulate(World.from_map(grid), navigator.robot, backend="mujoco") as sim:
        episode = run(sim, navigator, (1.0, 4.0, 0.0), (10.5, 4.0, 0.0), observers=[flicker])
    assert episode.outcome is Outcome.ARRIVED
    assert navigator.replans > 20
    return int(np.count_nonzero(np.diff(np.array(flicker.above, dtype=int)))), len(flicker.paths)


@pytest.mark.parametrize("planner", ["least_cost", "astar"])
def test_it_keeps_its_path_while_the_map_flickers(planner):
    count, paths = flips(planner, 0.1)
    assert count == 0
    assert paths <= 3


def test_without_a_margin_the_map_decides_each_time():
    assert flips("least_cost", 0.0)[1] > 20
