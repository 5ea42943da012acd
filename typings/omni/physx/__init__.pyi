# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

class IPhysxSimulation:
    def get_contact_report(self) -> tuple[Any, Any]: ...
def get_physx_simulation_interface() -> IPhysxSimulation: ...
