from __future__ import annotations

import dataclasses

import pytest

from fuzz import fuzz_hybrid_astar
from trundle.planning.hybrid_astar import HybridAStarPlanner


def test_hundreds_of_maps_and_options_give_free_paths_or_typed_errors():
    rounds, paths = fuzz_hybrid_astar.run(seed=1, count=700)
    assert rounds == 700
    assert paths > 70


def test_a_path_that_leaves_the_free_space_is_noticed(monkeypatch):
    plan = HybridAStarPlanner.plan

    def moved(self, costmap, start, goal, **options):
        path = plan(self, costmap, start, goal, **options)
        poses = path.poses.copy()
        poses[1:-1, :2] += 0.5 * costmap.resolution * max(costmap.shape)
        return dataclasses.replace(path, poses=poses)

    monkeypatch.setattr(HybridAStarPlanner, "plan", moved)
    with pytest.raises(AssertionError):
        fuzz_hybrid_astar.run(seed=1, count=100)
