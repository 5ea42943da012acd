"""All that navigate.py measures, many at once, for a machine with many cores: a table, and memory over time.

python benchmarks/ros2/at_once.py [--minutes 8] [--jobs 16] [--missions 100] [--kills 50] [--goals 20] [--no-rclpy]

Each run has a domain of its own. The load is measured first, with little beside it. What has not begun when the
minutes are over is left out, and the table says how many there were.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from network import load, percentile

NAVIGATE = Path(__file__).with_name("navigate.py")

SETTLES_S = 20.0
"""The load is measured for a minute; programs start before and end after that [s]."""

ENDS_S = 70.0
"""A run that begins so long before the end [s] can still arrive."""


@dataclass
class Runs:
    """What has been measured.

    Attributes:
        figures: The figures of each kind of run.
        failed: The last lines of runs that gave none.
        loads: The load of the machine over time.
    """

    figures: dict[str, list[dict[str, Any]]] = field(default_factory=dict)
    failed: list[str] = field(default_factory=list)
    loads: list[float] = field(default_factory=list)
    running: set[subprocess.Popen[str]] = field(default_factory=set)
    lock: threading.Lock = field(default_factory=threading.Lock)

    def run(self, kind: str, arguments: Sequence[str]) -> None:
        """Run navigate.py with these arguments."""
        command = [sys.executable, "-u", str(NAVIGATE), *arguments, "--json"]
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
        ) as process:
            with self.lock:
                self.running.add(process)
            lines = process.communicate()[0].splitlines()
            with self.lock:
                self.running.discard(process)
                for line in lines[:-1]:
                    print(f"{kind}: {line}", flush=True)
                try:
                    figures = json.loads(lines[-1])
                    self.figures.setdefault(kind, []).append(figures)
                except (IndexError, ValueError):
                    self.failed.append(f"{kind} {' '.join(arguments)}: {' | '.join(lines[-4:]) or 'nothing was said'}")
                    print(f"FAILED {self.failed[-1]}", flush=True)

    def end(self) -> None:
        """End what still runs, with all that it has started."""
        with self.lock:
            for process in self.running:
                os.killpg(process.pid, signal.SIGKILL)


def work_of(given: argparse.Namespace, transports: Sequence[str]) -> list[tuple[str, list[str]]]:
    """The runs, mixed so that a share of each kind is done where the time does not suffice for all."""
    few = min(2, given.kills)
    parts: list[list[tuple[str, list[str]]]] = []
    for transport in transports:
        how = ["--transport", transport]
        stops = [(f"stops {transport}", ["stops", "--count", str(few), *how]) for _ in range(given.kills // few)]
        share = given.missions if len(transports) == 1 else given.missions * (4 if transport == "dds" else 1) // 5
        seeds = range(given.first, given.first + share)
        parts += [
            stops,
            [(f"missions {transport}", ["missions", "--count", "1", "--first", str(n), *how]) for n in seeds],
        ]
    parts.append([("odd", ["odd", "--count", "1", "--first", str(number)]) for number in range(given.goals)])
    placed = [(at / len(part), one) for part in parts for at, one in enumerate(part)]
    return [one for _, one in sorted(placed, key=lambda place: place[0])]


def measure(given: argparse.Namespace, transports: Sequence[str]) -> tuple[Runs, int]:
    """Run all; what has been measured, and how many runs had no time."""
    runs, until = Runs(), time.monotonic() + 60.0 * given.minutes
    long = [
        threading.Thread(
            target=runs.run,
            args=("lossy", ["lossy", "--seconds", str(max(40.0, 60.0 * given.minutes - SETTLES_S))]),
            daemon=True,
        )
    ]
    first = [
        threading.Thread(
            target=runs.run,
            args=(f"load {one}", ["load", "--seconds", str(given.seconds), "--transport", one]),
            daemon=True,
        )
        for one in transports
    ]
    for thread in (*long, *first):
        thread.start()
    for thread in first:
        thread.join(given.seconds + 60.0)
    waiting: queue.SimpleQueue[tuple[str, list[str]]] = queue.SimpleQueue()
    for one in work_of(given, transports):
        waiting.put(one)

    def work() -> None:
        while time.monotonic() < until - ENDS_S:
            try:
                kind, arguments = waiting.get_nowait()
            except queue.Empty:
                return
            runs.run(kind, arguments)

    pool = [threading.Thread(target=work, daemon=True) for _ in range(given.jobs)]
    for number, thread in enumerate(pool):
        thread.start()
        time.sleep(0.0 if number % 4 else 0.5)  # not all start at once
    while time.monotonic() < until and any(thread.is_alive() for thread in (*pool, *long)):
        time.sleep(1.0)
        runs.loads.append(os.getloadavg()[0])
    for thread in (*pool, *long):
        thread.join(max(0.0, until - time.monotonic()))
    runs.end()
    for thread in (*pool, *long):
        thread.join(5.0)
    return runs, waiting.qsize()


def rows(runs: Runs) -> Iterable[tuple[str, str, str]]:
    """What was measured, the aim, and the figures, of each kind."""
    for kind, found in sorted(runs.figures.items()):
        what = kind.partition(" ")[0]
        match what:
            case "missions":
                offs = [off for one in found for off in one["off"]]
                near = sum(off <= 0.3 for off in offs)
                most = max([off for off in offs if off <= 0.3], default=math.nan)
                touched = sum(one["contacts"] for one in found)
                yield (
                    kind,
                    "98 % within 0.3 m",
                    f"{near} of {len(offs)}, {touched} with contacts, those at most {most * 100:.1f} cm off",
                )
            case "stops":
                kinds = sorted({name for one in found for name in one["took"]})
                for name in kinds:
                    took = [at for one in found for at in one["took"].get(name, [])]
                    text = f"{len(took)} times, p50 {percentile(took, 0.5):.2f} s, largest {max(took):.2f} s"
                    yield f"{kind}: {name}", "0.5 s", text
                yield f"{kind}: contacts", "0", str(sum(one["contacts"] for one in found))
            case "odd":
                arrived, touched = (sum(one[name] for one in found) for name in ("arrived", "contacts"))
                yield kind, "all", f"{arrived} of {len(found)} arrived, {touched} with contacts"
            case "load":
                for one in found:
                    late = f"p50 {one['p50_ms']:.1f} ms, p95 {one['p95_ms']:.1f} ms, largest {one['largest_ms']:.1f} ms"
                    yield f"{kind}: share of a core", "20 %", f"{one['share']:.1%}"
                    yield f"{kind}: scan to command", "p95 25 ms", f"{late} of {one['commands']}"
            case _:
                for one in found:
                    memory = " ".join(f"{mb:.1f}" for mb in one["memory"])
                    text = f"{one['seconds']:.0f} s, {one['moved']:.0f} m, {one['contacts']} contacts"
                    yield kind, "no contact, memory flat", f"{text}; MB each 30 s: {memory}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=8.0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs at once, besides the long one")
    parser.add_argument("--missions", type=int, default=100, help="a fifth of them with rclpy")
    parser.add_argument("--first", type=int, default=0, help="seed of the first mission")
    parser.add_argument("--kills", type=int, default=50, help="of each kind and transport")
    parser.add_argument("--goals", type=int, default=20, help="of the odd robot")
    parser.add_argument("--seconds", type=float, default=60.0, help="of the load")
    parser.add_argument("--no-rclpy", action="store_true", help="there is none")
    given = parser.parse_args()
    began = time.monotonic()
    runs, left = measure(given, ["dds"] if given.no_rclpy else ["dds", "rclpy"])
    print("\n| what | aim | measured |\n| --- | --- | --- |")
    for row in rows(runs):
        print("| " + " | ".join(row) + " |")
    mean = sum(runs.loads) / len(runs.loads) if runs.loads else math.nan
    print(f"\n{time.monotonic() - began:.0f} s, mean load {mean:.1f}, {load()}; {left} runs had no time", end="; ")
    print(f"{len(runs.failed)} failed")
    for text in runs.failed:
        print(f"FAILED {text[:600]}")


if __name__ == "__main__":
    main()
