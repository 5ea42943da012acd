"""`Names`: the names of topics, services and frames on the network, with a namespace and remaps as ROS 2 has them."""

from __future__ import annotations

import re
from collections.abc import Iterable

from trundle.errors import InputError

_TOKEN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")
_FRAME_PREFIX = re.compile(r"[A-Za-z0-9_./-]*\Z")
_LONGEST = 255
_SUBSTITUTION = re.compile(r"\{([^{}]*)\}")
_URLS = ("rostopic://", "rosservice://")
_RULES = (
    "letters, digits and underscores, in parts that are separated by single slashes and do not begin with a digit; "
    "a leading / makes it absolute, a leading ~/ private to the node"
)


class Names:
    """Resolves names as a ROS 2 node does: relative ones get the namespace, then the remaps apply.

    Args:
        node: Name of the node.
        namespace: Namespace of the node, such as "robot1" or "/fleet/robot1"; empty for none.
        remaps: Pairs (from, to), or texts "from:=to" as after `--ros-args -r`; `__ns:=/robot1` and `__node:=name` set
            the namespace and the node's name. The first one that fits a name is used.
        frame_prefix: Before every frame but the map's, as robot_state_publisher's parameter: "robot1/".

    Attributes:
        node: Name of the node.
        namespace: Its namespace, with a leading slash; "/" without one.

    Raises:
        InputError: If a name is not one that ROS allows.
    """

    def __init__(
        self,
        *,
        node: str = "trundle",
        namespace: str = "",
        remaps: Iterable[str | tuple[str, str]] = (),
        frame_prefix: str = "",
    ) -> None:
        pairs = [read_remap(remap) for remap in remaps]
        specials = {name: to for name, to in pairs if name in ("__ns", "__node", "__name")}
        node = specials.get("__node", specials.get("__name", node))
        namespace = specials.get("__ns", namespace)
        if not _TOKEN.match(node):
            raise InputError(f"the name of a node is one word of letters, digits and underscores, got {node!r}")
        self.node = node
        self.namespace = _check_namespace(namespace)
        if not _FRAME_PREFIX.match(frame_prefix) or frame_prefix.startswith("/"):
            raise InputError(f"a prefix of frames is such as 'robot1/', got {frame_prefix!r}")
        self.frame_prefix = frame_prefix
        self._remaps = [(self.expand(name), self.expand(to)) for name, to in pairs if not name.startswith("__")]

    def resolve(self, name: str) -> str:
        """Return the full name of a topic, a service or an action, such as "/robot1/scan".

        Raises:
            InputError: If ROS does not allow the name.
        """
        full = self.expand(name)
        return next((to for name, to in self._remaps if name == full), full)

    def frame(self, name: str) -> str:
        """Return a frame with the prefix."""
        return self.frame_prefix + name

    def expand(self, name: str) -> str:
        """Return the full name without remaps.

        Raises:
            InputError: If ROS does not allow the name.
        """
        for url in _URLS:
            name = name.removeprefix(url)
        text = _SUBSTITUTION.sub(lambda found: self._substitute(found[1], name), name)
        base = "" if self.namespace == "/" else self.namespace
        if text.startswith("~"):
            if not text.startswith("~/"):
                raise InputError(f"{name!r} is no name in ROS: ~ is followed by /, as in ~/status")
            full = f"{base}/{self.node}{text[1:]}"
        else:
            full = text if text.startswith("/") else f"{base}/{text}"
        _check_full(full, name)
        return full

    def _substitute(self, word: str, name: str) -> str:
        known = {"node": self.node, "ns": self.namespace.strip("/"), "namespace": self.namespace.strip("/")}
        if word not in known:
            raise InputError(f"{name!r}: {{{word}}} is unknown in ROS; there are {{node}} and {{ns}}")
        return known[word]


def read_remap(remap: str | tuple[str, str]) -> tuple[str, str]:
    """Read a remap from "from:=to", or from a pair.

    Raises:
        InputError: If it is not a remap.
    """
    pair = tuple(remap.split(":=")) if isinstance(remap, str) else tuple(remap)
    if len(pair) != 2 or not all(pair):
        raise InputError(f"a remap is FROM:=TO, such as scan:=/front/scan, got {remap!r}")
    return pair


def _check_namespace(namespace: str) -> str:
    if namespace in ("", "/"):
        return "/"
    full = namespace if namespace.startswith("/") else f"/{namespace}"
    full = full.rstrip("/")
    _check_full(full, namespace)
    return full


def _check_full(full: str, name: str) -> None:
    parts = full.split("/")[1:]
    if not full or len(full) > _LONGEST:
        raise InputError(f"a name in ROS has 1 to {_LONGEST} characters, got {len(full)}")
    for part in parts:
        if not _TOKEN.match(part):
            what = f"{part!r} in it" if part else "an empty part of it"
            raise InputError(f"{name!r} is no name in ROS, because of {what}; a name has {_RULES}")
