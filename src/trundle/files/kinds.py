"""The kind of a file, from its suffix or keys: for messages about a file of the wrong kind."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from trundle.errors import InputError
from trundle.files.yaml_nodes import compose, keys_of

MAP, ROBOT, SCENARIO, SUITE, WORLD, PICTURE, RUN, DRIVE, EVALUATION, TABLE, ARRAYS = (
    "a map",
    "a robot",
    "a scenario",
    "a suite",
    "a world",
    "a picture",
    "the folder of a run",
    "the folder of a drive",
    "the folder of an evaluation",
    "a table",
    "a file of arrays",
)

_SUFFIXES = {
    PICTURE: (".png", ".pgm", ".ppm", ".pbm", ".bmp", ".jpg", ".jpeg", ".gif", ".webp", ".tif", ".tiff"),
    MAP: (".map",),
    WORLD: (".sdf", ".world", ".glb", ".gltf", ".obj", ".stl", ".ply", ".dae", ".usd", ".usda", ".usdc", ".usdz"),
    "a video": (".mp4",),
    "a recording": (".mcap", ".db3", ".bag"),
    TABLE: (".csv", ".parquet"),
    ARRAYS: (".npz", ".npy"),
    "a page": (".html", ".pdf", ".md"),
    "a program": (".py", ".sh"),
}
_BY_SUFFIX = {suffix: kind for kind, suffixes in _SUFFIXES.items() for suffix in suffixes}

_FILES = {"episode.json": RUN, "drive.csv": DRIVE, "evaluation.json": EVALUATION}
"""Files that identify the folder of a run, a drive or an evaluation."""

_ROBOT_KEYS = frozenset({"drive", "limits", "footprint", "body", "casters", "lidars", "model", "base"})
_SCENARIO_KEYS = frozenset({"world", "map", "start", "goal", "goals", "robot", "planner", "controller", "backend"})
_SUITE_KEYS = frozenset(
    {"worlds", "maps", "robots", "planners", "controllers", "smoothers", "backends", "missions", "seeds", "vary"}
    | {"require"}
)


def find_kind(path: str | os.PathLike[str]) -> str | None:
    """Return the kind of an existing file or folder; None if it is unclear."""
    file = Path(path)
    try:
        if file.is_dir():
            return next((kind for name, kind in _FILES.items() if (file / name).is_file()), "a folder")
        if not file.is_file():
            return None
    except (OSError, ValueError):
        return None
    suffix = file.suffix.lower()
    if suffix in (".yaml", ".yml"):
        try:
            return kind_of_keys(keys_of(compose(file, allow_duplicate_keys=True)))
        except InputError:
            return None
    return _BY_SUFFIX.get(suffix)


def kind_of_keys(keys: Iterable[str]) -> str | None:
    """Return the kind of a YAML file that has these keys; None if it is unclear."""
    found = set(keys)
    if "image" in found and found & {"resolution", "origin", "negate"}:
        return MAP
    known = ((ROBOT, _ROBOT_KEYS), (SCENARIO, _SCENARIO_KEYS), (SUITE, _SUITE_KEYS))
    counts = {kind: len(found & of_kind) for kind, of_kind in known}
    best, second = sorted(counts, key=counts.__getitem__, reverse=True)[:2]
    return None if counts[best] == counts[second] else best


def describe_mismatch(name: str, found: str | None, wanted: str) -> str:
    """Say that a file is not of the expected kind."""
    return f"{name}: this is {found}, not {wanted}"
