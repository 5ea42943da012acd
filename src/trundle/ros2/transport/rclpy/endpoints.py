"""Topics, requests and goals that a child serves: our ends of them."""

from __future__ import annotations

import logging
import threading
from collections import deque

from trundle.messages import Qos
from trundle.ros2.transport.rclpy import child
from trundle.ros2.transport.transport import ActionHandler, Handler, Sample

_logger = logging.getLogger(__name__)

_LEAST_DEPTH = 32
"""A subscription holds at least so many: more than its depth in ROS, because two queues follow each other."""

_YES, _NO = b"\1", b"\0"
_UUID_SIZE = 16
_FEEDBACK_DEPTH = 10


class RelayedPublisher:
    """A publisher in the child.

    Args:
        number: Its number.
        qos: Its quality of service. What is reliable waits a moment for a child that does not keep up.
        outbox: To the child.

    Attributes:
        matched: How many subscriptions of other nodes get what is written.
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
        wakes: Whether a message ends `wait`.

    Attributes:
        wakes: The same.
        matched: How many publishers it gets messages from; -1 on Humble, which does not say.
        dropped_by_child: How many messages waited too long in the child.
    """

    def __init__(self, qos: Qos, *, wakes: bool = True) -> None:
        self.wakes = wakes
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
        """Return what arrived since the last call, oldest first."""
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


class RelayedGoal:
    """A goal of an action that was accepted.

    Args:
        number: The child's number of it.
        id_: Its UUID.
        data: The goal.
        outbox: To the child that has it.

    Attributes:
        cancel_requested: Whether the client asked to cancel it and the handler agreed.
    """

    def __init__(self, number: int, id_: bytes, data: bytes, outbox: child.Outbox) -> None:
        self.id, self.data = id_, data
        self.cancel_requested = False
        self._number, self._outbox = number, outbox
        self._feedback = child.Stream(child.FEEDBACK, number, _FEEDBACK_DEPTH)
        self._lock = threading.Lock()
        self.is_over = False

    def publish_feedback(self, data: bytes) -> None:
        """Send feedback; after its end, nothing happens."""
        if not self.is_over:
            self._outbox.put_message(self._feedback, data)

    def succeed(self, result: bytes) -> None:
        """End the goal: it was reached."""
        self._end(child.SUCCEEDED, result)

    def abort(self, result: bytes) -> None:
        """End the goal: it was not reached."""
        self._end(child.ABORTED, result)

    def canceled(self, result: bytes) -> None:
        """End the goal: its client canceled it."""
        self._end(child.CANCELED, result)

    def _end(self, how: int, result: bytes) -> None:
        with self._lock:
            if self.is_over:
                return
            self.is_over = True
        self._outbox.put(child.RESULT, self._number, bytes([how]) + result)


class Requests:
    """The handlers of services and actions, and what waits for them.

    Attributes:
        services, actions: The handlers, by the child's numbers.
        waiting: Frames of the child (kind, number, payload) that wait for `dispatch`.
    """

    def __init__(self) -> None:
        self.services: dict[int, Handler] = {}
        self.actions: dict[int, ActionHandler] = {}
        self.waiting: deque[tuple[int, int, bytes]] = deque()
        self._goals: dict[int, tuple[RelayedGoal, ActionHandler]] = {}

    def forget(self) -> None:
        """Drop what waits and what is under way: the child that asked is gone."""
        self.waiting.clear()
        self._goals.clear()

    def dispatch(self, outbox: child.Outbox) -> None:
        """Run the handlers of all that waits, in this thread.

        One that fails is logged. Its client is answered all the same: with a response as ROS makes it, with a
        rejection, or with an aborted goal.
        """
        while self.waiting:
            kind, number, payload = self.waiting.popleft()
            (subject,), data = child.NUMBER.unpack_from(payload), payload[child.NUMBER.size :]
            if kind == child.STARTED:
                self._start(number, self.actions[subject], data, outbox)
                continue
            try:
                answer = self._answer(kind, subject, data)
            except Exception:  # whatever it raises, its client is answered
                _logger.exception("the handler of a service or action failed")
                answer = _NO
            outbox.put(child.ANSWER, number, answer)

    def _answer(self, kind: int, subject: int, data: bytes) -> bytes:
        if kind == child.REQUEST:
            return _YES + self.services[subject](data)
        if kind == child.GOAL:
            return _YES if self.actions[subject].accepts(data) else _NO
        goal, handler = self._goals[subject]
        if goal.is_over or not handler.cancel(goal):
            return _NO
        goal.cancel_requested = True
        return _YES

    def _start(self, number: int, handler: ActionHandler, data: bytes, outbox: child.Outbox) -> None:
        goal = RelayedGoal(number, data[:_UUID_SIZE], data[_UUID_SIZE:], outbox)
        self._goals = {key: entry for key, entry in self._goals.items() if not entry[0].is_over}
        self._goals[number] = goal, handler
        try:
            handler.accepted(goal)
        except Exception:  # whatever it raises, its client gets a result
            _logger.exception("the handler of an action failed")
            goal.abort(b"")
