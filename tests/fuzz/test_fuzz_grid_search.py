from __future__ import annotations

import numpy as np
import pytest

from fuzz import fuzz_grid_search
from trundle.planning import GridPath, GridSearch


def test_hundreds_of_maps_and_updates_are_searched_alike_by_all_methods():
    assert fuzz_grid_search.run(seed=1, count=300) == 300


def test_a_method_that_finds_another_way_is_noticed(monkeypatch):
    search = GridSearch.shortest_path

    def longer(self, start, goal, **limits):
        path = search(self, start, goal, **limits)
        detour = 2.0 if self.method == "astar" else 0.0
        return GridPath(path.status, path.length + detour, path.corners)

    monkeypatch.setattr(GridSearch, "shortest_path", longer)
    with pytest.raises(AssertionError):
        fuzz_grid_search.run(seed=1, count=50)


def test_a_refused_update_changes_nothing():
    search = GridSearch(np.zeros((4, 4), bool))
    with pytest.raises(ValueError, match="shape"):
        search.update((0, 2), (0, 2), np.ones((3, 2), bool))
    assert search.shortest_path((0, 0), (1, 1)).status == "found"
