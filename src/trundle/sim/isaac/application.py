"""Finding, starting and closing Isaac Sim's application, Kit. A process has one, and can start it once."""

from __future__ import annotations

import faulthandler
import importlib.util
import os
import signal
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from trundle.errors import InputError, SimulationError
from trundle.sim.isaac.signatures import Generation

if TYPE_CHECKING:
    from isaacsim import SimulationApp

PYTHONS = {5: (3, 11), 6: (3, 12)}
"""The Python version of each generation."""

CLOSING_S = 120.0
"""Time limit for closing the application [s]; after that it is considered hung and its process is ended."""

_WHEELED_ROBOTS_6 = "isaacsim.robot.experimental.wheeled_robots"
_STREAMING = "isaacsim.exp.full.streaming.kit"

_running: Application | None = None


class Application:
    """A running Isaac Sim; close it, or use it in a `with` block.

    Ctrl-C raises KeyboardInterrupt again, instead of ending the process as Isaac Sim's handler does.

    Args:
        headless: Run without a window.
        livestream: Run without a window and stream by WebRTC.
        app: A running SimulationApp; it is used but not closed.

    Attributes:
        generation: Generation of its API.
        draws: Whether its rendering is visible: it has a window, or is streamed.

    Raises:
        InputError: If there is no Isaac Sim for this Python.
        SimulationError: If it does not start, is running already, or its API is unknown.
    """

    def __init__(self, *, headless: bool = False, livestream: bool = False, app: SimulationApp | None = None) -> None:
        global _running
        if _running is not None:
            raise SimulationError("Isaac Sim is already running in this process, and there can be only one")
        self.draws = livestream or not headless
        self._borrowed = app is not None
        if app is None:
            check_installation()
            app = _start(headless=headless, livestream=livestream)
        self._app: SimulationApp | None = app
        _running = self
        try:
            self.generation: Generation = _find_generation()
        except BaseException:
            self.close()
            raise

    @property
    def is_running(self) -> bool:
        """Whether its window is open, if it has one, and it has not been closed."""
        return self._app is not None and self._app.is_running() and not self._app.is_exiting()

    def update(self) -> None:
        """Run one update of its loop: loading, rendering, window events."""
        if self._app is not None:
            self._app.update()

    def close(self) -> None:
        """Close it; closing twice does nothing. Printed output is flushed first: closing may end the process."""
        global _running
        app, self._app = self._app, None
        if app is None:
            return
        _running = None
        if self._borrowed:
            return
        sys.stdout.flush()
        sys.stderr.flush()
        # It sometimes hangs here; by now all output has been written.
        if sys.__stderr__ is not None:
            faulthandler.dump_traceback_later(CLOSING_S, exit=True, file=sys.__stderr__)
        try:
            app.close()
        finally:
            faulthandler.cancel_dump_traceback_later()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def running_application() -> Application | None:
    """Return the application running in this process, or None."""
    return _running


def check_installation() -> None:
    """Check that this Python has an Isaac Sim that it can start.

    Raises:
        InputError: If it has none, or one for another Python; the message says how to start trundle.
    """
    here = ".".join(map(str, sys.version_info[:2]))
    found = importlib.util.find_spec("isaacsim")
    # Without a loader it is only a folder of that name, such as Isaac Sim's own in the current folder.
    if found is None or found.loader is None:
        root = os.environ.get("ISAAC_PATH") or os.environ.get("ISAACSIM_PATH")
        python = f"{root}/python.sh" if root else "/path/to/isaac-sim/python.sh"
        raise InputError(
            f"backend 'isaac' needs Isaac Sim 5.1 or 6.x, and {sys.executable} (Python {here}) has none. Start trundle "
            f"with ./isaac.sh, or with Isaac Sim's own interpreter: {python} -m trundle …; or install Isaac Sim into "
            "this Python (3.11 for 5.1, 3.12 for 6.x). Here, use --backend mujoco"
        )
    installed = installed_version()
    generation = int(installed.partition(".")[0]) if installed and installed[0].isdigit() else None
    if generation is not None and generation < 5:
        raise InputError(f"Isaac Sim {installed} is too old for trundle; it needs 5.1 or 6.x")
    wanted = PYTHONS.get(generation or 0)
    if wanted is not None and sys.version_info[:2] != wanted:
        needs = ".".join(map(str, wanted))
        raise InputError(
            f"Isaac Sim {installed} needs Python {needs}, and {sys.executable} is Python {here}. Start trundle with "
            "Isaac Sim's own interpreter: /path/to/isaac-sim/python.sh -m trundle …"
        )


def installed_version() -> str | None:
    """Return the version of this Python's Isaac Sim, `5.1.0…`; None if that is unknown before it starts."""
    for package in ("isaacsim", "isaacsim-kernel", "isaacsim-core"):
        try:
            return version(package)
        except PackageNotFoundError:
            continue
    for name in ("ISAAC_PATH", "ISAACSIM_PATH"):
        file = Path(os.environ.get(name, "")) / "VERSION"
        if os.environ.get(name) and file.is_file():
            return file.read_text(encoding="utf-8").strip()
    return None


def _start(*, headless: bool, livestream: bool) -> SimulationApp:
    try:
        from isaacsim import SimulationApp
    except ImportError as error:
        raise InputError(
            f"Isaac Sim is installed for {sys.executable} but cannot be imported: {error}. Start trundle with Isaac "
            "Sim's own interpreter: /path/to/isaac-sim/python.sh -m trundle …"
        ) from error
    # With fast shutdown, closing ends the process: the exit code would always be 0, and scripts would end there.
    config: dict[str, Any] = {"headless": headless or livestream, "fast_shutdown": False}
    experience = ""
    if livestream:
        config["hide_ui"] = False
        experience = str(Path(os.environ.get("EXP_PATH", "")) / _STREAMING)
    try:
        app = SimulationApp(config, experience)
    except Exception as error:
        raise SimulationError(
            f"Isaac Sim does not start: {error}. It needs an NVIDIA RTX GPU with a supported driver; see its log "
            "and its compatibility checker"
        ) from error
    # Isaac Sim's own handler ends the process at once, before the run's folder can be written.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    return app


def _find_generation() -> Generation:
    """Detect the API of this Isaac Sim by its installed modules, which can be found once it has started."""
    if _enable_wheeled_robots() and _has_module(_WHEELED_ROBOTS_6):
        return 6
    if _has_module("isaacsim.core.api") and _has_module("isaacsim.robot.wheeled_robots"):
        return 5
    raise SimulationError(
        f"this Isaac Sim ({installed_version() or 'of unknown version'}) has neither the API of 5.1 "
        f"(isaacsim.core.api, isaacsim.robot.wheeled_robots) nor that of 6.x ({_WHEELED_ROBOTS_6})"
    )


def _enable_wheeled_robots() -> bool:
    """Enable the extension of 6.x, which not every experience includes; 5.1 does not have it."""
    try:
        from isaacsim.core.experimental.utils.app import enable_extension
    except ImportError:
        return False
    return enable_extension(_WHEELED_ROBOTS_6)


def _has_module(name: str) -> bool:
    try:
        return importlib.util.find_spec(name) is not None
    except (ImportError, ValueError):
        return False
