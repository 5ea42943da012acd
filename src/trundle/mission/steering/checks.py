"""How directives are checked: pydantic calls a check for each field, and the first that fails is an `InputError`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeAlias

from pydantic import ConfigDict, ValidationError, ValidationInfo

from trundle.errors import InputError, UnknownNameError
from trundle.values import check_flag, check_number

CONFIG = ConfigDict(extra="forbid", arbitrary_types_allowed=True)
"""For `pydantic.dataclasses.dataclass`: a field that a directive does not have is an error."""

Check: TypeAlias = Callable[[Any, ValidationInfo], Any]

if TYPE_CHECKING:

    class CheckedDirective:
        """Base of all directives."""

        __slots__ = ()

else:

    class _TypedErrors(type):
        """Raises the error of the first check that failed in place of pydantic's list of all."""

        def __call__(cls, *arguments: Any, **given: Any) -> Any:
            try:
                return super().__call__(*arguments, **given)
            except ValidationError as error:
                raise _first_problem(cls, error) from None

    class CheckedDirective(metaclass=_TypedErrors):
        """Base of all directives."""

        __slots__ = ()


def number_of(what: str, least: float, most: float, unit: str) -> Check:
    """Return a check for numbers; its errors name the field and what it is of: "x of a box must be a number …"."""

    def check(value: Any, info: ValidationInfo) -> float:
        return check_number(f"{info.field_name} of {what}", value, least, most, unit)

    return check


def flag(value: Any, info: ValidationInfo) -> bool:
    """Check that a field is a bool."""
    return check_flag(str(info.field_name), value)


def _first_problem(kind: Any, error: ValidationError) -> InputError:
    """Describe the first problem that pydantic found in the fields of a directive."""
    problem = error.errors(include_url=False)[0]
    cause = problem.get("ctx", {}).get("error")
    if isinstance(cause, InputError):
        return cause
    known = [field.name for field in fields(kind)]
    if problem["type"] == "unexpected_keyword_argument":
        return UnknownNameError(f"field of {kind.__name__}", str(problem["loc"][-1]), known)
    return InputError(f"{kind.__name__} needs {', '.join(known)}: {problem['msg']}")
