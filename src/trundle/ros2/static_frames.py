"""`StaticFrames`: publishes where sensors and other fixed frames are on the robot, where nobody else does."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Sequence
from typing import Any, Literal, TypeAlias

from trundle.messages import MessageMaker
from trundle.messages.qos import LATCHED, Qos
from trundle.ros2.wire import Wire

StaticFramesMode: TypeAlias = Literal["auto", "always", "never"]
"""When fixed frames are published: where nobody else publishes them, in any case, or not at all."""

PATIENCE_S = 2.0
"""How long frames that somebody else usually publishes are waited for [real time]: a latched message arrives within a
second of the discovery, also on a busy machine."""

_ALL = Qos(100, durability="transient_local")
"""It is as deep as this for several publishers, each of which has its latched message."""

_TF = "tf2_msgs/msg/TFMessage"
_SAME = 1e-6
"""Numbers of two transforms that differ by less [m, 1] are the same."""


class StaticFrames:
    """Publishes fixed frames on /tf_static, and keeps out of the way of others that do.

    With "auto", a frame that another node publishes is left to it, also where that node comes later: it is withdrawn
    then, with one remark for each node's message. A frame that another node has elsewhere is reported.

    Args:
        wire: The network.
        transforms: The frames, each a geometry_msgs/TransformStamped.
        mode: When they are published.
        topic: Their topic.
        patience_s: How long "auto" listens before it publishes [real time]; 0 where nobody else is expected.
    """

    def __init__(
        self,
        wire: Wire,
        transforms: Sequence[Any],
        *,
        mode: StaticFramesMode = "auto",
        topic: str = "/tf_static",
        patience_s: float = PATIENCE_S,
    ) -> None:
        self._wire, self._mode, self._topic = wire, mode, topic
        self._make = MessageMaker(wire.types.codec)
        self._waiting = {transform.child_frame_id: transform for transform in transforms}
        self._published: dict[str, Any] | None = None
        self._foreign: set[str] = set()
        self._until = clock.monotonic() + (0.0 if mode == "always" else patience_s)
        self._patience_s = patience_s

    @property
    def published(self) -> tuple[str, ...]:
        """The frames that are published now."""
        return tuple(self._published or ())

    @property
    def foreign(self) -> frozenset[str]:
        """The frames that others publish."""
        return frozenset(self._foreign)

    def open(self) -> None:
        """Publish the frames, or begin to listen whether others do."""
        if self._mode == "never":
            return
        self._outlet = self._wire.outlet(self._topic, _TF, LATCHED)
        if self._mode == "auto":
            self._wire.listen(self._topic, _TF, _ALL, self._take, is_recorded=False)
            self._wire.every_round(self._look)
        if self._mode == "always" or self._patience_s == 0.0:
            self._write()

    def _look(self) -> None:
        """Publish what nobody else does, once that was waited for."""
        if self._published is None and clock.monotonic() >= self._until:
            self._write()

    def _take(self, message: Any, source: str) -> None:
        """Take note of what is published; what is as our own is ours, or does no harm."""
        others = [one for one in message.transforms if one.child_frame_id in self._waiting]
        others = [one for one in others if not _same(one, self._waiting[one.child_frame_id])]
        new = [one for one in others if one.child_frame_id not in self._foreign]
        if not new:
            return
        self._foreign |= {one.child_frame_id for one in new}
        self._report(new, source)
        if self._published is not None:
            self._write()

    def _report(self, new: list[Any], source: str) -> None:
        names = ", ".join(sorted(one.child_frame_id for one in new))
        who = self._wire.describe_source(source)
        self._wire.warnings.note(f"{who} publishes the static frames {names}: they are left to it")
        for one in new:
            own = self._waiting[one.child_frame_id]
            if one.header.frame_id == own.header.frame_id and (off := _distance(one, own)) > 0.05:
                name = one.child_frame_id
                self._wire.warn(
                    f"{name}: two places",
                    f"{who} has the frame {name} {off:.2f} m from where trundle has it on the robot: one of the two "
                    "is wrong",
                )

    def _write(self) -> None:
        left = {name: one for name, one in self._waiting.items() if name not in self._foreign}
        self._outlet.write(self._make.transforms(list(left.values())))
        self._published = left


def _same(one: Any, other: Any) -> bool:
    """Return whether two transforms are the same."""
    if one.header.frame_id != other.header.frame_id or _distance(one, other) > _SAME:
        return False
    turn, turned = one.transform.rotation, other.transform.rotation
    product = turn.x * turned.x + turn.y * turned.y + turn.z * turned.z + turn.w * turned.w
    return abs(abs(product) - 1.0) <= _SAME


def _distance(one: Any, other: Any) -> float:
    """Return how far the origins of two transforms are apart [m]."""
    at, there = one.transform.translation, other.transform.translation
    return math.dist((at.x, at.y, at.z), (there.x, there.y, there.z))
