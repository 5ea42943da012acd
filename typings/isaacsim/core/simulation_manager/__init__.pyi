# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

class SimulationManager:
    @classmethod
    def setup_simulation(cls, dt: float | None = None, device: str | None = None) -> None: ...
    @classmethod
    def step(
        cls,
        *,
        steps: int = 1,
        callback: Callable[[int, int], bool | None] | None = None,
        update_fabric: bool = False,
    ) -> None: ...
