# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

from isaacsim.core.utils.types import ArticulationAction

class DifferentialController:
    def __init__(
        self,
        name: str,
        wheel_radius: float,
        wheel_base: float,
        max_linear_speed: float = 1.0e20,
        max_angular_speed: float = 1.0e20,
        max_wheel_speed: float = 1.0e20,
    ) -> None: ...
    def forward(self, command: Annotated[npt.ArrayLike, (2,)]) -> ArticulationAction: ...
