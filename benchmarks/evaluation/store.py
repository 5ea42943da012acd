"""What it costs to keep the rows of an evaluation: CPU time per row, bytes, memory, and reading them again.

python benchmarks/evaluation/store.py [--rows 1000000]
"""

import argparse
import random
import resource
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from trundle.evaluation.row import Row
from trundle.evaluation.store import Results, Store

TRAIL = 64


def a_row(draw: random.Random) -> Row:
    x, y = draw.uniform(-20, 20), draw.uniform(-20, 20)
    trail = []
    for _ in range(TRAIL):
        x, y = x + draw.uniform(-0.5, 0.5), y + draw.uniform(-0.5, 0.5)
        trail += [round(x, 2), round(y, 2)]
    numbers = ("time_s", "distance_m", "min_clearance_m", "path_length_m", "shortest_path_m", "max_cross_track_error_m")
    numbers += ("smoothness_rad_per_m", "start_x", "start_y", "start_yaw", "goal_x", "goal_y", "end_x", "end_y")
    numbers += ("end_yaw", "closest_x", "closest_y", "planning_ms", "cpu_s", "wall_s")
    return Row(
        id=f"{draw.getrandbits(64):016x}",
        mission=f"{draw.getrandbits(64):016x}",
        index=0,
        world="carter_warehouse_navigation",
        robot="nova_carter",
        planner="auto",
        controller="regulated_pure_pursuit",
        backend="mujoco",
        seed=0,
        outcome="arrived",
        message="arrived at the goal",
        spl=0.98,
        contacts=0,
        replans=0,
        trail=tuple(trail),
        place="0123456789abcdef",
        **{name: draw.uniform(-30, 30) for name in numbers},
    )


def megabytes() -> float:
    """The most memory that this process has had [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1024 if sys.platform == "linux" else 1024**2)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--rows", type=int, default=1_000_000)
    count = parser.parse_args().rows
    draw = random.Random(0)
    templates = [a_row(draw) for _ in range(1000)]
    head = {"name": "benchmark", "suite_text": "name: benchmark\n", "total": count, "versions": {}}
    with tempfile.TemporaryDirectory() as name:
        before = time.process_time()
        for index in range(count):
            replace(templates[index % 1000], id=f"{draw.getrandbits(64):016x}", index=index)
        making = time.process_time() - before
        before, start = time.process_time(), time.perf_counter()
        with Store.open(name, **head) as store:
            for index in range(count):
                store.append(replace(templates[index % 1000], id=f"{draw.getrandbits(64):016x}", index=index))
        spent = time.process_time() - before - making
        took = time.perf_counter() - start - making
        size = sum(part.stat().st_size for part in Path(name, "parts").iterdir())
        print(f"writing: {1e6 * spent / count:.1f} µs of CPU time per row ({1e6 * took / count:.1f} µs elapsed)")
        print(f"size: {size / count:.0f} B per row; memory so far {megabytes():.0f} MB")
        before = time.process_time()
        with Store.open(name, **head) as store:
            print(f"continuing: {time.process_time() - before:.2f} s; {len(store.done)} rows; {megabytes():.0f} MB")
        before = time.process_time()
        with Results.open(name) as results:
            print(f"opening: {time.process_time() - before:.2f} s")
            before = time.process_time()
            read = sum(1 for _ in results.rows())
            print(f"all rows: {1e6 * (time.process_time() - before) / read:.1f} µs each; {megabytes():.0f} MB")
            before = time.process_time()
            results.columns("outcome", "planner", "time_s", "spl")
            print(f"four columns: {time.process_time() - before:.2f} s; {megabytes():.0f} MB")
            before = time.process_time()
            results.query("SELECT world, planner, count(*), avg(time_s) FROM episodes GROUP BY ALL")
            print(f"a query, with pandas imported: {time.process_time() - before:.2f} s; {megabytes():.0f} MB")


if __name__ == "__main__":
    main()
