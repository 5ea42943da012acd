"""Stands in for the compiled part of isaacsim.core.simulation_manager."""

from __future__ import annotations

import itertools
import types
from collections.abc import Callable

from pxr import Usd, UsdPhysics

from trundle.testing.isaac.kit import App
from trundle.testing.isaac.nothing import Nothing
from trundle.testing.isaac.physics import Engine
from trundle.testing.isaac.stage import Context


class PhysicsScenes:
    """Watches the stage for physics scenes and deletions, and counts callbacks."""

    def __init__(self, app: App, context: Context, engine: Engine) -> None:
        self._app, self._context, self._engine = app, context, engine
        self._own = itertools.count(-1, -1)
        self._last = 0
        self.reset()
        context.watchers.append(self._watch)

    def reset(self) -> None:
        """Forget the callbacks."""
        self._added: list[Callable[[str], None]] = []
        self._deleted: dict[int, Callable[[str], None]] = {}

    def register_physics_scene_addition_callback(self, function: Callable[[str], None]) -> None:
        """Call a function with the path of each physics scene, of those that are there too."""
        self._added.append(function)
        stage = self._context.get_stage()
        for prim in stage.Traverse() if stage else ():
            if prim.IsA(UsdPhysics.Scene):
                function(str(prim.GetPath()))

    def register_deletion_callback(self, function: Callable[[str], None]) -> None:
        """Call a function with the path of each prim that is removed; its number is that of the next callback."""
        self._deleted[next(self._own) if function.__name__ == "remove_physics_scene" else self._last] = function

    def cleanup_invalid_physics_scenes(self) -> list[str]:
        """Return the scenes that are gone: those that are removed are told of at once."""
        return []

    def get_simulation_time(self) -> float:
        """Return the simulated time [s]."""
        return self._app.timeline.time

    def get_num_physics_steps(self) -> int:
        """Return the number of steps."""
        return self._engine.steps

    def is_simulating(self) -> bool:
        """Return whether the timeline plays."""
        return self._app.timeline.is_playing()

    def is_paused(self) -> bool:
        """Return whether it is paused."""
        return not self._app.timeline.is_playing() and not self._app.timeline.is_stopped()

    def get_callback_iter(self) -> int:
        """Return the next callback's number."""
        return self._last

    def set_callback_iter(self, value: int) -> None:
        """Set the next callback's number."""
        self._last = value

    def deregister_callback(self, number: int) -> bool:
        """Forget a callback for deletions: whether there was one of this number."""
        return self._deleted.pop(number, None) is not None

    def scene(self, path: str) -> types.SimpleNamespace:
        """Return the physics scene at a path, which is made where there is none."""
        UsdPhysics.Scene.Define(self._context.get_stage(), path)
        return types.SimpleNamespace(path=path)

    def paths(self, _: int | None) -> list[str]:
        """Return the paths of all physics scenes."""
        return [str(prim.GetPath()) for prim in self._context.stage.Traverse() if prim.IsA(UsdPhysics.Scene)]

    def __getattr__(self, name: str) -> Nothing:
        return getattr(Nothing("isaacsim.core.simulation_manager.bindings"), name)

    def _watch(self, notice: Usd.Notice.ObjectsChanged) -> None:
        stage = self._context.stage
        for path in notice.GetResyncedPaths():
            if not path.IsPrimPath():
                continue
            prim = stage.GetPrimAtPath(path)
            if not prim:
                for function in list(self._deleted.values()):
                    self._call(function, str(path))
                continue
            for part in Usd.PrimRange(prim):
                if part.IsA(UsdPhysics.Scene):
                    for function in list(self._added):
                        self._call(function, str(part.GetPath()))

    def _call(self, function: Callable[[str], None], path: str) -> None:
        try:
            function(path)
        except ReferenceError:
            self._deleted = {number: kept for number, kept in self._deleted.items() if kept is not function}
