"""What SDF elements hold: numbers, names, poses, and frames that poses refer to.

Every mistake is reported with file, line and model. Frames: http://sdformat.org/tutorials?tut=pose_frame_semantics
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn, cast

from trundle.errors import WorldError
from trundle.files.xml_elements import XmlElement
from trundle.geometry import Pose3D

VERSIONS = tuple(f"1.{minor}" for minor in range(2, 13))
"""Supported versions of SDF."""

_NOT_LOOKED_AT = ("plugin", "gui", "scene", "physics", "light", "sensor", "actor", "state", "visual")
_HARMLESS_MACROS = ("xacro:arg", "xacro:property", "xacro:if", "xacro:unless")

FAR = 1e7
"""Larger numbers [m] are mistakes."""

MODEL_FRAME = "__model__"
WORLD_FRAME = "world"


@dataclass(frozen=True, slots=True)
class Place:
    """A location in a file, for messages.

    Attributes:
        file: The file.
        model: Name of the model; empty outside models.
    """

    file: Path
    model: str = ""

    def fail(self, element: XmlElement | None, message: str) -> NoReturn:
        """Raise a `WorldError` that names file, line and model."""
        line = "" if element is None else f":{element.line}"
        model = f" model {self.model!r}:" if self.model else ""
        raise WorldError(f"{self.file}{line}:{model} {message}")


@dataclass(frozen=True, slots=True)
class PoseIn:
    """A pose relative to a named frame.

    Attributes:
        frame: Name of the frame; empty means the default of the element.
        pose: The pose in that frame.
        element: Its element, or None if it was omitted.
    """

    frame: str = ""
    pose: Pose3D = Pose3D()
    element: XmlElement | None = None


def child(element: XmlElement, tag: str) -> XmlElement | None:
    """Return the first child of a tag."""
    return cast("XmlElement | None", element.find(tag))


def children(element: XmlElement, *tags: str) -> list[XmlElement]:
    """Return all children of some tags, in order."""
    return [cast("XmlElement", item) for item in element if item.tag in tags]


def read_version(place: Place, root: XmlElement) -> None:
    """Check that a root element is <sdf> of a supported version."""
    if root.tag != "sdf":
        place.fail(root, f"an SDF file must start with <sdf version=…>, got <{root.tag}>")
    version = root.get("version", "").strip()
    if version not in VERSIONS:
        what = f"SDF version {version!r} is not known" if version else "<sdf> has no version"
        place.fail(root, f"{what}; {VERSIONS[0]} to {VERSIONS[-1]} are supported")


def refuse_macros(place: Place, root: XmlElement) -> None:
    """Refuse xacro macros in the elements that are read; conditions on plugins and the like are ignored."""
    advice = f"expand the file first: xacro {place.file.name} > world.sdf"
    pending = [root]
    while pending:
        element = pending.pop()
        if element.tag.startswith("xacro:"):
            used = next((item for item in element.iter() if item.tag in ("model", "include")), None)
            if used is not None or element.tag not in _HARMLESS_MACROS:
                place.fail(element, f"<{element.tag}> is not supported; {advice}")
        elif element.tag not in _NOT_LOOKED_AT:
            texts = [element.text or "", *element.attrib.values()]
            if any("${" in text or "$(" in text for text in texts):
                place.fail(element, f"<{element.tag}> contains a xacro expression; {advice}")
            pending += list(reversed(cast("list[XmlElement]", list(element))))


def read_name(place: Place, element: XmlElement) -> str:
    """Return the name of an element."""
    name = element.get("name", "").strip()
    if not name:
        place.fail(element, f"<{element.tag}> has no name")
    return name


def read_text(place: Place, parent: XmlElement, tag: str) -> str:
    """Return the text of a required child."""
    element = child(parent, tag)
    text = "" if element is None else (element.text or "").strip()
    if not text:
        place.fail(element if element is not None else parent, f"<{parent.tag}> needs <{tag}>")
    return text


def read_flag(place: Place, parent: XmlElement, tag: str, *, default: bool) -> bool:
    """Return a boolean child."""
    element = child(parent, tag)
    if element is None:
        return default
    text = (element.text or "").strip().lower()
    if text not in ("1", "0", "true", "false"):
        place.fail(element, f"<{tag}> must be true or false, got {text!r}")
    return text in ("1", "true")


def read_attribute_flag(place: Place, element: XmlElement, name: str) -> bool:
    """Return a boolean attribute, false by default."""
    text = element.get(name, "false").strip().lower()
    if text not in ("1", "0", "true", "false"):
        place.fail(element, f"{name} of <{element.tag}> must be true or false, got {text!r}")
    return text in ("1", "true")


def read_numbers(place: Place, element: XmlElement, count: int, *, positive: bool = False) -> tuple[float, ...]:
    """Return the numbers in an element."""
    words = (element.text or "").split()
    try:
        numbers = tuple(float(word) for word in words)
    except ValueError:
        numbers = ()
    sound = len(numbers) == count and all(math.isfinite(number) and abs(number) <= FAR for number in numbers)
    if not sound or (positive and min(numbers) <= 0.0):
        what = "number" if count == 1 else f"{count} numbers"
        place.fail(
            element,
            f"<{element.tag}> must be {what}, finite{' and above 0' if positive else ''}, got {' '.join(words)[:80]!r}",
        )
    return numbers


def read_sizes(place: Place, parent: XmlElement, tag: str, count: int) -> tuple[float, ...]:
    """Return the positive numbers in a required child."""
    element = child(parent, tag)
    if element is None:
        place.fail(parent, f"<{parent.tag}> needs <{tag}>")
    return read_numbers(place, element, count, positive=True)


def read_pose(place: Place, parent: XmlElement) -> PoseIn:
    """Return the <pose> of an element: x y z roll pitch yaw, or with a quaternion (x y z w), in its named frame."""
    element = child(parent, "pose")
    if element is None:
        return PoseIn()
    frame = (element.get("relative_to") or element.get("frame") or "").strip()
    if not (element.text or "").strip():
        return PoseIn(frame, element=element)
    form = element.get("rotation_format", "euler_rpy").strip()
    if form not in ("euler_rpy", "quat_xyzw"):
        place.fail(element, f"rotation_format of <pose> must be euler_rpy or quat_xyzw, got {form!r}")
    if form == "quat_xyzw":
        x, y, z, qx, qy, qz, qw = read_numbers(place, element, 7)
        if not 0.5 < math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw) < 2.0:
            place.fail(element, f"<pose>: {qx:g} {qy:g} {qz:g} {qw:g} is not a unit quaternion (x y z w)")
        return PoseIn(frame, Pose3D((x, y, z), (qw, qx, qy, qz)), element)
    x, y, z, *angles = read_numbers(place, element, 6)
    if read_attribute_flag(place, element, "degrees"):
        angles = [math.radians(angle) for angle in angles]
    return PoseIn(frame, Pose3D.from_rpy((x, y, z), angles), element)


@dataclass(slots=True)
class Scope:
    """The frames of a world or a model, by name; poses in it are relative to its own frame.

    Attributes:
        place: For messages.
        own: Name of its own frame, `__model__` or `world`.
        frames: Pose of each named frame, as given.
        scopes: Scopes of its models, which are frames too.
        placement_frame: The frame of a model that its pose refers to; empty means its own.
        aliases: Full names of frames from models merged into this one, by their plain names.
    """

    place: Place
    own: str = MODEL_FRAME
    frames: dict[str, PoseIn] = field(default_factory=dict[str, PoseIn])
    scopes: dict[str, Scope] = field(default_factory=dict[str, "Scope"])
    placement_frame: str = ""
    aliases: dict[str, str] = field(default_factory=dict[str, str])
    _resolved: dict[str, Pose3D] = field(default_factory=dict[str, Pose3D])

    def add(self, name: str, pose: PoseIn, element: XmlElement) -> None:
        """Add a frame: a link, a joint, a model, or a <frame>."""
        self._check_new(name, element)
        self.frames[name] = pose

    def merge(self, model: str, scope: Scope, pose: PoseIn, element: XmlElement) -> str:
        """Add the frames of a merged model under their plain names; return the name of its own frame."""
        own = f"_merged__{model}__model__"
        self.add(own, pose, element)
        self.scopes[own] = scope
        for name in (*scope.frames, *scope.aliases):
            self._check_new(name, element)
            self.aliases[name] = f"{own}::{name}"
        return own

    def _check_new(self, name: str, element: XmlElement) -> None:
        if name in self.frames or name in self.aliases:
            self.place.fail(element, f"<{element.tag}>: there are two frames named {name!r}")

    def find(self, name: str, element: XmlElement | None, trail: tuple[str, ...] = ()) -> Pose3D:
        """Return the pose of a frame in this scope's own frame."""
        if name in ("", self.own):
            return Pose3D()
        if name in self._resolved:
            return self._resolved[name]
        outer, mark, inner = name.partition("::")
        if outer in self.aliases:
            return self.find(self.aliases[outer] + mark + inner, element, trail)
        if name in trail:
            self.place.fail(element, f"frames refer to each other in a cycle: {' -> '.join((*trail, name))}")
        given = self.frames.get(name)
        if given is not None:
            asker = element if given.element is None else given.element
            pose = self.find(given.frame, asker, (*trail, name)) @ given.pose
            if name in self.scopes:
                pose = pose @ self.scopes[name].placement().inverse()
            self._resolved[name] = pose
            return pose
        if not inner or outer not in self.scopes:
            known = ", ".join(sorted((*self.frames, *self.aliases))) or "none"
            self.place.fail(element, f"there is no frame {name!r} here; there are: {known}")
        return self.find(outer, element, trail) @ self.scopes[outer].find(inner, element)

    def placement(self) -> Pose3D:
        """Return the frame that this model's pose refers to, in the model's own frame."""
        return self.find(self.placement_frame, None)
