"""Puts the stand-ins into a Python with NVIDIA's packages, which then starts as Isaac Sim's own does."""

from __future__ import annotations

import builtins
import contextlib
import importlib
import math
import os
import sys
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from trundle.testing.isaac.kit import App
from trundle.testing.isaac.modules import Finder, torch_members
from trundle.testing.isaac.nothing import Nothing

HIDDEN = {5: ("isaacsim.robot.experimental",)}
"""What a generation does not have: 5.1's classes are in 6.2, deprecated, and its adapter is chosen without the new."""


def install(*, assets: str, seconds: float = math.inf, generation: int = 6) -> App:
    """Make `isaacsim.SimulationApp` importable, and after its start everything else.

    Args:
        assets: The asset root.
        seconds: Simulated time [s] after which the application is no longer running.
        generation: 6, or 5 for an Isaac Sim that only has the classes of 5.1.

    Returns:
        The application that SimulationApp will start.
    """
    app = App(seconds, assets)
    finder = Finder()
    builtins.ISAAC_LAUNCHED_FROM_TERMINAL = False  # type: ignore[attr-defined]

    def start() -> None:
        finder.started = True
        _start(app, finder)
        finder.hidden = HIDDEN.get(generation, ())

    finder.provide("isaacsim", {"SimulationApp": app.simulation_app(start, lambda: None)})
    for module, members in app.modules().items():
        finder.provide(module, members)
    sys.meta_path.insert(0, finder)
    return app


def _start(app: App, finder: Finder) -> None:
    """Start what SimulationApp starts: USD, PhysX, and the extension of the simulation manager."""
    import pxr

    warp: Any = importlib.import_module("warp")
    warp.config.log_level = warp.LOG_ERROR
    with _silence():
        warp.init()
    from trundle.testing.isaac import interfaces, tensors
    from trundle.testing.isaac.physics import Engine
    from trundle.testing.isaac.scenes import PhysicsScenes
    from trundle.testing.isaac.stage import Context, add_ground_plane, physx_schema

    context = Context(app.events)
    engine = Engine(app, context)
    scenes = PhysicsScenes(app, context, engine)
    _add_to_pxr(pxr, "PhysxSchema", physx_schema())
    tools = types.ModuleType("pxr.PhysicsSchemaTools")
    tools.intToSdfPath, tools.sdfPathToInt = engine.name, engine.number  # type: ignore[attr-defined]
    tools.addGroundPlane = add_ground_plane  # type: ignore[attr-defined]
    _add_to_pxr(pxr, "PhysicsSchemaTools", tools)
    provided = {
        **context.modules(), **interfaces.modules(app, context, engine), **tensors.modules(engine, context),
        # The compiled half of two extensions.
        "isaacsim.core.simulation_manager.bindings": {
            "_simulation_manager": types.SimpleNamespace(
                acquire_simulation_manager_interface=lambda: scenes,
                release_simulation_manager_interface=lambda _: None,
                PhysicsScene=scenes.scene,
                get_physics_scene_paths=scenes.paths,
            )
        },
        "isaacsim.core.experimental.prims.bindings": {"_prims_reader": Nothing("prims_reader")},
        **_replicator(),
        "isaacsim.storage": {}, "isaacsim.storage.native": _storage(app),
        "torch": torch_members(),
    }  # fmt: skip
    for module, members in provided.items():
        finder.provide(module, members)
    context.new_stage()
    manager: Any = importlib.import_module("isaacsim.core.simulation_manager")
    manager.Extension().on_startup("isaacsim.core.simulation_manager")
    # Of 5.1, which 6.2 has left out.
    semantics: Any = importlib.import_module("isaacsim.core.utils.semantics")
    semantics.add_update_semantics = lambda prim, semantic_label, type_label="class", suffix="": semantics.add_labels(
        prim, [semantic_label], type_label + suffix
    )
    app.physics_dt = manager.SimulationManager.get_physics_dt
    stop = app.events.observe_event("omni.timeline.stop", lambda _: engine.unload(), order=100)
    closing = app.events.observe_event("omni.usd.stage.closing", lambda _: app.timeline.stop())
    app.kept = (stop, closing)


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Keep from standard error what libraries write there directly: Warp warns of a missing GPU in any case."""
    sys.stderr.flush()
    kept = os.dup(2)
    with Path(os.devnull).open("wb") as nowhere:
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def _add_to_pxr(pxr: types.ModuleType, name: str, module: types.ModuleType) -> None:
    sys.modules[f"pxr.{name}"] = module
    setattr(pxr, name, module)


def _replicator() -> dict[str, dict[str, object]]:
    """omni.replicator.core: cameras whose pictures never come."""

    class Annotator:
        def attach(self, render_products: list[str]) -> None:
            pass

        def detach(self) -> None:
            pass

        def get_data(self) -> list[int]:
            return []

    class AnnotatorRegistry:
        @classmethod
        def get_annotator(cls, name: str) -> Annotator:
            return Annotator()

    def render_product(camera: str, resolution: tuple[int, int]) -> types.SimpleNamespace:
        return types.SimpleNamespace(path=f"/Render{camera}", destroy=lambda: None)

    members: dict[str, object] = {"Annotator": Annotator, "AnnotatorRegistry": AnnotatorRegistry}
    return {"omni.replicator.core": members, "omni.replicator.core.create": {"render_product": render_product}}


def _storage(app: App) -> dict[str, object]:
    """isaacsim.storage.native: the assets lie in a folder."""

    def get_assets_root_path(*, skip_check: bool = False) -> str:
        return str(app.settings.get("/persistent/isaac/asset_root/default"))

    async def get_assets_root_path_async(*, skip_check: bool = False) -> str:
        return get_assets_root_path()

    return {
        "get_assets_root_path": get_assets_root_path, "get_assets_root_path_async": get_assets_root_path_async,
        "is_file": lambda path: Path(path).is_file(), "is_dir": lambda path: Path(path).is_dir(),
        "check_server": lambda server, path="", timeout=10.0: Path(server + path).exists(),
    }  # fmt: skip
