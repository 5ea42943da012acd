"""The messages between pages and the server. What a page sends comes from outside: it is checked against a schema."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, InstanceOf, TypeAdapter, ValidationError, model_validator

from trundle.errors import InputError
from trundle.mission.steering.checks import CheckedDirective
from trundle.mission.steering.directives import read_directive
from trundle.page.encoding import to_json
from trundle.values import as_sequence, check_number, show_value

MAX_BYTES = 16_384
"""Size of one message at most."""

_Metres = Annotated[float, Field(ge=-1e6, le=1e6)]
_Radians = Annotated[float, Field(ge=-1e3, le=1e3)]
_Name = Annotated[str, Field(min_length=1, max_length=200)]
_Seed = Annotated[int, Field(ge=0, le=2**53 - 1)]  # JavaScript's largest exact integer

PoseNumbers: TypeAlias = tuple[_Metres, _Metres, _Radians]
GoalNumbers: TypeAlias = tuple[_Metres, _Metres, _Radians | None]


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class Setup(_Message):
    """Starts a run of this mission; what is None is taken from the server's source, or picked by seed."""

    type: Literal["setup"]
    world: _Name | None = None
    robot: _Name | None = None
    planner: _Name | None = None
    controller: _Name | None = None
    seed: _Seed | None = None
    start: PoseNumbers | None = None
    goal: GoalNumbers | None = None


class Preview(_Message):
    """Shows this world and robot while nothing is running."""

    type: Literal["preview"]
    world: _Name | None = None
    robot: _Name | None = None
    seed: _Seed | None = None


class Order(_Message):
    """A directive for a run: `{"type": "manual", "v": 0.5, "w": 0.0, "run": 3}`.

    The directive is read as in a record, with its name as the type of the message. A page may give those of `type`, and
    no others: one that runs a behavior, for example, would let it load any plug-in.

    Attributes:
        run: Number of the run that the page shows, as its `run` message tells it: the order is refused where another
            one runs. If None, it is for the run in progress.
        directive: What the run is to do.
    """

    type: Literal[
        "pause", "step", "speed", "goal", "manual", "release", "restart", "box", "end", "pose", "reinitialize"
    ]
    run: Annotated[int, Field(ge=1, le=10**9)] | None = None
    directive: InstanceOf[CheckedDirective]

    @model_validator(mode="before")
    @classmethod
    def _read(cls, message: dict[str, Any]) -> dict[str, Any]:
        envelope = {key: message[key] for key in ("type", "run") if key in message}
        values = {key: value for key, value in message.items() if key not in envelope}
        kind = message["type"]
        if (own := _NOT_OF_PAGES.get(kind)) in values:
            raise InputError(f"{own!r} is no field of a page's {kind!r}")
        if kind == "goal" and "pose" in values:
            values["goal"] = _read_goal(values.pop("pose"))
        if kind == "pose" and "pose" in values and len(_read_goal(values["pose"])) < 3:
            raise InputError("the pose of a robot is [x, y, yaw], and all three are numbers")
        return {**envelope, "directive": read_directive(kind, values)}


_NOT_OF_PAGES = {"step": "periods", "end": "why", "goal": "goal"}
"""Fields of directives that a page does not give; its goal is a `pose`."""


def _read_goal(pose: Any) -> tuple[float, ...]:
    """Return the goal of a page's [x, y, yaw], in which null stands for any yaw."""
    numbers = as_sequence(pose, "the pose of a goal")
    if len(numbers) != 3:
        raise InputError(f"the pose of a goal is [x, y, yaw], with null for any yaw, got {show_value(pose)}")
    x, y, yaw = numbers
    place = tuple(check_number(f"{name} of a goal", number, -1e6, 1e6, "m") for name, number in (("x", x), ("y", y)))
    return place if yaw is None else (*place, check_number("yaw of a goal", yaw, -1e3, 1e3, "rad"))


class Keys(_Message):
    """Tells which keys are held, as a loop of one's own gets them: `KeyboardEvent.key`, letters in lower case."""

    type: Literal["keys"]
    held: Annotated[tuple[Annotated[str, Field(min_length=1, max_length=24)], ...], Field(max_length=16)]


class Drive(_Message):
    """Asks to drive; or, from the client that drives, answers the client that asked."""

    type: Literal["drive"]
    answer: Literal["grant", "refuse"] | None = None


class Ping(_Message):
    """Asks for an answer with the same echo."""

    type: Literal["ping"]
    echo: Annotated[float, Field(ge=-1e15, le=1e15)] | Annotated[str, Field(max_length=64)] | None = None


Message: TypeAlias = Annotated[Setup | Preview | Order | Keys | Drive | Ping, Field(discriminator="type")]

_SCHEMA: TypeAdapter[Message] = TypeAdapter(Message)


def parse_message(text: str) -> Message:
    """Read a message of a page.

    Raises:
        InputError: If it is no JSON, or not as the schema says; the message names the first mistake.
    """
    try:
        return _SCHEMA.validate_json(text)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        where = ".".join(str(part) for part in first["loc"])[:80]
        what = str(first.get("ctx", {}).get("error") or first["msg"])
        raise InputError(f"message refused: {where + ': ' if where else ''}{what[:200]}") from None


def encode(value: object) -> str:
    """Return JSON on one line; numbers that are not finite, which JSON does not have, become null."""
    try:
        return to_json(value)
    except ValueError:
        return to_json(_finite(value))


def encode_message(kind: str, **fields: object) -> str:
    """Return a message of this type."""
    return encode({"type": kind, **fields})


def encode_items(values: Sequence[object]) -> str:
    """Return the items of a JSON array, without its brackets."""
    return encode(list(values))[1:-1]


def _finite(value: object) -> object:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return value
