"""`FolderClaim`: exclusive use of a run's folder, without losing an earlier run in it."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Self

from trundle.errors import OutputError
from trundle.files.writing import FolderLock, make_folder, new_folder, sync_folder

_LOGGER = logging.getLogger(__name__)

RUN_FILES = (
    "episode.json",
    "drive.csv",
    "trajectory.npz",
    "paths.npz",
    "directives.json",
    "scenario.yaml",
    "report.html",
    "overlay.png",
    "video.mp4",
    "video.gif",
    "run.mcap",
    "own_map.yaml",
    "own_map.png",
    "own_map_overlay.png",
    "own_map.mp4",
    "own_map.gif",
)
"""Files that mark a folder as a run's. The first two are written last and complete it."""

PREVIOUS = "previous-run"
"""Subfolder that keeps the old run while it is being replaced."""


def check_free(out: str | os.PathLike[str] | None, *, overwrite: bool = False, extra: Sequence[str] = ()) -> None:
    """Refuse a folder that already holds a run, before any work is done.

    Args:
        out: The folder. By default, a new one is made.
        overwrite: Whether to replace its run.
        extra: Names of further files that will be written.

    Raises:
        OutputError: If it holds a run.
    """
    if out is None or overwrite:
        return
    folder = Path(out)
    held = [name for name in (*RUN_FILES, *extra, PREVIOUS) if os.path.lexists(folder / name)]
    if held:
        raise OutputError(
            f"{folder} already holds a run ({', '.join(held)}); give another folder with -o, or replace that run with "
            "--overwrite"
        )


class FolderClaim:
    """Exclusive use of a folder while the claim is open; use it in a `with` block.

    An empty folder is removed at the end if it was created here.

    Args:
        out: The folder. By default, it is a new `runs/<time>-<name>`.
        name: Name of the run, for the folder's name.
        overwrite: Replace the run that the folder holds.
        extra: Names of files that the run writes in addition to `RUN_FILES`.
        root: Parent of new folders.

    Attributes:
        path: The folder.

    Raises:
        OutputError: If the folder holds a run, another run is writing there, or it cannot be written to.
    """

    def __init__(
        self,
        out: str | os.PathLike[str] | None,
        name: str,
        *,
        overwrite: bool = False,
        extra: Sequence[str] = (),
        root: str | os.PathLike[str] = "runs",
    ) -> None:
        self._files = (*RUN_FILES, *extra)
        self._is_new = out is None or not Path(out).exists()
        try:
            self.path = new_folder(root, name) if out is None else make_folder(out)
            self._lock = FolderLock(self.path, "run")
        except OutputError as error:
            raise OutputError(f"{error}; give another folder with -o") from error
        except OSError as error:
            raise OutputError(f"cannot write to the folder {out or root}: {error}; give another with -o") from error
        self._is_open = True
        self._previous = self.path / PREVIOUS
        try:
            if not self._is_recorded():
                self._put_back()
            check_free(self.path, overwrite=overwrite, extra=extra)
        except BaseException:
            self.close()
            raise

    @contextmanager
    def replacing(self) -> Iterator[None]:
        """Set the folder's old run aside while the block writes the new one; delete it when the block has ended.

        If the block fails, or is killed, before it has written `episode.json` or `drive.csv`, the old run is restored:
        at once, or by the next claim. After that both exist, the old one in `PREVIOUS`.

        Raises:
            OutputError: If the old run cannot be moved.
        """
        self._try(self._put_aside)
        try:
            yield
        except BaseException:
            if not self._is_recorded():
                self._try(self._put_back)
            raise
        self._try(self._drop_previous)

    def close(self) -> None:
        """Release the folder; closing twice does nothing."""
        if not self._is_open:
            return
        self._is_open = False
        self._lock.release()
        if self._is_new:
            with suppress(OSError):  # it is not empty: keep it
                self.path.rmdir()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _try(self, move: Callable[[], None]) -> None:
        try:
            move()
        except OSError as error:
            raise OutputError(f"cannot replace the run in {self.path}: {error}") from error

    def _is_recorded(self) -> bool:
        """Return whether the folder holds a run's record other than the old one."""
        return any((self.path / name).exists() for name in RUN_FILES[:2])

    def _put_aside(self) -> None:
        held = [name for name in self._files if os.path.lexists(self.path / name)]
        if not held:
            return
        self._drop_previous()  # of a replacement that was killed after its record was written
        self._previous.mkdir()
        for name in held:
            (self.path / name).rename(self._previous / name)
        sync_folder(self.path)

    def _put_back(self) -> None:
        if not self._previous.is_dir():
            return
        for path in self._previous.iterdir():
            path.replace(self.path / path.name)
        self._previous.rmdir()
        sync_folder(self.path)
        _LOGGER.info("replacing the run in %s was interrupted: the old run is restored", self.path)

    def _drop_previous(self) -> None:
        if not self._previous.is_dir():
            return
        for path in self._previous.iterdir():
            path.unlink()
        self._previous.rmdir()
