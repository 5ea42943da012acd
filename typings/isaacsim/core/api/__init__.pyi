# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

class World:
    def __init__(
        self,
        physics_dt: float | None = None,
        rendering_dt: float | None = None,
        stage_units_in_meters: float | None = None,
        physics_prim_path: str = "/physicsScene",
        sim_params: dict[str, Any] | None = None,
        set_defaults: bool = True,
        backend: str = "numpy",
        device: str | None = None,
    ) -> None: ...
    @classmethod
    def clear_instance(cls) -> None: ...
    def reset(self, soft: bool = False) -> None: ...
    def step(self, render: bool = True, step_sim: bool = True, update_fabric: bool = False) -> None: ...
    def render(self) -> None: ...
    def is_playing(self) -> bool: ...
    def is_stopped(self) -> bool: ...
    def stop(self) -> None: ...
