"""Rows of an evaluation, made up, and what a folder holds of them."""

import random
from pathlib import Path
from typing import Any

from trundle.evaluation.row import Row
from trundle.evaluation.store import Results, Store

VERSIONS = {"trundle": "1.0", "numpy": "2.0", "sources": "aa", "kernels": "bb", "commit": "1" * 40}
SUITE = "name: s\nworlds: [a]\n"


def make_row(index: int, **given: Any) -> Row:
    """A row whose id and figures come of its index."""
    draw = random.Random(index)
    values: dict[str, Any] = {
        "id": f"{draw.getrandbits(64):016x}",
        "mission": f"{draw.getrandbits(64):016x}",
        "index": index,
        "world": f"world {index % 3}",
        "robot": "nova_carter",
        "planner": "auto",
        "controller": "it's",
        "backend": "mujoco",
        "seed": index,
        "outcome": "arrived" if index % 4 else "crashed",
        "message": 'a "quoted", ünïcode\n text',
        "time_s": draw.uniform(0, 30) if index % 4 else None,
        "contacts": index % 2 if index % 4 else None,
        "trail": tuple(round(draw.uniform(-90, 90), 2) for _ in range(2 * (index % 65))),
        "vary": {"friction": draw.random(), "mass kg": draw.random()} if index % 2 else None,
    }
    return Row(**{**values, **given})


def open_store(folder: Path | None, **given: Any) -> Store:
    values: dict[str, Any] = {"name": "s", "suite_text": SUITE, "total": 100, "versions": VERSIONS, "part_rows": 10}
    return Store.open(folder, **{**values, **given})


def write_rows(folder: Path, rows: range, **given: Any) -> None:
    with open_store(folder, **given) as store:
        for index in rows:
            store.append(make_row(index))


def read_rows(folder: Path) -> list[Row]:
    with Results.open(folder) as results:
        return list(results.rows())
