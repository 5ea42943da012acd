"""The Python 3.12 with NVIDIA's packages in which scripts for Isaac Sim run: it is built once, in the user's cache."""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

HERE = Path(__file__).resolve().parent
PACKAGE = HERE.parents[1]
REQUIREMENTS = HERE / "requirements.txt"
BUILD = "python -m trundle.testing.isaac --build"

_TRY = """import ensurepip, json, pathlib, ssl, sys, sysconfig, venv
header = pathlib.Path(sysconfig.get_path("include"), "Python.h").is_file()
print(json.dumps([sys.version_info[:2] == (3, 12), header]))"""

_CHECK = "import ovphysx, ovstage, warp, physx_usd_schemas, matplotlib; from pxr import UsdPhysics; import trundle"


class UnavailableError(Exception):
    """Why there is no environment, in one line."""


@dataclass(frozen=True, slots=True)
class Environment:
    """An environment that is built.

    Attributes:
        python: Its interpreter.
        kernels: trundle's compiled kernels for it.
        assets: The folder of assets.
    """

    python: Path
    kernels: Path
    assets: Path

    def command(self, program: str, *arguments: str) -> list[str]:
        """Return the command that runs a program of this folder in it."""
        return [str(self.python), str(HERE / program), str(self.kernels), *arguments]


def find() -> Environment:
    """Return the environment.

    Raises:
        UnavailableError: If it is not built, or could not be.
    """
    found = Environment(_prefix() / "bin" / "python", _kernels(), _assets())
    if found.python.exists() and found.kernels.is_file() and (found.assets / "Isaac").is_dir():
        return found
    with contextlib.suppress(OSError):
        raise UnavailableError(_failure().read_text(encoding="utf-8").strip())
    raise UnavailableError(f"it is not built for this trundle. `{BUILD}` builds it, once: it loads about 600 MB")


def build() -> Environment:
    """Build what is missing of it, and return it.

    Raises:
        UnavailableError: If it cannot be built here; `find` says the same from then on.
    """
    with contextlib.suppress(UnavailableError):
        if not _failure().exists():
            return find()
    try:
        with _locked(), (_folder() / "build.log").open("w", encoding="utf-8") as log:
            _build(log)
            _failure().unlink(missing_ok=True)
            return find()
    except (UnavailableError, OSError) as error:
        reason = " ".join(str(error).split())
        with contextlib.suppress(OSError):
            _failure().write_text(reason, encoding="utf-8")
        raise UnavailableError(reason) from error


def _folder() -> Path:
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(cache, "trundle", "isaac")


def _prefix() -> Path:
    """Return the Python, of its packages and of the machine's libraries."""
    return _folder() / f"python-{_hash([REQUIREMENTS], f'{platform.machine()} {platform.libc_ver()}')}"


def _failure() -> Path:
    """Return the file that keeps why the last build failed."""
    return _folder() / f"{_prefix().name}.failed"


def _kernels() -> Path:
    """Return the kernels: those of an installed trundle fit where they are of the stable ABI; others are compiled."""
    installed = PACKAGE / "_core" / "_kernels.abi3.so"
    if installed.is_file() or not _sources():
        return installed
    return _folder() / f"kernels-{_hash(_sources())}" / "_kernels.so"


def _sources() -> list[Path]:
    """Return what the kernels are compiled of; nothing where trundle is not a checkout."""
    root = PACKAGE.parents[1]
    if not (root / "CMakeLists.txt").is_file():
        return []
    core = PACKAGE / "_core"
    return [root / "CMakeLists.txt", *sorted(path for path in core.rglob("*") if path.suffix in (".cpp", ".hpp"))]


def _assets() -> Path:
    """Return the assets, of what writes them: trundle's robots, worlds and USD."""
    parts = ("robots", "worlds", "usd", "export", "testing/isaac/assets.py", "sim/isaac/assets.py", "sim/mujoco")
    files = [path for part in parts for path in sorted([PACKAGE / part, *(PACKAGE / part).rglob("*")])]
    return _folder() / f"assets-{_hash([path for path in files if path.suffix in ('.py', '.yaml', '.xml')])}"


def _hash(files: Sequence[Path], more: str = "") -> str:
    digest = hashlib.sha256(more.encode())
    for path in files:
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


@contextlib.contextmanager
def _locked() -> Iterator[None]:
    _folder().mkdir(parents=True, exist_ok=True)
    with (_folder() / "lock").open("w", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def _build(log: TextIO) -> None:
    """Build each part beside its place, then move it there: a build that is stopped leaves none that seems whole."""
    if not _prefix().is_dir():
        base = _check_machine()
        print("installing NVIDIA's packages into a Python 3.12", file=sys.stderr)
        with _beside(_prefix()) as work:
            _run([base, "-m", "venv", str(work)], "could not make an environment", log)
            pip = [str(work / "bin" / "python"), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
            wheels = [*pip, "--no-deps", "--only-binary", ":all:", "-r", str(REQUIREMENTS)]
            _run(wheels, "could not install the wheels (is there a network?)", log)
    kernels, assets = _kernels(), _assets()
    if not kernels.is_file():
        if not _sources():
            raise UnavailableError("this trundle was built for Python 3.11, and has no sources to build it for 3.12")
        print("compiling trundle's kernels for it", file=sys.stderr)
        with _beside(kernels.parent) as work:
            _compile(work, log)
    environment = Environment(_prefix() / "bin" / "python", kernels, assets)
    if not (assets / "Isaac").is_dir():
        print("writing assets", file=sys.stderr)
        with _beside(assets) as work:
            _run(environment.command("inside.py", "--assets", str(work)), "could not write the assets", log)
        _run(environment.command("inside.py", "--check", _CHECK), "its packages cannot be imported", log)


@contextlib.contextmanager
def _beside(place: Path) -> Iterator[Path]:
    for left in place.parent.glob(f".{place.name}-*"):
        shutil.rmtree(left, ignore_errors=True)
    work = Path(tempfile.mkdtemp(prefix=f".{place.name}-", dir=place.parent))
    try:
        yield work
        work.chmod(0o755)
        work.rename(place)
    finally:
        shutil.rmtree(work, ignore_errors=True)


def _compile(work: Path, log: TextIO) -> None:
    python = str(_prefix() / "bin" / "python")
    nanobind = subprocess.run([python, "-m", "nanobind", "--cmake_dir"], capture_output=True, text=True, check=False)
    build = work / "build"
    settings = {
        "CMAKE_BUILD_TYPE": "Release", "Python_EXECUTABLE": python, "nanobind_DIR": nanobind.stdout.strip(),
        "SKBUILD_PROJECT_NAME": "trundle", "SKBUILD_PROJECT_VERSION": "0",
    }  # fmt: skip
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    configure = ["cmake", "-S", str(PACKAGE.parents[1]), "-B", str(build), *generator]
    _run([*configure, *(f"-D{key}={value}" for key, value in settings.items())], "could not configure the kernels", log)
    _run(["nice", "cmake", "--build", str(build), "--parallel"], "could not compile the kernels", log)
    made = next(build.rglob("_kernels*.so"))
    shutil.copy(made, work / "_kernels.so")
    shutil.rmtree(build)


def _check_machine() -> str:
    """Return a Python 3.12 that works, where NVIDIA's wheels and a compiler do."""
    if sys.platform != "linux" or platform.machine() != "x86_64":
        raise UnavailableError(f"PhysX' wheels are for Linux on x86-64, not for {sys.platform} on {platform.machine()}")
    name, version = platform.libc_ver()
    if name != "glibc" or tuple(map(int, version.split(".")[:2])) < (2, 35):
        raise UnavailableError(
            f"PhysX' wheels need glibc 2.35 or later, and here is {name or 'another C library'} {version}"
        )
    with contextlib.suppress(OSError):
        if " avx " not in Path("/proc/cpuinfo").read_text(encoding="utf-8").replace("\n", " "):
            raise UnavailableError("PhysX needs a CPU with AVX")
    if _sources():
        missing = [name for name in ("cmake", os.environ.get("CXX", "c++")) if shutil.which(name) is None]
        if missing:
            raise UnavailableError(f"there is no {' and no '.join(missing)} to compile the kernels for Python 3.12")
    return find_python()


def find_python() -> str:
    """Return a Python 3.12 of PATH or pyenv, tried by running it: a shim may be there for a version that is not.

    Raises:
        UnavailableError: If there is none with headers, venv and ssl.
    """
    found = [Path(entry, "python3.12") for entry in os.get_exec_path()]
    pyenv = Path(os.environ.get("PYENV_ROOT") or Path.home() / ".pyenv")
    found += sorted((pyenv / "versions").glob("3.12*/bin/python3.12"), reverse=True)
    reason = "there is no Python 3.12, neither on PATH nor in pyenv"
    for python in dict.fromkeys(path for path in found if os.access(path, os.X_OK)):
        try:
            done = subprocess.run([python, "-c", _TRY], capture_output=True, text=True, timeout=60, check=False)
        except (OSError, subprocess.TimeoutExpired):
            continue
        if done.returncode != 0:
            reason = f"{python} does not start or lacks venv or ssl"
            continue
        right, header = json.loads(done.stdout)
        if right and header:
            return str(python)
        reason = f"{python} has no headers (Python.h)" if right else f"{python} is not Python 3.12"
    raise UnavailableError(reason)


def _run(command: Sequence[str], complaint: str, log: TextIO) -> None:
    done = subprocess.run(command, stdout=log, stderr=subprocess.PIPE, text=True, check=False)
    log.write(done.stderr)
    if done.returncode != 0:
        last = done.stderr.strip().splitlines()[-1:] or [f"exit status {done.returncode}"]
        raise UnavailableError(f"{complaint}: {last[0][:200]} ({log.name})")
