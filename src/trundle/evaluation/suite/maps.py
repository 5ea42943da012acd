"""The suite `maps`: the ROS maps of a folder, each with missions, tight ends, and boxes that are not on it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from trundle.errors import InputError
from trundle.evaluation.suite.suite import MAPS, Suite
from trundle.files.kinds import MAP, find_kind

SEEDS = "0:20"
_BOXES = (5, 30)
_SUFFIXES = (".yaml", ".yml")


def maps_suite(folders: Sequence[str | os.PathLike[str]], *, seeds: object = SEEDS, **changes: Any) -> Suite:
    """Make the suite of all maps in some folders, and in folders in these; masks (`keepout_mask.yaml`) are left out.

    In each map there are missions with roomy and with tight ends, each without boxes and with 5 to 30 of them that only
    the lidars see.

    Args:
        folders: The folders.
        seeds: Of the missions.
        **changes: Other fields of the suite.

    Raises:
        InputError: If there is no folder, or no map in one.
    """
    if not folders:
        raise InputError("give a folder of ROS maps: trundle evaluate maps FOLDER")
    worlds: list[dict[str, Any]] = []
    for folder in folders:
        place = Path(folder)
        if not place.is_dir():
            raise InputError(f"{place}: this is no folder: trundle evaluate maps takes folders of ROS maps")
        files = [path for path in sorted(place.rglob("*")) if path.suffix.lower() in _SUFFIXES]
        found = [path for path in files if not path.stem.endswith("mask") and find_kind(path) == MAP]
        if not found:
            raise InputError(f"{place}: there is no ROS map in it: a YAML file with image: and resolution:")
        for path in found:
            label = path.relative_to(place).with_suffix("").as_posix()
            label = label if len(folders) == 1 else f"{place.name}/{label}"
            worlds.append({"name": str(path), "label": label, "missions": {"seeds": seeds}})
            worlds.append(
                {"name": str(path), "label": f"{label}, tight", "missions": {"seeds": seeds, "ends": "tight"}}
            )
    settings = {"name": MAPS, "lidar": True, "unmapped": [None, {"boxes": _BOXES}], **changes}
    return Suite.make(worlds=worlds, **settings)
