# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

class Articulation:
    def __init__(
        self,
        prim_paths_expr: str,
        name: str = "articulation_prim_view",
        positions: Any = None,
        translations: Any = None,
        orientations: Any = None,
        scales: Any = None,
        visibilities: Any = None,
        reset_xform_properties: bool = True,
    ) -> None: ...
    def initialize(self, physics_sim_view: Any = None) -> None: ...
    def get_body_coms(
        self, indices: npt.ArrayLike | None = None, body_indices: npt.ArrayLike | None = None, clone: bool = True
    ) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]: ...
