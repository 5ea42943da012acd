"""List trundle's public names with their signatures: `public_api.py [--write]`; --write keeps the list for the test.

Public is what `__all__` of trundle and of its packages names, and what its public modules define.
"""

from __future__ import annotations

import argparse
import enum
import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

LIST = Path(__file__).parents[1] / "tests" / "api" / "public_api.txt"
MODULES = ("errors", "geometry.solids", "path")
"""Modules beside the packages whose names are public."""

PRIVATE = {"cli", "gym"}
"""The interface of cli is the command line; gym can only be imported with its extra."""


def lines() -> Iterator[str]:
    """One line for each public name, and one for each public member of a class."""
    trundle = importlib.import_module("trundle")
    yield from _lines_of_module(trundle, trundle.__all__)
    packages = {found.name for found in pkgutil.iter_modules(trundle.__path__) if found.ispkg}
    for name in sorted({name for name in packages if not name.startswith("_")} - PRIVATE | set(MODULES)):
        module = importlib.import_module(f"trundle.{name}")
        yield from _lines_of_module(module, getattr(module, "__all__", None) or _defined(module))


def _defined(module: ModuleType) -> list[str]:
    if hasattr(module, "__path__"):  # a package without __all__ offers its modules, not names
        return []
    return [
        name
        for name, value in vars(module).items()
        if not name.startswith("_") and getattr(value, "__module__", None) == module.__name__
    ]


def _lines_of_module(module: ModuleType, names: list[str]) -> Iterator[str]:
    for name in sorted(names):
        value = getattr(module, name)
        full = f"{module.__name__}.{name}"
        home = getattr(value, "__module__", "")
        if module.__name__ == "trundle" and home.startswith("trundle.") and callable(value):
            yield full  # its signature stands with the package that it comes from
        elif inspect.isclass(value):
            yield from _lines_of_class(full, value)
        elif callable(value) and not hasattr(value, "__args__"):
            yield f"{full}{_signature(value)}"
        else:
            yield f"{full}: {type(value).__name__}"


def _lines_of_class(full: str, cls: type) -> Iterator[str]:
    if issubclass(cls, enum.Enum):
        yield f"{full}({', '.join(member.name for member in cls)})"
        return
    yield f"{full}{_signature(cls)}"
    members: dict[str, Any] = {}
    for base in reversed(cls.__mro__):
        if base.__module__.startswith("trundle"):
            members.update(vars(base))
    for name, member in sorted(members.items()):
        if name.startswith("_") or name == "model_config":
            continue
        if isinstance(member, property):
            yield f"{full}.{name}: property"
        elif isinstance(member, classmethod | staticmethod):
            yield f"{full}.{name}{_signature(member.__func__)}"
        elif inspect.isfunction(member):
            yield f"{full}.{name}{_signature(member)}"


def _signature(value: Any) -> str:
    """The parameters with what they must be, where that is written as text; defaults that are no plain values as …."""
    try:
        signature = inspect.signature(value)
    except (TypeError, ValueError):
        return "(…)"
    shown = []
    for parameter in signature.parameters.values():
        text = isinstance(parameter.annotation, str)
        default = parameter.default
        if default is not inspect.Parameter.empty and not isinstance(default, str | int | float | bool | tuple | None):
            default = _Elsewhere()
        shown.append(
            parameter.replace(annotation=_Text(parameter.annotation) if text else parameter.empty, default=default)
        )
    returned = signature.return_annotation
    arrow = f" -> {returned}" if isinstance(returned, str) and not inspect.isclass(value) else ""
    return str(inspect.Signature(shown)) + arrow


class _Text(type):
    """An annotation that is shown as it is written."""

    def __new__(cls, text: str) -> _Text:
        return super().__new__(cls, text, (), {"__module__": "builtins"})

    def __init__(cls, text: str) -> None:
        super().__init__(text, (), {})
        cls.__qualname__ = text


class _Elsewhere:
    def __repr__(self) -> str:
        return "…"


def main() -> None:
    """Print the list, or keep it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help=f"write {LIST.name} in place of printing")
    text = "\n".join(lines()) + "\n"
    if parser.parse_args().write:
        LIST.write_text(text)
    else:
        print(text, end="")


if __name__ == "__main__":
    main()
