"""The signatures of Isaac Sim that trundle calls, from signatures.yaml, and a comparison with a running one."""

from __future__ import annotations

import ast
import importlib
import inspect
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import resources
from typing import Literal, TypeAlias

import yaml

Generation: TypeAlias = Literal[5, 6]
"""Generation of the API: 5 is Isaac Sim 5.1, 6 is 6.0 and later."""


@dataclass(frozen=True, slots=True)
class ApiModule:
    """One module of Isaac Sim, as far as trundle uses it.

    Attributes:
        name: Dotted name.
        generations: Generations that have it.
        source: Source of its signatures.
        imports: The import line that its text needs; may be empty.
        text: Text of a Python stub.
    """

    name: str
    generations: tuple[Generation, ...]
    source: str
    imports: str
    text: str


def read_signatures() -> list[ApiModule]:
    """Read all modules in the file's order, in which imported modules come first."""
    text = (resources.files("trundle.sim.isaac") / "signatures.yaml").read_text(encoding="utf-8")
    return [
        ApiModule(
            name=entry["name"],
            generations=tuple(entry["generations"]),
            source=entry["source"],
            imports=entry.get("imports", ""),
            text=entry["text"],
        )
        for entry in yaml.safe_load(text)["modules"]
    ]


def differences(generation: Generation) -> list[str]:
    """Compare the Isaac Sim that is running in this process with the signatures that trundle was written for.

    An additional parameter with a default is not a difference.

    Returns:
        One line for each module, class, function or parameter that is missing; empty if there is no difference.
    """
    found: list[str] = []
    for module in read_signatures():
        if generation in module.generations:
            found += _module_differences(module)
    return found


def _module_differences(module: ApiModule) -> Iterator[str]:
    try:
        real = _find_module(module.name)
    except ImportError as error:
        yield f"{module.name} cannot be imported: {error}"
        return
    # The signatures of Omniverse's own modules come from example calls, which do not show parameter names.
    look_inside = module.name.partition(".")[0] == "isaacsim"
    for node in ast.parse(module.text).body:
        if isinstance(node, ast.FunctionDef):
            yield from _function_differences(real, node, module.name, look_inside=look_inside)
        elif isinstance(node, ast.ClassDef):
            owner = getattr(real, node.name, None)
            if owner is None:
                # Objects that are only returned by functions, such as IPhysxSimulation, need not have a public class.
                continue
            for method in node.body:
                if isinstance(method, ast.FunctionDef):
                    yield from _function_differences(
                        owner, method, f"{module.name}.{node.name}", look_inside=look_inside
                    )


def _find_module(name: str) -> object:
    """Import a module, or get it as an attribute of its package, as for some of Omniverse's modules."""
    try:
        return importlib.import_module(name)
    except ImportError:
        parent, _, attribute = name.rpartition(".")
        found = getattr(importlib.import_module(parent), attribute, None) if parent else None
        if found is None:
            raise
        return found


def _function_differences(owner: object, node: ast.FunctionDef, where: str, *, look_inside: bool) -> Iterator[str]:
    name = f"{where}.{node.name}"
    real = inspect.getattr_static(owner, node.name, None)
    if real is None:
        yield f"{name} is missing"
        return
    if not look_inside:
        return
    try:
        has = inspect.signature(getattr(owner, node.name)).parameters
    except (TypeError, ValueError):
        return  # a property, or compiled: its parameters are unknown
    if any(parameter.kind is inspect.Parameter.VAR_KEYWORD for parameter in has.values()):
        return
    wants = [
        argument.arg for argument in [*node.args.args, *node.args.kwonlyargs] if argument.arg not in ("self", "cls")
    ]
    for argument in wants:
        if argument not in has:
            yield f"{name} has no parameter {argument}"
    for parameter in has.values():
        required = (
            parameter.default is inspect.Parameter.empty and parameter.kind is not inspect.Parameter.VAR_POSITIONAL
        )
        if required and parameter.name not in (*wants, "self"):
            yield f"{name} requires {parameter.name}, which trundle does not pass"
