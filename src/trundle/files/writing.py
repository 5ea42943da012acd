"""Writing files that a kill cannot tear: to a temporary name beside the target, then renamed over it."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from trundle.errors import OutputError
from trundle.values import as_path


@contextmanager
def atomic_path(target: str | os.PathLike[str], *, durable: bool = False) -> Iterator[Path]:
    """Give a temporary path of the same suffix beside `target`; rename it over `target` when the block ends well.

    A file that is replaced keeps its permissions.

    Args:
        target: What is to be written.
        durable: Return only when the file and its name are on the disk, so that a power cut does not undo it.

    Raises:
        OutputError: If the folder does not exist or cannot be written to. Nothing is left behind.
    """
    path = output_path(target)
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}-", suffix=path.suffix)
        os.close(handle)
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror or error}") from error
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(_permissions(path))
        if durable:
            _sync(temporary)
        temporary.replace(path)
        if durable:
            sync_folder(path.parent)
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        temporary.unlink(missing_ok=True)


def write_bytes(target: str | os.PathLike[str], content: bytes, *, durable: bool = False) -> None:
    """Write a whole file, or leave what was there; see `atomic_path`."""
    with atomic_path(target, durable=durable) as temporary:
        temporary.write_bytes(content)


def write_new_bytes(target: str | os.PathLike[str], content: bytes) -> bool:
    """Write a file whole and onto the disk, unless there is one of that name.

    Returns:
        Whether it was written; False where the name is taken.

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
        raise OutputError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
    return True


def write_text(target: str | os.PathLike[str], content: str, *, durable: bool = False) -> None:
    """Write a whole text file in UTF-8, or leave what was there; see `atomic_path`."""
    write_bytes(target, content.encode(), durable=durable)


def sync_folder(folder: str | os.PathLike[str]) -> None:
    """Put a folder's names on the disk: what was created, renamed or deleted in it."""
    with suppress(OSError):  # a file system that cannot do it for folders, as some over a network
        _sync(Path(folder))


def make_folder(target: str | os.PathLike[str]) -> Path:
    """Create a folder, with its parents, that can be written to.

    Raises:
        OutputError: If it cannot be created or written to.
    """
    folder = output_path(target)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise OutputError(f"cannot write to the folder {folder}: {error.strerror or error}") from error
    return folder


def output_path(target: str | os.PathLike[str]) -> Path:
    """The path of what is to be written.

    Raises:
        OutputError: If it cannot be a path.
    """
    path = as_path(target, "a file or folder to write", OutputError)
    if "\0" in path:
        raise OutputError(f"cannot write {path!r}: no path has a null character in it")
    return Path(path)


def _permissions(path: Path) -> int:
    """Those of the file that is replaced, or those that a new file gets."""
    try:
        return stat.S_IMODE(path.stat().st_mode)
    except FileNotFoundError:
        return 0o666 & ~_umask()


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
