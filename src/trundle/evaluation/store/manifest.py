"""`Manifest`: what an evaluation's folder says of itself, in `evaluation.json`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from trundle.errors import InputError
from trundle.evaluation.store.layout import MANIFEST
from trundle.files.writing import write_text


@dataclass(frozen=True, slots=True, kw_only=True)
class Stopped:
    """Why an evaluation has ended without a row for each episode.

    Attributes:
        reason: "from outside", "by its time budget", or empty where all is done that is to be done.
        in_flight_s: For how long the episodes had been driven that had begun and have no row [s].
        left_out: How many episodes were left out, as their combination of planner, controller, backend and settings was
            given up.
    """

    reason: str
    in_flight_s: tuple[float, ...] = ()
    left_out: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Manifest:
    """What an evaluation's folder says of itself.

    Attributes:
        name: Of the suite.
        total: Number of episodes of the suite.
        started: When the evaluation was started, as ISO 8601.
        versions: Of the code that its rows are made with.
        earlier_versions: Of other code that made some of its rows, oldest first (`--mixed`).
        stopped: Why it has ended without a row for each episode; None while it runs, after a kill, and at the end.
    """

    name: str
    total: int
    started: str
    versions: Mapping[str, str]
    earlier_versions: tuple[Mapping[str, str], ...] = ()
    stopped: Stopped | None = None

    @classmethod
    def load(cls, folder: Path) -> Manifest:
        """Read it.

        Raises:
            InputError: If it cannot be read.
        """
        file = folder / MANIFEST
        try:
            return _ADAPTER.validate_python(json.loads(file.read_bytes()))
        except OSError as error:
            raise InputError(f"cannot read {file}: {error.strerror or error}") from error
        except (ValidationError, ValueError, RecursionError) as error:
            raise InputError(
                f"{file}: it is damaged ({str(error).splitlines()[0]}): restore it from a copy, or give another folder"
            ) from error

    def save(self, folder: Path) -> None:
        """Write it whole."""
        write_text(folder / MANIFEST, json.dumps(asdict(self), indent=2) + "\n", durable=True)


_ADAPTER = TypeAdapter(Manifest)
