"""Where bodies are: what PhysX moves is moved in the stage, and what a script moves in the stage is moved in PhysX."""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterable
from typing import Any, Protocol

import numpy as np
from ovphysx.types import SimObjectType, TensorType  # pyright: ignore[reportMissingImports]
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics

_OPS = {
    "xformOp:translate": Sdf.ValueTypeNames.Double3, "xformOp:orient": Sdf.ValueTypeNames.Quatd,
    "xformOp:scale": Sdf.ValueTypeNames.Double3,
}  # fmt: skip
_ORDER = "xformOpOrder"
_SAME = 1e-6
"""Transforms whose numbers differ by less are the same."""

Kept = dict[str, dict[str, tuple[bool, Any]]]
"""Of each body and each of its attributes: whether the root layer had it, and its value there."""


class Physics(Protocol):
    """What is asked of PhysX."""

    def bind(self, paths: list[str], kind: int) -> Any:
        """Return its own view of one quantity of prims."""
        ...

    def set(self, kind: int, quantity: str, values: dict[str, Any]) -> None:
        """Set one quantity of objects, by their paths."""
        ...


class Poses:
    """The bodies of a stage that PhysX simulates.

    Their poses are written to the stage's root layer, where a script writes as well: what it sets after that holds.

    Args:
        stage: The stage.
        bodies: Paths of the bodies that can move.
        links: Bodies that are links of articulations.
        roots: The root link of each articulation, and the path by which PhysX knows the articulation.
        physics: PhysX.
        kept: What the root layer had of bodies before; it is added to.

    Attributes:
        writing: Whether it is changing the stage itself.
    """

    def __init__(
        self, stage: Usd.Stage, bodies: list[str], *, links: Collection[str], roots: dict[str, str],
        physics: Physics, kept: Kept,
    ) -> None:  # fmt: skip
        self._stage, self._links, self._roots, self._physics, self._kept = stage, links, roots, physics, kept
        self._frames = {path: _Frame(stage, path, bodies) for path in bodies}
        self._colliders = dict(self._fixed(stage.GetPseudoRoot()))
        self._poses = physics.bind(bodies, TensorType.RIGID_BODY_POSE) if bodies else None
        self._told: set[str] = set()
        self.writing = False

    def write(self, only: Iterable[str] | None = None, leave: Collection[Sdf.Path] = ()) -> dict[str, Gf.Matrix4d]:
        """Write poses to the stage, as Kit does once a frame.

        Args:
            only: Paths of bodies. If None, all.
            leave: Attributes to leave as they are.

        Returns:
            The poses of all bodies, by path.
        """
        world = self._read()
        layer = self._stage.GetRootLayer()
        self.writing = True
        try:
            with Sdf.ChangeBlock():
                for path in world if only is None else only:
                    if path in world and self._stage.GetPrimAtPath(path):
                        self._write(layer, path, world, leave)
        finally:
            self.writing = False
        return world

    def _read(self) -> dict[str, Gf.Matrix4d]:
        if self._poses is None:
            return {}
        poses = np.zeros(self._poses.shape, np.float32)
        self._poses.read(poses)
        return dict(zip(self._poses.prim_paths, [_matrix(pose) for pose in poses], strict=True))

    def _write(self, layer: Sdf.Layer, path: str, world: dict[str, Gf.Matrix4d], leave: Collection[Sdf.Path]) -> None:
        frame = self._frames[path]
        if path not in self._kept:
            specs = {name: layer.GetAttributeAtPath(f"{path}.{name}") for name in (*_OPS, _ORDER)}
            self._kept[path] = {name: (spec is not None, spec and spec.default) for name, spec in specs.items()}
        local = world[path] * (frame.between * world.get(frame.above, Gf.Matrix4d(1.0))).GetInverse()
        turned = local.RemoveScaleShear().ExtractRotationQuat()
        prim = Sdf.CreatePrimInLayer(layer, path)
        for (name, kind), value in zip(
            frame.kinds.items(), (local.ExtractTranslation(), turned, frame.scale), strict=True
        ):
            if prim.path.AppendProperty(name) not in leave:
                spec = prim.attributes.get(name) or Sdf.AttributeSpec(prim, name, kind)
                spec.default = spec.typeName.type.pythonClass(value)
        if prim.path.AppendProperty(_ORDER) not in leave:
            order = prim.attributes.get(_ORDER) or Sdf.AttributeSpec(
                prim, _ORDER, Sdf.ValueTypeNames.TokenArray, Sdf.VariabilityUniform
            )
            order.default = list(_OPS)

    def follow(self, changed: Collection[Sdf.Path]) -> bool:
        """Put bodies where they are in the stage now, after these attributes of transforms were changed.

        Returns:
            Whether a collider was moved that is fixed to the world or to its body: PhysX has to be given the stage
            again.
        """
        tops = Sdf.Path.RemoveDescendentPaths(sorted({path.GetPrimPath() for path in changed}))
        moved = [path for path in self._frames if any(Sdf.Path(path).HasPrefix(top) for top in tops)]
        before = self.write(moved, changed) if moved else {}
        for path in moved:
            prim = self._stage.GetPrimAtPath(path)
            if prim and path in before:
                self._frames[path] = _Frame(self._stage, path, self._frames)
                now = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(0).RemoveScaleShear()
                self._put(path, now, before[path], moved)
        return any(
            path not in self._colliders or not Gf.IsClose(now, self._colliders[path], _SAME)
            for top in tops if (prim := self._stage.GetPrimAtPath(top))
            for path, now in self._fixed(prim)
        )  # fmt: skip

    def _put(self, path: str, pose: Gf.Matrix4d, before: Gf.Matrix4d, moved: list[str]) -> None:
        """Put a body somewhere; its velocity stays as it is. Links follow the root of their articulation."""
        turned = pose.ExtractRotationQuat()
        position, quaternion = [*pose.ExtractTranslation()], [*turned.GetImaginary(), turned.GetReal()]
        if UsdPhysics.RigidBodyAPI(self._stage.GetPrimAtPath(path)).GetKinematicEnabledAttr().Get():
            # It gets there in the next step, and pushes what is in its way.
            self._physics.set(SimObjectType.RIGID_BODY, "kinematicTargetPosition", {path: position})
            self._physics.set(SimObjectType.RIGID_BODY, "kinematicTargetOrientation", {path: quaternion})
        elif Gf.IsClose(pose, before, _SAME):
            return
        elif path in self._roots or path not in self._links:
            kind = TensorType.ARTICULATION_ROOT_POSE if path in self._roots else TensorType.RIGID_BODY_POSE
            binding = self._physics.bind([self._roots.get(path, path)], kind)
            binding.write(np.array([[*position, *quaternion]], np.float32))
            binding.destroy()
        elif path not in self._told and self._roots.keys().isdisjoint(moved):
            self._told.add(path)
            print(f"[warn] {path} is a link of an articulation: while it plays only joints move it", file=sys.stderr)

    def _fixed(self, top: Usd.Prim) -> Iterable[tuple[str, Gf.Matrix4d]]:
        """Colliders of a subtree, and their transforms to the body that they are part of, or to the world."""
        cache = UsdGeom.XformCache()
        for prim in Usd.PrimRange(top, Usd.TraverseInstanceProxies()):
            if prim.HasAPI(UsdPhysics.CollisionAPI):
                body = _above(prim.GetPath(), self._frames)
                transform = cache.GetLocalToWorldTransform(prim)
                if body:
                    above = cache.GetLocalToWorldTransform(self._stage.GetPrimAtPath(body))
                    transform *= above.RemoveScaleShear().GetInverse()
                yield str(prim.GetPath()), transform


class _Frame:
    """What a body's pose is written in: the nearest body above it, the transform from its parent to that, its scale."""

    def __init__(self, stage: Usd.Stage, path: str, bodies: Collection[str]) -> None:
        prim = stage.GetPrimAtPath(path)
        parent = prim.GetParent()
        self.above = _above(parent.GetPath(), bodies)
        self.between = Gf.Matrix4d(1.0)
        if parent.IsA(UsdGeom.Xformable):
            self.between = UsdGeom.Xformable(parent).ComputeLocalToWorldTransform(0)
        if self.above:
            above = UsdGeom.Xformable(stage.GetPrimAtPath(self.above)).ComputeLocalToWorldTransform(0)
            self.between *= above.RemoveScaleShear().GetInverse()
        local = UsdGeom.Xformable(prim).GetLocalTransformation()
        self.scale = Gf.Vec3d(*(local.GetRow3(axis).GetLength() for axis in range(3)))
        given = {name: prim.GetAttribute(name) for name in _OPS}
        # As they are: a script that has set a Quatf will do so again.
        self.kinds = {name: given[name].GetTypeName() if given[name] else kind for name, kind in _OPS.items()}


def restore(stage: Usd.Stage, kept: Kept) -> None:
    """Give bodies the transforms again that the root layer had before; `kept` is empty then."""
    layer = stage.GetRootLayer()
    with Sdf.ChangeBlock():
        for path, attributes in kept.items():
            prim = layer.GetPrimAtPath(path)
            for name, (was_there, value) in attributes.items() if prim else ():
                spec = prim.attributes.get(name)
                if spec is None:
                    continue
                if not was_there:
                    prim.RemoveProperty(spec)
                elif value is None:
                    spec.ClearDefaultValue()
                else:
                    spec.default = value
            if prim:
                layer.ScheduleRemoveIfInert(prim)
    kept.clear()


def _above(path: Sdf.Path, bodies: Collection[str]) -> str:
    """Return the nearest body at a path or above it; empty if there is none."""
    return next((name for name in map(str, path.GetPrefixes()[::-1]) if name in bodies), "")


def _matrix(pose: Any) -> Gf.Matrix4d:
    x, y, z, qx, qy, qz, qw = map(float, pose)
    matrix = Gf.Matrix4d().SetRotate(Gf.Quatd(qw, qx, qy, qz))
    return matrix.SetTranslateOnly(Gf.Vec3d(x, y, z))
