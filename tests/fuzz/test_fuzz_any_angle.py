from __future__ import annotations

import dataclasses

import pytest

from fuzz import fuzz_any_angle
from trundle.planning import GridSearch


def test_a_hundred_maps_and_updates_are_searched_as_the_oracle_says():
    assert fuzz_any_angle.run(seed=1, count=100) == 100


def test_a_way_that_is_longer_than_the_oracles_is_noticed(monkeypatch):
    search = GridSearch.any_angle_path

    def longer(self, start, goal, **options):
        path = search(self, start, goal, **options)
        return dataclasses.replace(path, length=path.length * (1.0 + 1e-9))

    monkeypatch.setattr(GridSearch, "any_angle_path", longer)
    with pytest.raises(AssertionError):
        fuzz_any_angle.run(seed=1, count=100)
