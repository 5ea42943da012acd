# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

from warp import array

class WheeledRobot:
    def __init__(
        self,
        paths: str,
        *,
        wheel_dof_names: list[str] | None = None,
        wheel_dof_indices: list[int] | None = None,
        usd_path: str | None = None,
        positions: Annotated[npt.ArrayLike | None, (1, 3)] = None,
        orientations: Annotated[npt.ArrayLike | None, (1, 4)] = None,
    ) -> None: ...
    @property
    def dof_names(self) -> list[str]: ...
    def is_physics_tensor_entity_valid(self) -> bool: ...
    def get_dof_indices(self, names: str | list[str]) -> array: ...
    def apply_wheel_actions(self, velocities: Annotated[npt.NDArray[Any], (2,)]) -> None: ...
    def set_world_poses(
        self,
        positions: Annotated[npt.ArrayLike | None, (1, 3)] = None,
        orientations: Annotated[npt.ArrayLike | None, (1, 4)] = None,
        *,
        indices: npt.ArrayLike | None = None,
    ) -> None: ...
    def get_world_poses(self, *, indices: npt.ArrayLike | None = None) -> tuple[array, array]: ...
    def set_velocities(
        self,
        linear_velocities: Annotated[npt.ArrayLike | None, (1, 3)] = None,
        angular_velocities: Annotated[npt.ArrayLike | None, (1, 3)] = None,
        *,
        indices: npt.ArrayLike | None = None,
    ) -> None: ...
    def get_velocities(self, *, indices: npt.ArrayLike | None = None) -> tuple[array, array]: ...
    def get_link_coms(
        self, *, indices: npt.ArrayLike | None = None, link_indices: npt.ArrayLike | None = None
    ) -> tuple[array, array]: ...
    def set_dof_velocities(
        self,
        velocities: npt.ArrayLike,
        *,
        indices: npt.ArrayLike | None = None,
        dof_indices: npt.ArrayLike | None = None,
    ) -> None: ...
    def get_dof_positions(
        self, *, indices: npt.ArrayLike | None = None, dof_indices: npt.ArrayLike | None = None
    ) -> array: ...
    def get_dof_velocities(
        self, *, indices: npt.ArrayLike | None = None, dof_indices: npt.ArrayLike | None = None
    ) -> array: ...
