"""`Distro`: the ROS 2 distributions that are known; `Codec`: the message types of one, and their bytes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

from trundle.errors import InputError, UnknownNameError
from trundle.extras import missing_extra

if TYPE_CHECKING:
    from rosbags.interfaces.typing import FieldDesc
    from rosbags.typesys.store import Typestore

Distro: TypeAlias = Literal["humble", "jazzy", "kilted", "lyrical"]
"""A distribution of ROS 2."""

DISTROS: tuple[Distro, ...] = get_args(Distro)
"""All of them, oldest first."""

DEFAULT: Distro = "jazzy"

STAMPED_COMMANDS = frozenset[Distro]({"kilted", "lyrical"})
"""The distributions in which Nav2 sends geometry_msgs/TwistStamped on /cmd_vel by default, and no longer Twist."""

OLD_BAGS = frozenset[Distro]({"humble"})
"""The distributions whose rosbag2 writes QoS settings as numbers, and metadata of version 5."""

_MORE_TYPES = {
    "map_msgs/msg/OccupancyGridUpdate": (
        "std_msgs/Header header\nint32 x\nint32 y\nuint32 width\nuint32 height\nint8[] data\n"
    ),
}
"""Types that rosbags does not bring along; they are the same in every distribution."""

_NEW = "trundle/msg/New"


class Codec:
    """Messages of one distribution: makes them, and writes and reads their CDR bytes.

    Args:
        distro: The distribution.

    Raises:
        UnknownNameError: If the distribution is not known.
        MissingExtraError: If rosbags is not installed.
    """

    def __init__(self, distro: Distro = DEFAULT) -> None:
        if distro not in DISTROS:
            raise UnknownNameError("ROS 2 distribution", distro, DISTROS)
        self.distro: Distro = distro
        self._store = _load_types(distro)
        self._hashes: dict[str, str] = {}

    def __repr__(self) -> str:
        return f"Codec({self.distro!r})"

    def make(self, type_name: str, **fields: object) -> Any:
        """Make a message, such as `make("std_msgs/msg/String", data="text")`.

        Raises:
            UnknownNameError: If the distribution has no such type.
            InputError: If the fields are not those of the type.
        """
        kind = self.kind(type_name)
        try:
            return kind(**fields)
        except TypeError as error:
            raise InputError(f"a message of type {type_name} cannot be made: {error}") from error

    def kind(self, type_name: str) -> Any:
        """Return the class of a message type.

        Raises:
            UnknownNameError: If the distribution has no such type.
        """
        try:
            return self._store.types[type_name]
        except KeyError:
            raise UnknownNameError("message type", type_name, self._store.types) from None

    def __contains__(self, type_name: str) -> bool:
        return type_name in self._store.types

    def fields(self, type_name: str) -> Mapping[str, FieldDesc]:
        """Return the fields of a type, as rosbags describes them.

        Raises:
            UnknownNameError: If the distribution has no such type.
        """
        self.kind(type_name)
        return dict(self._store.fielddefs[type_name][1])

    def register(self, type_name: str, text: str) -> None:
        """Add a type, and those in it that are not known.

        Args:
            type_name: Its name, "package/msg/Name"; of a part of a service or action "package/srv/Name_Request".
            text: Its text, with those of the types in it after lines "MSG: package/Name", as a bag's schema has them.

        Raises:
            InputError: If the text cannot be read, or differs from what is known by that name.
        """
        from rosbags.typesys import get_types_from_msg

        try:
            # Under another name, because rosbags makes "package/srv/msg/Name" of "package/srv/Name".
            found = get_types_from_msg(text, _NEW)
            found[type_name] = found.pop(_NEW)
            for name, (_, fields) in found.items():
                known = self._store.fielddefs.get(name)
                if known is not None and list(known[1]) != list(fields):
                    raise InputError(f"{name} of the other side is not that of {self.distro}: {text!r}")
            self._store.register({name: found[name] for name in found if name not in self._store.fielddefs})
            self._store.generate_msgdef(type_name, ros_version=2)  # raises where a part is missing
        except InputError:
            raise
        except Exception as error:  # of rosbags' parser, whatever the text makes it stumble over
            raise InputError(f"not the text of {type_name}: {error}") from error

    def encode(self, message: Any) -> bytes:
        """Return the CDR bytes of a message, little-endian, with their header of four bytes."""
        return bytes(self._store.serialize_cdr(message, message.__msgtype__))

    def decode(self, type_name: str, data: bytes) -> Any:
        """Read a message from its CDR bytes.

        Raises:
            UnknownNameError: If the distribution has no such type.
            InputError: If they are not the bytes of such a message.
        """
        self.kind(type_name)
        try:
            return self._store.deserialize_cdr(data, type_name)
        except Exception as error:  # rosbags' generated readers raise what the damage makes them stumble over
            raise InputError(f"not the bytes of a {type_name}: {error}") from error

    def definition(self, type_name: str) -> str:
        """Return the text of a type and of all types in it, as a bag's schema has it."""
        self.kind(type_name)
        return self._store.generate_msgdef(type_name, ros_version=2)[0]

    def type_hash(self, type_name: str) -> str:
        """Return the hash of a type, `RIHS01_…` (REP-2016)."""
        if type_name not in self._hashes:
            self.kind(type_name)
            self._hashes[type_name] = self._store.hash_rihs01(type_name)
        return self._hashes[type_name]


def _load_types(distro: Distro) -> Typestore:
    try:
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore
    except ImportError as error:
        raise missing_extra("ROS 2 messages", "rosbags", "record") from error
    store = get_typestore(Stores[f"ROS2_{distro.upper()}"])
    for name, text in _MORE_TYPES.items():
        if name not in store.fielddefs:
            store.register(get_types_from_msg(text, name))
    return store
