"""Writing files and folders: whole or not at all, by renaming, and in a folder that no other process writes to."""

from __future__ import annotations

import errno
import fcntl
import logging
import os
import re
import stat
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from trundle.errors import OutputError
from trundle.values import as_path

_LOGGER = logging.getLogger(__name__)

LOCK = ".lock"
"""The file by which a folder is locked."""

DISK_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""Errors of a system that has no room for a file."""

_ADVICE = {
    errno.ENOSPC: "free space on that disk, or write to another one",
    errno.EDQUOT: "free space of yours on that disk, or write to another one",
    errno.EFBIG: "raise the limit on the size of files (ulimit -f), or write less",
    errno.EROFS: "write to another disk",
}


@contextmanager
def atomic_path(target: str | os.PathLike[str], *, durable: bool = False) -> Iterator[Path]:
    """Give a temporary path of the same suffix beside `target`; rename it over `target` if the block succeeds.

    A file that is replaced keeps its permissions.

    Args:
        target: The file to write.
        durable: Return only when the file and its name are on the disk, so that they survive a power cut.

    Raises:
        OutputError: If the folder does not exist or cannot be written to. Nothing is left behind.
    """
    path = output_path(target)
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}-", suffix=path.suffix)
        os.close(handle)
    except OSError as error:
        raise cannot_write(path, error) from error
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(_permissions(path))
        if durable:
            sync_file(temporary)
        temporary.replace(path)
        if durable:
            sync_folder(path.parent)
    except OSError as error:
        raise cannot_write(path, error) from error
    finally:
        temporary.unlink(missing_ok=True)


def cannot_write(what: str | os.PathLike[str], error: OSError) -> OutputError:
    """Return the error of a file that could not be written: which, why, and what to do if the disk is full."""
    reason = f"cannot write {os.fspath(what)}: {error.strerror or error}"
    return OutputError(f"{reason}; {_ADVICE[error.errno]}" if error.errno in _ADVICE else reason)


def write_bytes(target: str | os.PathLike[str], content: bytes, *, durable: bool = False) -> None:
    """Write a file atomically; see `atomic_path`."""
    with atomic_path(target, durable=durable) as temporary:
        temporary.write_bytes(content)


def write_new_bytes(target: str | os.PathLike[str], content: bytes) -> bool:
    """Write a file atomically and durably, unless a file of that name exists.

    Returns:
        Whether it was written; False if the name is taken.

    Raises:
        OutputError: If the folder does not exist or cannot be written to. Nothing is left behind.
    """
    path = output_path(target)
    temporary: Path | None = None
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}-", suffix=path.suffix)
        temporary = Path(name)
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fchmod(handle, 0o666 & ~_umask())
            os.fsync(handle)
        try:
            path.hardlink_to(temporary)  # Unlike a rename, it fails where the name is taken.
        except FileExistsError:
            return False
        except OSError:  # A file system without links.
            if path.exists():
                return False
            temporary.replace(path)
        sync_folder(path.parent)
    except OSError as error:
        raise cannot_write(path, error) from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
    return True


def write_text(target: str | os.PathLike[str], content: str, *, durable: bool = False) -> None:
    """Write a UTF-8 text file atomically; see `atomic_path`."""
    write_bytes(target, content.encode(), durable=durable)


def sync_file(path: Path) -> None:
    """Flush a file's content, or a folder's entries, to disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def sync_folder(folder: str | os.PathLike[str]) -> None:
    """Flush a folder's entries to disk: files created, renamed or deleted in it."""
    with suppress(OSError):  # some network file systems cannot sync folders
        sync_file(Path(folder))


def make_folder(target: str | os.PathLike[str]) -> Path:
    """Create a writable folder with its parents.

    Raises:
        OutputError: If it cannot be created or written to.
    """
    folder = output_path(target)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise cannot_write(f"to the folder {folder}", error) from error
    return folder


def new_folder(root: str | os.PathLike[str], name: str) -> Path:
    """Create a folder `<time>-<name>` in `root` that no one else has.

    Raises:
        OutputError: If it cannot be created.
    """
    parent = make_folder(root)
    tidy = re.sub(r"[^\w.-]+", "-", name).strip("-.") or "run"
    stem = f"{time.strftime('%Y%m%d-%H%M%S')}-{tidy}"
    number = 1
    while True:
        folder = parent / (stem if number == 1 else f"{stem}-{number}")
        try:
            folder.mkdir()
        except FileExistsError:
            number += 1
            continue
        except OSError as error:
            raise cannot_write(f"to the folder {folder}", error) from error
        sync_folder(parent)
        return folder


def output_path(target: str | os.PathLike[str]) -> Path:
    """Return the path of an output file or folder.

    Raises:
        OutputError: If it is not a valid path.
    """
    path = as_path(target, "a file or folder to write", OutputError)
    if "\0" in path:
        raise OutputError(f"cannot write {path!r}: a path must not contain a null character")
    return Path(path)


def path_beside(name: str, target: str | os.PathLike[str]) -> str:
    """Return the path by which a file that is to be written at `target` names another file.

    It is relative to the folder of `target` if both are below the current folder, so that they can be moved
    together; else it is absolute.
    """
    here, folder, other = Path.cwd(), output_path(target).resolve().parent, Path(name).resolve()
    together = Path(name).suffix and other.is_relative_to(here) and folder.is_relative_to(here)
    return os.path.relpath(other, folder) if together else str(other)


def _permissions(path: Path) -> int:
    """Return the permissions of the file to replace, or the default ones of a new file."""
    try:
        return stat.S_IMODE(path.stat().st_mode)
    except FileNotFoundError:
        return 0o666 & ~_umask()


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


class FolderLock:
    """Holds a folder until `release`; the lock ends with its process.

    A file system that cannot lock files is used without a lock.

    Args:
        folder: The folder; it is created if it does not exist.
        user: What uses it, for the message to a second one ("run").

    Raises:
        OutputError: If another process holds it; its number is named.
        OSError: If the folder cannot be written to.
    """

    def __init__(self, folder: Path, user: str) -> None:
        self._path = folder / LOCK
        self._descriptor = _lock(folder, user)

    def release(self) -> None:
        """Release the folder; a second time does nothing."""
        if self._descriptor is None:
            return
        self._path.unlink(missing_ok=True)
        os.close(self._descriptor)
        self._descriptor = None


def _lock(folder: Path, user: str) -> int | None:
    """Lock a folder by a file in it, and return its descriptor; None if the file system cannot lock files."""
    path = folder / LOCK
    while True:
        folder.mkdir(parents=True, exist_ok=True)  # Whoever held the lock may have removed it, and the folder.
        with suppress(FileNotFoundError):
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if os.path.samestat(os.fstat(descriptor), path.stat()):
                    os.ftruncate(descriptor, 0)
                    os.write(descriptor, f"{os.getpid()}\n".encode())
                    return descriptor
            except BlockingIOError:
                owner = os.read(descriptor, 20).decode(errors="replace").strip() or "?"
                os.close(descriptor)
                raise OutputError(f"another {user} (process {owner}) is writing into {folder}") from None
            except FileNotFoundError:
                pass
            except OSError as error:
                os.close(descriptor)
                path.unlink(missing_ok=True)
                _LOGGER.info("%s cannot be locked: %s", folder, error)
                return None
            os.close(descriptor)
