"""`Types`: messages as the other side has them, whatever its distribution."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from trundle.errors import InputError
from trundle.messages import Codec, Distro
from trundle.ros2.transport.transport import Transport

_DEFAULTS = {("geometry_msgs/msg/Quaternion", "w"): 1.0}
"""The fields of the messages in use whose default is not 0."""


class Types:
    """The codec of a distribution, and what only the other side knows: packages such as nav2_msgs, by their text.

    Args:
        codec: The codec of the transport's distribution.
        transport: Asked for the types that the codec does not have.
    """

    def __init__(self, codec: Codec, transport: Transport) -> None:
        self.codec = codec
        self._transport = transport
        self._lock = threading.RLock()
        self._missing: set[str] = set()
        self._makers: dict[str, dict[str, Callable[[], Any]]] = {}

    @property
    def distro(self) -> Distro:
        """The distribution."""
        return self.codec.distro

    def make(self, type_name: str, /, **fields: object) -> Any:
        """Make a message.

        What is not given is what ROS makes it: 0, "", [] and messages of such. Fields that the other side's type does
        not have are left out, because distributions differ in them. Lists become arrays where the field has numbers.

        Raises:
            UnknownNameError: If there is no such type.
            InputError: If a list has numbers that its field cannot hold.
        """
        makers = self._makers_of(type_name)
        values = {name: make() for name, make in makers.items() if name not in fields}
        for name, value in fields.items():
            if name in makers:
                values[name] = self._array(type_name, name, value) if isinstance(value, (list, tuple)) else value
        return self.kind(type_name)(**values)

    def kind(self, type_name: str) -> Any:
        """Return the class of a type; its constants are attributes.

        Raises:
            UnknownNameError: If there is no such type.
        """
        self._learn(type_name)
        return self.codec.kind(type_name)

    def knows(self, type_name: str) -> bool:
        """Return whether there is such a type; the other side is asked once.

        Raises:
            InputError: If the other side has it, and its text cannot be read.
        """
        if type_name in self.codec:
            return True
        with self._lock:
            if type_name in self._missing:
                return False
            text = self._transport.definition(type_name)
            if not text:
                self._missing.add(type_name)
                return False
            self.codec.register(type_name, text)
            return True

    def has(self, type_name: str, field: str) -> bool:
        """Return whether there is such a type, and it has this field."""
        return self.knows(type_name) and field in self.codec.fields(type_name)

    def item_type(self, type_name: str, field: str) -> str:
        """Return the type of the messages in a list of a type; "" where it has no such field, or that holds numbers.

        Raises:
            UnknownNameError: If there is no such type.
        """
        from rosbags.interfaces import Nodetype

        self._learn(type_name)
        fields = self.codec.fields(type_name)
        if field not in fields:
            return ""
        what, detail = fields[field]
        is_list = what in (Nodetype.ARRAY, Nodetype.SEQUENCE) and detail[0][0] == Nodetype.NAME
        return str(detail[0][1]) if is_list else ""

    def constant(self, type_name: str, name: str, default: int = 0) -> int:
        """Return a constant of a type, such as an error code, or `default` where this distribution does not have it."""
        return getattr(self.kind(type_name), name, default) if self.knows(type_name) else default

    def encode(self, message: Any) -> bytes:
        """Return the CDR bytes of a message.

        Raises:
            InputError: If a field has a value that its type cannot hold.
        """
        try:
            return self.codec.encode(message)
        except Exception as error:
            raise InputError(f"a message of type {message.__msgtype__} cannot be written: {error}") from error

    def decode(self, type_name: str, data: bytes) -> Any:
        """Read a message from its CDR bytes.

        Raises:
            UnknownNameError: If there is no such type.
            InputError: If they are not the bytes of such a message.
        """
        self._learn(type_name)
        return self.codec.decode(type_name, data)

    def definition(self, type_name: str) -> str:
        """Return the text of a type and of all in it, as a bag's schema has it.

        Raises:
            UnknownNameError: If there is no such type.
        """
        self._learn(type_name)
        return self.codec.definition(type_name)

    def type_hash(self, type_name: str) -> str:
        """Return the hash of a type, `RIHS01_…`.

        Raises:
            UnknownNameError: If there is no such type.
        """
        self._learn(type_name)
        return self.codec.type_hash(type_name)

    def _learn(self, type_name: str) -> None:
        if not self.knows(type_name):
            self.codec.kind(type_name)  # raises the error, which looks for the nearest name

    # Defaults -------------------------------------------------------------------------------------------------------

    def _makers_of(self, type_name: str) -> dict[str, Callable[[], Any]]:
        if type_name not in self._makers:
            self._learn(type_name)
            fields = self.codec.fields(type_name)
            self._makers[type_name] = {name: self._maker(type_name, name, desc) for name, desc in fields.items()}
        return self._makers[type_name]

    def _maker(self, type_name: str, name: str, desc: Any) -> Callable[[], Any]:
        """Return what makes the default of a field."""
        from rosbags.interfaces import Nodetype

        if (type_name, name) in _DEFAULTS:
            return lambda: _DEFAULTS[type_name, name]
        what, detail = desc
        if what == Nodetype.BASE:
            return _BASES.get(detail[0], int)
        if what == Nodetype.NAME:
            return lambda: self.make(detail)
        element, length = detail
        count = length if what == Nodetype.ARRAY else 0
        dtype = _dtype(element)
        if dtype is not None:
            return lambda: np.zeros(count, dtype)
        make = self._maker(type_name, "", element)
        return lambda: [make() for _ in range(count)]

    def _array(self, type_name: str, name: str, value: list[Any] | tuple[Any, ...]) -> Any:
        from rosbags.interfaces import Nodetype

        what, detail = self.codec.fields(type_name)[name]
        dtype = _dtype(detail[0]) if what in (Nodetype.ARRAY, Nodetype.SEQUENCE) else None
        try:
            return list(value) if dtype is None else np.asarray(value, dtype)
        except (ValueError, TypeError, OverflowError) as error:
            raise InputError(f"{name} of {type_name} cannot hold what it is given: {error}") from error


_BASES: dict[str, Callable[[], Any]] = {
    "bool": bool,
    "float32": float,
    "float64": float,
    "string": str,
    "wstring": str,
}


def _dtype(element: Any) -> np.dtype[Any] | None:
    """Return what an array of a field's elements is made of; None where rosbags has a list."""
    from rosbags.interfaces import Nodetype

    what, detail = element
    if what != Nodetype.BASE or detail[0] in ("string", "wstring"):
        return None
    name = {"byte": "uint8", "char": "uint8"}.get(detail[0], detail[0])
    return np.dtype(name)
