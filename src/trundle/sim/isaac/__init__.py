"""Isaac Sim as a simulator. Nothing of it is imported until a simulator is made and its application runs."""

from trundle.sim.isaac.simulator import IsaacSimulator

__all__ = ["IsaacSimulator"]
