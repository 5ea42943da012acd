"""Files of an evaluation's suite that have moved since: looked for beside the suite, or where the user says."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from trundle.errors import InputError
from trundle.evaluation.episode.task import facts_of
from trundle.evaluation.row import Row
from trundle.evaluation.suite import Suite
from trundle.evaluation.suite.expand import Expansion
from trundle.evaluation.suite.parts import SuiteWorld
from trundle.files.opening import advise_missing, exists


def find_beside(suite: Suite, folder: Path) -> Suite:
    """Return the suite with the files of a folder in place of those that are not where it says."""

    def moved(path: str) -> str:
        beside = folder / Path(path).name
        return str(beside) if not exists(path) and exists(beside) else path

    return suite.with_paths(moved)


def use_map(suite: Suite, row: Row, place: str | os.PathLike[str], versions: tuple[Mapping[str, str], ...]) -> Suite:
    """Return the suite with a map, or a world's file, in place of the one that an episode was driven in.

    Args:
        suite: The suite of the evaluation.
        row: The row of the episode.
        place: The file, or the folder that holds it.
        versions: Versions of the code that made the row, and of the code here; where they are equal, the content is
            compared.

    Raises:
        InputError: If it is not there, or is another map than that of the episode.
    """
    at = _world_of(suite, row)
    world = suite.worlds[at]
    if not world.is_file:
        raise InputError(
            f"--map {os.fspath(place)}: episode {row.id} was driven in a generated world, {row.world}; leave --map out"
        )
    given = Path(place)
    found = {"name": str(given)}
    if given.is_dir():
        files = {field: str(given / Path(path).name) for field, path in world.files().items()}
        found = {field: path for field, path in files.items() if exists(path)}
        if "name" not in found:
            raise InputError(f"--map {given}: there is no {Path(world.name).name} in it; give the folder that has it")
    elif not exists(given):
        raise InputError(f"--map {given}: no such file{advise_missing(given)}")
    worlds = [*suite.worlds]
    worlds[at] = SuiteWorld.model_validate({**world.model_dump(), **found, "label": row.world})
    changed = suite.with_fields(worlds=worlds)
    if versions[0] == versions[1] and facts_of(changed.spec(row.index))["place"] != row.place:
        raise InputError(
            f"--map {found['name']}: this is not the map of episode {row.id}, {row.world}: its content is different; "
            "give the map as it was"
        )
    return changed


def check_there(suite: Suite, row: Row, folder: Path) -> None:
    """Refuse an episode of which a file is missing.

    Raises:
        InputError: If one is; the message says how to give it.
    """
    for path in suite.worlds[_world_of(suite, row)].files().values():
        if not exists(path):
            raise InputError(
                f"{path}: this file of episode {row.id} is not there any more; put it beside {folder / 'suite.yaml'}, "
                "or give it, or its folder, with --map"
            )


def _world_of(suite: Suite, row: Row) -> int:
    return Expansion(suite).world_of(row.index)
