"""The types of messages as Cyclone DDS wants them: it checks all bytes against them, written and received."""

# Cyclone DDS has no wheel for some Pythons and machines.
# pyright: reportMissingImports=false

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from trundle.messages import Codec
from trundle.ros2.transport.dds import names

if TYPE_CHECKING:
    from cyclonedds.idl import IdlStruct
    from rosbags.interfaces.typing import FieldDesc

_BASES: dict[str, Any] = {
    "bool": bool,
    "byte": "byte",
    "char": "uint8",
    "float32": "float32",
    "float64": "float64",
    "int8": "int8",
    "int16": "int16",
    "int32": "int32",
    "int64": "int64",
    "uint8": "uint8",
    "uint16": "uint16",
    "uint32": "uint32",
    "uint64": "uint64",
}
"""ROS's `char` is an unsigned byte; names are those of `cyclonedds.idl.types`."""


class IdlTypes:
    """Makes Cyclone's types, each once."""

    def __init__(self, codec: Codec) -> None:
        self._codec = codec
        self._made: dict[str, type[IdlStruct]] = {}

    def struct(self, type_name: str) -> type[IdlStruct]:
        """The type of a message.

        Raises:
            UnknownNameError: If the distribution has no such type.
        """
        if type_name not in self._made:
            from cyclonedds.idl import make_idl_struct

            dds_name = names.dds_type(type_name)
            fields = {name: self._field(field) for name, field in self._codec.fields(type_name).items()}
            self._made[type_name] = make_idl_struct(dds_name.rpartition("::")[2], dds_name, fields)
        return self._made[type_name]

    def _field(self, field: FieldDesc) -> Any:
        from cyclonedds.idl import types
        from rosbags.interfaces import Nodetype

        if field[0] == Nodetype.NAME:
            return self.struct(field[1])
        if field[0] == Nodetype.BASE:
            name, length = field[1]
            if name == "string":
                return types.bounded_str[length] if length else str
            return _BASES[name] if isinstance(_BASES[name], type) else getattr(types, _BASES[name])
        element, length = self._field(field[1][0]), field[1][1]
        if field[0] == Nodetype.ARRAY:
            return types.array[element, length]
        return types.sequence[element, length] if length else types.sequence[element]
