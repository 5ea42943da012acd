"""The folder of an evaluation: its files, its code and suite, and whether it may be used or continued."""

from __future__ import annotations

import hashlib
import json
import platform
import subprocess
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import yaml
from pydantic import TypeAdapter, ValidationError

import trundle.version
from trundle._core import _kernels
from trundle.errors import InputError, OutputError
from trundle.files.kinds import DRIVE, RUN, find_kind
from trundle.files.opening import exists
from trundle.files.writing import write_text

COMMIT = "commit"
SOURCES = "sources"
KERNELS = "kernels"

_PACKAGES = ("numpy", "mujoco", "pydantic", "scipy", "trimesh", "usd-core", "ovphysx")
_NOT_IN_AN_EPISODE = ("cli", "record", "viewer", "teleop", "doctor", "testing", "export", "pictures")
_OF_EVALUATION = ("row.py", "suite", "episode")


def code_versions(packages: Iterable[str] = ()) -> dict[str, str]:
    """Return versions of everything that decides an episode's row.

    `sources` is a digest of the Python files and data of trundle that an episode uses, and `kernels` of the compiled
    ones; `commit` is that of trundle's checkout, where it is one.

    Args:
        packages: Further packages to list, for example of plug-ins.
    """
    versions = {"trundle": trundle.version.__version__, "python": platform.python_version()}
    for package in (*_PACKAGES, *packages):
        with suppress(PackageNotFoundError):
            versions[package] = version(package)
    versions["machine"] = platform.machine()
    package = Path(trundle.version.__file__).parent
    versions[SOURCES] = _digest(sorted(_sources(package)), package)
    compiled = Path(str(_kernels.__file__))
    versions[KERNELS] = _digest([compiled], compiled.parent)
    commit = _commit(package)
    if commit is not None:
        versions[COMMIT] = commit
    return versions


def describe_differences(before: Mapping[str, str], now: Mapping[str, str]) -> str:
    """Name what differs between two versions of the code; empty where a row is the same with both.

    Another commit with the same sources is the same code.
    """
    parts = [
        f"{name} {before.get(name, 'none')} → {now.get(name, 'none')}"
        for name in dict.fromkeys((*before, *now))
        if name not in (COMMIT, SOURCES, KERNELS) and before.get(name) != now.get(name)
    ]
    edited = [name for name in (SOURCES, KERNELS) if before.get(name) != now.get(name)]
    if edited:
        commits = [versions.get(COMMIT, "")[:10] for versions in (before, now)]
        of = f", commit {commits[0]} → {commits[1]}" if all(commits) and commits[0] != commits[1] else ""
        parts.append(f"trundle's {' and '.join(edited)}{of}")
    return "; ".join(parts)


def _sources(package: Path) -> Iterable[Path]:
    for path in package.rglob("*"):
        parts = path.relative_to(package).parts
        if "__pycache__" in parts or path.suffix not in (".py", ".yaml", ".xml", ".json", ".png", ".npz"):
            continue
        if parts[0] in _NOT_IN_AN_EPISODE or (parts[0] == "evaluation" and parts[1] not in _OF_EVALUATION):
            continue
        yield path


def _digest(files: Iterable[Path], root: Path) -> str:
    digest = hashlib.sha256()
    for file in files:
        content = file.read_bytes()
        digest.update(f"{file.relative_to(root)}\0{len(content)}\0".encode())
        digest.update(content)
    return digest.hexdigest()[:16]


def _commit(package: Path) -> str | None:
    """Return the commit of the checkout that the package is part of."""
    try:
        git = ["git", "-C", str(package)]
        tracked = subprocess.run([*git, "ls-files", "--error-unmatch", "__init__.py"], capture_output=True, check=False)
        if tracked.returncode != 0:
            return None
        head = subprocess.run([*git, "rev-parse", "HEAD"], capture_output=True, text=True, check=False)
    except OSError:  # no git
        return None
    return head.stdout.strip() or None


SUITE = "suite.yaml"
MANIFEST = "evaluation.json"
JOURNAL = "journal.jsonl"
DAMAGED_LINES = f"{JOURNAL}.damaged"
"""Lines of the journal that held no row when the evaluation was continued."""
PARTS = "parts"
SELECTION = "selection.npy"
"""The ids of the suite's episodes, by index: written where the folder also holds rows that are not of the suite."""

WRITTEN_AFTERWARDS = ("report.html", "junit.xml", "summary.json")

HOLDS_RUN = (RUN, DRIVE)


def check_free_for_evaluation(folder: Path) -> None:
    """Refuse a folder without an evaluation that holds something of which a file would be replaced.

    Raises:
        OutputError: If it holds a run, or a file of the name of one that is written.
    """
    kind = find_kind(folder)
    if kind in HOLDS_RUN:
        raise OutputError(f"{folder} is {kind}, not of an evaluation; give another folder with -o")
    held = [name for name in (SUITE, JOURNAL, PARTS, *WRITTEN_AFTERWARDS) if exists(folder / name)]
    if held:
        raise OutputError(
            f"{folder} holds no evaluation, but files that one would replace ({', '.join(held)}); give another folder "
            "with -o"
        )


def check_holds_evaluation(folder: Path) -> None:
    """Refuse a folder that is not an evaluation's.

    Raises:
        InputError: If it is not; for a run's folder, the message names the verbs for those.
    """
    if exists(folder / MANIFEST):
        return
    if not exists(folder):
        raise InputError(f"{folder}: no such folder; give the folder that trundle evaluate wrote")
    if not folder.is_dir():
        raise InputError(f"{folder}: not a folder; give the folder that trundle evaluate wrote")
    kind = find_kind(folder)
    if kind in HOLDS_RUN:
        raise InputError(
            f"{folder}: this is {kind}, not of an evaluation: trundle compare compares runs and drives, and trundle "
            "run --from runs one again"
        )
    raise InputError(f"{folder}: no {MANIFEST} in it; give the folder that trundle evaluate wrote")


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
        name: Name of the suite.
        total: Number of episodes of the suite.
        started: When the evaluation was started, as ISO 8601.
        versions: Versions of the code that its rows are made with.
        earlier_versions: Versions of other code that made some of its rows, oldest first (`--mixed`).
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
        """Write the file as a whole."""
        write_text(folder / MANIFEST, json.dumps(asdict(self), indent=2) + "\n", durable=True)


_ADAPTER = TypeAdapter(Manifest)


def check_continues(folder: Path, new: Manifest, suite_text: str, *, mixed: bool) -> Manifest:
    """Return the manifest with which the evaluation in a folder goes on.

    Args:
        folder: The folder of the evaluation.
        new: The manifest that a new evaluation would have.
        suite_text: The suite that is to be evaluated.
        mixed: Whether its rows may be made by different code.

    Raises:
        OutputError: If it is of another suite, or its rows were made by other code and `mixed` is not set.
    """
    old = Manifest.load(folder)
    if old.name != new.name:
        raise OutputError(
            f"{folder} holds the evaluation of another suite, {old.name!r} with {old.total} episodes, not "
            f"{new.name!r}{_describe_changes(folder, suite_text)}; give another folder with -o, "
            f"replace that evaluation with --overwrite, or continue it with your suite by `name: {old.name}` in it"
        )
    differences = describe_differences(old.versions, new.versions)
    if not differences:
        return replace(new, started=old.started, earlier_versions=old.earlier_versions)
    if not mixed:
        raise OutputError(
            f"{folder}: the rows that are there were made with other code ({differences}); give another folder with -o "
            "to compare the two, replace them with --overwrite, or keep them with --mixed"
        )
    return replace(new, started=old.started, earlier_versions=(*old.earlier_versions, old.versions))


def _describe_changes(folder: Path, suite_text: str) -> str:
    """Name the parts in which the two suites differ."""
    try:
        old, new = (yaml.safe_load(text) for text in ((folder / SUITE).read_text(), suite_text))
    except (OSError, UnicodeDecodeError, yaml.YAMLError):
        return ""
    if not isinstance(old, Mapping) or not isinstance(new, Mapping):
        return ""
    keys = [str(key) for key in dict.fromkeys((*old, *new)) if key != "name" and old.get(key) != new.get(key)]
    return f" (they differ in {', '.join(keys)})" if keys else ""
