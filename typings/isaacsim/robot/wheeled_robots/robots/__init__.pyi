# Made by scripts/isaac_stubs.py of src/trundle/sim/isaac/signatures.yaml: change that.
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

from isaacsim.core.utils.types import ArticulationAction

class WheeledRobot:
    def __init__(
        self,
        prim_path: str,
        name: str = "wheeled_robot",
        robot_path: str | None = None,
        wheel_dof_names: list[str] | None = None,
        wheel_dof_indices: list[int] | None = None,
        usd_path: str | None = None,
        create_robot: bool | None = False,
        position: Annotated[npt.ArrayLike | None, (3,)] = None,
        orientation: Annotated[npt.ArrayLike | None, (4,)] = None,
    ) -> None: ...
    @property
    def dof_names(self) -> list[str]: ...
    @property
    def num_dof(self) -> int: ...
    def apply_wheel_actions(self, actions: ArticulationAction) -> None: ...
    def get_wheel_positions(self) -> list[float]: ...
    def get_wheel_velocities(self) -> list[float]: ...
    def set_world_pose(
        self,
        position: Annotated[npt.ArrayLike | None, (3,)] = None,
        orientation: Annotated[npt.ArrayLike | None, (4,)] = None,
    ) -> None: ...
    def set_default_state(
        self,
        position: Annotated[npt.ArrayLike | None, (3,)] = None,
        orientation: Annotated[npt.ArrayLike | None, (4,)] = None,
    ) -> None: ...
    def get_world_pose(self) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]: ...
    def get_linear_velocity(self) -> npt.NDArray[Any]: ...
    def get_angular_velocity(self) -> npt.NDArray[Any]: ...
    def set_linear_velocity(self, velocity: Annotated[npt.ArrayLike, (3,)]) -> None: ...
    def set_angular_velocity(self, velocity: Annotated[npt.ArrayLike, (3,)]) -> None: ...
    def set_joint_velocities(
        self, velocities: Annotated[npt.ArrayLike, (-1,)], joint_indices: npt.ArrayLike | None = None
    ) -> None: ...
