# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

def get_assets_root_path(*, skip_check: bool = False) -> str: ...
