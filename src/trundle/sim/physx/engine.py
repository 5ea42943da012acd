"""ovphysx, NVIDIA's PhysX as a Python package: whether it runs on this machine, and its start in this process."""

from __future__ import annotations

import importlib
import importlib.metadata
import logging
import os
import platform
import re
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from trundle.errors import InputError
from trundle.extras import check_extra, install_line

EXTRA = "physx"
SERIES = "0.7."
"""The ovphysx that this is written for: it calls itself alpha, and 0.7 replaced the interface of 0.6."""

_GLIBC = (2, 35)
_ADDRESS_SPACE = 5 << 30
"""Address space of a process with the engine [bytes], most of which is reserved and not used."""

_CPU_INFO = Path("/proc/cpuinfo")
_SCHEMAS = ("PhysxSchema", "OmniUsdPhysicsDeformableSchema")
_LOG = "trundle.sim.physx.ovphysx"
"""Logger that gets the messages of the engine."""
_LOG_TIMEOUT_NS = 1_000_000_000
_NOT_MADE = "Unable to create"
"""How a warning begins that a collider was left out: of a mesh whose triangles are all without an area, for one."""
_PRIM = re.compile(r"(?<![\w./])/[A-Za-z_]\w*")
"""Where a message names a prim, also behind a colon."""

_log = logging.getLogger(_LOG)
_log.addHandler(logging.NullHandler())  # what matters becomes an exception or a warning; a program can still log it
_registered = False


def check_installation() -> str:
    """Check that ovphysx can run here, without importing it.

    Returns:
        Its version.

    Raises:
        InputError: If this machine is not one that it is built for, or it is of another version.
        MissingExtraError: If it is not installed.
    """
    _check_machine()
    _check_address_space()
    check_extra(EXTRA, "backend physx (NVIDIA PhysX: 350 MB, under NVIDIA's licence)")
    version = importlib.metadata.version("ovphysx")
    if not version.startswith(SERIES):
        raise InputError(
            f"ovphysx {version} is installed, and backend physx is written for {SERIES}x; install that with: "
            f"{install_line(EXTRA)}"
        )
    return version


def _check_machine() -> None:
    """Check the operating system, the processor and the C library, before a library fails to load.

    Raises:
        InputError: If one is not supported.
    """
    advice = "use backend mujoco or kinematic"
    machine = platform.machine()
    if sys.platform != "linux" or machine.lower() not in ("x86_64", "amd64"):
        system = {"darwin": "macOS", "win32": "Windows", "linux": "Linux"}.get(sys.platform, sys.platform)
        raise InputError(
            f"backend physx runs on Linux with an x86-64 processor; this is {system} on {machine}: {advice}"
        )
    library, version = platform.libc_ver()
    if library != "glibc":
        raise InputError(f"backend physx needs glibc, which this Linux does not have (musl?): {advice}")
    if tuple(int(part) for part in version.split(".")[:2]) < _GLIBC:
        raise InputError(
            f"backend physx needs glibc {_GLIBC[0]}.{_GLIBC[1]} or later, as in Ubuntu 22.04; this is {version}: "
            f"{advice}"
        )
    if not _has_avx():
        raise InputError(f"backend physx needs a processor with AVX, which this one lacks: {advice}")


def _check_address_space() -> None:
    """Check that no `ulimit -v` keeps the engine's threads from starting, which would end the process.

    Raises:
        InputError: If one does.
    """
    import resource

    _, most = resource.getrlimit(resource.RLIMIT_AS)
    if most != resource.RLIM_INFINITY and most < _ADDRESS_SPACE:
        raise InputError(
            f"backend physx reserves {_ADDRESS_SPACE >> 30} GB of address space, and this process may have "
            f"{most / 2**30:.1f} GB: raise the limit (ulimit -v), or use backend mujoco or kinematic"
        )


def _has_avx() -> bool:
    try:
        text = _CPU_INFO.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return True  # not to be known here; the library says so itself
    flags = next((line for line in text.splitlines() if line.startswith("flags")), None)
    return flags is None or "avx" in flags.split()


def library(name: str) -> Any:
    """Import a module of ovphysx or of what it needs. It is not checked against types: the extra may be missing."""
    return importlib.import_module(name)


def start_engine() -> Any:
    """Start an engine, on the CPU and on the calling thread alone.

    Returns:
        An `ovphysx.PhysX`.

    Raises:
        InputError: If it cannot run here, or this process has used it on a GPU.
        MissingExtraError: If it is not installed.
    """
    check_installation()
    try:
        ovphysx = library("ovphysx")
        _start_warp()
        make = ovphysx.PhysX  # loads what is native
    except (ImportError, OSError, RuntimeError) as error:
        raise InputError(f"backend physx: ovphysx cannot be loaded: {error}") from error
    _set_up(ovphysx)
    engine = make()
    # The last engine that is closed takes this with it.
    ovphysx.enable_default_log_output(False)
    ovphysx.enable_python_logging(_LOG, min_severity=ovphysx.LogLevel.WARNING)
    return engine


def _start_warp() -> None:
    """Start Warp, in whose arrays ovphysx hands out numbers, without its report of devices and missing GPU drivers."""
    warp = library("warp")
    before = warp.config.log_level
    warp.config.log_level = warp.LOG_ERROR
    try:
        with _stderr_off():
            warp.init()
    finally:
        warp.config.log_level = before


@contextmanager
def _stderr_off() -> Iterator[None]:
    """Discard what native code writes to stderr while the block runs."""
    sys.stderr.flush()
    kept, nothing = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nothing, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nothing)


def _set_up(ovphysx: Any) -> None:
    """Set what holds for the whole process, before its first engine.

    Raises:
        InputError: If this process has used PhysX on a GPU.
    """
    global _registered
    if not _registered:
        try:
            ovphysx.PhysX.set_cpu_mode(True)
        except RuntimeError as error:
            raise InputError(
                f"this process already runs PhysX on a GPU, and backend physx needs it on the CPU: {error}"
            ) from error
        library("ovstage").population.register_usd_schemas(_schema_folders())
        _registered = True
    threads = ovphysx.GlobalConfigKey.NUM_THREADS
    if ovphysx.get_global_config(threads) != 0:
        # One robot is too little work for a pool of threads: with the default of 8 a step takes 25 times as long. It is
        # only slower where somebody else simulates in this process, so that it cannot be changed.
        with suppress(RuntimeError):
            ovphysx.set_global_config(threads, 0)


def _schema_folders() -> list[str]:
    """Return folders of the PhysX schemas, without which a stage would lose its PhysX attributes.

    Their package is not imported: that registers them with usd-core.
    """
    package = importlib.metadata.distribution("physx-usd-schemas")
    folders = [str(package.locate_file(f"physx_usd_schemas/{name}/resources")) for name in _SCHEMAS]
    newton = library("ovphysx.schemas").find_newton_schema_root()
    return folders if newton is None else [*folders, str(newton)]


class Messages(logging.Handler):
    """What the engine says was wrong.

    Attributes:
        errors: Its errors, in order.
        warnings: Its warnings: of a mesh that is not valid, only they name the prim.
    """

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.errors: list[str] = []
        self.warnings: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a message."""
        text = " ".join(record.getMessage().split())
        messages = self.errors if record.levelno >= logging.ERROR else self.warnings
        messages.append(text.partition(" , FILE ")[0].partition(", FILE ")[0])  # where in PhysX' sources

    @property
    def refused(self) -> list[str]:
        """What says that a part of the stage was left out."""
        return [*self.errors, *(text for text in self.warnings if text.startswith(_NOT_MADE))]

    def reason(self) -> str:
        """Return all errors; where there is none, what else says that a part was left out."""
        return "; ".join(self.errors or self.refused)

    def told(self) -> str:
        """Return the first message of `refused`; the first one that names a prim, if there is one."""
        named = (message for message in (*self.refused, *self.warnings) if _PRIM.search(message))
        return next(named, self.refused[0])


@contextmanager
def collected_messages(messages: Messages) -> Iterator[None]:
    """Collect what the engine logs in the block, until its end, and leave out its advice on Warp's builds."""
    before = _log.propagate
    _log.addHandler(messages)
    _log.propagate = False
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            yield
    finally:
        with suppress(RuntimeError, TimeoutError):
            library("ovphysx").flush_log(_LOG_TIMEOUT_NS)  # messages come from another thread
        _log.propagate = before
        _log.removeHandler(messages)
