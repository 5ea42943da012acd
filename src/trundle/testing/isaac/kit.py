"""Stands in for Kit: the application, its loop, the timeline, events, settings and extensions."""

from __future__ import annotations

import enum
import itertools
import math
import sys
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

from trundle.testing.isaac.events import Event, Events
from trundle.testing.isaac.modules import extension_paths
from trundle.testing.isaac.nothing import Nothing

STOPPED = "omni.timeline.stop"
UPDATE = "omni.kit.app.update"


class TimelineEvent(enum.IntEnum):
    """omni.timeline.TimelineEventType."""

    PLAY = 0
    PAUSE = 1
    STOP = 2
    CURRENT_TIME_TICKED = 3


class Settings:
    """carb.settings: a dict of paths."""

    def __init__(self, values: dict[str, object]) -> None:
        self._values = values

    def get(self, path: str) -> Any:
        """Return a value, or None."""
        return self._values.get(path.strip("/"))

    def set(self, path: str, value: object) -> None:
        """Set a value."""
        self._values[path.strip("/")] = value

    set_bool = set_int = set_float = set_string = set
    set_default = set_default_bool = set_default_int = set_default_float = set_default_string = set

    def get_as_bool(self, path: str) -> bool:
        """Return a value as bool."""
        return bool(self.get(path))

    def get_as_int(self, path: str) -> int:
        """Return a value as int; 0 if there is none."""
        return int(self.get(path) or 0)

    def get_as_float(self, path: str) -> float:
        """Return a value as float; 0 if there is none."""
        return float(self.get(path) or 0.0)

    def get_as_string(self, path: str) -> str:
        """Return a value as text; empty if there is none."""
        return str(self.get(path) or "")

    def __getattr__(self, name: str) -> Nothing:
        return getattr(Nothing("carb.settings.ISettings"), name)


class Timeline:
    """omni.timeline's interface."""

    def __init__(self, events: Events) -> None:
        self._events = events
        self._state = TimelineEvent.STOP
        self.time = 0.0

    def is_playing(self) -> bool:
        """Return whether it plays."""
        return self._state is TimelineEvent.PLAY

    def is_stopped(self) -> bool:
        """Return whether it was stopped."""
        return self._state is TimelineEvent.STOP

    def play(self, *_: object) -> None:
        """Start the timeline."""
        self._become(TimelineEvent.PLAY)

    def pause(self) -> None:
        """Pause, unless it was stopped."""
        if self.is_playing():
            self._become(TimelineEvent.PAUSE)

    def stop(self) -> None:
        """Stop."""
        self._become(TimelineEvent.STOP)

    def get_current_time(self) -> float:
        """Return its time [s]."""
        return self.time

    def get_timeline_event_stream(self) -> types.SimpleNamespace:
        """Return the stream of its events."""
        return self._events.stream("omni.timeline")

    def _become(self, state: TimelineEvent) -> None:
        if state is self._state:
            return
        self._state = state
        if state is TimelineEvent.STOP:
            self.time = 0.0
        self._events.send("omni.timeline", Event("omni.timeline", int(state), {}), kind=int(state))
        self._events.dispatch_event(f"omni.timeline.{state.name.lower()}")

    def __getattr__(self, name: str) -> Nothing:
        return getattr(Nothing("omni.timeline.ITimeline"), name)


class Extensions:
    """The extension manager: all extensions that there are can be imported from the start."""

    def is_extension_enabled(self, name: str) -> bool:
        """Return whether it can be imported; Fabric, a copy of the stage in memory, is not there."""
        return not name.startswith("omni.") or "fabric" not in name

    def set_extension_enabled_immediate(self, name: str, enabled: bool) -> bool:
        """Enable an extension: whether it is there."""
        from importlib.util import find_spec

        try:
            return name.partition(".")[0] != "isaacsim" or find_spec(name) is not None
        except ModuleNotFoundError:
            return False

    def get_enabled_extension_id(self, name: str) -> str:
        """Return the identifier of an extension: its name."""
        return name

    def get_extension_path(self, name: str) -> str:
        """Return the folder of an extension of NVIDIA's wheels; empty for one of Kit."""
        found = (Path(path).parent for path in extension_paths())
        return next((str(folder) for folder in found if folder.name == name), "")

    def __getattr__(self, name: str) -> Nothing:
        return getattr(Nothing("omni.kit.app.IExtensionManager"), name)


class EndedError(BaseException):
    """The script goes on long after the simulation has ended."""


class App:
    """The application and its loop.

    Args:
        seconds: Simulated time [s] after which it is no longer running.
        assets: The asset root.

    Attributes:
        step: Set by the physics: does a physics step.
        physics_dt: Set by the physics: returns the length of a step [s].
        synchronize: Set by the physics: writes what it moved to the stage.
    """

    def __init__(self, seconds: float = math.inf, assets: str = "") -> None:
        self.events = Events()
        self.timeline = Timeline(self.events)
        self.extensions = Extensions()
        self.settings = Settings(
            {
                "app/player/playSimulations": True,
                "physics/updateToUsd": True,
                "exts/isaacsim.core.simulation_manager/enable_default_callbacks": True,
                "persistent/isaac/asset_root/default": assets,
            }
        )
        self.assets = assets
        self.seconds = seconds
        self.simulated = 0.0
        self.closed = False
        self.rendering_dt = 1.0 / 60.0
        self._left = 0.0
        self._idle = 0
        self.step: Callable[[float], None] = lambda _: None
        self.physics_dt: Callable[[], float] = lambda: 1.0 / 60.0
        self.synchronize: Callable[[], None] = lambda: None
        self.kept: object = None

    def is_running(self) -> bool:
        """Return whether there is simulated time left, and it was not closed."""
        return not self.closed and self.simulated < self.seconds - 1e-9

    def count(self, dt: float) -> None:
        """Count a physics step.

        Raises:
            EndedError: If the script has gone on for long without asking whether the application runs.
        """
        self._idle = 0
        self.timeline.time += dt
        self._count(dt)

    def _count(self, dt: float) -> None:
        self.simulated += dt
        if self.simulated > 10.0 * self.seconds + 60.0:
            raise EndedError

    def update(self) -> None:
        """Run the loop once: as many physics steps as fit into a frame while it plays, then the subscribers."""
        self._idle += 1
        if self._idle > 1:
            # A script that only draws has to end as well; one frame between steps takes no time.
            self._count(self.rendering_dt)
        if self.timeline.is_playing() and self.settings.get_as_bool("/app/player/playSimulations"):
            dt = self.physics_dt()
            self._left += self.rendering_dt
            while self._left > dt - 1e-9:
                self._left -= dt
                self.step(dt)
        self.synchronize()
        self.events.send(UPDATE, Event(UPDATE, 0, {"dt": self.rendering_dt}))

    def get_extension_manager(self) -> Extensions:
        """Return the extension manager."""
        return self.extensions

    def get_update_event_stream(self) -> types.SimpleNamespace:
        """Return the stream of the loop."""
        return self.events.stream(UPDATE)

    async def next_update_async(self) -> None:
        """Run the loop once."""
        self.update()

    def shutdown(self, code: int = 1) -> None:
        """End the process; NVIDIA's modules do it where a package is missing."""
        sys.exit(code)

    def __getattr__(self, name: str) -> Nothing:
        return getattr(Nothing("omni.kit.app.IApp"), name)

    def modules(self) -> dict[str, dict[str, object]]:
        """Return the members of the modules that this file stands in for."""
        timeline, app, settings = self.timeline, self, self.settings
        loop = types.SimpleNamespace(
            set_manual_step_size=lambda dt, name="": setattr(app, "rendering_dt", dt),
            get_manual_step_size=lambda name="": app.rendering_dt,
            set_manual_mode=lambda on, name="": None, get_manual_mode=lambda name="": True,
        )  # fmt: skip
        log = {f"log_{level}": (lambda *_: None) for level in ("info", "verbose")}
        log |= {f"log_{level}": _logger(level) for level in ("warn", "error", "fatal")}
        vector = {f"{kind}{n}": _vector for kind in ("Float", "Double", "Int", "Uint") for n in (2, 3, 4)}
        get_settings: dict[str, object] = {
            "get_settings": lambda: settings,
            "acquire_settings_interface": lambda: settings,
        }
        dispatcher: dict[str, object] = {"get_eventdispatcher": lambda: app.events}
        return {
            "carb": {**log, **vector},
            "carb.settings": {**get_settings, "ISettings": Settings},
            "carb.eventdispatcher": dispatcher,
            "omni.ext": {"IExt": type("IExt", (), {})},
            "omni.kit.app": {"get_app": lambda: app, "get_app_interface": lambda: app},
            "omni.kit.async_engine": {"run_coroutine": _run_coroutine},
            "omni.kit.loop": {"_loop": types.SimpleNamespace(acquire_loop_interface=lambda: loop)},
            "omni.timeline": {
                "get_timeline_interface": lambda *_: timeline, "TimelineEventType": TimelineEvent,
                "GLOBAL_EVENT_PLAY": "omni.timeline.play", "GLOBAL_EVENT_PAUSE": "omni.timeline.pause",
                "GLOBAL_EVENT_STOP": STOPPED,
            },
        }  # fmt: skip

    def simulation_app(self, start: Callable[[], None], finish: Callable[[], None]) -> type:
        """Return isaacsim.SimulationApp: `start` is called when it is created, `finish` when it is closed."""
        app, starts = self, itertools.count()

        class SimulationApp:
            DEFAULT_LAUNCHER_CONFIG: ClassVar[dict[str, object]] = {"headless": True, "width": 1280, "height": 720}

            def __init__(self, launch_config: dict[str, object] | None = None, experience: str = "") -> None:
                if next(starts):
                    raise RuntimeError("SimulationApp can be created only once in a process")
                self.config = {**self.DEFAULT_LAUNCHER_CONFIG, **(launch_config or {})}
                start()

            app = property(lambda self: app)
            context = property(lambda self: sys.modules["omni.usd"].get_context())

            def update(self) -> None:
                app.update()

            def is_running(self) -> bool:
                return app.is_running()

            def is_exiting(self) -> bool:
                return app.closed

            def close(self, wait_for_replicator: bool = True, skip_cleanup: bool = False, **_: object) -> None:
                if not app.closed:
                    app.timeline.stop()
                    app.closed = True
                    finish()

            def set_setting(self, path: str, value: object) -> None:
                app.settings.set(path, value)

            def __getattr__(self, name: str) -> Nothing:
                return getattr(Nothing("isaacsim.SimulationApp"), name)

        return SimulationApp


def _logger(level: str) -> Callable[..., None]:
    def log(message: object, *_: object, **__: object) -> None:
        if "is deprecated" not in str(message):
            print(f"[{level}] {message}", file=sys.stderr)

    return log


def _vector(*values: float) -> tuple[float, ...]:
    return values


def _run_coroutine(coroutine: Any) -> Nothing:
    """Run a coroutine at once: nothing here waits."""
    try:
        while True:
            coroutine.send(None)
    except StopIteration:
        return Nothing("asyncio.Task")
