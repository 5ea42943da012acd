import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import InputError, NoPathError, OutsideMapError, PlanningStoppedError, UnknownNameError
from trundle.geometry import Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.path import Path
from trundle.planning import Cancellation, create_planner, plan_many, planner_names

OUTLINE = ((0.3, 0.15), (-0.2, 0.15), (-0.2, -0.15), (0.3, -0.15))


def make_costmap():
    rng = np.random.default_rng(1)
    data = np.zeros((120, 160), np.int8)
    for _ in range(14):
        row, col = int(rng.integers(5, 105)), int(rng.integers(5, 145))
        data[row : row + 8, col : col + 8] = 100
    data[:, 140:142] = 100  # what is beyond cannot be reached
    return Costmap.from_grid(OccupancyGrid(data, 0.05), OUTLINE)


def make_queries(count, seed=2):
    rng = np.random.default_rng(seed)
    ends = np.column_stack(
        [rng.uniform(-0.2, 8.0, 2 * count), rng.uniform(0.0, 6.0, 2 * count), rng.uniform(-3, 3, 2 * count)]
    )
    return ends[:count], ends[count:]


def describe(outcome):
    return outcome.poses.tolist() if isinstance(outcome, Path) else (type(outcome), str(outcome), outcome.cell)


@pytest.mark.parametrize("name", planner_names())
def test_many_threads_give_what_one_plan_after_the_other_gives(name):
    """One planner, with what it keeps of the costmap and its pooled memory, in eight threads."""
    costmap = make_costmap()
    starts, goals = make_queries(60)
    options = {"max_expansions": 2000} if name == "hybrid_astar" else {}
    alone = [
        describe(outcome) for outcome in plan_many(create_planner(name, **options), costmap, starts, goals, threads=1)
    ]
    planner = create_planner(name, **options)
    for _ in range(2):
        assert [describe(outcome) for outcome in plan_many(planner, costmap, starts, goals, threads=8)] == alone
    kinds = {entry[0] for entry in alone if isinstance(entry, tuple)}
    assert OutsideMapError in kinds
    assert any(isinstance(entry, list) for entry in alone)
    assert NoPathError in kinds


def test_errors_carry_where_they_are():
    outcomes = plan_many("astar", make_costmap(), [(0.5, 0.5), (1.0, 1.0)], [(-3.0, 1.0), Pose2D(7.5, 3.0)])
    assert [type(outcome) for outcome in outcomes] == [OutsideMapError, NoPathError]
    assert (outcomes[0].pose, outcomes[0].cell) == ((-3.0, 1.0, 0.0), (20, -60))


def test_one_deadline_is_for_all_and_cancelling_ends_all():
    costmap = make_costmap()
    starts, goals = make_queries(40, seed=3)
    for name in ("astar", "hybrid_astar"):
        assert {type(outcome) for outcome in plan_many(name, costmap, starts, goals, deadline_s=1e-6)} == {
            PlanningStoppedError
        }
        cancel = Cancellation()
        cancel.cancel()
        stopped = plan_many(name, costmap, starts, goals, cancel=cancel)
        assert {outcome.status for outcome in stopped} == {"cancelled"}


def test_a_planner_that_knows_no_deadline_is_stopped_between_queries():
    class Straight:
        def plan(self, costmap, start, goal):
            return Path(np.array([start.as_tuple(), goal.as_tuple()]))

    costmap = make_costmap()
    assert [path.length for path in plan_many(Straight(), costmap, [(0, 0)], [(3, 4)], deadline_s=60.0)] == [5.0]
    late = plan_many(Straight(), costmap, [(0, 0)] * 3, [(3, 4)] * 3, deadline_s=1e-9)
    assert [outcome.status for outcome in late] == ["timeout"] * 3
    assert plan_many(Straight(), costmap, [], []) == []


@pytest.mark.parametrize(
    ("arguments", "options", "kind", "message"),
    [
        (("astr", [(0, 0)], [(1, 1)]), {}, UnknownNameError, "astar"),
        (("astar", [(0, 0)], []), {}, InputError, "1 starts and 0 goals"),
        (("astar", [(0, 0), (1, "x")], [(1, 1), (2, 2)]), {}, InputError, "query 1: the start must be a pose"),
        (("astar", 3, [(1, 1)]), {}, InputError, "starts must be poses"),
        (("astar", [(0, 0)], [None]), {}, InputError, "query 0: the goal must be a pose"),
        (("astar", [(0, 0)], [(1, 1)]), {"threads": 0}, InputError, "threads"),
        (("astar", [(0, 0)], [(1, 1)]), {"deadline_s": 0}, InputError, "deadline_s"),
        (("astar", [(0, 0)], [(1, 1)]), {"cancel": 1}, InputError, "Cancellation"),
    ],
)
def test_what_cannot_be_asked_is_refused(arguments, options, kind, message):
    planner, starts, goals = arguments
    with pytest.raises(kind, match=message):
        plan_many(planner, make_costmap(), starts, goals, **options)
    with pytest.raises(InputError, match="a planner's costmap must be of type Costmap"):
        plan_many("astar", np.zeros((3, 3)), [(0, 0)], [(1, 1)])


def test_the_number_of_threads_can_be_limited_by_a_variable(monkeypatch):
    monkeypatch.setenv("TRUNDLE_THREADS", "1")
    monkeypatch.setattr("trundle.planning.many.ThreadPoolExecutor", None)
    assert len(plan_many(create_planner("astar"), make_costmap(), *make_queries(3))) == 3


@pytest.mark.parametrize("text", ["0", "many", "-1", "1.5"])
def test_a_bad_number_of_threads_is_refused_with_its_variable(monkeypatch, text):
    monkeypatch.setenv("TRUNDLE_THREADS", text)
    with pytest.raises(InputError, match="TRUNDLE_THREADS must be an integer from 1 to 1024"):
        plan_many(create_planner("astar"), make_costmap(), *make_queries(1))
