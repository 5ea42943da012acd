"""Publishers and subscriptions that a child serves."""

from __future__ import annotations

import threading
from collections import deque

from trundle.messages import Qos
from trundle.ros2.transport.rclpy import child
from trundle.ros2.transport.transport import Sample

_LEAST_DEPTH = 32
"""A subscription holds at least so many: more than its depth in ROS, because two queues follow each other."""


class RelayedPublisher:
    """A publisher in the child.

    Args:
        number: Its number.
        qos: Its quality of service. What is reliable waits a moment for a child that does not keep up.
        outbox: To the child.

    Attributes:
        matched: How many subscriptions get what is written.
    """

    def __init__(self, number: int, qos: Qos, outbox: child.Outbox) -> None:
        self.matched = 0
        self._number, self._qos = number, qos
        self._dropped_before = 0
        self._kept: deque[bytes] = deque(maxlen=qos.depth)
        self._outlet = self._make_outlet(outbox)

    @property
    def dropped(self) -> int:
        """How many messages a child that did not keep up has not got."""
        return self._dropped_before + self._outlet[1].dropped

    def write(self, data: bytes) -> None:
        """Send a message."""
        if self._qos.durability == "transient_local":
            self._kept.append(data)
        outbox, stream = self._outlet
        outbox.put_message(stream, data)

    def attach(self, outbox: child.Outbox) -> None:
        """Write to a new child from now on; late subscribers get the last messages from it as well."""
        self._dropped_before = self.dropped
        self._outlet = self._make_outlet(outbox)
        for data in list(self._kept):
            outbox.put_message(self._outlet[1], data)

    def _make_outlet(self, outbox: child.Outbox) -> tuple[child.Outbox, child.Stream]:
        is_patient = self._qos.reliability == "reliable" and self._qos.durability == "volatile"
        return outbox, child.Stream(child.PUBLISH, self._number, self._qos.depth, patient=is_patient)


class RelayedSubscription:
    """A subscription in the child, and the queue of what it received.

    Args:
        qos: Its quality of service.

    Attributes:
        matched: How many publishers it gets messages from; -1 on Humble, which does not say.
        dropped_by_child: How many messages waited too long in the child.
    """

    def __init__(self, qos: Qos) -> None:
        self.matched = 0
        self.dropped_by_child = 0
        self._depth = max(qos.depth, _LEAST_DEPTH)
        self._lock = threading.Lock()
        self._samples: deque[Sample] = deque()
        self._size = self._dropped = 0

    @property
    def dropped(self) -> int:
        """How many messages found the queue full."""
        return self._dropped + self.dropped_by_child

    def take(self) -> list[Sample]:
        """What arrived since, oldest first."""
        with self._lock:
            samples = list(self._samples)
            self._samples.clear()
            self._size = 0
            return samples

    def add(self, payload: bytes) -> None:
        """Add a message, as the child sends it; where there are too many, the oldest are dropped."""
        start = 1 + payload[0]
        sample = Sample(payload[start:], payload[1:start].decode("ascii"))
        with self._lock:
            while self._samples and (len(self._samples) >= self._depth or self._size + len(payload) > child.LIMIT):
                self._size -= len(self._samples.popleft().data)
                self._dropped += 1
            self._samples.append(sample)
            self._size += len(sample.data)
