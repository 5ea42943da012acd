"""`Robot`: one wheeled robot, read from YAML."""

from __future__ import annotations

import os
from functools import cached_property
from importlib import resources
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np
import yaml
from pydantic import Field, field_validator

from trundle.errors import InputError, RobotError, UnknownNameError
from trundle.files.kinds import ROBOT
from trundle.files.uris import Folders, split_folders
from trundle.files.yaml_config import Config, Plain, build, plain_value, validate
from trundle.files.yaml_nodes import compose
from trundle.geometry import FloatArray, Footprint, Twist2D
from trundle.guard import ReadCall, ReadLimits, read_guarded, read_limits
from trundle.registry import Registry
from trundle.robots.parts import Body, Caster, CasterFrame, Coordinate, DifferentialDrive, Lidar, Limits, WheelSpeeds
from trundle.values import check_kind

MODEL_SUFFIXES = (".urdf", ".xacro", ".xml", ".mjcf")
"""Suffixes of files that `Robot.from_model` reads."""

_PLUGINS: Registry[Robot] = Registry("robot", "trundle.robots", {})


class Robot(Config):
    """A wheeled robot, as described to planners, controllers and simulators.

    base_link is on the floor, midway between the drive wheels, x forward.

    Attributes:
        name: Name of the robot.
        drive: The drive.
        limits: Maximum speeds and accelerations.
        footprint: Corners of its convex outline in base_link [m], clockwise or counter-clockwise.
        body: The chassis.
        casters: Passive wheels.
        caster_frame: What carries the casters. If None, they are on the chassis.
        lidars: Planar lidars by name.
        map_height_band: Range of heights above the floor in which solids are obstacles to this robot [m, m]. If None,
            it goes from 0.05 m to the robot's height.
    """

    file_keys: ClassVar[tuple[str, ...]] = ("model", "paths", "base")

    name: str
    drive: DifferentialDrive
    limits: Limits
    footprint: Annotated[tuple[tuple[Coordinate, Coordinate], ...], Field(min_length=3, max_length=64)]
    body: Body
    casters: tuple[Caster, ...] = ()
    caster_frame: CasterFrame | None = None
    lidars: dict[str, Lidar] = Field(default_factory=dict)
    map_height_band: tuple[Coordinate, Coordinate] | None = None

    @classmethod
    def load(
        cls,
        name_or_path: str | os.PathLike[str] | Robot,
        *,
        paths: Folders = (),
        trusted: bool | None = None,
        time_limit_s: float | None = None,
        memory_limit_gb: float | None = None,
    ) -> Robot:
        """Load a robot by catalogue name, or from a YAML, URDF or MJCF file.

        A YAML may have a key `model`, the path of a URDF or MJCF file relative to the YAML's folder: settings are then
        derived from the model, and those in the YAML override them. A key `base` does the same with another robot, by
        its name or file: `base: nova_carter` and `lidars: {low: {…}}` add a lidar to Nova Carter. A URDF or MJCF file
        alone is read as by `from_model`, with the wheels' joints found by their names. URDF and MJCF files are read in
        a separate process.

        Args:
            name_or_path: Its name or file; a `Robot` is returned unchanged.
            paths: Folders to search for a file's package:// names, after those above it.
            trusted: As in `World.load`.
            time_limit_s: As in `World.load`.
            memory_limit_gb: As in `World.load`.

        Raises:
            UnknownNameError: If it is neither a known name nor a path; the nearest name is offered.
            RobotError: If the file cannot be used; every mistake is listed as file:line:column.
        """
        if isinstance(name_or_path, Robot):
            return name_or_path
        check_kind(name_or_path, (str, os.PathLike), "a robot", "give a Robot, a name or the path of a file")
        text = os.fspath(name_or_path)
        limits = read_limits(trusted=trusted, time_limit_s=time_limit_s, memory_limit_gb=memory_limit_gb)
        if text in _catalogue():
            return _load_file(_catalogue()[text], limits)
        if is_robot_file(text):
            return _load_file(Path(text), limits, split_folders(paths))
        if text in _PLUGINS.names():
            return _load_plugin(text, limits)
        raise UnknownNameError("robot", text, robot_names())

    @classmethod
    def from_model(
        cls,
        path: str | os.PathLike[str],
        *,
        left_joint: str | None = None,
        right_joint: str | None = None,
        wheel_radius: float | None = None,
        track_width: float | None = None,
        limits: Limits | None = None,
        name: str | None = None,
        paths: Folders = (),
        trusted: bool | None = None,
        time_limit_s: float | None = None,
        memory_limit_gb: float | None = None,
    ) -> Robot:
        """Create a robot from a URDF or MJCF file; see `robots.from_model` for how its settings are derived.

        Args:
            path: The file.
            left_joint: Name of the left drive wheel's joint. If None, it is found by its name.
            right_joint: As `left_joint`.
            wheel_radius: Radius of the wheels [m]. If None, it is read from their geometry.
            track_width: Distance between the wheels' centres [m]. If None, it is read from their geometry.
            limits: Maximum speeds and accelerations. If None, they are the joints', or assumed with a warning.
            name: Name of the robot. If None, it is the model's.
            paths: Folders to search for package:// names, after those above the file.
            trusted: As in `World.load`.
            time_limit_s: As in `World.load`.
            memory_limit_gb: As in `World.load`.

        Raises:
            RobotError: If the file cannot be read, or does not describe a robot with two drive wheels.
            UnknownNameError: If it has no such joint; the nearest name is offered.

        Warns:
            RobotWarning: If limits or supports had to be assumed.
        """
        reading = read_limits(trusted=trusted, time_limit_s=time_limit_s, memory_limit_gb=memory_limit_gb)
        drive = {
            "left_joint": left_joint,
            "right_joint": right_joint,
            "wheel_radius": wheel_radius,
            "track_width": track_width,
        }
        given: dict[str, Plain] = {"drive": {key: value for key, value in drive.items() if value is not None}}
        if limits is not None:
            given["limits"] = limits.model_dump()
        if name is not None:
            given["name"] = name
        return _make(_read_model(Path(path), given, split_folders(paths), reading), str(path))

    def __repr__(self) -> str:
        return f"Robot({self.name!r}, {self._size_text()}, up to {self.limits.linear_speed:g} m/s)"

    def __str__(self) -> str:
        return repr(self)

    def _size_text(self) -> str:
        long, wide = self.planar.size
        return f"{long:.3g} x {wide:.3g} x {self.body.height:.3g} m, {self.total_mass:.4g} kg"

    def _repr_png_(self) -> bytes:
        """Show a picture from above in notebooks: footprint, wheels, casters and lidars; the robot faces right."""
        from trundle.pictures.figure import to_png
        from trundle.robots.picture import DrawnWheel, draw_robot

        drive, body = self.drive, self.body
        wheels = [
            DrawnWheel(wheel.x, wheel.side * drive.track_width / 2.0, 2.0 * drive.wheel_radius, drive.wheel_width)
            for wheel in drive.wheels
        ]
        casters = [(caster.x, caster.y, caster.radius) for caster in self.casters]
        lidars = [(lidar.x, lidar.y, lidar.yaw) for lidar in self.lidars.values()]
        red, green, blue = (round(255 * share) for share in body.color)
        speeds = f"up to {self.limits.linear_speed:g} m/s and {self.limits.angular_speed:g} rad/s"
        lines = [self._size_text(), speeds]
        return to_png(draw_robot(self.outline, wheels, casters, lidars, (red, green, blue), self.name, lines))

    @field_validator("footprint")
    @classmethod
    def _check_footprint(cls, corners: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        return tuple((float(x), float(y)) for x, y in Footprint(np.asarray(corners)).outline)

    @field_validator("map_height_band")
    @classmethod
    def _check_band(cls, band: tuple[float, float] | None) -> tuple[float, float] | None:
        if band is not None and not band[0] < band[1]:
            raise ValueError(f"the band must go from low to high, got {band}")
        return band

    @cached_property
    def planar(self) -> Footprint:
        """The footprint as a value: its outline, its radii, and how to pad it."""
        return Footprint(np.asarray(self.footprint))

    @property
    def outline(self) -> FloatArray:
        """The footprint [m] in base_link, counter-clockwise, shape (N, 2), read-only."""
        return self.planar.outline

    @property
    def inscribed_radius(self) -> float:
        """Distance [m] from base_link to the nearest edge of the footprint."""
        return self.planar.inscribed_radius

    @property
    def circumscribed_radius(self) -> float:
        """Distance [m] from base_link to the farthest corner of the footprint: the radius of a turn in place."""
        return self.planar.circumscribed_radius

    @property
    def z_range(self) -> tuple[float, float]:
        """Range of heights [m] in which solids are obstacles to this robot."""
        return self.map_height_band or (0.05, self.body.height)

    @property
    def total_mass(self) -> float:
        """Chassis, wheels, casters and what carries them [kg]."""
        return (
            self.body.mass
            + len(self.drive.wheels) * self.drive.wheel_mass
            + sum(caster.mass for caster in self.casters)
            + (self.caster_frame.mass if self.caster_frame is not None else 0.0)
        )

    def wheel_speeds(self, twist: Twist2D) -> WheelSpeeds:
        """Return the wheel speeds [rad/s] that drive a twist without slip."""
        return self.drive.wheel_speeds(twist)

    def twist(self, wheels: WheelSpeeds) -> Twist2D:
        """Return the twist that wheel speeds [rad/s] drive without slip."""
        return self.drive.twist(wheels)

    def wheel_command(self, twist: Twist2D) -> WheelSpeeds:
        """Return the wheel speeds [rad/s] for a command, clipped as Isaac Sim's DifferentialController clips."""
        return self.drive.wheel_command(
            twist, max_linear_speed=self.limits.linear_speed, max_angular_speed=self.limits.angular_speed
        )


def robot_names() -> list[str]:
    """Return the names of the robots that can be loaded without a file, sorted."""
    return sorted({*_catalogue(), *_PLUGINS.names()})


def is_robot_file(text: str) -> bool:
    """Return whether a text names a robot file rather than a robot of the catalogue; the file need not exist."""
    return Path(text).suffix.lower() in (".yaml", ".yml", *MODEL_SUFFIXES) or os.sep in text


def _catalogue() -> dict[str, Path]:
    folder = Path(str(resources.files("trundle.robots") / "catalogue"))
    return {path.stem: path for path in folder.glob("*.yaml")}


def _load_file(path: Path, limits: ReadLimits, paths: tuple[Path, ...] = (), derived: tuple[Path, ...] = ()) -> Robot:
    """Load a file, which `derived` files are based on."""
    if path.suffix.lower() in MODEL_SUFFIXES:
        return _make(_read_model(path, {"drive": {}}, paths, limits), str(path))
    try:
        node = compose(path)
        settings = plain_value(node, str(path))
        if not isinstance(settings, dict) or not settings.keys() & {"model", "base"}:
            return validate(node, Robot, str(path), kind=ROBOT)
    except InputError as error:
        raise RobotError(str(error)) from error
    if "base" in settings:
        if "model" in settings:
            raise RobotError(f"{path}: give either model or base")
        base = _load_base(settings.pop("base"), path, limits, paths, derived)
        given: dict[str, Plain] = {"name": path.stem, **settings}
        return _make(_merge(base.model_dump(mode="json"), given), str(path), node)
    model, folders = settings.pop("model"), settings.pop("paths", [])
    if not isinstance(model, str) or Path(model).suffix.lower() not in MODEL_SUFFIXES:
        raise RobotError(f"{path}: model must be the path of a {', '.join(MODEL_SUFFIXES)} file, got {model!r}")
    if not isinstance(folders, list):
        raise RobotError(f"{path}: paths must be a list of folders, got {folders!r}")
    found = tuple(path.parent / str(folder) for folder in folders)
    return _make(_read_model(path.parent / model, settings, (*found, *paths), limits), str(path), node)


def _load_base(
    base: Plain, path: Path, limits: ReadLimits, paths: tuple[Path, ...], derived: tuple[Path, ...]
) -> Robot:
    """Return the robot that a file is based on."""
    if not isinstance(base, str):
        raise RobotError(f"{path}: base must be the name of a robot or the path of its file, got {base!r}")
    if not is_robot_file(base):
        try:
            return Robot.load(base)
        except UnknownNameError as error:
            raise RobotError(f"{path}: base: {error}") from error
    derived = (*derived, path.resolve())
    file = path.parent / base
    if file.resolve() in derived:
        raise RobotError(f"{path}: base {base} is based on this file itself")
    return _load_file(file, limits, paths, derived)


def _read_model(path: Path, given: dict[str, Plain], folders: tuple[Path, ...], limits: ReadLimits) -> dict[str, Plain]:
    call = ReadCall(
        "trundle.robots.from_model:read_robot",
        (path, given, folders),
        what=str(path),
        error=RobotError,
        limits=limits,
        imports=("mujoco",),
    )
    return _merge(read_guarded(call, stacklevel=4), given)


def _merge(below: dict[str, Plain], given: dict[str, Plain]) -> dict[str, Plain]:
    """Merge given settings over others, key by key, also within mappings; lists are replaced as a whole."""
    merged = dict(below)
    for key, value in given.items():
        old = merged.get(key)
        merged[key] = _merge(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
    return merged


def _make(settings: dict[str, Plain], where: str, node: yaml.Node | None = None) -> Robot:
    try:
        return build(settings, Robot, name=where, node=node)
    except InputError as error:
        raise RobotError(str(error)) from error


def _load_plugin(name: str, limits: ReadLimits) -> Robot:
    """Load an entry point: a `Robot`, the path of its YAML, or a function that returns either."""
    value = _PLUGINS.load(name)
    if callable(value):
        value = value()
    if isinstance(value, Robot):
        return value
    if isinstance(value, str | Path):
        return _load_file(Path(value), limits)
    raise RobotError(
        f"the entry point of robot {name!r} returns {type(value).__name__}, not a Robot or the path of one"
    )


def describe_imbalance(robot: Robot) -> str:
    """Explain why a robot tips over, and what to add."""
    x, y = _center_of_mass(robot)
    carried = [wheel.x for wheel in robot.drive.wheels] + [caster.x - caster.trail for caster in robot.casters]
    first, last = min(carried), max(carried)
    begin = f"the robot {robot.name!r} tips over: its wheels and casters do not support it"
    if first < x < last:
        return f"{begin}: check body.center_of_mass, which is at ({x:.3g}, {y:.3g}) m, and where its casters are"
    front = x >= last
    reach = robot.outline[:, 0].max() if front else robot.outline[:, 0].min()
    where, at = ("in front of", max(reach * 0.8, x)) if front else ("behind", min(reach * 0.8, x))
    what = "wheels and casters" if robot.casters else "wheels, and it has no casters"
    return (
        f"{begin}: its centre of mass (body.center_of_mass, x {x:.3g} m) is {where} all of its {what}. Add one there, "
        f"for example casters: [{{x: {at:.3g}, y: 0, radius: {max(0.005, robot.body.clearance / 2.0):.3g}}}]"
    )


def _center_of_mass(robot: Robot) -> tuple[float, float]:
    if robot.body.center_of_mass is not None:
        return robot.body.center_of_mass[0], robot.body.center_of_mass[1]
    low, high = robot.outline.min(axis=0), robot.outline.max(axis=0)
    return float(low[0] + high[0]) / 2.0, float(low[1] + high[1]) / 2.0
