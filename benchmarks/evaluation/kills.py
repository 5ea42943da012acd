"""SIGKILL at random moments of the driver, the server or a worker of an evaluation: no row is lost, doubled or changed.

    python -m benchmarks.evaluation.kills MAP.yaml [--kills 100] [--episodes 300] [--workers 2] [--seed 0]

A driver that was killed is started again with the same command. An evaluation that ends is compared with one that
nobody interrupted, in all but measured columns, and another one starts until there were enough kills.
"""

from __future__ import annotations

import argparse
import itertools
import os
import random
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

from benchmarks.evaluation.pools import descendants

from trundle.evaluation.store import Results

KINDS = ("driver", "driver", "server", "worker", "worker", "worker")


def start(map_file: str, folder: Path, episodes: int, workers: int) -> subprocess.Popen[str]:
    """Start an evaluation, or continue it."""
    what = [map_file, "--backends", "kinematic", "--seeds", f"0:{episodes}", "--workers", str(workers)]
    return subprocess.Popen(
        [sys.executable, "-m", "trundle", "evaluate", *what, "-o", str(folder), "--quiet"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def rows_of(folder: Path) -> list[dict[str, Any]]:
    """Rows of a folder without measured columns."""
    return [row.unmeasured() for row in Results.open(folder).rows()]


def kill_one(driver: int, rng: random.Random) -> str | None:
    """Kill a process of an evaluation; returns which, None if there was none such."""
    kind = rng.choice(KINDS)
    below = descendants(driver)
    chosen = {"driver": [driver], "server": below[:1], "worker": below[1:]}[kind]
    if not chosen:
        return None
    try:
        os.kill(rng.choice(chosen), signal.SIGKILL)
    except ProcessLookupError:
        return None
    return kind


def run_with_kills(options: argparse.Namespace, folder: Path, rng: random.Random, kills: Counter[str]) -> None:
    """Run an evaluation to its end, with kills meanwhile as long as there were not enough."""
    while True:
        driver = start(options.map, folder, options.episodes, options.workers)
        while driver.poll() is None:
            left = options.kills - kills.total()
            try:
                driver.wait(rng.uniform(0.0, options.longest) if left > 0 else None)
            except subprocess.TimeoutExpired:
                kind = kill_one(driver.pid, rng)
                if kind is not None:
                    kills[kind] += 1
        _, said = driver.communicate()
        if driver.returncode in (0, 1):
            return
        if driver.returncode != -signal.SIGKILL:
            raise SystemExit(f"the evaluation ended with {driver.returncode}: {said}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map")
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--episodes", type=int, default=300)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--longest", type=float, default=4.0, help="time between two kills, at most [s]")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    rng, kills, unequal = random.Random(options.seed), Counter[str](), 0
    with tempfile.TemporaryDirectory() as root:
        before = Path(root, "uninterrupted")
        start(options.map, before, options.episodes, options.workers).communicate()
        wanted = rows_of(before)
        for number in itertools.count(1):
            folder = Path(root, f"killed-{number}")
            run_with_kills(options, folder, rng, kills)
            found = rows_of(folder)
            differing = [row for row, other in itertools.zip_longest(found, wanted) if row != other]
            unequal += len(differing)
            print(
                f"evaluation {number}: {len(found)} rows, {len(differing)} of them differ; kills: {dict(kills)}",
                flush=True,
            )
            for row in differing[:3]:
                print(f"  {row}")
            if kills.total() >= options.kills:
                break
    print(f"{kills.total()} kills: {unequal} rows differ from the {len(wanted)} of the uninterrupted evaluation")
    raise SystemExit(unequal > 0)


if __name__ == "__main__":
    main()
