# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

class RenderingManager:
    @classmethod
    def render(cls) -> None: ...
class ViewportManager:
    @classmethod
    def set_camera_view(
        cls,
        camera: str,
        *,
        eye: Annotated[npt.ArrayLike | None, (3,)] = None,
        target: Annotated[npt.ArrayLike | None, (3,)] = None,
        relative_tracking: bool = False,
    ) -> None: ...
