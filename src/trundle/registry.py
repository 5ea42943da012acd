"""Names that become classes: a small table of `"module:Class"` strings plus package entry points."""

from __future__ import annotations

import importlib
import importlib.metadata
import inspect
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Generic, TypeVar, cast

from trundle.errors import InputError, UnknownNameError
from trundle.fault import find_fault
from trundle.values import check_kind

_Made = TypeVar("_Made")


class Registry(Generic[_Made]):
    """The named implementations of one interface, each a class or function that creates it.

    Args:
        kind: What a name stands for, in messages ("planner").
        group: Entry-point group where other packages register theirs ("trundle.planners").
        builtin: The built-in names, each with its `"module:attribute"`.
        removed: Names from earlier versions, each with its replacement ("was removed; use …").
    """

    def __init__(
        self, kind: str, group: str, builtin: Mapping[str, str], removed: Mapping[str, str] | None = None
    ) -> None:
        self._kind = kind
        self._group = group
        self._builtin = dict(builtin)
        self._removed = dict(removed or {})

    def names(self) -> list[str]:
        """Every name, built in or from an installed package, sorted."""
        return sorted({*self._builtin, *(point.name for point in importlib.metadata.entry_points(group=self._group))})

    def removal(self, name: str) -> str | None:
        """Hint for a name that was removed ("was removed; use …"); None for any other name."""
        hint = self._removed.get(name)  # first, as names() asks for the entry points of every installed package
        return None if hint is None or name in self.names() else hint

    def check(self, name: str) -> None:
        """Refuse a name that is not known, without importing what it stands for.

        Raises:
            UnknownNameError: As `load`.
        """
        if name not in self._builtin and name not in self.names():
            raise UnknownNameError(self._kind, name, self.names(), hint=self._removed.get(name))

    def module_of(self, name: str) -> str | None:
        """The module behind a built-in name or `"module:Class"`; None for any other name."""
        return self._builtin.get(name, name if ":" in name else "").partition(":")[0] or None

    def load(self, name: str) -> object:
        """Import what a name stands for.

        Raises:
            UnknownNameError: If there is no such name; it lists the choices and the nearest one, or the replacement
                of a name that was removed.
            InputError: If the name is not a string, or another package's entry point cannot be imported.
        """
        given = cast("object", name)
        if not isinstance(given, str):  # asked first, as names() reads the entry points of every installed package
            check_kind(name, str, f"the name of a {self._kind}", f"there are: {', '.join(self.names())}")
        if name in self._builtin:
            module, _, attribute = self._builtin[name].partition(":")
            return getattr(importlib.import_module(module), attribute)
        for point in importlib.metadata.entry_points(group=self._group, name=name):
            try:
                return point.load()
            except (ImportError, AttributeError) as error:
                raise InputError(f"{self._kind} {name!r} ({point.value}) cannot be imported: {error}") from error
        raise UnknownNameError(self._kind, name, self.names(), hint=self._removed.get(name))

    def make(self, name: str, /, *arguments: object, **options: Any) -> _Made:
        """Create an object by name.

        Raises:
            UnknownNameError: If there is no such name.
            InputError: If it does not accept these options.
        """
        return self._call(name, cast("Callable[..., _Made]", self.load(name)), *arguments, **options)

    def load_class(self, name: str, method: str) -> Callable[..., _Made]:
        """Import a class by `"module:Class"`, for one that no package has registered.

        Nothing but a class with the given method is taken, so that a name in somebody's file calls no other function.

        Raises:
            InputError: If there is no such module, or no such class in it, or the class has no such method.
        """
        module, _, attribute = name.partition(":")
        try:
            found = getattr(importlib.import_module(module), attribute)
        except (ImportError, AttributeError, ValueError) as error:
            raise InputError(f"{self._kind} {name!r} cannot be imported: {error}") from error
        if not isinstance(found, type) or not callable(getattr(found, method, None)):
            raise InputError(f"{self._kind} {name!r} is not a class with {method}(…), as a {self._kind} has")
        return cast("Callable[..., _Made]", found)

    def _call(self, name: str, maker: Callable[..., _Made], /, *arguments: object, **options: Any) -> _Made:
        try:
            return maker(*arguments, **options)
        except TypeError as error:
            foreign = re.search(r"unexpected keyword argument '(\w+)'", str(error))
            if foreign is None and find_fault(error).is_plugin:  # its constructor was called, and raised
                raise
            what = f" has no option {foreign[1]!r}" if foreign else f": {error}"
            raise InputError(f"{self._kind} {name!r}{what}") from error

    def take(self, given: str | _Made, method: str, /, *arguments: object, **options: Any) -> _Made:
        """Create an object by name or `"module:Class"`, or take an existing one that has the given method.

        Raises:
            UnknownNameError: If there is no such name.
            InputError: If it does not accept these options or has no such method, or if options come with an object.
        """
        if isinstance(given, str) and ":" in given:
            return self._call(given, self.load_class(given, method), *arguments, **options)
        if isinstance(given, str):
            return self.make(given, *arguments, **options)
        if isinstance(given, type) or not callable(getattr(given, method, None)):
            raise InputError(f"a {self._kind} is given by its name or as an object with {method}(…), got {given!r}")
        if options:
            raise InputError(f"{', '.join(options)}: options need a {self._kind} given by name, not an object")
        return given


def keywords_taken(function: Callable[..., object], names: Iterable[str]) -> frozenset[str]:
    """The subset of these keywords that a function accepts; all of them if it accepts `**kwargs`.

    For adapters around code written for an older interface. A function whose signature Python cannot read, such as a
    compiled one, is assumed to follow the current interface.
    """
    wanted = frozenset(names)
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return wanted
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        return wanted
    by_keyword = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return wanted & {parameter.name for parameter in parameters if parameter.kind in by_keyword}
