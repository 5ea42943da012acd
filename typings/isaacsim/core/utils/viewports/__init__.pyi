# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

def set_camera_view(
    eye: Annotated[npt.ArrayLike, (3,)],
    target: Annotated[npt.ArrayLike, (3,)],
    camera_prim_path: str = "/OmniverseKit_Persp",
    viewport_api: Any = None,
) -> None: ...
