import numpy as np
import pytest

from trundle.evaluation import Suite
from trundle.evaluation.schedule import PROBATION, EpisodeOrder, GivenUp, Schedule

WORLDS = [{"name": "office", "seed": seed, "label": f"office {seed}"} for seed in range(6)]


@pytest.fixture
def order():
    return EpisodeOrder(Suite.make(worlds=WORLDS, missions=9, planners=["auto", "astar"]))


def schedule_of(order, workers, is_left_out=lambda _: False):
    return Schedule(order.sort(np.arange(108)).tolist(), order, workers, is_left_out)


def take_all(schedule, worker):
    taken = []
    try:
        while True:
            taken.append(schedule.take(worker))
    except StopIteration:
        return taken


def test_one_worker_gets_all_episodes_in_order(order):
    assert take_all(schedule_of(order, 1), 1) == order.sort(np.arange(108)).tolist()


def test_a_worker_goes_on_in_its_place(order):
    schedule = schedule_of(order, 2)
    for _ in range(6):  # the first mission of each place
        assert order.batch_of(schedule.take(1)) == order.batch_of(schedule.take(1))
    begun = {worker: order.batch_of(schedule.take(worker)) for worker in (1, 2)}
    assert begun[1] != begun[2]
    for worker in (1, 2, 2, 1, 1, 1):
        assert order.batch_of(schedule.take(worker)) == begun[worker]


def test_what_a_lost_worker_leaves_is_done_by_others(order):
    schedule = schedule_of(order, 2)
    taken = [schedule.take(worker) for worker in range(100, 120)]
    assert len({order.batch_of(index) for index in taken}) < 20
    taken += take_all(schedule, 1)
    assert sorted(taken) == list(range(108))
    assert set(schedule.in_flight) == set(taken)


def test_a_combination_whose_first_ten_episodes_end_in_an_error_is_given_up(order):
    given_up = GivenUp(order)
    bad = [index for index in order.sort(np.arange(108)).tolist() if index % 2 == 1]
    for index in bad[: PROBATION - 1] + bad[PROBATION:]:
        given_up.note(index, "error")
    assert not given_up.has(bad[-1])  # the tenth may still end otherwise
    given_up.note(bad[PROBATION - 1], "error")
    assert given_up.has(bad[-1])
    assert not given_up.has(0)
    assert all(index % 2 == 0 for index in take_all(schedule_of(order, 2, given_up.has), 1))


def test_one_episode_that_ends_otherwise_keeps_a_combination(order):
    given_up = GivenUp(order)
    first, *others = [index for index in order.sort(np.arange(108)).tolist() if index % 2 == 1]
    given_up.note(first, "crashed")
    for index in others:
        given_up.note(index, "error")
    assert not given_up.has(first)
