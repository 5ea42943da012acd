"""`FolderLock`: exclusive use of a folder by one process, which ends with that process."""

from __future__ import annotations

import fcntl
import logging
import os
from contextlib import suppress
from pathlib import Path

from trundle.errors import OutputError

_LOGGER = logging.getLogger(__name__)

LOCK = ".lock"


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
    """Lock a folder by a file in it. None where files cannot be locked."""
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
