"""Timing for benchmarks: contestants take turns, so that a busy moment of the machine affects all of them."""

from __future__ import annotations

import importlib
import os
import platform
import statistics
import time
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any


def interleaved_times(
    contestants: Mapping[str, Callable[[], Any]], rounds: int, clock: Callable[[], float] = time.perf_counter
) -> dict[str, list[float]]:
    """Seconds of each contestant in each of `rounds` turns, after one turn that does not count."""
    times: dict[str, list[float]] = {name: [] for name in contestants}
    for turn in range(rounds + 1):
        for name, run in contestants.items():
            begin = clock()
            run()
            elapsed = clock() - begin
            if turn > 0:
                times[name].append(elapsed)
    return times


def interleaved_medians(contestants: Mapping[str, Callable[[], Any]], rounds: int) -> dict[str, float]:
    """Median seconds of each contestant over `rounds` turns, after one turn that does not count."""
    return {name: statistics.median(values) for name, values in interleaved_times(contestants, rounds).items()}


def load_peer(module: str, package: str) -> ModuleType:
    """Import a peer to compare with, or end with what to install."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise SystemExit(
            f"This benchmark compares with {package}. Install it with: pip install -e '.[bench]'"
        ) from None


def print_table(header: tuple[str, ...], rows: list[tuple[str, ...]]) -> None:
    """Print a Markdown table."""
    widths = [max(len(line[i]) for line in (header, *rows)) for i in range(len(header))]
    for line in (header, tuple("-" * width for width in widths), *rows):
        print("| " + " | ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) + " |")


def describe_machine() -> str:
    """The processor and how busy the machine is; timings of a busy one are worth less than their ratios."""
    model = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:  # noqa: PTH123 - a system file, not a path of ours
            model = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), model)
    except OSError:
        pass
    return f"{model}, load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores, Python {platform.python_version()}"
