"""`SimulatorRole`: other programs drive the robot, as in Gazebo or Isaac Sim."""

from __future__ import annotations

from collections.abc import Sequence

from trundle.mission import Observer, Session
from trundle.mission.simulation import SessionOptions
from trundle.ros2.inputs.agent import RosAgent
from trundle.ros2.role import BridgeContext


class SimulatorRole:
    """Takes commands from the network. There is no map, no localizer and no collision monitor: those are Nav2's.

    A contact is published, and does not end the run.

    Args:
        context: What it plugs into.

    Attributes:
        agent: What drives the robot.
    """

    def __init__(self, context: BridgeContext) -> None:
        self._context = context
        self.agent = RosAgent(context.wire, context.profile, context.clock, context.mission.robot)

    def open(self) -> None:
        """Listen to commands."""
        self.agent.open()

    def begin(self, observers: Sequence[Observer], seed: int | None) -> Session:
        """Begin a run; see `Role`."""
        options: SessionOptions = {
            "localizer": None,
            "latency": self._context.mission.scenario.latency,
            "rules": None,
            "monitor": False,
            "through": False,
        }
        return self._context.begin_session(self.agent, observers, seed, options)

    def lost(self, why: str) -> None:
        """Stop the robot."""
        self.agent.lost(why)

    def close(self) -> None:
        """Do nothing more."""
