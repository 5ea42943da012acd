"""Missions that a kernel drives as a whole: `needs_python` says which it cannot, `MissionBatch` drives the others."""

from trundle.mission.batch.missions import BatchMission, HandedOver, MissionBatch
from trundle.mission.batch.needs import BATCH, CONTROLLER, needs_python

__all__ = ["BATCH", "CONTROLLER", "BatchMission", "HandedOver", "MissionBatch", "needs_python"]
