"""What a page may send, checked against a schema. Everything in it comes from outside."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from trundle.errors import InputError

MAX_BYTES = 16_384
"""Of one message."""

_Metres = Annotated[float, Field(ge=-1e6, le=1e6)]
_Radians = Annotated[float, Field(ge=-1e3, le=1e3)]
_Rate = Annotated[float, Field(ge=-100.0, le=100.0)]  # [m/s] or [rad/s]
_Edge = Annotated[float, Field(ge=0.02, le=10.0)]
_Name = Annotated[str, Field(min_length=1, max_length=200)]
_Seed = Annotated[int, Field(ge=0, le=2**53 - 1)]  # JavaScript's largest exact integer

PoseNumbers: TypeAlias = tuple[_Metres, _Metres, _Radians]
GoalNumbers: TypeAlias = tuple[_Metres, _Metres, _Radians | None]


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class Setup(_Message):
    """Start a run of this mission; what is None is taken from the server's source, or picked by seed."""

    type: Literal["setup"]
    world: _Name | None = None
    robot: _Name | None = None
    planner: _Name | None = None
    controller: _Name | None = None
    seed: _Seed | None = None
    start: PoseNumbers | None = None
    goal: GoalNumbers | None = None


class Preview(_Message):
    """Show this world and robot while nothing is running."""

    type: Literal["preview"]
    world: _Name | None = None
    robot: _Name | None = None
    seed: _Seed | None = None


class Order(_Message):
    """What a run is to do.

    Attributes:
        run: Number of the run that the page shows, as its `run` message tells it: the order is refused where another
            one runs. None means the run in progress.
    """

    run: Annotated[int, Field(ge=1, le=10**9)] | None = None


class NewGoal(Order):
    """Drive to this goal now, or after those that the robot has."""

    type: Literal["goal"]
    pose: GoalNumbers
    append: bool = False


class SetPause(Order):
    """Hold the run, or let it go on."""

    type: Literal["pause"]
    paused: bool


class OneStep(Order):
    """One control period of a paused run."""

    type: Literal["step"]


class SetSpeed(Order):
    """Simulated seconds per second."""

    type: Literal["speed"]
    factor: Annotated[float, Field(ge=0.1, le=50.0)] | Literal["max"]


class ManualCommand(Order):
    """Drive by hand [m/s, rad/s]; to be repeated, because it holds for a moment only."""

    type: Literal["manual"]
    v: _Rate
    w: _Rate


class ReleaseCommand(Order):
    """Hand control back to the navigator."""

    type: Literal["release"]


class RestartRun(Order):
    """Run the mission again: with its seed, another, or the next."""

    type: Literal["restart"]
    seed: _Seed | Literal["next"] | None = None


class NewBox(Order):
    """Put a box on the floor [m]."""

    type: Literal["box"]
    x: _Metres
    y: _Metres
    yaw: _Radians = 0.0
    size: tuple[_Edge, _Edge, _Edge]


class EndRun(Order):
    """End the run."""

    type: Literal["end"]


class Drive(_Message):
    """Ask to drive; or, from the client that drives, the answer to who asked."""

    type: Literal["drive"]
    answer: Literal["grant", "refuse"] | None = None


class Ping(_Message):
    """Answered with the same echo."""

    type: Literal["ping"]
    echo: Annotated[float, Field(ge=-1e15, le=1e15)] | Annotated[str, Field(max_length=64)] | None = None


Message: TypeAlias = Annotated[
    Setup
    | Preview
    | NewGoal
    | SetPause
    | OneStep
    | SetSpeed
    | ManualCommand
    | ReleaseCommand
    | RestartRun
    | NewBox
    | EndRun
    | Drive
    | Ping,
    Field(discriminator="type"),
]

_SCHEMA: TypeAdapter[Message] = TypeAdapter(Message)


def parse_message(text: str) -> Message:
    """Read a message of a page.

    Raises:
        InputError: If it is no JSON, or not as the schema says; the message names the first mistake.
    """
    try:
        return _SCHEMA.validate_json(text)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False, include_context=False)[0]
        where = ".".join(str(part) for part in first["loc"])[:80]
        raise InputError(f"message refused: {where + ': ' if where else ''}{first['msg'][:200]}") from None
