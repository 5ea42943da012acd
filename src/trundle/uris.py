"""What model://, package://, file:// and plain paths in worlds and robots mean."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import TypeAlias
from urllib.parse import unquote

Folders: TypeAlias = str | os.PathLike[str] | Iterable[str | os.PathLike[str]]


def split_folders(folders: Folders) -> tuple[Path, ...]:
    """Take folders as a sequence, or as one text with the system's path separator between them."""
    if isinstance(folders, str):
        return tuple(Path(part) for part in folders.split(os.pathsep) if part)
    if isinstance(folders, os.PathLike):
        return (Path(folders),)
    return tuple(Path(folder) for folder in folders)


def find_uri(uri: str, base: Path, folders: tuple[Path, ...]) -> Path | None:
    """The file or folder that a URI names, or none where it is not there.

    A plain or file:// path is looked for beside the file that names it and above, then in the folders. The name in
    model://NAME/… or package://NAME/… is a folder above the file, or one in the folders.

    Args:
        uri: What the file says.
        base: Folder of the file that says it.
        folders: Where else to look.
    """
    scheme, mark, rest = uri.partition("://")
    if not mark:
        scheme, rest = "file", uri
    if scheme not in ("model", "package", "file"):
        return None
    path = Path(unquote(rest))
    if path.is_absolute():
        return path if path.exists() else None
    above = (base.parent, base.parent.parent, base.parent.parent.parent)
    near = (base, *above) if scheme == "file" else (*above, base)
    return next((folder / path for folder in (*near, *folders) if (folder / path).exists()), None)


def describe_search(folders: tuple[Path, ...]) -> str:
    """Where `find_uri` looked, for messages."""
    return f"the file's own folder, those above it and {os.pathsep.join(map(str, folders)) or 'no others'}"
