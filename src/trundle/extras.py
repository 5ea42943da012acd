"""The extras: which optional libraries each one has, and the line that installs it beside this trundle."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import json
import os
import platform
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit
from urllib.request import url2pathname

from trundle.errors import MissingExtraError

NO_WHEELS_FROM = (3, 14)
"""The first Python for which Cyclone DDS has no wheels."""


@dataclass(frozen=True, slots=True)
class Extra:
    """An extra of trundle.

    Attributes:
        purpose: What it is for.
        modules: The module to import of each distribution.
    """

    purpose: str
    modules: dict[str, str]


_BAGS = {"rosbags": "rosbags", "mcap": "mcap", "zstandard": "zstandard"}

# The same distributions as in pyproject.toml, which a test compares.
EXTRAS = {
    "gpu": Extra("the batch simulator on NVIDIA GPUs", {"warp-lang": "warp"}),
    "video": Extra("videos of runs as MP4 instead of GIF", {"av": "av"}),
    "record": Extra("--record, trundle record: runs as rosbag2, and bags as runs", _BAGS),
    "ros2": Extra("trundle ros2", {**_BAGS, "cyclonedds": "cyclonedds"}),
    "usd": Extra("USD worlds and robots", {"usd-core": "pxr.Usd", "scipy": "scipy.spatial"}),
    "mesh": Extra("mesh files: GLB, DAE and others", {"trimesh": "trimesh", "pycollada": "collada"}),
    "evaluate": Extra(
        "large evaluations, their SQL and tables, plug-ins of notebooks",
        {"duckdb": "duckdb", "pandas": "pandas", "cloudpickle": "cloudpickle"},
    ),
    "ray": Extra(
        "evaluations on a cluster, and folders in an object store",
        {"ray": "ray", "pyarrow": "pyarrow", "cloudpickle": "cloudpickle"},
    ),
    "policy": Extra("policies in ONNX files as agents", {"onnxruntime": "onnxruntime"}),
    "gym": Extra("trundle.gym: environments for learning", {"gymnasium": "gymnasium"}),
    "pandas": Extra("tables of trajectories", {"pandas": "pandas"}),
    "physx": Extra(
        "--backend physx: NVIDIA PhysX on the CPU, under NVIDIA's licence",
        {
            "ovphysx": "ovphysx",
            "ovstage": "ovstage",
            "physx-usd-schemas": "physx_usd_schemas",
            "usd-core": "pxr.Usd",
            "scipy": "scipy.spatial",
        },
    ),
    "bench": Extra(
        "the comparisons in benchmarks/",
        {
            "opencv-python-headless": "cv2",
            "pyastar2d": "pyastar2d",
            "scikit-image": "skimage",
            "scipy": "scipy",
            "tcod": "tcod",
        },
    ),
}


def missing_extra(purpose: str, library: str, extra: str) -> MissingExtraError:
    """Return the error of a library that is not installed, with the line that installs its extra.

    Args:
        purpose: What needs it.
        library: The missing library.
        extra: The extra that has it.
    """
    return MissingExtraError(purpose, library, install_line(extra))


def check_extra(extra: str, purpose: str) -> None:
    """Check that every library of an extra is installed, without importing them.

    Call it before importing a module that imports them at its top.

    Raises:
        MissingExtraError: If one is not; the message gives the install line.
    """
    for library, module in EXTRAS[extra].modules.items():
        if is_offered(library) and importlib.util.find_spec(module.partition(".")[0]) is None:
            raise missing_extra(purpose, library, extra)


def is_offered(library: str) -> bool:
    """Return whether an extra installs a library here: it is left out where it has no wheels."""
    if library in ("ovphysx", "ovstage", "physx-usd-schemas"):
        return sys.platform == "linux" and platform.machine() == "x86_64"
    return library != "cyclonedds" or not lacks_wheels()


def lacks_wheels() -> bool:
    """Return whether the extra leaves Cyclone DDS out here, because it has no wheels."""
    return sys.version_info >= NO_WHEELS_FROM or (sys.platform == "linux" and platform.machine() == "aarch64")


def install_line(extra: str) -> str:
    """Return the command that installs an extra where this trundle came from, with the pip of this Python.

    In a checkout it is `pip install ".[record]"`, from a package index `pip install "trundle[record]"`.
    """
    return f'{_pip_install()} "{_origin().format(extra=f"[{extra}]")}"'


def _pip_install() -> str:
    """Return how a shell calls `pip install` of this Python; an environment that uv made has none."""
    if sys.prefix == sys.base_prefix:
        return "pip install"
    scripts = Path(sys.prefix) / "bin"
    has_pip = (scripts / "pip").exists()
    if _is_active():
        return "pip install" if has_pip else "uv pip install"
    python = _from_here(scripts / "python")
    return f"{_from_here(scripts / 'pip')} install" if has_pip else f"uv pip install --python {python}"


def _is_active() -> bool:
    """Return whether the shell has activated the environment of this Python."""
    return any(
        os.environ.get(name) and Path(os.environ[name]).resolve() == Path(sys.prefix).resolve()
        for name in ("VIRTUAL_ENV", "CONDA_PREFIX")
    )


def _from_here(path: Path) -> str:
    """Return a path from the current folder if it is below that, else the whole path."""
    here = Path.cwd()
    return str(path.relative_to(here)) if path.is_relative_to(here) else str(path)


def _origin() -> str:
    """Return what pip is told to install, with `{extra}` where the extra goes."""
    checkout = Path(__file__).resolve().parents[2]
    source = checkout if (checkout / "pyproject.toml").is_file() else None
    for given in () if source is not None else (_direct_url(),):
        url = str(given.get("url", ""))
        if "vcs_info" in given:
            return f"trundle{{extra}} @ {given['vcs_info'].get('vcs', 'git')}+{url}"
        if url.startswith("file:"):
            source = Path(url2pathname(urlsplit(url).path))
    if source is None or not source.exists():
        return "trundle{extra}"
    at = _from_here(source).replace("{", "{{").replace("}", "}}")
    return at + "{extra}" if at == "." or Path(at).is_absolute() else f"./{at}{{extra}}"


def _direct_url() -> dict[str, Any]:
    """Return what pip wrote about where trundle was installed from (PEP 610); empty for a package index."""
    try:
        text = importlib.metadata.distribution("trundle").read_text("direct_url.json")
        found = json.loads(text or "{}")
    except (importlib.metadata.PackageNotFoundError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}
