"""Many robots at once: the kinematic model in arrays."""

from trundle.sim.batch.recording import MoverRecording
from trundle.sim.batch.simulator import CELL, MOVER, NOTHING, BatchSimulator

__all__ = ["CELL", "MOVER", "NOTHING", "BatchSimulator", "MoverRecording"]
