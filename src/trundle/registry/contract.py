"""What a plug-in of one kind must have, and how functions do the work of one."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Self, SupportsIndex, TypeVar

_Made = TypeVar("_Made")


@dataclass(frozen=True, slots=True)
class Contract:
    """What a plug-in of one kind must have.

    Attributes:
        methods: The methods that an object needs, each with its arguments: `{"plan": "costmap, start, goal"}`.
        attributes: The attributes that an object needs besides.
        function: The arguments by position of a plain function; empty where a function cannot do the work.
        keywords: More keywords of a call, which a plain function may take.
        former: Keywords that a call had in earlier versions, each with what to write instead.
        files: Whether `"file.py:name"` is a name: not for kinds that others name, in a file or over the network.
    """

    methods: Mapping[str, str]
    attributes: tuple[str, ...] = ()
    function: tuple[str, ...] = ()
    keywords: tuple[str, ...] = ()
    former: Mapping[str, str] = field(default_factory=dict[str, str])
    files: bool = True

    def lacks(self, found: object) -> list[str]:
        """List what an object or a class lacks of the contract; attributes of a class may come with its objects."""
        missing = [f"{name}({args})" for name, args in self.methods.items() if not callable(getattr(found, name, None))]
        if not isinstance(found, type):
            missing += [name for name in self.attributes if not hasattr(found, name)]
        return missing

    def describe(self) -> str:
        """Return what an object needs, in words."""
        parts = [f"{name}({args})" for name, args in self.methods.items()] + list(self.attributes)
        return " and ".join(filter(None, [", ".join(parts[:-1]), parts[-1]]))


@dataclass(frozen=True, slots=True)
class PluginFunction:
    """A plain function that does the work of a plug-in.

    Attributes:
        name: Its name, for messages and tables.
        function: The function.
        keywords: What it gets in every call besides the arguments of its kind: robot, map and options.
        taken: Which keywords of a call it takes.
    """

    name: str
    function: Callable[..., Any]
    keywords: Mapping[str, object]
    taken: frozenset[str]

    def __call__(self, *arguments: object, **keywords: object) -> Any:
        """Call it with the arguments of its kind, and with those keywords of the call that it takes."""
        given = {name: value for name, value in keywords.items() if name in self.taken}
        return self.function(*arguments, **self.keywords, **given)


def is_foreign(made: object) -> bool:
    """Return whether an object is of another package than trundle, and may lack optional members of its protocol."""
    return not type(made).__module__.startswith("trundle.")


class CopiedAsNew:
    """Base of plug-ins that are copied and pickled by the arguments that they were made with.

    Those that keep a kernel of `_core` need it, as kernels cannot be copied. A class of another package that derives
    from one of these may keep more, so it says itself how it is copied.
    """

    _made_with: tuple[tuple[Any, ...], dict[str, Any]]

    def __new__(cls, *arguments: Any, **options: Any) -> Self:
        """Make one, and remember what it was made with."""
        made = super().__new__(cls)
        made._made_with = arguments, options
        return made

    def __reduce_ex__(self, protocol: SupportsIndex) -> str | tuple[Any, ...]:
        return super().__reduce_ex__(protocol) if is_foreign(self) else (_make_again, (type(self), *self._made_with))


def _make_again(kind: type[_Made], arguments: tuple[Any, ...], options: dict[str, Any]) -> _Made:
    return kind(*arguments, **options)


def name_of(found: object) -> str:
    """Return what a class, a function or an object is called in messages and tables."""
    inner = getattr(found, "func", found)  # of a functools.partial
    return str(getattr(inner, "__name__", None) or type(found).__name__)


def keywords_taken(function: Callable[..., object], names: Iterable[str]) -> frozenset[str]:
    """Return the subset of these keywords that a function accepts; all of them if it accepts `**kwargs`.

    A function whose signature Python cannot read, such as a compiled one, is assumed to take all of them.
    """
    wanted = frozenset(names)
    parameters = parameters_of(function)
    if parameters is None or any(one.kind is one.VAR_KEYWORD for one in parameters):
        return wanted
    return wanted & {one.name for one in parameters if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY)}


def parameters_of(function: Callable[..., object]) -> list[inspect.Parameter] | None:
    """Return the parameters of a function; None where Python cannot read them."""
    # A suite makes the same classes for each of its missions, and reading their signatures takes as long as that.
    return _parameters_of_class(function) if isinstance(function, type) else _read_parameters(function)


def _read_parameters(function: Callable[..., object]) -> list[inspect.Parameter] | None:
    try:
        return list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError):
        return None


_parameters_of_class = lru_cache(maxsize=256)(_read_parameters)


def by_position(parameters: list[inspect.Parameter]) -> list[inspect.Parameter]:
    """Return those parameters that can be given by position."""
    return [one for one in parameters if one.kind in (one.POSITIONAL_ONLY, one.POSITIONAL_OR_KEYWORD)]
