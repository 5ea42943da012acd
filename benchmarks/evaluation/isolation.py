"""A batch with a planner that crashes in one mission, hangs, eats memory and raises in others: the rest is untouched.

    python -m benchmarks.evaluation.isolation MAP.yaml [--episodes 200] [--workers 2] [--deadline 5]

The same episodes run before with a planner that does none of that; rows are compared in all but measured columns.
"""

from __future__ import annotations

import argparse
import ctypes
import time
from typing import Any

from benchmarks.timing import print_table

from trundle.evaluation.episode import EpisodeTask
from trundle.evaluation.pool import Done, Failed, Pool
from trundle.evaluation.suite import Suite
from trundle.planning import create_planner


class TrappedPlanner:
    """Plans as `auto` does, but for some starts."""

    def __init__(self, traps: dict[tuple[float, float], str]) -> None:
        self.traps = traps

    def plan(self, costmap: Any, start: Any, goal: Any, **limits: Any) -> Any:
        """Plan, or do what the trap says."""
        trap = self.traps.get((start.x, start.y))
        if trap == "crashed":
            ctypes.string_at(0)
        if trap == "hung":
            time.sleep(10_000)
        if trap == "error":
            raise RuntimeError("planted")
        kept = []
        while trap == "out_of_memory":
            kept.append(bytearray(10_000_000))
        return create_planner("auto").plan(costmap, start, goal, **limits)


def run(planner: TrappedPlanner, options: argparse.Namespace) -> dict[int, Done | Failed]:
    """Outcomes by episode."""
    suite = Suite.make(maps=[options.map], backends="kinematic", planners=[planner], seeds=f"0:{options.episodes}")
    with Pool(EpisodeTask(suite), workers=options.workers, deadline_s=options.deadline, memory_mb=1000.0) as pool:
        return {outcome.job: outcome for outcome in pool.run(range(options.episodes))}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map")
    parser.add_argument("--episodes", type=int, default=200)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--deadline", type=float, default=5.0, help="wall time of an episode [s]")
    options = parser.parse_args()
    untouched = run(TrappedPlanner({}), options)
    kinds = ("crashed", "hung", "out_of_memory", "error")
    planted = {(2 * k + 1) * options.episodes // 8: kind for k, kind in enumerate(kinds)}
    starts = {index: outcome.value for index, outcome in untouched.items() if isinstance(outcome, Done)}
    outcomes = run(TrappedPlanner({(starts[k].start_x, starts[k].start_y): planted[k] for k in planted}), options)

    def is_untouched(index: int) -> bool:
        now, before = outcomes[index], untouched[index]
        if isinstance(now, Failed) or isinstance(before, Failed):
            return False
        return {**now.value.unmeasured(), "id": ""} == {**before.value.unmeasured(), "id": ""}

    others = [index for index in range(options.episodes) if index not in planted]
    equal = sum(map(is_untouched, others))
    print(f"{equal} of {len(others)} other rows are as without the failures")
    rows = [(str(k), planted[k], outcomes[k]) for k in planted]
    print_table(
        ("episode", "planted", "outcome", "error", "place"),
        [
            (index, kind, outcome.kind, outcome.text, str(outcome.place))
            for index, kind, outcome in rows
            if isinstance(outcome, Failed)
        ],
    )


if __name__ == "__main__":
    main()
