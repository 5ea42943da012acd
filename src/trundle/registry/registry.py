"""Plug-ins: from a name, a class, a function or an object to what does the work, for every kind in the same way."""

from __future__ import annotations

import functools
import importlib
import importlib.metadata
import inspect
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Generic, TypeVar, cast

from trundle.errors import InputError, UnknownNameError
from trundle.fault import find_fault, place_of
from trundle.registry.contract import Contract, PluginFunction, by_position, name_of, parameters_of
from trundle.registry.importing import import_named, is_model_file, is_plugin_file
from trundle.values import check_kind

_Made = TypeVar("_Made")

_NO_ARGUMENTS: Mapping[str, object] = {}
_SAME_AS_MAP = "grid"
_OFFERED = ("robot", "map", _SAME_AS_MAP)
"""Names of parameters that stand for the robot and its map."""


class Registry(Generic[_Made]):
    """The plug-ins of one kind: those that have a name, and how one is made of what a user gives.

    Args:
        kind: What a name stands for, in messages ("planner").
        group: Entry-point group where other packages register theirs ("trundle.planners").
        builtin: The built-in names, each with its `"module:attribute"`.
        contract: What such a plug-in must have; None for kinds that are only made by name.
        model: The `"module:class"` that is made with `file` where the name is the file of a network; None where such
            a file is nothing of this kind.
    """

    def __init__(
        self,
        kind: str,
        group: str,
        builtin: Mapping[str, str],
        *,
        contract: Contract | None = None,
        model: str | None = None,
    ) -> None:
        self.kind = kind
        self._group = group
        self._builtin = dict(builtin)
        self._contract = contract or Contract({})
        self._model = model

    def names(self) -> list[str]:
        """List every name, built in or from an installed package, sorted."""
        return sorted({*self._builtin, *(point.name for point in importlib.metadata.entry_points(group=self._group))})

    def check(self, name: str) -> None:
        """Refuse a name that is not known; only `"module:name"` and `"file.py:name"` are imported for that.

        Raises:
            UnknownNameError: As `load`.
            InputError: As `load`.
        """
        if self._is_model(name):
            return
        if ":" in name and self._contract.methods:
            self.load(name)
        elif name not in self._builtin and name not in self.names():
            raise UnknownNameError(self.kind, name, self.names())

    def module_of(self, name: str) -> str | None:
        """Return the module behind a built-in name or `"module:name"`; None for any other name and for a file."""
        known = self._model if self._is_model(name) else self._builtin.get(name, name if ":" in name else "")
        module = (known or "").partition(":")[0]
        return None if is_plugin_file(name) else module or None

    def load(self, name: str) -> object:
        """Import what a name stands for: a class, a function or an object.

        Args:
            name: A built-in name, one of an installed package, `"module:name"`, `"file.py:name"`, or the file of a
                network, `policy.onnx`, for kinds that have these.

        Raises:
            UnknownNameError: If there is no such name; it lists the choices and the nearest one.
            InputError: If the name is not a string, or it cannot be imported or is nothing of this kind.
        """
        given = cast("object", name)
        if not isinstance(given, str):  # asked first, as names() reads the entry points of every installed package
            check_kind(name, str, f"the name of a {self.kind}", f"there are: {', '.join(self.names())}")
        if name in self._builtin:
            return _import_builtin(self._builtin[name])
        if self._model is not None and self._is_model(name):
            return functools.partial(cast("Callable[..., object]", _import_builtin(self._model)), file=name)
        if ":" in name and self._contract.methods:
            return self._import(name)
        for point in importlib.metadata.entry_points(group=self._group, name=name):
            try:
                return point.load()
            except (ImportError, AttributeError) as error:
                raise InputError(f"{self.kind} {name!r} ({point.value}) cannot be imported: {error}") from error
        raise UnknownNameError(self.kind, name, self.names())

    def make(self, name: str, /, *arguments: object, **options: Any) -> _Made:
        """Create an object by name.

        Raises:
            UnknownNameError: If there is no such name.
            InputError: If it does not accept these options.
        """
        maker = cast("Callable[..., _Made]", self.load(name))
        return self._call(f"{self.kind} {name!r}", maker, arguments, options)

    def resolve(
        self, given: object, offered: Mapping[str, object] = _NO_ARGUMENTS, options: Mapping[str, Any] = _NO_ARGUMENTS
    ) -> _Made | PluginFunction:
        """Make what a user gives for a plug-in into one: the same for every kind, and wherever one can be given.

        - An object that has the methods of its kind is taken as it is.
        - A class is made: with those of `offered` that its parameters name, and with the options.
        - A function that takes the arguments of its kind by position does the work itself. It may name what is
          offered, the options and the keywords of its kind as further parameters.
        - Any other function makes one, like a class; with parameters of other names it gets what is offered in order.
        - A name stands for one of these: a built-in or registered name, `"module:name"`, or `"file.py:name"`.

        Args:
            given: Any of these.
            offered: What a class may be made with, by parameter name.
            options: Its options.

        Raises:
            UnknownNameError: If there is no such name.
            InputError: If it cannot be imported or is nothing of this kind, a parameter is not filled, there is no such
                option, or it takes a keyword of earlier versions; the message names it.
        """
        if not isinstance(given, str):
            return self._resolve(f"{self.kind} {_title(given)}", given, offered, options)
        label, found = f"{self.kind} {given!r}", self.load(given)
        if ":" in given and inspect.isfunction(found):  # never one that makes something: see `_import`
            return self._bind(label, found, offered, options)
        return self._resolve(label, found, offered, options)

    def _is_model(self, name: str) -> bool:
        return self._model is not None and name not in self._builtin and is_model_file(name)

    # Parts of resolving ---------------------------------------------------------------------------------------------

    def _resolve(
        self, label: str, found: object, offered: Mapping[str, object], options: Mapping[str, Any]
    ) -> _Made | PluginFunction:
        if isinstance(found, type):
            return self._accept(label, self._fill(label, found, offered, options))
        if not self._contract.lacks(found):
            if options:
                raise InputError(
                    f"{label} is an object already, and takes no option {next(iter(options))!r}: give its class or its "
                    "name with options"
                )
            return self._accept(label, found)
        if not callable(found):
            raise self._refuse(label, found)
        if self._does_the_work(found, {**offered, **options}):
            return self._bind(label, found, offered, options)
        return self._accept(label, self._fill(label, found, offered, options))

    def _accept(self, label: str, made: object) -> _Made | PluginFunction:
        """Accept what a class or a function has made."""
        if not isinstance(made, type) and not self._contract.lacks(made):
            for name in self._contract.methods:
                self._check_keywords(label, getattr(made, name))
            return cast("_Made", made)
        if callable(made) and self._does_the_work(made, {}):
            return self._bind(label, made, {}, {})
        raise self._refuse(label, made, f" ({_title(made)} was made)")

    def _refuse(self, label: str, found: object, got: str = "") -> InputError:
        """Make the error that says what a plug-in of this kind must be."""
        contract = self._contract
        missing = contract.lacks(found)
        has_some = len(missing) < len(contract.methods) + len(contract.attributes)
        what = f"has no {' and no '.join(missing)}" if has_some else f"is no {self.kind}"
        call = f", or a function ({', '.join(contract.function)})" if contract.function else ""
        article = "An" if self.kind[0] in "aeiou" else "A"
        return InputError(
            f"{label} {what}{got}. {article} {self.kind} is a name, an object with {contract.describe()}, a class of "
            f"such objects{call}"
        )

    def _check_keywords(self, label: str, function: Callable[..., object]) -> None:
        """Refuse a function, or a method, that takes a keyword of earlier versions."""
        former = self._contract.former
        for one in (parameters_of(function) or []) if former else []:
            if one.name in former:
                raise InputError(
                    f"{label}{_place_of(function)} takes {one.name!r}, which it does not get any more: "
                    f"{former[one.name]}"
                )

    def _does_the_work(self, function: Callable[..., object], known: Iterable[str]) -> bool:
        """Return whether a function takes the arguments of this kind by position, and is not one that makes an object.

        `known` are the names of what else it may need.
        """
        count, known = len(self._contract.function), {*known, *self._contract.keywords, *self._contract.former}
        parameters = parameters_of(function)
        if not count or parameters is None:
            return False
        places = by_position(parameters)
        needed = [one.name for one in places if one.default is one.empty]
        if needed and all(name in known for name in needed):
            return False
        takes_any = any(one.kind is one.VAR_POSITIONAL for one in parameters)
        return (len(places) >= count or takes_any) and all(name in known for name in needed[count:])

    def _bind(
        self, label: str, function: Callable[..., Any], offered: Mapping[str, object], options: Mapping[str, Any]
    ) -> PluginFunction:
        """Make a plug-in of a function, with the keywords that it gets in every call."""
        self._check_keywords(label, function)
        parameters = parameters_of(function) or []
        places = by_position(parameters)[: len(self._contract.function)]
        rest = [one for one in parameters if one not in places]
        takes_all = any(one.kind is one.VAR_KEYWORD for one in rest)
        names = [one.name for one in rest if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY)]
        in_call = self._contract.keywords
        if not takes_all:
            self._check_options(label, options, [name for name in names if name not in {*_OFFERED, *in_call}])
        keywords = {**{name: offered[name] for name in names if name in offered}, **options}
        taken = frozenset(in_call) if takes_all else frozenset(names).intersection(in_call)
        for one in rest:
            if one.default is one.empty and one.name in names and one.name not in {*keywords, *taken}:
                raise self._unfilled(label, function, one.name, [*offered, *in_call])
        return PluginFunction(name_of(function), function, keywords, taken)

    def _fill(
        self, label: str, maker: Callable[..., Any], offered: Mapping[str, object], options: Mapping[str, Any]
    ) -> object:
        """Call a class, or a function that makes a plug-in, with what its parameters name."""
        parameters = parameters_of(maker)
        if parameters is None:
            return self._call(label, maker, (), options)
        places = by_position(parameters)
        names = [one.name for one in (*places, *(one for one in parameters if one.kind is one.KEYWORD_ONLY))]
        if not any(one.kind is one.VAR_KEYWORD for one in parameters):
            self._check_options(label, options, [name for name in names if name not in _OFFERED])
        values = {**{name: offered[name] for name in names if name in offered}, **options}
        needed = [one.name for one in parameters if one.default is one.empty and one.name in names]
        unfilled = [name for name in needed if name not in values]
        if not isinstance(maker, type) and not {*unfilled} & {*_OFFERED}:
            used = [id(value) for value in values.values()]
            ordered = [one for name, one in offered.items() if name != _SAME_AS_MAP and id(one) not in used]
            values |= dict(zip(unfilled, ordered, strict=False))
            unfilled = unfilled[len(ordered) :]
        if unfilled:
            raise self._unfilled(label, maker, unfilled[0], offered)
        ahead = [values.pop(one.name) for one in places if one.kind is one.POSITIONAL_ONLY and one.name in values]
        return self._call(label, maker, ahead, values)

    def _unfilled(self, label: str, maker: object, name: str, offered: Iterable[str]) -> InputError:
        where = f"{label}{_place_of(maker)} needs {name!r}"
        if name in _OFFERED:
            return InputError(f"{where}, and there is none here: give one, or the parameter a default")
        filled = ", ".join(offered)
        given = f"parameters named {filled} are filled in, and " if filled else ""
        return InputError(
            f"{where}, which nothing gives: {given}everything else is an option. Give an option {name!r}, or the "
            "parameter a default"
        )

    def _check_options(self, label: str, options: Mapping[str, Any], known: list[str]) -> None:
        for name in options:
            if name not in known:
                raise InputError(f"{label} has no option {name!r}; it has: {', '.join(known) or 'none'}")

    def _call(
        self, label: str, maker: Callable[..., _Made], arguments: Iterable[object], options: Mapping[str, Any]
    ) -> _Made:
        try:
            return maker(*arguments, **options)
        except TypeError as error:
            foreign = re.search(r"unexpected keyword argument '(\w+)'", str(error))
            if foreign is None and find_fault(error).is_plugin:  # its constructor was called, and raised
                raise
            what = f" has no option {foreign[1]!r}" if foreign else f": {error}"
            raise InputError(f"{label}{what}") from error

    def _import(self, name: str) -> object:
        """Import `"module:name"` or `"file.py:name"`.

        A name may come from somebody's file. So what it stands for must be of this kind: a class or an object with its
        methods, or a function written in Python that takes its arguments by position. Nothing else is called.
        """
        found = import_named(self.kind, name, files=self._contract.files)
        count = len(self._contract.function)
        works = count and inspect.isfunction(found) and len(by_position(parameters_of(found) or [])) >= count
        if self._contract.lacks(found) and not works:
            raise self._refuse(f"{self.kind} {name!r}", found)
        return found


def _import_builtin(place: str) -> object:
    module, _, attribute = place.partition(":")
    return getattr(importlib.import_module(module), attribute)


def offered_arguments(robot: object, grid: object) -> dict[str, object]:
    """Return what a class may be made with, by parameter name: robot and map, where they are known."""
    known = {"robot": robot, "map": grid, _SAME_AS_MAP: grid}
    return {name: value for name, value in known.items() if value is not None}


def _title(found: object) -> str:
    """Describe what was given, for a message."""
    if isinstance(found, type):
        return f"class {found.__qualname__!r}"
    if inspect.isroutine(found):
        return f"function {found.__qualname__!r}"
    return repr(found) if found is None or isinstance(found, int | float) else f"{type(found).__name__!r}"


def _place_of(found: object) -> str:
    """Return the file and line of a class or a function, for a message; empty where Python does not know them."""
    file, line = place_of(found)
    return f" ({file}:{line})" if line else ""
