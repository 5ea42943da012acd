"""Missions in the kernel, and the same ones step by step in Python: `Session` with the kinematic simulator."""

import numpy as np
import pytest

from trundle.maps import OccupancyGrid
from trundle.mission import Episode, Scenario
from trundle.mission.batch.missions import BatchMission, MissionBatch
from trundle.mission.metrics import measure_truth

TOLERANCE = 1e-9
"""Of poses [m, rad] and commands [m/s, rad/s]; on one machine they are equal bit for bit."""

SMALL = {"name": "warehouse", "options": {"size": [14, 11]}, "seed": 3}


def scenario(**settings) -> Scenario:
    return Scenario.make(**{"world": SMALL, "backend": "kinematic", "robot": "nova_carter"} | settings)


def in_python(chosen: Scenario) -> Episode:
    with chosen.build() as mission:
        return mission.run()


def in_kernel(chosen: Scenario):
    (end,) = MissionBatch().drive([BatchMission(chosen.prepare(), measure_truth)])
    return end


def assert_alike(one: Episode, other: Episode) -> None:
    assert (one.outcome, one.message, one.goals_reached) == (other.outcome, other.message, other.goals_reached)
    assert len(one.trajectory) == len(other.trajectory)
    for name in one.trajectory.columns():
        ours, theirs = getattr(one.trajectory, name), getattr(other.trajectory, name)
        assert np.abs(ours - theirs).max() <= TOLERANCE, name
    assert np.array_equal(one.paths[0].poses, other.paths[0].poses)
    assert one.metrics.min_clearance_m == pytest.approx(other.metrics.min_clearance_m, abs=TOLERANCE)
    assert one.metrics.standing_reasons == other.metrics.standing_reasons


def wall(doorway: bool) -> OccupancyGrid:
    cells = np.zeros((80, 120), dtype=np.int8)
    cells[:2] = cells[-2:] = cells[:, :2] = cells[:, -2:] = cells[:, 58:62] = 100
    if doorway:
        cells[10:30, 58:62] = 0
    return OccupancyGrid(cells, 0.05)
