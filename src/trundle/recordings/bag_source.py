"""`BagSource`: a bag that is read more than once, or what could be recovered of it."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
import weakref
from collections.abc import Iterator
from pathlib import Path

from trundle.bags.bag_reader import BagReader
from trundle.errors import InputError
from trundle.messages.codec import Distro
from trundle.recordings.drive import Remarks


class DamagedError(Exception):
    """The bag ends early, or is damaged on the way; it can be recovered."""


class BagSource:
    """A bag, or what could be recovered of it.

    Attributes:
        path: The bag.
        remarks: What there is to say of it.
        damage: What cut it off; empty where it was not recovered, or nothing is lost.
        recovered: A whole bag of what could be read, for as long as this is kept; None where it was not recovered.
    """

    def __init__(self, path: Path, distro: Distro, remarks: Remarks) -> None:
        self.path, self.remarks = path, remarks
        self._distro: Distro = distro
        self.damage = ""
        self.recovered: Path | None = None
        self._has_tried = False

    @contextlib.contextmanager
    def open(self) -> Iterator[BagReader]:
        """Open it to read."""
        try:
            with BagReader(self.recovered or self.path, distro=self._distro) as bag:
                yield bag
        except InputError as error:
            if not self._has_tried and self._find_file() is not None and "damaged" in str(error):
                raise DamagedError from error
            raise

    def recover(self) -> None:
        """Recover the bag, and go on with what can be read of it.

        Raises:
            InputError: If nothing can.
        """
        from trundle.bags.recovery import recover

        file = self._find_file()
        if file is None:
            raise InputError(f"{self.path}: the bag is damaged")
        folder = tempfile.mkdtemp(prefix="trundle-bag-")
        weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        self._has_tried = True
        done = recover(file, Path(folder) / "drive.mcap")
        self.recovered, self.damage = done.path, done.damage or ""
        self.remarks.note(
            f"the recording is cut off or damaged ({done.damage or 'its index is wrong'}): what could be read is used, "
            f"{done.duration_s:.1f} s"
        )

    def _find_file(self) -> Path | None:
        """Return the only MCAP file of the bag."""
        if self.path.is_dir():
            found = sorted(self.path.glob("*.mcap"))
            return found[0] if len(found) == 1 else None
        return self.path if self.path.suffix == ".mcap" else None
