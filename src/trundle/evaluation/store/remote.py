"""An evaluation's folder in an object store (`s3://`, `gs://`), and its copy on this machine."""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from trundle.errors import OutputError
from trundle.evaluation.store.folder import JOURNAL, MANIFEST, PARTS, SELECTION, SUITE, WRITTEN_AFTERWARDS
from trundle.extras import missing_extra

_URI = re.compile(r"[a-z][a-z0-9+.-]+://")
_KEPT = (MANIFEST, SUITE, SELECTION, JOURNAL)


def is_remote(out: object) -> bool:
    """Return whether this names an object store (`s3://bucket/folder`) and no folder."""
    return isinstance(out, str) and _URI.match(out) is not None


class RemoteFolder:
    """Files below a URI, through pyarrow.

    Args:
        uri: `s3://bucket/folder`, `gs://bucket/folder`, or `file:///folder`.

    Raises:
        OutputError: If there is no such file system.
        MissingExtraError: If pyarrow is not installed.
    """

    def __init__(self, uri: str) -> None:
        try:
            from pyarrow import fs  # pyright: ignore[reportMissingImports] - an extra
        except ImportError as error:
            raise missing_extra(f"the folder {uri}", "pyarrow", "ray") from error
        self.uri = uri
        self._regular = fs.FileType.File
        self._selector: Any = fs.FileSelector
        try:
            self._files, self._root = fs.FileSystem.from_uri(uri)
        except (OSError, ValueError) as error:
            raise OutputError(f"cannot use the folder {uri}: {error}") from error

    def list(self, below: str = "") -> list[str]:
        """Return names of the files in it, or in a folder of it.

        Raises:
            OutputError: If it cannot be read.
        """
        folder = f"{self._root}/{below}" if below else self._root
        try:
            found = self._files.get_file_info(self._selector(folder, allow_not_found=True))
        except OSError as error:
            raise OutputError(f"cannot read {self.uri}: {error}") from error
        return sorted(info.base_name for info in found if info.type == self._regular)

    def get(self, name: str, target: Path) -> None:
        """Copy a file from it.

        Raises:
            OutputError: If that fails.
        """
        try:
            with self._files.open_input_stream(f"{self._root}/{name}") as source, target.open("wb") as stream:
                shutil.copyfileobj(source, stream, 1 << 20)
        except OSError as error:
            raise OutputError(f"cannot read {self.uri}/{name}: {error}") from error

    def put(self, source: Path, name: str) -> None:
        """Copy a file to it; an object store shows the file when it is whole.

        Raises:
            OutputError: If that fails.
        """
        path = f"{self._root}/{name}"
        try:
            self._files.create_dir(path.rpartition("/")[0], recursive=True)
            with source.open("rb") as stream, self._files.open_output_stream(path) as target:
                shutil.copyfileobj(stream, target, 1 << 20)
        except OSError as error:
            raise OutputError(f"cannot write {self.uri}/{name}: {error}") from error


class Staged:
    """An evaluation's folder on this machine: itself, or the copy of one in an object store.

    Attributes:
        folder: On this machine.
        remote: Where it is a copy.
    """

    def __init__(self, folder: Path, remote: RemoteFolder | None) -> None:
        self.folder = folder
        self.remote = remote

    def pull(self, names: Sequence[str] = _KEPT) -> None:
        """Fetch what the store has and the copy has not, and these files again; parts never change."""
        if self.remote is None:
            return
        (self.folder / PARTS).mkdir(exist_ok=True)
        held = {name for name in self.remote.list() if name in names}
        for name in sorted(held):
            self.remote.get(name, self.folder / name)
        for name in self.remote.list(PARTS):
            if name.endswith(".parquet") and not (self.folder / PARTS / name).exists():
                self.remote.get(f"{PARTS}/{name}", self.folder / PARTS / name)

    def push(self, names: Sequence[str] = (SUITE, MANIFEST, SELECTION, *WRITTEN_AFTERWARDS)) -> None:
        """Send files of the copy to the store; those that are not there are left out."""
        if self.remote is None:
            return
        for name in names:
            if (self.folder / name).exists():
                self.remote.put(self.folder / name, name)


@contextmanager
def staged(out: str | Path) -> Iterator[Staged]:
    """Give an evaluation's folder on this machine; for one in an object store, a copy that is deleted afterwards.

    Raises:
        OutputError: If the store cannot be read.
        MissingExtraError: If it needs pyarrow, which is not installed.
    """
    if not (isinstance(out, str) and is_remote(out)):
        yield Staged(Path(out), None)
        return
    with tempfile.TemporaryDirectory(prefix="trundle-") as name:
        copy = Staged(Path(name), RemoteFolder(out))
        copy.pull()
        if not (copy.folder / MANIFEST).exists():  # a new one, which starts with an empty folder
            shutil.rmtree(copy.folder / PARTS)
        yield copy
