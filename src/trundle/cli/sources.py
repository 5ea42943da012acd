"""What a verb's first argument stands for: a world by name, a map's YAML, or a scenario's."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from trundle.errors import InputError, UnknownNameError

if TYPE_CHECKING:
    from trundle.worlds import World


def is_map(path: Path) -> bool:
    """Whether a YAML file is a ROS map: it has an `image:` key.

    Raises:
        InputError: If it cannot be read as YAML.
    """
    import yaml

    from trundle.yamlfile import compose

    node = compose(path)
    return isinstance(node, yaml.MappingNode) and any(key.value == "image" for key, _ in node.value)


def looks_like_file(text: str) -> bool:
    """Whether an argument means a file and not a name."""
    return text.lower().endswith((".yaml", ".yml")) or os.sep in text


def load_world(text: str, *, seed: int, settings: Mapping[str, bool | int | float | str]) -> World:
    """Generate a world by name, or extrude a map from its YAML.

    Raises:
        UnknownNameError: If it is neither a world nor a file; the nearest name is offered.
        InputError: If the file is no map, or generator options are given for a map.
    """
    from trundle.worlds import World, world_names

    if text in world_names():
        return World.generate(text, seed=seed, **settings)
    if not looks_like_file(text):
        raise UnknownNameError("world", text, world_names())
    if settings:
        raise InputError(f"--set is for generated worlds ({', '.join(world_names())}); {text} is a map")
    if not is_map(Path(text)):
        raise InputError(f"{text}: not a map: it has no image: key")
    return World.from_map(text)
