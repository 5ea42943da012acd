"""Frames of SDF: resolving poses relative to other frames in a world and its nested models.

http://sdformat.org/tutorials?tut=pose_frame_semantics
"""

from __future__ import annotations

from dataclasses import dataclass, field

from trundle.files.xml_elements import XmlElement
from trundle.geometry import Pose3D
from trundle.worlds.gazebo.values import Place, PoseIn

MODEL_FRAME = "__model__"
WORLD_FRAME = "world"


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

    def locate(self, given: PoseIn, default: str = "") -> Pose3D:
        """The given pose in this scope's own frame; `default` names its frame if the pose names none."""
        return self.find(given.frame or default, given.element) @ given.pose

    def find(self, name: str, element: XmlElement | None, trail: tuple[str, ...] = ()) -> Pose3D:
        """The pose of a frame in this scope's own frame."""
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
        """The frame that this model's pose refers to, in the model's own frame."""
        return self.find(self.placement_frame, None)
