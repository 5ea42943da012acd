"""`plan_many`: one planner, one costmap, many queries, in several threads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor

from trundle.costmap import Costmap
from trundle.errors import InputError, PlanningError
from trundle.geometry import Goal, Pose2D
from trundle.path import Path
from trundle.planning.cancellation import Cancellation, Patience
from trundle.planning.grid.cells import check_threads
from trundle.planning.planner import PlannerLike, create_planner
from trundle.planning.queries.query import check_question

PoseLike = Pose2D | Sequence[float]


def plan_many(
    planner: PlannerLike,
    costmap: Costmap,
    starts: Iterable[PoseLike],
    goals: Iterable[PoseLike],
    *,
    threads: int | None = None,
    deadline_s: float | None = None,
    cancel: Cancellation | None = None,
) -> list[Path | PlanningError]:
    """Plan many queries on one costmap, in several threads.

    The kernels release the GIL and run in parallel; the Python parts of a planner do not. The planners of trundle may
    be used by several threads; for one that may not be, give `threads=1`. The results equal those of single plans.

    Args:
        planner: A planner, a name, a class or a function; see `PlannerLike`.
        costmap: What to stay clear of.
        starts: Poses, (x, y) or (x, y, yaw) [m, m, rad], map frame.
        goals: As many; (x, y) is a goal with any yaw.
        threads: How many to use. If None, TRUNDLE_THREADS, or as many as there are processors, up to 8.
        deadline_s: Give up after this time for all [s].
        cancel: Give up once this is cancelled.

    Returns:
        For each query its path, or the error that says why there is none: `PlanningStoppedError` for queries that were
        not done in time.

    Raises:
        UnknownNameError: If there is no planner of that name.
        InputError: If a pose is invalid, there are not as many goals as starts, or another argument is invalid.
    """
    chosen = create_planner(planner)
    first, last = _as_list(starts, "starts"), _as_list(goals, "goals")
    if len(first) != len(last):
        raise InputError(f"there are {len(first)} starts and {len(last)} goals; each query needs both")
    queries: list[tuple[Pose2D, Goal]] = []
    for index, (start, goal) in enumerate(zip(first, last, strict=True)):
        try:
            queries.append(check_question(costmap, start, goal))
        except InputError as error:
            raise InputError(f"query {index}: {error}") from error
    count = check_threads(threads)
    patience = Patience(deadline_s, cancel, f"not all of {len(queries)} paths were planned")

    def plan(query: tuple[Pose2D, Goal]) -> Path | PlanningError:
        try:
            patience.check()
            return chosen.plan(costmap, *query, deadline_s=patience.seconds, cancel=cancel)
        except PlanningError as error:
            return error

    if count == 1 or len(queries) < 2:
        return [plan(query) for query in queries]
    with ThreadPoolExecutor(min(count, len(queries)), thread_name_prefix="plan") as pool:
        return list(pool.map(plan, queries))


def _as_list(poses: Iterable[PoseLike], what: str) -> list[PoseLike]:
    try:
        return list(poses)
    except TypeError:
        raise InputError(f"{what} must be poses, got {poses!r}") from None
