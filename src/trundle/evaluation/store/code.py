"""The code that makes an episode's row: versions, commit, and a digest of the sources that notices an edit."""

from __future__ import annotations

import hashlib
import platform
import subprocess
from collections.abc import Iterable, Mapping
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import trundle.version
from trundle._core import _kernels

COMMIT = "commit"
SOURCES = "sources"
KERNELS = "kernels"

_PACKAGES = ("numpy", "mujoco", "pydantic", "scipy", "trimesh", "usd-core", "ovphysx")
_NOT_IN_AN_EPISODE = ("cli", "record", "viewer", "teleop", "doctor", "testing", "export", "pictures")
_OF_EVALUATION = ("row.py", "suite", "episode")


def code_versions(packages: Iterable[str] = ()) -> dict[str, str]:
    """Versions of everything that decides an episode's row.

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
    """The commit of the checkout that the package is part of."""
    try:
        git = ["git", "-C", str(package)]
        tracked = subprocess.run([*git, "ls-files", "--error-unmatch", "__init__.py"], capture_output=True, check=False)
        if tracked.returncode != 0:
            return None
        head = subprocess.run([*git, "rev-parse", "HEAD"], capture_output=True, text=True, check=False)
    except OSError:  # no git
        return None
    return head.stdout.strip() or None
