"""Isaac Sim as a simulator. Its modules are imported only once a simulator has started the application."""

from trundle.sim.isaac.simulator import IsaacSimulator

__all__ = ["IsaacSimulator"]
