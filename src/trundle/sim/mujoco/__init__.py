"""MuJoCo as a simulator. Each name, and with it the engine, is imported on first use."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trundle.sim.mujoco.joint import Joint
    from trundle.sim.mujoco.joints import list_joints
    from trundle.sim.mujoco.simulator import MujocoSimulator

_HOMES = {
    "Joint": "trundle.sim.mujoco.joint",
    "MujocoSimulator": "trundle.sim.mujoco.simulator",
    "list_joints": "trundle.sim.mujoco.joints",
}

__all__ = ["Joint", "MujocoSimulator", "list_joints"]


def __getattr__(name: str) -> object:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'trundle.sim.mujoco' has no attribute {name!r}")
    return getattr(importlib.import_module(home), name)
