"""Checks of this machine's libraries and graphics, and end-to-end checks of a backend."""

from __future__ import annotations

import importlib
import importlib.metadata
import platform
import re
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from trundle.errors import InputError, TrundleError
from trundle.extras import EXTRAS, install_line, is_offered
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid

Status = Literal["pass", "fail", "missing"]


@dataclass(frozen=True, slots=True)
class MachineCheck:
    """One item of a checklist.

    Attributes:
        name: What was checked.
        status: "pass", "fail", or "missing" for something optional.
        detail: The result, and the fix if it did not pass.
    """

    name: str
    status: Status
    detail: str


ISAAC = "isaac"

_NO_RAY_TRACING = re.compile(r"\b(P100|V100|A100|A30|H100|H200|GH200|B200|GB200)\b")
"""Data-centre GPUs without RT cores, which Isaac Sim does not support."""

_KIT_PACKAGES = ("isaacsim-extscache-kit", "isaacsim-extscache-kit-sdk")
"""What an Isaac Sim of pip lacks if it came from PyPI alone."""

_BOX = Solid("box", Box((0.5, 2.0, 1.0)), Pose3D((0.0, -5.0, 0.5)))
"""Far from the robot's other checks; the robot drives into it to check contacts."""


def check_machine(backend: str | None = None) -> Iterator[MachineCheck]:
    """Check Python, the kernels, the libraries and the graphics, one after the other.

    Args:
        backend: The backend to check for; for `isaac`, libraries that conflict with Isaac Sim are not imported.
    """
    found = f"Python {platform.python_version()} on {platform.system()} {platform.machine()}"
    yield MachineCheck("python", "pass" if sys.version_info >= (3, 11) else "fail", found)
    yield _attempt("kernels", _check_kernels)
    if backend == ISAAC:
        yield _attempt("isaac sim", _check_isaac)
        yield from _check_packages()
        yield _check_no_other_usd()
        yield _check_gpu()
        return
    yield _check_engine()
    for name in EXTRAS:
        yield _check_extra(name)
    yield _check_graphics()


def check_backend(backend: str, *, robot: str = "nova_carter", **options: Any) -> Iterator[MachineCheck]:
    """Check that a backend starts, steps, drives as configured, completes a mission, reports contacts, and closes.

    Args:
        backend: Its name.
        robot: The robot to drive, on a floor with one box.
        options: Options of the backend.

    Yields:
        One item after the other, up to the first failure that prevents the rest.
    """
    from trundle.robots import Robot
    from trundle.sim import simulate
    from trundle.worlds import World

    if "environment" in options:
        raise InputError(
            "the checklist uses its own floor with a box: leave out --environment, and check "
            f"that environment with:  trundle view {robot} --backend {backend} --environment {options['environment']}"
        )
    machine = Robot.load(robot)
    try:
        simulator = simulate(World("box", (_BOX,), seeds=((0.0, 0.0),)), machine, backend=backend, **options)
    except Exception as error:  # noqa: BLE001 - see _attempt
        yield MachineCheck("start", "fail", _words(error))
        return
    with simulator:
        yield MachineCheck("start", "pass", f"{backend} with {machine.name} on a floor with a box")
        yield _attempt("drive", lambda: _check_drive(simulator))
        if backend == ISAAC:
            yield _attempt("interface", lambda: _check_interface(simulator))
        yield _attempt("step", lambda: _check_step(simulator))
        yield _attempt("mission", lambda: _check_mission(simulator))
        yield _attempt("contact", lambda: _check_contact(simulator))
        if hasattr(simulator, "picture"):
            yield _attempt("picture", lambda: _check_picture(simulator))
    yield _attempt("close", lambda: _check_close(simulator))


def _attempt(name: str, check: Callable[[], str]) -> MachineCheck:
    try:
        return MachineCheck(name, "pass", check())
    except Exception as error:  # noqa: BLE001 - a check may raise anything, and the next one must still run
        return MachineCheck(name, "fail", _words(error))


def _words(error: Exception) -> str:
    """Return the message of trundle's errors; of others also the type, because their message may be empty."""
    if isinstance(error, TrundleError):
        return str(error)
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__


def _check_kernels() -> str:
    from trundle import _core

    mask = np.zeros((3, 3), dtype=np.int8)
    mask[1, 1] = 100
    costs = _core.inflate(mask, np.array([254, 253], dtype=np.uint8))
    if costs[1, 1] != 254 or costs[0, 1] != 253:
        raise TrundleError("the compiled kernels give wrong results: rebuild them")
    return "the compiled kernels work"


def _check_engine() -> MachineCheck:
    try:
        importlib.import_module("mujoco")
    except ImportError as error:
        how = f"for the built-in physics: {error}. Install it with: pip install mujoco==4.0.0"
        return MachineCheck("mujoco", "fail", how)
    return MachineCheck("mujoco", "pass", f"{importlib.metadata.version('mujoco')}, for the built-in physics")


def _version(library: str) -> str:
    """Return the version of a distribution; "" where another distribution gives the same module."""
    try:
        return importlib.metadata.version(library)
    except importlib.metadata.PackageNotFoundError:
        return ""


def _check_extra(name: str) -> MachineCheck:
    """Check the libraries of an extra: each is imported, because one that is there may not load."""
    extra = EXTRAS[name]
    have: list[str] = []
    lacking: list[str] = []
    for library, module in extra.modules.items():
        if not is_offered(library):
            continue
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                importlib.import_module(module)
        except ModuleNotFoundError:
            lacking.append(library)
        except Exception as error:  # noqa: BLE001 - a library that does not load raises anything
            lacking.append(f"{library} (does not load: {_words(error)})")
        else:
            have.append(f"{library} {_version(library)}".rstrip())
    if not lacking:
        return MachineCheck(name, "pass", f"{', '.join(have)}, for {extra.purpose}")
    what = f"for {extra.purpose}: no {', no '.join(lacking)}. Install it with: {install_line(name)}"
    return MachineCheck(name, "missing", what)


def _check_graphics() -> MachineCheck:
    from trundle.viewer.gl import describe_missing_gl, find_gl

    kind = find_gl()
    if kind is None:
        return MachineCheck("graphics", "missing", describe_missing_gl())
    return MachineCheck("graphics", "pass", f"offscreen rendering by {kind.upper()}")


def _check_isaac() -> str:
    from trundle.sim.isaac.application import check_installation, installed_version

    check_installation()
    return f"Isaac Sim {installed_version() or '(the version is known once it runs)'}, for this Python"


def _check_packages() -> Iterator[MachineCheck]:
    """Check that an Isaac Sim of pip has Kit's extensions, which only NVIDIA's own package index has."""
    if not _version("isaacsim-kernel"):
        return
    lacking = [name for name in _KIT_PACKAGES if not _version(name)]
    if lacking:
        yield MachineCheck(
            "packages",
            "missing",
            f"no {' and no '.join(lacking)}, with Kit's extensions (omni.usd and others): Isaac Sim does not start "
            "unless it can fetch them. They are in NVIDIA's package index: pip install 'isaacsim[all,extscache]'",
        )
    else:
        yield MachineCheck("packages", "pass", f"{' and '.join(_KIT_PACKAGES)}, with Kit's extensions")


def _check_no_other_usd() -> MachineCheck:
    for name in ("usd-core", "usd-exchange"):
        try:
            found = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
        return MachineCheck(
            "usd",
            "fail",
            f"{name} {found} conflicts with Isaac Sim's own USD and prevents its start: pip uninstall {name}",
        )
    return MachineCheck("usd", "pass", "only Isaac Sim's own USD")


def _check_gpu() -> MachineCheck:
    ask = ["nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader"]
    try:
        done = subprocess.run(ask, capture_output=True, text=True, check=False, timeout=30)
    except (OSError, subprocess.TimeoutExpired):
        return MachineCheck("gpu", "missing", "nvidia-smi cannot be run; Isaac Sim needs an NVIDIA RTX GPU")
    found = "; ".join(line.strip().replace(", ", ", driver ") for line in done.stdout.splitlines() if line.strip())
    if done.returncode != 0 or not found:
        return MachineCheck("gpu", "fail", f"no NVIDIA GPU: {found or done.stderr.strip() or 'nvidia-smi lists none'}")
    if all(_NO_RAY_TRACING.search(gpu) for gpu in found.split("; ")):
        return MachineCheck("gpu", "missing", f"{found}: no RT cores, which Isaac Sim's renderer needs")
    return MachineCheck("gpu", "pass", found)


def _check_interface(simulator: Any) -> str:
    from trundle.sim.isaac.signatures import differences

    found = differences(simulator.application.generation)
    if found:
        raise TrundleError("this Isaac Sim differs from what trundle expects: " + "; ".join(found))
    return f"everything that trundle calls exists; joints: {', '.join(simulator.joint_names())}"


def _check_drive(simulator: Any) -> str:
    from trundle.doctor.drive_check import check_drive

    check = check_drive(simulator)
    if check.findings:
        raise TrundleError("; ".join(finding.message for finding in check.findings))
    return f"as configured: radius {check.wheel_radius:.4f} m, track {check.track_width:.4f} m, slip {check.slip:.1%}"


def _check_step(simulator: Any) -> str:
    simulator.reset(Pose2D(1.0, -0.5, 0.7))
    state = simulator.step(Twist2D(0.2, 0.0), 0.05)
    if abs(state.time - 0.05) > 1e-6 or state.pose.distance_to(Pose2D(1.0, -0.5)) > 0.05:
        raise TrundleError(f"a step of 0.05 s from (1, -0.5) ended at {state.time} s, {state.pose}")
    return "resets to a pose and steps one control period"


def _check_mission(simulator: Any) -> str:
    from trundle.maps import OccupancyGrid
    from trundle.mission import RunSettings, run
    from trundle.navigation import Navigator

    grid = OccupancyGrid(np.zeros((120, 160), dtype=np.int8), 0.05, Pose2D(-3.0, -3.0))
    episode = run(simulator, Navigator(grid, simulator.robot, settings=RunSettings()), Pose2D(0.0, 0.0), (2.0, 1.0))
    if not episode.arrived:
        raise TrundleError(f"a mission over 2.2 m of free floor ended as {episode.outcome.value}: {episode.message}")
    return f"2.2 m of free floor in {episode.metrics.time_s:.1f} s"


def _check_contact(simulator: Any) -> str:
    ahead = float(simulator.robot.outline[:, 0].max())
    x, y, _ = _BOX.pose.position
    state = simulator.reset(Pose2D(x - 0.25 - ahead - 0.3, y))
    for _ in range(60):
        state = simulator.step(Twist2D(0.2, 0.0), 0.05)
        if state.contacts:
            return f"driving into a box reports a contact with {state.contacts[0].other}"
    raise TrundleError("driving into a box reports no contact: runs would not end at collisions")


def _check_picture(simulator: Any) -> str:
    simulator.reset(Pose2D(0.0, 0.0))
    picture = simulator.picture((3.0, 3.0, 2.0), (0.0, 0.0, 0.3), (320, 180))
    if picture.std() < 1.0:
        raise TrundleError("the camera's picture has a single colour: nothing is rendered")
    return "the camera sees the scene"


def _check_close(simulator: Any) -> str:
    from trundle.errors import SimulationError

    try:
        simulator.step(Twist2D(), 0.05)
    except SimulationError:
        return "closes, and refuses further steps"
    raise TrundleError("a step after close is accepted")
