"""`ClockOutput`: /clock, from the physics steps."""

from __future__ import annotations

import threading
import time as real_time

from trundle.messages import MessageMaker
from trundle.messages.qos import Qos
from trundle.mission import Step
from trundle.ros2.outputs.cadence import Cadence
from trundle.ros2.outputs.stencil import Stencil, mark_stamp
from trundle.ros2.simulation.clock import SimulationClock
from trundle.ros2.wire import Wire

CLOCK = Qos(10)
"""Of /clock: reliable, so that readers who ask for that get it, too; time sources take it as it comes."""

_REPEAT_S = 0.5


class ClockOutput:
    """Publishes the simulated time at a rate, as far as the physics steps are that short.

    While the time stands, it is repeated twice a second of real time, so that nodes that start meanwhile know it.

    Args:
        wire: The network.
        topic: Its topic.
        clock: The time.
        rate: [Hz of simulated time].
    """

    def __init__(self, wire: Wire, topic: str, clock: SimulationClock, rate: float) -> None:
        self._outlet = wire.outlet(topic, "rosgraph_msgs/msg/Clock", CLOCK)
        make = MessageMaker(wire.types.codec)
        message = make.clock(0.0)
        mark_stamp(message.clock)
        self._bytes = Stencil(wire.types.encode(message))
        self._lock = threading.Lock()
        self._clock, self._cadence = clock, Cadence(1.0 / rate)
        self._written_s = 0.0
        wire.every_round(self._repeat)

    def tick(self, time: float) -> None:
        """Publish a time [s] if it is due."""
        if self._cadence.is_due(time):
            self._write(time)

    def publish(self, step: Step, time: float) -> None:
        """Publish the end of a control period, where no physics step did."""
        self.tick(time)

    def _write(self, time: float) -> None:
        self._cadence.mark(time)
        self._written_s = real_time.monotonic()
        if self._outlet.is_wanted:
            with self._lock:
                data = self._bytes.fill(time)
            self._outlet.write_bytes(data)

    def _repeat(self) -> None:
        if 0.0 < self._written_s < real_time.monotonic() - _REPEAT_S:
            self._write(self._clock.now)
