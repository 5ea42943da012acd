"""Traversing a USD stage: every geometric prim with its transform, through instances and point instancers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pxr import Tf, Usd, UsdGeom, UsdPhysics

from trundle.errors import WorldError
from trundle.geometry import FloatArray
from trundle.worlds.leave_out import Filter

TIME = Usd.TimeCode.EarliestTime()
"""Time at which attributes are read: animated ones take the value at their start."""

SHAPES = ("Mesh", "Cube", "Sphere", "Cylinder", "Cylinder_1", "Cone", "Capsule", "Capsule_1", "Plane")
"""The types of prims that become solids."""


@dataclass(frozen=True, slots=True)
class Place:
    """One occurrence of a prim, with the properties inherited from the prims above it.

    Attributes:
        prim: The prim.
        name: Its path; inside a point instancer with the number of the instance.
        matrix: From its own frame to the map frame [m], acting on columns, shape (4, 4).
        visible: Whether it and all above it are visible.
        purpose: `default`, `render`, `proxy` or `guide`.
        approximation: Its collider's approximation in UsdPhysics; None if it is not a collider.
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


def walk(path: str, stage: Any, root: FloatArray, leave_out: Filter) -> Iterator[Place]:
    """Yield all geometric prims of a stage, whether visible, colliding or neither.

    Args:
        path: The file, for messages.
        stage: The stage.
        root: From the stage's frame to the map frame, shape (4, 4).
        leave_out: What to skip.

    Raises:
        WorldError: If a transform is not finite, or a point instancer is inconsistent.
    """
    predicate = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
    # Prototypes of a point instancer may be in a class or an over, so that they are drawn nowhere else.
    kept = Usd.PrimIsActive & Usd.PrimIsLoaded & Usd.PrimHasDefiningSpecifier
    prototypes = Usd.TraverseInstanceProxies(kept)
    # Last in, first out: this keeps the file's order.
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
        below = _children(prim, prototypes if place.within else predicate)
        stack.extend(replace(place, prim=child, name=f"{place.name}/{child.GetName()}") for child in below)


def _children(prim: Any, predicate: Any) -> list[Any]:
    """Return children in reverse order, for a stack."""
    return list(reversed(prim.GetFilteredChildren(predicate)))


def _arrive(path: str, place: Place, root: FloatArray, leave_out: Filter) -> Place | None:
    """Combine a prim's own transform, visibility, purpose, collider and label with those inherited."""
    prim = place.prim
    if leave_out.takes_name(place.name) or leave_out.takes_name(str(prim.GetPath())):
        return None
    labels = semantic_labels(prim)
    if any(leave_out.takes_kind(label) for label in labels):
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
        label=labels[0] if labels else place.label,
    )


def _approximation(prim: Any, above: str | None) -> str | None:
    """Return a collider's approximation; a collider on a group applies to its members."""
    if not prim.HasAPI(UsdPhysics.CollisionAPI):
        return above
    if UsdPhysics.CollisionAPI(prim).GetCollisionEnabledAttr().Get(TIME) is False:
        return None
    if prim.HasAPI(UsdPhysics.MeshCollisionAPI):
        return str(UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Get())
    return "none"


def semantic_labels(prim: Any) -> list[str]:
    """Return the semantic labels of a prim itself: of UsdSemantics, or in the older form of Isaac Sim."""
    found: list[str] = []
    # Not prim.GetAppliedSchemas(), which omits schemas unknown to this build of USD.
    for schema in prim.GetPrimTypeInfo().GetAppliedAPISchemas():
        kind, _, instance = schema.partition(":")
        if kind == "SemanticsLabelsAPI":
            found += map(str, prim.GetAttribute(f"semantics:labels:{instance}").Get(TIME) or ())
        elif kind == "SemanticsAPI":
            value = prim.GetAttribute(f"semantic:{instance}:params:semanticData").Get(TIME)
            found += [str(value)] if value else []
    return found


def _instances(path: str, stage: Any, place: Place, leave_out: Filter) -> list[Place]:
    """Return a point instancer's prototypes, once for every instance, to be placed like children of the instancer."""
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
        raise WorldError(f"{path}: {name}: it needs one position, orientation and scale for each of its protoIndices")
    mask = instancer.ComputeMaskAtTime(TIME)
    # A prototype that is invisible in place is still drawn by its instances.
    fresh = replace(place, within=within)
    places: list[Place] = []
    for index, (number, transform) in enumerate(zip(numbers, transforms, strict=True)):
        if len(mask) and not mask[index]:
            continue
        if not 0 <= number < len(prototypes) or not prototypes[number]:
            raise WorldError(f"{path}: {name}: instance {index} refers to prototype {number}, which does not exist")
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
    return [item for item in places if not leave_out.takes_name(item.name)]
