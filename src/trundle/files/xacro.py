"""Plain xacro: properties, arguments with defaults and arithmetic in `${…}`. Anything more needs ROS's xacro.

Expressions are parsed with Python's parser and evaluated here, from numbers, names and a few functions: no code of a
file is ever executed.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias, cast

from trundle.errors import InputError
from trundle.files.xml_elements import XmlElement

Value: TypeAlias = float | int | bool | str

_PREFIX = "xacro:"
_PLACE = re.compile(r"\$(\$*)(\{([^{}]*)\}|\(([^()]*)\))")
_LONGEST = 1_000
_DEEPEST = 50
_LARGEST_POWER = 100.0

_BINARY: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "abs": abs, "acos": math.acos, "asin": math.asin, "atan": math.atan, "atan2": math.atan2, "ceil": math.ceil,
    "cos": math.cos, "degrees": math.degrees, "exp": math.exp, "fabs": math.fabs, "float": float, "floor": math.floor,
    "hypot": math.hypot, "int": int, "log": math.log, "max": max, "min": min, "radians": math.radians, "round": round,
    "sin": math.sin, "sqrt": math.sqrt, "tan": math.tan,
}  # fmt: skip
_CONSTANTS: dict[str, Value] = {"pi": math.pi, "tau": math.tau, "e": math.e, "True": True, "False": False}


def expand_xacro(path: Path, root: XmlElement, *, error: type[InputError]) -> None:
    """Expand plain xacro in place; a file without xacro stays as it is.

    Supported: `<xacro:property name= value=>`, `<xacro:arg name= default=>`, `$(arg name)`, `${…}` with numbers, names,
    + - * / // % **, brackets and functions of `math`.

    Args:
        path: For messages.
        root: The document.
        error: Type of the exception.

    Raises:
        InputError: Of the type `error`, if it uses other parts of xacro (macros, includes, conditions), with the
            command that expands it; or if an expression cannot be computed.
    """
    elements = [cast("XmlElement", element) for element in root.iter()]
    marked = any(element.tag.startswith(_PREFIX) for element in elements)
    if not marked and not any("${" in value or "$(" in value for element in elements for value in _texts(element)):
        return
    scope = _Scope(path, error)
    for element in elements:
        if element.tag.startswith(_PREFIX):
            scope.define(element)
    for element in elements:
        for child in [child for child in element if child.tag.startswith(_PREFIX)]:
            element.remove(child)
        for key, value in element.attrib.items():
            element.set(key, scope.fill(element, value))
        if element.text:
            element.text = scope.fill(element, element.text)


def _texts(element: XmlElement) -> list[str]:
    return [*element.attrib.values(), element.text or ""]


@dataclass(slots=True)
class _Scope:
    """The definitions of a file. Properties are evaluated where they are used, so their order does not matter."""

    path: Path
    error: type[InputError]
    properties: dict[str, str] = field(default_factory=dict[str, str])
    arguments: dict[str, str] = field(default_factory=dict[str, str])
    _open: list[str] = field(default_factory=list[str])
    _known: dict[str, Value] = field(default_factory=dict[str, Value])

    def define(self, element: XmlElement) -> None:
        """Add a property or an argument; the last definition wins, as in xacro."""
        name, kind = element.get("name", ""), element.tag.removeprefix(_PREFIX)
        if kind == "property" and name and "value" in element.attrib and not len(element):
            self.properties[name] = element.attrib["value"]
        elif kind == "arg" and name and "default" in element.attrib:
            self.arguments[name] = element.attrib["default"]
        elif kind == "arg" and name:
            raise self.fault(element, f"the argument {name!r} has no default, so its value is unknown")
        else:
            raise self.fault(element, f"<{element.tag}> is more xacro than trundle expands")

    def fault(self, element: XmlElement, what: str) -> InputError:
        """Return an error with the command that expands the file."""
        out = self.path.name.removesuffix(".xacro").removesuffix(".urdf") + "_expanded.urdf"
        call = f"xacro {self.path.name} > {out}"
        return self.error(
            f"{self.path}:{element.line}: {what}. Expand the file first: ros2 run xacro {call}; without ROS: pip "
            f"install xacro, and {call}"
        )

    def fill(self, element: XmlElement, text: str) -> str:
        """Substitute `${…}` and `$(…)` in a text."""
        return _PLACE.sub(lambda match: self._replace(element, match), text)

    def _replace(self, element: XmlElement, match: re.Match[str]) -> str:
        dollars, whole, expression, command = match.group(1, 2, 3, 4)
        if dollars:  # $${ and $$( are xacro's escapes for ${ and $(.
            return dollars[:-1] + "$" + whole
        if command is not None:
            words = command.split()
            if len(words) != 2 or words[0] != "arg":
                raise self.fault(element, f"$({command}) is more xacro than trundle expands")
            return _as_text(self._look_up(element, words[1], self.arguments, "argument"))
        return self._compute(element, expression)

    def _look_up(self, element: XmlElement, name: str, known: dict[str, str], what: str) -> Value:
        if name not in known:
            raise self.fault(element, f"there is no {what} {name!r}")
        mark = f"{what} {name}"
        if mark in self._known:
            return self._known[mark]
        if mark in self._open or len(self._open) > _DEEPEST:
            raise self.error(f"{self.path}:{element.line}: the {what} {name!r} refers to itself")
        self._open.append(mark)
        value = self.fill(element, known[name])
        self._open.pop()
        if len(value) > _LONGEST:
            raise self.error(f"{self.path}:{element.line}: the {what} {name!r} is longer than {_LONGEST} characters")
        self._known[mark] = _as_value(value)
        return self._known[mark]

    def _compute(self, element: XmlElement, expression: str) -> str:
        try:
            if len(expression) > _LONGEST:
                raise ValueError(f"it is longer than {_LONGEST} characters")
            return _as_text(self._visit(element, ast.parse(expression.strip(), mode="eval").body))
        except (ArithmeticError, ValueError, TypeError, SyntaxError, RecursionError, MemoryError) as problem:
            reason = " ".join(str(problem).split()) or type(problem).__name__
            raise self.fault(element, f"cannot compute ${{{expression[:80]}}}: {reason}") from problem

    def _visit(self, element: XmlElement, node: ast.expr) -> Value:
        match node:
            case ast.Constant(value=bool() | int() | float() | str() as value):
                return value
            case ast.Name(id=name):
                if name in self.properties:
                    return self._look_up(element, name, self.properties, "property")
                if name in _CONSTANTS:
                    return _CONSTANTS[name]
                raise self.fault(element, f"there is no property {name!r}")
            case ast.UnaryOp(op=ast.USub() | ast.UAdd() as sign, operand=operand):
                value = _number(self._visit(element, operand))
                return -value if isinstance(sign, ast.USub) else value
            case ast.BinOp(left=left, op=kind, right=right):
                first, second = (_number(self._visit(element, side)) for side in (left, right))
                if isinstance(kind, ast.Pow):
                    return _power(first, second)
                if type(kind) in _BINARY:
                    return _BINARY[type(kind)](first, second)
            case ast.Call(func=ast.Name(id=name), args=given, keywords=[]) if name in _FUNCTIONS:
                return _FUNCTIONS[name](*(_number(self._visit(element, part)) for part in given))
            case ast.Call(func=ast.Attribute(value=ast.Name(id="math"), attr=name), args=given, keywords=[]) if (
                name in _FUNCTIONS
            ):
                return _FUNCTIONS[name](*(_number(self._visit(element, part)) for part in given))
            case ast.Attribute(value=ast.Name(id="math"), attr="pi" | "tau" | "e" as name):
                return _CONSTANTS[name]
            case _:
                pass
        raise ValueError("it may contain only numbers, names, + - * / // % **, brackets and functions of math")


def _number(value: Value) -> float:
    if isinstance(value, str):
        raise TypeError(f"{value!r} is not a number")
    return value


def _power(base: float, exponent: float) -> float:
    # A power of integers can fill the memory.
    if abs(exponent) > _LARGEST_POWER:
        raise ValueError(f"the exponent {exponent:g} is above {_LARGEST_POWER:g}")
    result = float(base) ** exponent
    if isinstance(result, complex):
        raise ValueError("the result is not a real number")
    return result


def _as_value(text: str) -> Value:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return {"true": True, "false": False}.get(text.strip().lower(), text)


def _as_text(value: Value) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else repr(value)
