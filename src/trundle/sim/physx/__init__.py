"""NVIDIA PhysX as a simulator, on the CPU. Each name, and with it the engine, is imported on first use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names

if TYPE_CHECKING:
    from trundle.sim.physx.simulator import PhysxSimulator

__getattr__ = lazy_names(__name__, {"PhysxSimulator": "trundle.sim.physx.simulator"})

__all__ = ["PhysxSimulator"]
