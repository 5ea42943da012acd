"""Files of run folders, and nothing else on the disk."""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path

_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.\-]{0,99}")
"""Names of files that are served: one name, without separators, which does not begin with a dot."""

MAX_FILE_BYTES = 128 * 2**20

_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".json": "application/json",
    ".yaml": "text/plain; charset=utf-8",
    ".csv": "text/plain; charset=utf-8",
    ".png": "image/png",
    ".gif": "image/gif",
    ".mp4": "video/mp4",
}


@dataclass(frozen=True, slots=True)
class ServedFile:
    """What is sent for a file.

    Attributes:
        content: Its bytes.
        kind: Its media type; files of no known type are offered as downloads.
    """

    content: bytes
    kind: str

    @property
    def is_download(self) -> bool:
        """Whether a browser is to save it instead of showing it."""
        return self.kind == "application/octet-stream"


class TooLargeError(OSError):
    """A file that is too large to be served."""


def read_run_file(folder: Path, name: str) -> ServedFile:
    """Read a regular file that lies directly in a run's folder; links are not followed.

    Raises:
        OSError: If there is no such file, it is a link or no regular file, or its name is not that of one.
        TooLargeError: If it is larger than `MAX_FILE_BYTES`.
    """
    if not _NAME.fullmatch(name):
        raise FileNotFoundError(name)
    inside = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        handle = os.open(name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK, dir_fd=inside)
    finally:
        os.close(inside)
    with os.fdopen(handle, "rb") as stream:
        found = os.fstat(stream.fileno())
        if not stat.S_ISREG(found.st_mode):
            raise FileNotFoundError(name)
        if found.st_size > MAX_FILE_BYTES:
            raise TooLargeError(f"{name} has {found.st_size / 1e6:.0f} MB: open it in the folder of the run")
        return ServedFile(
            stream.read(MAX_FILE_BYTES), _TYPES.get(Path(name).suffix.lower(), "application/octet-stream")
        )


def list_run_files(number: int, folder: Path) -> str:
    """Return a page with links to the files of a run's folder."""
    with os.scandir(folder) as entries:
        names = sorted(
            entry.name for entry in entries if entry.is_file(follow_symlinks=False) and _NAME.fullmatch(entry.name)
        )
    rows = "".join(f'<li><a href="/runs/{number}/{name}">{name}</a></li>' for name in names)
    title = escape(folder.name)
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{title}</title>'
        f"<h1>{title}</h1><p>{escape(str(folder))}</p><ul>{rows}</ul></html>"
    )


def find_run_file(folders: Mapping[int, Path], path: str) -> tuple[int, Path, str] | None:
    """Split `/runs/<n>/<name>` into the run's number, its folder and the file's name, which is "" for the list.

    Returns:
        These, or None if the path is no such path.
    """
    found = re.fullmatch(r"/runs/([0-9]{1,6})/([^/]*)", path)
    if found is None or int(found[1]) not in folders:
        return None
    return int(found[1]), folders[int(found[1])], found[2]
