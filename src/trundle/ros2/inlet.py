"""`Inlet`: a topic that the bridge reads: what came is decoded and handled, and floods are cut."""

from __future__ import annotations

import logging
import math
import time as clock
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from trundle.errors import TrundleError
from trundle.messages.qos import Qos

if TYPE_CHECKING:
    from trundle.ros2.transport.transport import Subscription
    from trundle.ros2.types import Types

_LOGGER = logging.getLogger(__name__)

MOST_A_SECOND = 500
"""Messages of one topic that are handled in a second [real time]; a node that sends more floods, and is reported."""


class Record(Protocol):
    """Keeps what goes over the wire."""

    def add(self, topic: str, type_name: str, qos: Qos, data: bytes, time: float) -> None:
        """Add a message that was written or received at a simulated time [s]."""
        ...


class Listener(Protocol):
    """What reads topics, as a `Wire` does: it has the types and the record, and reports what is wrong."""

    types: Types
    record: Record | None
    now: Callable[[], float]

    def warn(self, kind: str, text: str | Callable[[], str]) -> None:
        """Report something, once for each kind."""
        ...

    def describe_source(self, source: str) -> str:
        """Return who sent something."""
        ...


class Inlet:
    """A topic that the bridge reads.

    Attributes:
        topic: Its full name.
        type_name: Type of its messages.
        qos: What it is read with.
        received: How many messages came.
        flooded_s: When a message was last dropped as one of too many in a second [s of real time].
    """

    def __init__(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        subscription: Subscription,
        handler: Callable[[Any, str], None],
        *,
        is_recorded: bool = True,
        newest: bool = False,
    ) -> None:
        self._is_recorded = is_recorded
        self.topic, self.type_name, self.qos = topic, type_name, qos
        self._subscription, self._handler, self._newest = subscription, handler, newest
        self._second, self._count = 0, 0
        self.received, self.flooded_s = 0, -math.inf

    @property
    def writers(self) -> int:
        """Number of publishers."""
        return self._subscription.matched

    def take(self, wire: Listener) -> bool:
        """Handle what came, and return whether it was more than is handled in a second."""
        floods = False
        samples = self._subscription.take()
        if self._newest and samples:
            self.received += len(samples) - 1
            for sample in samples[:-1]:
                self._keep(sample.data, wire)
            samples = samples[-1:]
        for sample in samples:
            self.received += 1
            second = int(clock.monotonic())
            if second != self._second:
                self._second, self._count = second, 0
            self._count += 1
            if self._count > MOST_A_SECOND:
                floods, self.flooded_s = True, clock.monotonic()
                self._warn_of_flood(sample.source, wire)
            else:
                self._handle(sample.data, sample.source, wire)
        return floods

    def _warn_of_flood(self, source: str, wire: Listener) -> None:
        wire.warn(
            f"{self.topic}: flood",
            lambda: (
                f"{wire.describe_source(source)} floods {self.topic} with more than {MOST_A_SECOND} messages a "
                "second; the rest of each second is dropped"
            ),
        )

    def _keep(self, data: bytes, wire: Listener) -> None:
        if wire.record is not None and self._is_recorded:
            wire.record.add(self.topic, self.type_name, self.qos, data, wire.now())

    def _handle(self, data: bytes, source: str, wire: Listener) -> None:
        self._keep(data, wire)
        try:
            message = wire.types.decode(self.type_name, data)
        except TrundleError as error:
            reason = str(error)
            wire.warn(
                f"{self.topic}: not a {self.type_name}",
                lambda: (
                    f"{wire.describe_source(source)} sent on {self.topic} what is not a {self.type_name} of "
                    f"{wire.types.distro}: {reason}; it is dropped: give --distro as the other side has it"
                ),
            )
            return
        try:
            self._handler(message, source)
        except TrundleError as error:
            wire.warn(f"{self.topic}: refused", f"a message of {self.topic} is dropped: {error}")
        except Exception:  # a message from outside never ends the bridge
            _LOGGER.exception("a message of %s could not be handled", self.topic)
            wire.warn(f"{self.topic}: failed", f"a message of {self.topic} could not be handled, and is dropped")
