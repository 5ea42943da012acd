"""`Notes`: what is written down while parameters are translated."""

from __future__ import annotations

from trundle.files.yaml_config import Plain
from trundle.nav2.parameters import NodeParameters, Parameter
from trundle.nav2.remarks import Remark


class Notes:
    """Remarks on parameters, in the order in which they were found."""

    def __init__(self) -> None:
        self.remarks: list[Remark] = []

    def changed(self, node: NodeParameters, name: str, text: str) -> None:
        """A parameter of the file means something else here; nothing is noted where the file does not give it."""
        found = node.find(name)
        if found is not None:
            self.remarks.append(Remark("changed", node.name, found.name, found.value, text, found.line))

    def default(self, node: NodeParameters, name: str, value: Plain, text: str) -> None:
        """As `changed`, also where the file does not give it and Nav2's default counts."""
        found = node.find(name)
        if found is not None:
            self.changed(node, name, text)
        else:
            self.remarks.append(Remark("changed", node.name, name, value, f"(Nav2's default) {text}"))

    def ignored(self, node: NodeParameters, name: str, text: str) -> None:
        """A parameter of the file has no counterpart, for this reason."""
        found = node.find(name)
        if found is not None:
            self._ignore(node.name, found, text)

    def _ignore(self, node: str, found: Parameter, text: str) -> None:
        self.remarks.append(Remark("no counterpart", node, found.name, found.value, text, found.line))

    def ignore_parameter(self, node: str, found: Parameter, text: str) -> None:
        """As `ignored`, of a parameter that was not read."""
        self._ignore(node, found, text)
