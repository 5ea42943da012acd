"""What every node of ROS 2 has: its reports on /rosout, and parameters that can be listed and read."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

from trundle.errors import TrundleError
from trundle.messages import MessageMaker
from trundle.messages.qos import Qos
from trundle.navigation.behaviors.behavior import snake_case
from trundle.ros2.wire import Wire

ROSOUT = Qos(1000, durability="transient_local")
"""QoS of /rosout, as rcl has it."""

_LOG = "rcl_interfaces/msg/Log"
_WARN = 30
"""WARN of rcl_interfaces/msg/Log."""

Value: TypeAlias = bool | int | float | str

_TYPES: tuple[tuple[type, int, str], ...] = (
    (bool, 1, "bool_value"),
    (int, 2, "integer_value"),
    (float, 3, "double_value"),
    (str, 4, "string_value"),
)
"""Number and field of each type in rcl_interfaces/msg/ParameterValue; a bool is an int, and comes first."""

_WHY = "the parameters of trundle are set on its command line: start it again with another option"


class Rosout:
    """Publishes what is reported to the user on /rosout as well.

    Args:
        wire: The network.
    """

    def __init__(self, wire: Wire) -> None:
        self._wire, self._make = wire, MessageMaker(wire.types.codec)
        self._outlet = wire.outlet("/rosout", _LOG, ROSOUT)
        wire.warnings.listeners.append(self._write)

    def _write(self, text: str) -> None:
        wire = self._wire
        if wire.is_closing:
            return
        name = wire.transport.node.lstrip("/").replace("/", ".")
        stamp = self._make.stamp(wire.now())
        try:
            self._outlet.write(wire.types.make(_LOG, stamp=stamp, level=_WARN, name=name, msg=text))
        except TrundleError:  # a report is not worth an error
            return


class ParameterServices:
    """Serves the parameters of the node, which can be listed, described and read, and not set.

    Args:
        wire: The network.
        values: Their names and values.
    """

    def __init__(self, wire: Wire, values: Mapping[str, Value]) -> None:
        self._wire, self._values = wire, dict(sorted(values.items()))

    def open(self) -> None:
        """Offer the services, where the other side has their types."""
        wire = self._wire
        for name, handler in (
            ("ListParameters", self._list),
            ("GetParameters", self._get),
            ("GetParameterTypes", self._get_types),
            ("DescribeParameters", self._describe),
            ("SetParameters", self._set),
            ("SetParametersAtomically", self._set_at_once),
        ):
            kind = f"rcl_interfaces/srv/{name}"
            if wire.transport.has_services and wire.types.knows(f"{kind}_Request"):
                wire.serve(f"~/{snake_case(name)}", kind, handler)

    def _list(self, request: Any) -> Any:
        prefixes = [str(one) for one in request.prefixes]
        names = [
            name
            for name in self._values
            if not prefixes or any(name == prefix or name.startswith(f"{prefix}.") for prefix in prefixes)
        ]
        result = self._make("msg/ListParametersResult", names=names, prefixes=[])
        return self._make("srv/ListParameters_Response", result=result)

    def _get(self, request: Any) -> Any:
        return self._make("srv/GetParameters_Response", values=[self._value(str(name)) for name in request.names])

    def _get_types(self, request: Any) -> Any:
        types = [self._type(str(name)) for name in request.names]
        return self._make("srv/GetParameterTypes_Response", types=types)

    def _describe(self, request: Any) -> Any:
        described = [
            self._make(
                "msg/ParameterDescriptor", name=str(name), type=self._type(str(name)), description=_WHY, read_only=True
            )
            for name in request.names
        ]
        return self._make("srv/DescribeParameters_Response", descriptors=described)

    def _set(self, request: Any) -> Any:
        refused = [self._refusal() for _ in request.parameters]
        return self._make("srv/SetParameters_Response", results=refused)

    def _set_at_once(self, request: Any) -> Any:
        return self._make("srv/SetParametersAtomically_Response", result=self._refusal())

    def _refusal(self) -> Any:
        return self._make("msg/SetParametersResult", successful=False, reason=_WHY)

    def _value(self, name: str) -> Any:
        value = self._values.get(name)
        for kind, number, field in _TYPES:
            if isinstance(value, kind):
                return self._make("msg/ParameterValue", type=number, **{field: value})
        return self._make("msg/ParameterValue")

    def _type(self, name: str) -> int:
        value = self._values.get(name)
        return next((number for kind, number, _ in _TYPES if isinstance(value, kind)), 0)

    def _make(self, part: str, /, **fields: Any) -> Any:
        return self._wire.types.make(f"rcl_interfaces/{part}", **fields)
