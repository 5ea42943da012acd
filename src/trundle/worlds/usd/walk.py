"""Walking a USD stage: every geometric prim with its place, through instances and point instancers."""

from __future__ import annotations

import fnmatch
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from pxr import Tf, Usd, UsdGeom, UsdPhysics

from trundle.errors import WorldError
from trundle.geometry import FloatArray

TIME = Usd.TimeCode.EarliestTime()
"""When attributes are read: what is not animated has one value, and what is counts as it stands at its start."""

SHAPES = ("Mesh", "Cube", "Sphere", "Cylinder", "Cylinder_1", "Cone", "Capsule", "Capsule_1", "Plane")
"""The types of prims that become solids."""


@dataclass(frozen=True, slots=True)
class Place:
    """A prim at one of its places, and what it has from the prims above it.

    Attributes:
        prim: The prim.
        name: Its path; within a point instancer with the number of the instance.
        matrix: From its own frame to the map frame [m], acting on columns, shape (4, 4).
        visible: Whether it and all above it are visible.
        purpose: `default`, `render`, `proxy` or `guide`.
        approximation: Of its collider, as UsdPhysics names it; none where it is no collider.
        label: Semantic label of the nearest prim that has one, or "".
        within: Paths of the point instancers around it, outermost first.
    """

    prim: Any
    name: str
    matrix: FloatArray
    visible: bool = True
    purpose: str = ""
    approximation: str | None = None
    label: str = ""
    within: tuple[str, ...] = ()


@dataclass(slots=True)
class Filter:
    """What is left out, by prim path or semantic label; remembers what it met.

    Attributes:
        paths: Paths with everything below them, also with `*` and `?`.
        labels: Semantic labels in lower case.
        met: Those of both that something was left out by.
    """

    paths: tuple[str, ...]
    labels: frozenset[str]
    met: set[str] = field(default_factory=set)

    @classmethod
    def of(cls, words: Sequence[str]) -> Filter:
        """Sort what a user wrote: what starts with a slash is a path."""
        paths = tuple(word.rstrip("/") or "/" for word in words if word.startswith("/"))
        return cls(paths, frozenset(word.lower() for word in words if not word.startswith("/")))

    def takes_path(self, path: str) -> bool:
        """Whether a path, or one above it, is left out."""
        for pattern in self.paths:
            if "*" in pattern or "?" in pattern:
                hit = fnmatch.fnmatchcase(path, pattern) or fnmatch.fnmatchcase(path, f"{pattern}/*")
            else:
                hit = path == pattern or (path.startswith(pattern) and path[len(pattern)] in "/[")
            if hit:
                self.met.add(pattern)
                return True
        return False

    def takes_label(self, label: str) -> bool:
        """Whether a label is left out."""
        if label.lower() in self.labels:
            self.met.add(label.lower())
            return True
        return False

    @property
    def unmet(self) -> list[str]:
        """What nothing was left out by, in the order of writing."""
        return [word for word in (*self.paths, *sorted(self.labels)) if word not in self.met]


def walk(path: str, stage: Any, root: FloatArray, leave_out: Filter) -> Iterator[Place]:
    """Give all geometric prims of a stage, whether they are seen, collide or neither.

    Args:
        path: The file, for messages.
        stage: The stage.
        root: From the stage's frame to the map frame, shape (4, 4).
        leave_out: What not to walk into.

    Raises:
        WorldError: If a transform is not finite, or a point instancer does not fit together.
    """
    predicate = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
    # Last in, first out: in the file's order.
    stack = [Place(prim, str(prim.GetPath()), root) for prim in _children(stage.GetPseudoRoot(), predicate)]
    while stack:
        place = _arrive(path, stack.pop(), root, leave_out)
        if place is None:
            continue
        prim = place.prim
        if prim.IsA(UsdGeom.PointInstancer):
            stack.extend(reversed(_instances(path, stage, place, leave_out)))
            continue
        if prim.IsA(UsdGeom.Gprim):
            yield place
        stack.extend(
            replace(place, prim=child, name=f"{place.name}/{child.GetName()}") for child in _children(prim, predicate)
        )


def _children(prim: Any, predicate: Any) -> list[Any]:
    """Children, last first, as a stack takes them."""
    return list(reversed(prim.GetFilteredChildren(predicate)))


def _arrive(path: str, place: Place, root: FloatArray, leave_out: Filter) -> Place | None:
    """Take a prim's own transform, visibility, purpose, collider and label on top of what is above it."""
    prim = place.prim
    if leave_out.takes_path(place.name) or leave_out.takes_path(str(prim.GetPath())):
        return None
    label = semantic_label(prim) or place.label
    if label and leave_out.takes_label(label):
        return None
    matrix = place.matrix
    if prim.IsA(UsdGeom.Xformable):
        xformable = UsdGeom.Xformable(prim)
        local = np.array(xformable.GetLocalTransformation(TIME)).T
        if not np.isfinite(local).all():
            raise WorldError(f"{path}: {place.name}: its transform is not finite")
        matrix = (root if xformable.GetResetXformStack() else matrix) @ local
    visible, purpose = place.visible, place.purpose
    if prim.IsA(UsdGeom.Imageable):
        imageable = UsdGeom.Imageable(prim)
        visible = visible and imageable.GetVisibilityAttr().Get(TIME) != UsdGeom.Tokens.invisible
        if imageable.GetPurposeAttr().HasAuthoredValue():
            purpose = str(imageable.GetPurposeAttr().Get())
    return replace(
        place,
        matrix=matrix,
        visible=visible,
        purpose=purpose or "default",
        approximation=_approximation(prim, place.approximation),
        label=label,
    )


def _approximation(prim: Any, above: str | None) -> str | None:
    """A collider's approximation; colliders on a group hold for what is in it."""
    if not prim.HasAPI(UsdPhysics.CollisionAPI):
        return above
    if UsdPhysics.CollisionAPI(prim).GetCollisionEnabledAttr().Get(TIME) is False:
        return None
    if prim.HasAPI(UsdPhysics.MeshCollisionAPI):
        return str(UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Get())
    return "none"


def semantic_label(prim: Any) -> str:
    """The first semantic label of a prim: of UsdSemantics, or in the older form of Isaac Sim; "" where it has none."""
    # Not prim.GetAppliedSchemas(), which leaves out what this build of USD does not know.
    for schema in prim.GetPrimTypeInfo().GetAppliedAPISchemas():
        kind, _, instance = schema.partition(":")
        if kind == "SemanticsLabelsAPI":
            labels = prim.GetAttribute(f"semantics:labels:{instance}").Get(TIME)
            if labels:
                return str(labels[0])
        elif kind == "SemanticsAPI":
            value = prim.GetAttribute(f"semantic:{instance}:params:semanticData").Get(TIME)
            if value:
                return str(value)
    return ""


def _instances(path: str, stage: Any, place: Place, leave_out: Filter) -> list[Place]:
    """The prototypes of a point instancer, once for every instance, each to be placed like a child of the instancer."""
    name, prim = place.name, place.prim
    within = (*place.within, str(prim.GetPath()))
    if len(set(within)) < len(within):
        raise WorldError(f"{path}: {name}: a point instancer that is a prototype of itself")
    instancer = UsdGeom.PointInstancer(prim)
    targets = instancer.GetPrototypesRel().GetForwardedTargets()
    prototypes = [stage.GetPrimAtPath(target) for target in targets]
    numbers = instancer.GetProtoIndicesAttr().Get(TIME)
    if numbers is None or len(numbers) == 0:
        return []
    try:
        transforms = instancer.ComputeInstanceTransformsAtTime(
            TIME, TIME, UsdGeom.PointInstancer.ExcludeProtoXform, UsdGeom.PointInstancer.IgnoreMask
        )
    except Tf.ErrorException:
        transforms = []
    if len(transforms) != len(numbers):
        raise WorldError(f"{path}: {name}: its positions, orientations or scales are not as many as its protoIndices")
    mask = instancer.ComputeMaskAtTime(TIME)
    # A prototype that is not drawn where it stands is drawn where it is placed.
    fresh = replace(place, within=within)
    places: list[Place] = []
    for index, (number, transform) in enumerate(zip(numbers, transforms, strict=True)):
        if len(mask) and not mask[index]:
            continue
        if not 0 <= number < len(prototypes) or not prototypes[number]:
            raise WorldError(f"{path}: {name}: instance {index} is of prototype {number}, which is not there")
        prototype = prototypes[number]
        local = np.array(transform).T
        if not np.isfinite(local).all():
            raise WorldError(f"{path}: {name}: the transform of instance {index} is not finite")
        places.append(
            replace(
                fresh,
                prim=prototype,
                name=f"{name}[{index}]/{prototype.GetName()}",
                matrix=place.matrix @ local,
            )
        )
    return [item for item in places if not leave_out.takes_path(item.name)]
