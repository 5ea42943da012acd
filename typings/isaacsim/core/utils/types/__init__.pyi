# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

class ArticulationAction:
    joint_positions: Any
    joint_velocities: Any
    joint_efforts: Any
    joint_indices: Any
    def __init__(
        self,
        joint_positions: npt.ArrayLike | None = None,
        joint_velocities: npt.ArrayLike | None = None,
        joint_efforts: npt.ArrayLike | None = None,
        joint_indices: npt.ArrayLike | None = None,
    ) -> None: ...
    def get_length(self) -> int | None: ...
