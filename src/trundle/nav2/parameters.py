"""`ParameterFile`: a ROS 2 parameter file, by node, which knows which of its parameters were read."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import yaml

from trundle.errors import InputError
from trundle.files.yaml_config import Plain, plain_value
from trundle.files.yaml_nodes import compose, place
from trundle.values import as_path, finite_number, show_value

_PARAMETERS = "ros__parameters"
_WILD = ("*", "**")


@dataclass(slots=True, eq=False)
class Parameter:
    """One parameter.

    Attributes:
        name: Its name, dotted: `FollowPath.lookahead_dist`.
        value: Its value.
        line: Its line in the file, from 1.
        where: Its place, for messages: `nav2_params.yaml:12:5`.
        was_read: Whether something has asked for it.
    """

    name: str
    value: Plain
    line: int
    where: str
    was_read: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Repeated:
    """A parameter that is given twice.

    Attributes:
        node: The node, or a wildcard.
        first, second: Its lines in the file, from 1; of three or more, those of two of them.
        counts: The one that counts.
    """

    node: str
    first: int
    second: int
    counts: Parameter


@dataclass(slots=True, eq=False)
class _Entry:
    """The parameters under one `ros__parameters`, and the names above it: namespaces, then the node's."""

    path: tuple[str, ...]
    where: str
    parameters: dict[str, Parameter] = field(default_factory=dict)

    @property
    def node(self) -> str:
        return self.path[-1]

    @property
    def namespace(self) -> tuple[str, ...]:
        """The names before the node's; costmaps stand in a namespace of their own name."""
        names = self.path[:-1]
        return names[:-1] if names and names[-1] == self.node else names


class NodeParameters:
    """The parameters that one node gets, or those of one of its plugins.

    Reading one marks it as read. Where the file does not give it, its default counts.

    Args:
        name: Name of the node.
        parameters: Its parameters by name.
        prefix: The names of a plugin's parameters begin with this and a dot.
        file: The file, for messages on what is missing in it.
    """

    def __init__(self, name: str, parameters: dict[str, Parameter], prefix: str = "", *, file: str) -> None:
        self.name = name
        self._file = file
        self._parameters = parameters
        self._prefix = f"{prefix}." if prefix else ""

    def of_plugin(self, name: str) -> NodeParameters:
        """Return the parameters of one of its plugins, or of a part of a plugin."""
        return NodeParameters(self.name, self._parameters, f"{self._prefix}{name}", file=self._file)

    def has(self, name: str) -> bool:
        """Return whether the file gives a parameter."""
        return f"{self._prefix}{name}" in self._parameters

    def find(self, name: str) -> Parameter | None:
        """Return a parameter, which counts as read, or None if the file does not give it."""
        found = self._parameters.get(f"{self._prefix}{name}")
        if found is not None:
            found.was_read = True
        return found

    def value(self, name: str, default: Plain = None) -> Plain:
        """Return the value of a parameter, of any type."""
        found = self.find(name)
        return default if found is None else found.value

    def number(
        self,
        name: str,
        default: float,
        *,
        least: float = -math.inf,
        above: float = -math.inf,
        most: float = math.inf,
    ) -> float:
        """Return a number.

        Raises:
            InputError: If it is not a number, not finite, or out of range.
        """
        found = self.find(name)
        if found is None:
            return default
        value = finite_number(found.value)
        if value is None:
            raise self._wrong(found, "must be a finite number")
        if not (least <= value <= most and value > above):
            ends = [f"at least {least:g}"] * (least > -math.inf) + [f"above {above:g}"] * (above > -math.inf)
            ends += [f"at most {most:g}"] * (most < math.inf)
            raise self._wrong(found, f"must be {' and '.join(ends)}")
        return value

    def integer(self, name: str, default: int, *, least: int | None = None) -> int:
        """Return an integer.

        Raises:
            InputError: If it is not an integer, or too small.
        """
        found = self.find(name)
        if found is None:
            return default
        value = found.value
        if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int):
            raise self._wrong(found, "must be an integer")
        if least is not None and value < least:
            raise self._wrong(found, f"must be at least {least}")
        return value

    def flag(self, name: str, default: bool) -> bool:
        """Return true or false.

        Raises:
            InputError: If it is neither.
        """
        found = self.find(name)
        if found is None:
            return default
        if not isinstance(found.value, bool):
            raise self._wrong(found, "must be true or false")
        return found.value

    def text(self, name: str, default: str) -> str:
        """Return a text.

        Raises:
            InputError: If it is not text.
        """
        found = self.find(name)
        if found is None:
            return default
        if not isinstance(found.value, str):
            raise self._wrong(found, "must be text")
        return found.value

    def texts(self, name: str, default: tuple[str, ...]) -> tuple[str, ...]:
        """Return a list of texts; a single text is taken for a list, separated by spaces.

        Raises:
            InputError: If it is not a list of texts.
        """
        found = self.find(name)
        if found is None:
            return default
        value = found.value
        if isinstance(value, str):
            return tuple(value.split())
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            raise self._wrong(found, "must be a list of names")
        return tuple(str(item) for item in value)

    def numbers(self, name: str, default: tuple[float, ...], *, lengths: tuple[int, ...]) -> tuple[float, ...]:
        """Return a list of numbers.

        Raises:
            InputError: If it is not such a list, a number is not finite, or there are too few or too many.
        """
        found = self.find(name)
        if found is None:
            return default
        value = found.value
        items: list[Plain] = value if isinstance(value, list) else []
        if len(items) not in lengths or None in (numbers := [finite_number(item) for item in items]):
            sizes = " or ".join(map(str, lengths))
            raise self._wrong(found, f"must be a list of {sizes} finite numbers")
        return tuple(number for number in numbers if number is not None)

    def wrong(self, name: str, rule: str) -> InputError:
        """Return the error that a parameter, or one that is missing, breaks a rule."""
        found = self.find(name)
        if found is None:
            return InputError(f"{self._file}: {self.name}: {self._prefix}{name} {rule}; it is missing")
        return self._wrong(found, rule)

    def _wrong(self, found: Parameter, rule: str) -> InputError:
        return InputError(f"{found.where}: {self.name}: {found.name} {rule}, got {show_value(found.value)}")


class ParameterFile:
    """A ROS 2 parameter file.

    A node's parameters are those of its entry and of entries with wildcards (`/**`); of several, the later one in
    the file counts, as in ROS. Names may be nested or dotted, and stand in namespaces. Keys may be given twice, as ROS
    takes them: parts of one name are joined, and of a parameter the later value counts, but of values of several types
    the last one of the type that ROS looks for first.

    Args:
        path: The file.

    Attributes:
        repeated: Parameters that are given more than once under one name of a node.

    Raises:
        InputError: If it cannot be read, is no YAML, is larger or nested deeper than settings are, has anchors or
            aliases, or has no `ros__parameters`.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(as_path(path, "a parameter file"))
        self._name = str(self.path)
        node = compose(self.path, allow_duplicate_keys=True, wanted="Nav2's parameter file, such as nav2_params.yaml")
        self._entries: list[_Entry] = []
        self.repeated: list[Repeated] = []
        if isinstance(node, yaml.MappingNode):
            self._walk(node, ())
        if not self._entries:
            raise InputError(
                f"{self._name}: this is no ROS 2 parameter file: nothing in it is under {_PARAMETERS}; "
                "give one like Nav2's nav2_params.yaml"
            )

    def node(self, name: str) -> NodeParameters | None:
        """Return the parameters that a node gets, or None if the file has no entry for it alone.

        Raises:
            InputError: If the file has the node in several namespaces.
        """
        own = [entry for entry in self._entries if entry.node == name]
        if not own:
            return None
        spaces = {entry.namespace: entry for entry in own if not set(entry.namespace) & set(_WILD)}
        if len(spaces) > 1:
            found = " and ".join("/" + "/".join(space) for space in sorted(spaces))
            last = list(spaces.values())[-1]
            raise InputError(
                f"{last.where}: {name} is in the file for several robots, {found}; give a file with those of one"
            )
        merged: dict[str, Parameter] = {}
        for entry in self._entries:
            if entry.node == name or entry.node in _WILD:
                merged |= entry.parameters
        return NodeParameters(name, merged, file=self._name)

    def nodes(self) -> list[str]:
        """Return the names of the nodes that have entries, in the order of the file, without wildcards."""
        return list(dict.fromkeys(entry.node for entry in self._entries if entry.node not in _WILD))

    def unread(self) -> Iterator[tuple[str, Parameter]]:
        """Yield the parameters that nothing has asked for, each with the name of its entry's node."""
        for entry in self._entries:
            for parameter in entry.parameters.values():
                if not parameter.was_read:
                    yield "/" + "/".join(entry.path) if entry.node in _WILD else entry.node, parameter

    def _pairs(self, mapping: yaml.MappingNode) -> Iterator[tuple[yaml.ScalarNode, yaml.Node]]:
        """Yield the keys of a mapping, which have to be plain names, and their values."""
        for key, value in mapping.value:
            if not isinstance(key, yaml.ScalarNode):
                raise InputError(f"{place(key, self._name)}: a key must be a plain name, as in `name: value`")
            yield key, value

    def _walk(self, mapping: yaml.MappingNode, path: tuple[str, ...]) -> None:
        for key, value in self._pairs(mapping):
            if key.value == _PARAMETERS:
                self._add(key, value, path)
            elif isinstance(value, yaml.MappingNode):
                self._walk(value, (*path, *(part for part in str(key.value).split("/") if part)))
            elif not _is_empty(value):
                inside = " of ".join(reversed(path)) or "the file"
                raise InputError(
                    f"{place(key, self._name)}: {key.value!r} in {inside} is not under {_PARAMETERS}: "
                    f"write NODE: {{{_PARAMETERS}: {{{key.value}: …}}}}"
                )

    def _add(self, key: yaml.Node, value: yaml.Node, path: tuple[str, ...]) -> None:
        if not path:
            raise InputError(f"{place(key, self._name)}: {_PARAMETERS} stands under the name of a node, or under /**")
        entry = next((one for one in self._entries if one.path == path), None)
        if entry is None:
            entry = _Entry(path, place(key, self._name))
            self._entries.append(entry)
        if isinstance(value, yaml.MappingNode):
            self._flatten(value, "", entry)
        elif not _is_empty(value):
            raise InputError(f"{place(value, self._name)}: {_PARAMETERS} must be a mapping of parameters")

    def _flatten(self, mapping: yaml.MappingNode, prefix: str, entry: _Entry) -> None:
        for key, value in self._pairs(mapping):
            name = f"{prefix}{key.value}"
            if isinstance(value, yaml.MappingNode):
                self._flatten(value, f"{name}.", entry)
                continue
            found = Parameter(name, plain_value(value, self._name), key.start_mark.line + 1, place(key, self._name))
            before = entry.parameters.get(name)
            if before is not None:
                counts = found if _rank(found.value) <= _rank(before.value) else before
                self.repeated.append(Repeated(entry.node, before.line, found.line, counts))
                found = counts
            entry.parameters[name] = found


def _rank(value: Plain) -> int:
    """Return when ROS looks for a value of this type.

    Its parser keeps the last value of each type (`parse_value` of rcl_yaml_param_parser), and a node takes the first
    that there is of bool, integer, double, string, and then arrays (`parameter_value_from` of rclcpp).
    """
    if isinstance(value, list):
        return 4 + (_rank(value[0]) if value else 0)
    return 0 if isinstance(value, bool) else 1 if isinstance(value, int) else 2 if isinstance(value, float) else 3


def _is_empty(node: yaml.Node) -> bool:
    return isinstance(node, yaml.ScalarNode) and node.value in ("", "~", "null") and node.style is None
