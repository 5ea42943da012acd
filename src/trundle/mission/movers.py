"""`MoverChoice`: a moving obstacle, or a crowd of them, in a scenario's YAML."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from trundle.files.config_fields import NotNegative, Positive
from trundle.files.yaml_config import Config
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Solid
from trundle.worlds.movers import AlongPath, Crowd, Motion, Mover, Waypoints
from trundle.worlds.movers.mover import body_named

_COLOR = (0.55, 0.36, 0.70, 1.0)
_PLURALS = {"person": "people", "forklift": "forklifts"}

_Body = Literal["person", "forklift"]
_TimedPoint = Annotated[tuple[float, ...], Field(min_length=3, max_length=4)]
_Point = Annotated[tuple[float, ...], Field(min_length=2, max_length=2)]
_Sizes = Annotated[tuple[Positive, ...], Field(min_length=3, max_length=3)]
_RadiusHeight = Annotated[tuple[Positive, ...], Field(min_length=2, max_length=2)]
_Area = Annotated[tuple[float, ...], Field(min_length=4, max_length=4)]


class MoverChoice(Config):
    """A mover on a path, or a crowd.

    `{crowd: forklift, count: 6, speed: 1.2, sees_robot: false}`,
    `{name: cart, body: forklift, path: [[0, 0], [8, 0]], speed: 1.2, repeat: back_and_forth}`, or
    `{name: door, box: [1.0, 0.1, 2.0], waypoints: [[0, 2, 0], [5, 3, 0]]}`.

    Attributes:
        name: Its name, under which contacts are reported; of a crowd, none means `people` or `forklifts`.
        crowd: What a crowd is of.
        count: How many there are in the crowd.
        sees_robot: Whether a crowd stops for the robot and goes around it.
        area: (x0, y0, x1, y1) [m]: where the crowd stays; none means anywhere in the world.
        seed: Of the crowd's random places; none means the scenario's.
        body: The body of a mover. Either this, `box` or `cylinder`.
        box: Size (x, y, z) [m] of a mover that is a box on the floor.
        cylinder: Radius and height [m] of a mover that is a cylinder on the floor.
        waypoints: (t, x, y) or (t, x, y, yaw) each [s, m, m, rad], which a mover passes. Either this or `path`.
        path: (x, y) each [m], followed at constant speed.
        speed: Along the path, or the fastest of the crowd [m/s]; none means 1.2.
        start_s: When a mover sets off along its path [s].
        interpolation: Between the points: straight, or a smooth Catmull-Rom curve.
        repeat: After the last point: stay there, start again, or return in reverse.
    """

    name: str | None = None
    crowd: _Body | None = None
    count: Annotated[int, Field(ge=1, le=1000)] = 1
    sees_robot: bool = True
    area: _Area | None = None
    seed: Annotated[int, Field(ge=0)] | None = None
    body: _Body | None = None
    box: _Sizes | None = None
    cylinder: _RadiusHeight | None = None
    waypoints: Annotated[tuple[_TimedPoint, ...], Field(min_length=1)] | None = None
    path: Annotated[tuple[_Point, ...], Field(min_length=2)] | None = None
    speed: Positive | None = None
    start_s: NotNegative = 0.0
    interpolation: Literal["linear", "catmull_rom"] = "linear"
    repeat: Literal["once", "loop", "back_and_forth"] = "once"

    @model_validator(mode="after")
    def _check(self) -> Self:
        given = {name for name, field in type(self).model_fields.items() if getattr(self, name) != field.default}
        if self.crowd is not None:
            extra = given & {"body", "box", "cylinder", "waypoints", "path", "start_s", "interpolation", "repeat"}
            if extra:
                raise ValueError(f"{', '.join(sorted(extra))}: not of a crowd, which goes to random places")
        else:
            extra = given & {"count", "sees_robot", "area", "seed"}
            if extra:
                raise ValueError(f"{', '.join(sorted(extra))}: only of a crowd; give crowd: person or crowd: forklift")
            if self.name is None:
                raise ValueError("a mover needs a name")
            if (self.body is not None) + (self.box is not None) + (self.cylinder is not None) != 1:
                raise ValueError("give one of body, box and cylinder, or crowd")
            if (self.waypoints is None) == (self.path is None):
                raise ValueError("give either waypoints or path")
            if self.waypoints is not None and given & {"speed", "start_s"}:
                raise ValueError("speed and start_s are for path; waypoints have times")
        self.make()
        return self

    def make(self) -> Mover | Crowd:
        """Make the mover or the crowd.

        Raises:
            WorldError: If the times do not increase, or other values do not fit together.
        """
        speed = 1.2 if self.speed is None else self.speed
        if self.crowd is not None:
            x0, y0, x1, y1 = self.area or (0.0, 0.0, 0.0, 0.0)
            return Crowd(
                self.name or _PLURALS[self.crowd],
                self.count,
                self.crowd,
                speed,
                self.sees_robot,
                None if self.area is None else (x0, y0, x1, y1),
                seed=self.seed,
            )
        motion: Motion
        if self.waypoints is not None:
            motion = Waypoints(self.waypoints, self.interpolation, self.repeat)
        else:
            motion = AlongPath(self.path or (), speed, self.interpolation, self.repeat, self.start_s)
        return Mover(self.name or "", self._parts(), motion, self.body or "")

    def _parts(self) -> tuple[Solid, ...]:
        if self.body is not None:
            return body_named(self.body)
        if self.box is not None:
            x, y, z = self.box
            return (Solid("box", Box((x, y, z)), Pose3D((0.0, 0.0, z / 2.0)), _COLOR),)
        radius, height = self.cylinder or (0.0, 0.0)
        return (Solid("cylinder", Cylinder(radius, height), Pose3D((0.0, 0.0, height / 2.0)), _COLOR),)
