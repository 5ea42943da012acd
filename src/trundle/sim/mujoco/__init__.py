"""MuJoCo as a simulator. Each name, and with it the engine, is imported on first use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names

if TYPE_CHECKING:
    from trundle.sim.mujoco.joints import Joint, list_joints
    from trundle.sim.mujoco.simulator import MujocoSimulator

__getattr__ = lazy_names(
    __name__,
    {
        "Joint": "trundle.sim.mujoco.joints",
        "MujocoSimulator": "trundle.sim.mujoco.simulator",
        "list_joints": "trundle.sim.mujoco.joints",
    },
)

__all__ = ["Joint", "MujocoSimulator", "list_joints"]
