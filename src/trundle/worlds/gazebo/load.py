"""Worlds in SDF, Gazebo's format: versions 1.2 to 1.12, read with trundle's own parser."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, TypeAlias

from trundle.errors import WorldError, WorldWarning
from trundle.files.uris import Folders, split_folders
from trundle.files.xml_elements import XmlElement, read_xml
from trundle.geometry import Pose3D
from trundle.geometry.solids import Color, Solid
from trundle.values import first_names
from trundle.worlds.gazebo.elements import (
    WORLD_FRAME,
    Place,
    PoseIn,
    Scope,
    child,
    children,
    read_attribute_flag,
    read_flag,
    read_name,
    read_numbers,
    read_pose,
    read_text,
    read_version,
    refuse_macros,
)
from trundle.worlds.gazebo.shapes import (
    Files,
    MissingFileError,
    find_model_file,
    is_plain_floor,
    is_sun,
    read_color,
    read_geometry,
    read_plain_floor,
)
from trundle.worlds.leave_out import Filter, warn_of_unmet
from trundle.worlds.movers import Mover, Waypoints, person_body
from trundle.worlds.options import check_choice
from trundle.worlds.shapes import ENDLESS, LevelPlanes, Names, Part, make_solids
from trundle.worlds.world import World

GeometryChoice: TypeAlias = Literal["collision", "visual"]
MissingChoice: TypeAlias = Literal["error", "skip"]

MAX_NESTING = 32
"""Limit on nested models and includes."""

MAX_INCLUDES = 10_000
"""Limit on included models of a world, nested ones counted each time; large public worlds have about a hundred."""


def load_sdf(
    path: Path,
    *,
    geometry: GeometryChoice = "collision",
    movable: bool = False,
    missing: MissingChoice = "error",
    paths: Folders = (),
    world: str | None = None,
    exclude: str | Sequence[str] = (),
) -> World:
    """Read an SDF world, or the models of an SDF file without one.

    Boxes, cylinders, spheres, capsules, ellipsoids, cones and meshes become solids, with the colours of their
    materials. A level plane that faces up is the ground at its height (`worlds.ground.find_ground` chooses among
    several), any other a rectangle of its size. <state>, lights and plugins are ignored. Actors with a trajectory
    become movers, people in shape; others are left out with a warning. Nested models, includes by path, merged includes
    and poses in named frames are resolved; Gazebo's `Ground Plane` and `Sun` need no files.

    Args:
        path: The file.
        geometry: Read collision or visual geometry.
        movable: Include non-static models, at their initial pose; otherwise they are left out with a warning.
        missing: What to do about a missing mesh or included model: "error", or "skip" with a warning.
        paths: Folders to search for model:// and package:// names and other paths, after the file's own folder
            and before those in Gazebo's and ROS's environment variables; see `trundle.files.uris.find_uri`.
        world: Name of the <world>, if a file has several. If None, the first is read.
        exclude: What to leave out, see `World.load`. Errors in a shape that is left out by its name
            are ignored, and a missing model can be left out by the name that it would have.

    Raises:
        WorldError: If the file cannot be used; the message has file, line and model.
        InputError: If an option is out of range.
        MissingExtraError: If it has a mesh and trimesh is not installed.

    Warns:
        WorldWarning: If something was left out.
    """
    check_choice("geometry", geometry, ("collision", "visual"))
    check_choice("missing", missing, ("error", "skip"))
    reader = _Reader(geometry, movable, missing, Files(split_folders(paths)), Filter.of(exclude))
    found = reader.read_file(path, world)
    for text in reader.remarks():
        warnings.warn(f"{path}: {text}", WorldWarning, stacklevel=2)
    warn_of_unmet(reader.leave_out, str(path))
    return found


@dataclass(slots=True)
class _Model:
    """A model as read: its links with their elements, and its nested models.

    Attributes:
        name: Its name; empty if it is merged into its parent model.
        scope: Its frames.
        static: Whether it is static.
        frame: Name of its frame in the enclosing scope.
        links: Names and elements.
        models: Nested models.
    """

    name: str
    scope: Scope
    static: bool
    frame: str
    links: list[tuple[str, XmlElement]] = field(default_factory=list[tuple[str, XmlElement]])
    models: list[_Model] = field(default_factory=list["_Model"])


@dataclass(slots=True)
class _Reader:
    geometry: GeometryChoice
    movable: bool
    missing: MissingChoice
    files: Files
    leave_out: Filter
    names: Names = field(default_factory=Names)
    planes: LevelPlanes = field(default_factory=LevelPlanes)
    moving: list[str] = field(default_factory=list[str])
    skipped: list[str] = field(default_factory=list[str])
    includes: int = 0
    roots: dict[Path, XmlElement] = field(default_factory=dict[Path, XmlElement])

    def read_file(self, path: Path, world: str | None) -> World:
        place = Place(path)
        root = read_xml(path, error=WorldError)
        read_version(place, root)
        if path.suffix.lower() == ".xacro":
            refuse_macros(place, root)
        worlds = children(root, "world")
        if world is not None:
            worlds = [element for element in worlds if element.get("name") == world]
            if not worlds:
                there = ", ".join(element.get("name", "") for element in children(root, "world")) or "none"
                raise WorldError(f"{path}: it has no world {world!r}; there are: {there}")
        home = worlds[0] if worlds else root
        scope = Scope(place, own=WORLD_FRAME)
        models = self._read_models(place, home, scope, static=False, nesting=0)
        for frame in children(home, "frame"):
            _add_frame(place, frame, scope)
        self.skipped += [f"<{element.tag}>" for element in children(home, "population", "road")]
        movers = self._read_actors(place, home)
        solids: list[Solid] = []
        for model in models:
            solids += self._place_model(model, scope, Pose3D(), "")
        ground, rectangles, _ = self.planes.settle(solids, self.names)
        solids += [solid for solid in rectangles if not self.leave_out.takes_solid(solid)]
        name = home.get("name", "") if worlds else ""
        return World(path.stem if name in ("", "default") else name, tuple(solids), ground_z=ground, movers=movers)

    def _read_actors(self, place: Place, home: XmlElement) -> tuple[Mover, ...]:
        movers: list[Mover] = []
        for element in children(home, "actor"):
            mover = read_actor(place, element)
            if mover is None:
                self.skipped.append(f"the actor {element.get('name', '')!r}")
            elif not self.leave_out.takes_name(mover.name):
                movers.append(mover)
        return tuple(movers)

    def remarks(self) -> list[str]:
        """Return messages about what was left out."""
        texts: list[str] = []
        if self.moving:
            texts.append(
                f"{len(self.moving)} non-static models were left out ({first_names(self.moving)}); with "
                "movable=true they become fixed obstacles"
            )
        if self.skipped:
            texts.append(f"left out: {first_names(self.skipped)}")
        return texts

    def _read_models(
        self, place: Place, parent: XmlElement, scope: Scope, *, static: bool, nesting: int
    ) -> list[_Model]:
        """Read the models and includes below an element, and add them as frames to its scope."""
        models: list[_Model] = []
        for element in children(parent, "model", "include"):
            if nesting > MAX_NESTING:
                place.fail(element, f"models nested more than {MAX_NESTING} deep; does one include itself?")
            if element.tag == "model":
                name = read_name(place, element)
                model = self._read_model(place, element, name, static=static, nesting=nesting)
                pose = read_pose(model.scope.place, element)
            else:
                included = self._include(place, element, static=static, nesting=nesting)
                if included is None:
                    continue
                model, pose = included
            if element.tag == "include" and read_attribute_flag(place, element, "merge"):
                if not place.model:
                    place.fail(element, "<include merge=…> is allowed only inside a model, not directly in a world")
                model.frame = scope.merge(model.name, model.scope, pose, element)
                model.name, model.static = "", static
            else:
                scope.add(model.name, pose, element)
                scope.scopes[model.name] = model.scope
            models.append(model)
        return models

    def _read_model(self, place: Place, element: XmlElement, name: str, *, static: bool, nesting: int) -> _Model:
        place = replace(place, model=f"{place.model}::{name}" if place.model else name)
        # A model inside a static one is static, whatever its own <static> says.
        static = static or read_flag(place, element, "static", default=False)
        scope = Scope(place, placement_frame=element.get("placement_frame", ""))
        model = _Model(name, scope, static, frame=name)
        for link in children(element, "link"):
            link_name = read_name(place, link)
            scope.add(link_name, read_pose(place, link), link)
            model.links.append((link_name, link))
        model.models = self._read_models(place, element, scope, static=static, nesting=nesting + 1)
        for frame in children(element, "frame"):
            _add_frame(place, frame, scope)
        for joint in children(element, "joint"):
            pose = read_pose(place, joint)
            # Where a joint's pose names no frame, it is in that of the joint's child.
            link = (joint.findtext("child") or "").strip()
            scope.add(read_name(place, joint), pose if pose.frame else replace(pose, frame=link), joint)
        return model

    def _include(
        self, place: Place, element: XmlElement, *, static: bool, nesting: int
    ) -> tuple[_Model, PoseIn] | None:
        self.includes += 1
        if self.includes > MAX_INCLUDES:
            place.fail(element, f"more than {MAX_INCLUDES} models are included, including nested ones")
        uri = read_text(place, element, "uri")
        file = find_model_file(self.files.find(uri, place.file.parent))
        if file is None and is_plain_floor(uri):
            inside, root = Place(place.file, place.model), read_plain_floor(place.file)
        elif file is None:
            if not is_sun(uri):
                self._miss(place, element, uri)
            return None
        else:
            inside = Place(file, place.model)
            if file not in self.roots:
                self.roots[file] = read_xml(file, error=WorldError)
            root = self.roots[file]
            read_version(inside, root)
        found = child(root, "model")
        if found is None:
            if children(root, "light", "actor"):
                return None  # it has no geometry
            inside.fail(root, "an included file needs a <model>")
        name = (element.findtext("name") or "").strip() or read_name(inside, found)
        static = static or read_flag(place, element, "static", default=False)
        model = self._read_model(inside, found, name, static=static, nesting=nesting + 1)
        override = child(element, "static")
        if override is not None:
            model.static = static
        frame = (element.findtext("placement_frame") or "").strip()
        if frame:
            model.scope.placement_frame = frame
        own = read_pose(place, element)
        return model, own if own.element is not None else replace(read_pose(inside, found), frame="")

    def _miss(self, place: Place, element: XmlElement, uri: str) -> None:
        """Handle a missing included model: raise, or record that it was left out."""
        called = (element.findtext("name") or "").strip() or uri.rstrip("/").rpartition("/")[2]
        if self.leave_out.takes_name(f"{place.model}::{called}" if place.model else called):
            return
        if self.missing == "error":
            raise MissingFileError(
                f"{place.file}:{element.line}: the model {uri!r} was not found; {self.files.advise()}"
            )
        self.skipped.append(f"the model {uri!r}")

    def _place_model(self, model: _Model, outer: Scope, pose_outer: Pose3D, prefix: str) -> list[Solid]:
        path = "::".join(filter(None, (prefix, model.name)))
        pose = pose_outer @ outer.find(model.frame, None)
        if self.leave_out.takes_name(path):
            return []
        solids: list[Solid] = []
        if model.static or self.movable:
            for link_name, link in model.links:
                at = pose @ model.scope.find(link_name, None)
                shapes = children(link, self.geometry)
                alone = bool(model.name) and len(model.links) == 1 and len(shapes) == 1
                for shape in shapes:
                    name = path if alone else f"{path}/{link_name}/{shape.get('name') or self.geometry}"
                    solids += self._place_shape(model.scope, link, shape, pose, at, name)
        elif any(children(link, self.geometry) for _, link in model.links):
            self.moving.append(path)
        for inner in model.models:
            solids += self._place_model(inner, model.scope, pose, path)
        return solids

    def _place_shape(
        self, scope: Scope, link: XmlElement, shape: XmlElement, pose: Pose3D, at: Pose3D, name: str
    ) -> list[Solid]:
        if self.leave_out.takes_name(name):
            return []
        element = child(shape, "geometry")
        if element is None:
            scope.place.fail(shape, f"<{shape.tag}> needs <geometry>")
        try:
            found = read_geometry(scope.place, element, self.files)
        except MissingFileError:
            if self.missing == "error":
                raise
            found = "a missing mesh"
        if isinstance(found, str):
            self.skipped.append(f"{found} of {name!r}")
            return []
        given = read_pose(scope.place, shape)
        placed = pose @ scope.find(given.frame, given.element) @ given.pose if given.frame else at @ given.pose
        color = _color(link, shape)
        if child(element, "plane") is not None and self._keep_plane(name, found, placed, color):
            return []
        solids = make_solids(self.names, name, found, placed, color=color, kind="model")
        return [solid for solid in solids if not self.leave_out.takes_solid(solid)]

    def _keep_plane(self, name: str, plane: Sequence[Part], pose: Pose3D, color: Color | None) -> bool:
        """Keep a level <plane>, which may be the ground; return whether it was. A plane that collides is infinite."""
        (part,) = plane
        low, high = Solid(name, part.shape).bounds()
        area = ENDLESS if self.geometry == "collision" else float((high - low)[:2].prod())
        return self.planes.take(name, [part._replace(pose=Pose3D())], pose @ part.pose, area, color)


def _color(link: XmlElement, shape: XmlElement) -> Color | None:
    """Return the colour of a visual, or of a collision's visual: the one of the same name, else the link's first."""
    if shape.tag == "visual":
        return read_color(shape)
    visuals = children(link, "visual")
    same = [visual for visual in visuals if visual.get("name") == shape.get("name")]
    return next((color for color in map(read_color, [*same, *visuals]) if color is not None), None)


def _add_frame(place: Place, element: XmlElement, scope: Scope) -> None:
    pose = read_pose(place, element)
    attached = element.get("attached_to", "").strip()
    scope.add(read_name(place, element), pose if pose.frame else replace(pose, frame=attached), element)


def read_actor(place: Place, element: XmlElement) -> Mover | None:
    """Read an <actor> as a person who passes the waypoints of its trajectories, or None if it has none.

    As in Gazebo they are points of a Catmull-Rom spline with their times, and poses in the world; the actor's own pose
    is where it is without a script. Heights, roll and pitch are ignored, as are skins and animations.

    Raises:
        WorldError: If a waypoint lacks its time, or the times do not increase.
    """
    name = read_name(place, element)
    script = child(element, "script")
    waypoints = [
        waypoint
        for trajectory in (children(script, "trajectory") if script is not None else [])
        for waypoint in children(trajectory, "waypoint")
    ]
    if script is None or not waypoints:
        return None
    delay_element = child(script, "delay_start")
    delay = read_numbers(place, delay_element, 1)[0] if delay_element is not None else 0.0
    points: list[tuple[float, ...]] = []
    for waypoint in waypoints:
        time = child(waypoint, "time")
        if time is None:
            place.fail(waypoint, "a <waypoint> needs a <time>")
        pose = read_pose(place, waypoint).pose
        seconds = read_numbers(place, time, 1)[0]
        points.append((delay + seconds, pose.position[0], pose.position[1], pose.yaw()))
    repeat = "loop" if read_flag(place, script, "loop", default=True) else "once"
    try:
        return Mover(name, person_body(), Waypoints(tuple(points), "catmull_rom", repeat), "person")
    except WorldError as error:
        place.fail(script, f"the actor {name!r}: {error}")
