"""Plug-ins that are named by their module, or by a file of Python."""

from __future__ import annotations

import difflib
import hashlib
import importlib
import importlib.util
import sys
import traceback
from pathlib import Path
from types import ModuleType
from typing import cast

from trundle.errors import InputError

PYTHON = "python:"
"""What the name of something in Python begins with that a file cannot name: an object, or a file of Python."""

_MODULE_PREFIX = "trundle_plugin_file_"


def is_plugin_file(name: str) -> bool:
    """Return whether a name is `"file.py:name"`."""
    place, _, attribute = name.rpartition(":")
    return place.endswith(".py") and (not attribute or attribute.isidentifier())


def is_model_file(name: str) -> bool:
    """Return whether a name is the file of a network, `policy.onnx`, which is computed and not run."""
    return name.lower().endswith(".onnx")


def without_files(value: object) -> object:
    """Return plain values of a file that others may have written, so that no name in them runs a file of Python.

    What such a name stands for can then only be given again: see `Registry.load`.
    """
    if isinstance(value, dict):
        return {key: without_files(one) for key, one in cast("dict[str, object]", value).items()}
    if isinstance(value, list):
        return [without_files(one) for one in cast("list[object]", value)]
    runs = isinstance(value, str) and is_plugin_file(value) and not value.startswith(PYTHON)
    return f"{PYTHON}{value}" if runs else value


def import_named(kind: str, name: str, *, files: bool) -> object:
    """Import what `"module:name"` or `"file.py:name"` stands for, without calling anything of it.

    Args:
        kind: What the name stands for, in messages ("planner").
        name: The name.
        files: Whether a file may be named.

    Raises:
        InputError: If it cannot be imported, or a file is named that may not be.
    """
    label = f"{kind} {name!r}"
    if name.startswith(PYTHON):
        raise _python_only(kind, name.removeprefix(PYTHON))
    place, _, attribute = name.rpartition(":")
    if is_plugin_file(name) and not files:
        raise InputError(f"{label}: a {kind} is not named by a file; write module:name, or give the class")
    if not place or not attribute:
        raise InputError(f"{label}: write module:name or file.py:name, for example my_plugin.py:MyClass")
    try:
        module = _load_file(Path(place)) if is_plugin_file(name) else importlib.import_module(place)
    except ModuleNotFoundError as error:
        if error.name is None or not (place == error.name or place.startswith(f"{error.name}.")):
            raise InputError(f"{label} cannot be imported: {_describe(error)}") from error
        file = f"{place.replace('.', '/')}.py"
        hint = f"write {file}:{attribute}" if Path(file).is_file() else "install its package, or give its file"
        raise InputError(f"{label} cannot be imported: there is no module {error.name!r}; {hint}") from error
    except Exception as error:
        raise InputError(f"{label} cannot be imported: {_describe(error)}") from error
    found = getattr(module, attribute, None)
    if found is None:
        own = [key for key, value in vars(module).items() if getattr(value, "__module__", None) == module.__name__]
        nearest = difflib.get_close_matches(attribute, own, n=1)
        guess = f" Did you mean {nearest[0]!r}?" if nearest else ""
        has = ", ".join(own) or "nothing"
        raise InputError(f"{label} cannot be imported: {place} has no {attribute!r}.{guess} It has: {has}")
    return found


def _python_only(kind: str, name: str) -> InputError:
    """Make the error about a name that a file had, and that only Python or the command line can give."""
    if is_plugin_file(name):
        return InputError(
            f"{kind} {name!r} is a file of Python, which another file cannot name: give it as an option of the command "
            "line, or put its folder on PYTHONPATH and write module:name"
        )
    return InputError(f"{kind} {name!r} was a Python object, which a file cannot hold: give it again, in Python")


def _load_file(path: Path) -> ModuleType:
    """Import a file of Python, once; its folder is searched for what it imports, as if it were run."""
    file = path.resolve()
    name = f"{_MODULE_PREFIX}{hashlib.sha256(str(file).encode()).hexdigest()[:12]}_{file.stem}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None or not file.is_file():
        raise FileNotFoundError(f"there is no file {path}; correct its name")
    module = importlib.util.module_from_spec(spec)
    if str(file.parent) not in sys.path:
        sys.path.append(str(file.parent))
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def _describe(error: Exception) -> str:
    """Describe an error while a plug-in is imported, and where it occurred."""
    if isinstance(error, FileNotFoundError) and error.errno is None:
        return str(error)
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if "importlib" not in frame.filename]
    at = f" ({frames[-1].filename}:{frames[-1].lineno})" if frames[2:] and not isinstance(error, SyntaxError) else ""
    return f"{type(error).__name__}: {error}{at}"
