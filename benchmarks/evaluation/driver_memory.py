"""Memory of the driver with a million rows: python benchmarks/evaluation/driver_memory.py [--rows N] [--columns]

It writes rows as the driver does, continues the evaluation, and writes its reports, as `trundle evaluate` does at the
end. The target: at most 300 MB at a million rows. --columns reads arrays too, as a notebook does.
"""

import argparse
import random
import resource
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from store import a_row

from trundle.evaluation import Evaluation, Suite
from trundle.evaluation.store import Store

FAILING = 0.02


def megabytes() -> float:
    """The most memory that this process has had [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1024 if sys.platform == "linux" else 1024**2)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--columns", action="store_true")
    given = parser.parse_args()
    draw = random.Random(0)
    templates = [a_row(draw) for _ in range(1000)]
    suite = Suite.make(worlds=["warehouse"], planners=["auto", "astar"], backends="kinematic", seeds=given.rows // 2)
    with tempfile.TemporaryDirectory() as name:
        head = {"name": "benchmark", "suite_text": suite.to_yaml(Path(name) / "suite.yaml"), "versions": {}}
        with Store.open(name, total=given.rows, **head) as store:
            for index in range(given.rows):
                row = templates[index % 1000]
                store.append(
                    replace(
                        row,
                        id=f"{draw.getrandbits(64):016x}",
                        mission=f"{index // 2:016x}",
                        index=index,
                        planner=("auto", "astar")[index % 2],
                        outcome="stuck" if draw.random() < FAILING else "arrived",
                    )
                )
        print(f"{given.rows:,} rows written: {megabytes():.0f} MB")
        with Store.open(name, total=given.rows, **head) as store:
            print(f"{len(store.done):,} rows to continue from: {megabytes():.0f} MB")
        began = time.process_time()
        evaluation = Evaluation(name, suite=suite)
        evaluation.write_report()
        print(f"reports written: {megabytes():.0f} MB, {time.process_time() - began:.1f} s of CPU time")
        if given.columns:
            evaluation.results.columns("outcome", "planner", "time_s", "spl")
            print(f"four columns read: {megabytes():.0f} MB")


if __name__ == "__main__":
    main()
