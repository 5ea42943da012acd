"""Resolving model://, package://, file:// and plain paths in world and robot files."""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TypeAlias
from urllib.parse import unquote, urlsplit

Folders: TypeAlias = str | os.PathLike[str] | Iterable[str | os.PathLike[str]]

SEARCH_VARIABLES = (
    "GZ_SIM_RESOURCE_PATH",
    "IGN_GAZEBO_RESOURCE_PATH",
    "GAZEBO_MODEL_PATH",
    "GAZEBO_RESOURCE_PATH",
    "AMENT_PREFIX_PATH",
    "ROS_PACKAGE_PATH",
)
"""Environment variables of Gazebo and ROS that name folders, in the order in which they are searched."""

_ABOVE = 3  # folders above the file that are searched


def split_folders(folders: Folders) -> tuple[Path, ...]:
    """Return folders given as a sequence, or as one text with the system's path separator between them."""
    if isinstance(folders, str):
        return tuple(Path(part) for part in folders.split(os.pathsep) if part)
    if isinstance(folders, os.PathLike):
        return (Path(folders),)
    return tuple(Path(folder) for folder in folders)


def find_uri(uri: str, base: Path, folders: tuple[Path, ...]) -> Path | None:
    """Return the file or folder that a URI names, or None if it does not exist.

    A plain or file:// path is searched beside the file that names it and in the folders above. The name in
    model://NAME/… or package://NAME/… is a folder above the file, or in `models` there. Then the given folders are
    searched, then those in Gazebo's and ROS's environment variables, then Gazebo's own in the home folder. An address
    of Gazebo Fuel is looked up among the models that Gazebo has downloaded; nothing is downloaded here.

    Args:
        uri: The URI as written in the file.
        base: Folder of that file.
        folders: Further folders to search.
    """
    scheme, mark, rest = uri.partition("://")
    if not mark:
        scheme, rest = "file", uri
    if scheme in ("http", "https"):
        return _find_downloaded(uri)
    if scheme not in ("model", "package", "file"):
        return None
    path = Path(unquote(rest))
    try:
        if path.is_absolute():
            return path if path.exists() else None
        name = path.parts[0] if path.parts else ""
        own = (folder.joinpath(*path.parts[1:]) for folder in _own_versions(name, base) if scheme == "model")
        searched = (folder / path for folder in _search(scheme, name, base, folders))
        return next((place for place in itertools.chain(own, searched) if place.exists()), None)
    except (OSError, ValueError):  # a name too long, or with a NUL
        return None


def describe_search(folders: tuple[Path, ...]) -> str:
    """Describe the places that `find_uri` searches, for messages."""
    given = os.pathsep.join(map(str, folders)) or "none"
    there = [f"{name}={os.environ[name]}" for name in SEARCH_VARIABLES if os.environ.get(name)]
    missing = [name for name in SEARCH_VARIABLES if not os.environ.get(name)]
    texts = [
        f"the file's own folder, the {_ABOVE} above it and `models` in each",
        f"--paths ({given})",
        *there,
        f"the home folder's {', '.join(_HOME_FOLDERS)}",
    ]
    return "; ".join(texts) + (f" (not set: {', '.join(missing)})" if missing else "")


def _search(scheme: str, name: str, base: Path, folders: tuple[Path, ...]) -> Iterator[Path]:
    """Yield the folders to search, the nearest first."""
    above = list(base.resolve().parents)[:_ABOVE]
    yield from (base, *above) if scheme == "file" else (*above, base)
    yield from (folder / "models" for folder in (base, *above))
    yield from folders
    for variable in SEARCH_VARIABLES:
        for folder in split_folders(os.environ.get(variable, "")):
            yield from _expand(variable, name, folder)
    yield from (Path.home() / folder for folder in _HOME_FOLDERS)


def _expand(variable: str, name: str, folder: Path) -> Iterator[Path]:
    """Yield the folders that one entry of an environment variable adds to the search."""
    if variable == "AMENT_PREFIX_PATH":
        share = folder / "share"
        yield share
        # Packages with models export this folder to Gazebo.
        yield from sorted(share.glob("*/models"))
        return
    yield folder
    if variable == "ROS_PACKAGE_PATH":
        if folder.name == name:
            yield folder.parent
        # Packages of a repository lie one folder deeper.
        yield from (found.parent for found in sorted(folder.glob(f"*/{_literal(name)}")) if name)
        yield from sorted(folder.glob("*/models"))


def _literal(name: str) -> str:
    """Return a glob pattern that matches exactly this name."""
    return re.sub(r"([*?\[])", r"[\1]", name)


# Gazebo Fuel --------------------------------------------------------------------------------------------------------

_HOME_FOLDERS = (".gazebo/models",)
_FUEL_CACHES = (".gz/fuel", ".ignition/fuel")


def fuel_caches() -> tuple[Path, ...]:
    """Return the folders where Gazebo keeps its downloads from Fuel."""
    named = [os.environ.get(name, "") for name in ("GZ_FUEL_CACHE_PATH", "IGN_FUEL_CACHE_PATH")]
    return (*(Path(path) for path in named if path), *(Path.home() / folder for folder in _FUEL_CACHES))


def _find_downloaded(address: str) -> Path | None:
    """Find the download of an address like https://fuel.gazebosim.org/1.0/OWNER/models/NAME[/VERSION][/files/PATH]."""
    try:
        parts = urlsplit(address)
    except ValueError:
        return None
    words = [unquote(word) for word in parts.path.split("/") if word]
    if words and re.fullmatch(r"\d+\.\d+", words[0]):
        words = words[1:]
    if len(words) < 3 or words[1] not in ("models", "worlds") or ".." in words:
        return None
    owner, kind, name, *rest = words
    version = rest.pop(0) if rest and (rest[0].isdigit() or rest[0] == "tip") else "tip"
    inside = Path(*rest[1:]) if rest[:1] == ["files"] else Path(*rest)
    for cache in fuel_caches():
        for server in dict.fromkeys((parts.hostname or "", "fuel.gazebosim.org", "fuel.ignitionrobotics.org")):
            # Gazebo writes these names in lower case.
            home = cache / server / owner.lower() / kind / name.lower()
            found = home / version if version != "tip" else _newest(home)
            if found is not None and (found / inside).exists():
                return found / inside
    return None


def _own_versions(name: str, base: Path) -> Iterator[Path]:
    """Yield the folder of a downloaded model that refers to itself: it lies in its version's folder, NAME/3."""
    for folder in (base, *list(base.parents)[:_ABOVE]):
        if folder.name.isdigit() and folder.parent.name.lower() == name.lower():
            yield folder


def _newest(home: Path) -> Path | None:
    """Return the newest version of a downloaded model, whose folders are named by version number."""
    try:
        versions = [folder for folder in home.iterdir() if folder.name.isdigit() and folder.is_dir()]
    except OSError:
        return None
    return max(versions, key=lambda folder: int(folder.name), default=None)
