from collections import Counter
from itertools import pairwise

import numpy as np
import pytest

from trundle.evaluation import Suite
from trundle.evaluation.schedule import EpisodeOrder


def order_of(suite):
    return EpisodeOrder(suite).sort(np.arange(len(suite))).tolist()


def groups_of(suite, indices):
    specs = [suite.spec(index) for index in indices]
    return Counter((spec.world, spec.planner, spec.settings) for spec in specs)


CROSSED = {"planners": ["auto", "astar"], "inflation_radius": [0.3, 0.6], "backends": "kinematic"}
FEW = [{"name": "office", "seed": seed, "label": f"office {seed}"} for seed in range(3)]
MANY = [{"name": "office", "seed": seed, "label": f"office {seed}"} for seed in range(12)]


@pytest.mark.parametrize("worlds", [FEW, MANY, ["office", "warehouse"]])
def test_each_episode_is_there_once_in_the_same_order_each_time(worlds):
    suite = Suite.make(worlds=worlds, missions=7, **CROSSED)
    order = order_of(suite)
    assert sorted(order) == list(range(len(suite)))
    assert order == order_of(Suite.make(worlds=worlds, missions=7, **CROSSED))
    some = np.array(sorted(order[5:50]))
    assert EpisodeOrder(suite).sort(some).tolist() == order[5:50]


@pytest.mark.parametrize("worlds", [FEW, ["office", "warehouse"]])
def test_the_first_episodes_have_as_many_of_each_group(worlds):
    suite = Suite.make(worlds=worlds, missions=9, **CROSSED)
    order = order_of(suite)
    for end in range(0, len(order), 5):
        counts = groups_of(suite, order[:end])
        assert max(counts.values(), default=0) - min(counts.values(), default=0) <= 1 or len(counts) < 4 * len(worlds)
        assert max(counts.values(), default=0) <= end // (4 * len(worlds)) + 1


def test_many_worlds_that_workers_cannot_keep_come_once_each_and_then_in_blocks_of_four():
    suite = Suite.make(worlds=MANY, missions=9, planners=["auto", "astar"])
    worlds = [suite.spec(index).world for index in order_of(suite)]
    runs = [1]
    for one, other in pairwise(worlds):
        runs[-1] += one == other
        runs += [] if one == other else [1]
    assert runs == [2] * 12 + [8] * 24
    assert worlds[:4:2] != ["office 0", "office 1"]  # which may be listed by difficulty
    assert Counter(worlds[24:120]) == dict.fromkeys(set(worlds), 8)


def test_all_planners_of_a_mission_follow_one_another():
    suite = Suite.make(worlds=["office", "warehouse"], planners=["auto", "astar", "least_cost"], missions=5)
    order = order_of(suite)
    for at in range(0, len(order), 3):
        assert len({(suite.spec(index).world, suite.spec(index).seed) for index in order[at : at + 3]}) == 1


def test_a_world_with_more_missions_has_more_of_them_in_any_part():
    worlds = [{"name": "office", "seed": 1, "missions": 40}, {"name": "warehouse", "seed": 1, "missions": 10}]
    suite = Suite.make(worlds=worlds)
    for end in (5, 10, 20, 35):
        counts = Counter(suite.spec(index).world for index in order_of(suite)[:end])
        assert abs(counts["office"] - 0.8 * end) <= 1.0


def test_listed_missions_are_interleaved_with_their_seeds():
    listed = [{"start": (x, 1.0, 0.0), "goal": (5.0, 1.0)} for x in range(8)]
    suite = Suite.make(worlds={"name": "office", "seed": 3}, missions={"seeds": 4, "listed": listed})
    starts = [suite.spec(index).listed.start[0] for index in order_of(suite)]
    assert all(len(set(starts[at : at + 8])) == 8 for at in range(0, 32, 8))


def test_episodes_of_one_place_are_a_batch_where_workers_cannot_keep_all_places():
    suite = Suite.make(worlds=MANY, missions=5, planners=["auto", "astar"])
    order = EpisodeOrder(suite)
    batches = [order.batch_of(index) for index in order.sort(np.arange(len(suite))).tolist()]
    assert [batches.count(batch) for batch in dict.fromkeys(batches)] == [2] * 12 + [8] * 12
