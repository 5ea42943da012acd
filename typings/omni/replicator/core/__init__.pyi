# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

from omni.replicator.core import create as create

class Annotator:
    def attach(self, render_products: list[str]) -> None: ...
    def detach(self) -> None: ...
    def get_data(self) -> npt.NDArray[np.uint8]: ...
class AnnotatorRegistry:
    @classmethod
    def get_annotator(cls, name: str) -> Annotator: ...
