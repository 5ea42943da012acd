"""Stands in for omni.physics.tensors: views of articulations and bodies, on PhysX's own views of one quantity."""

from __future__ import annotations

import enum
import importlib
import types
from collections.abc import Callable
from typing import Any

import numpy as np
from ovphysx.types import TensorType  # pyright: ignore[reportMissingImports]
from pxr import Usd, UsdPhysics

from trundle.testing.isaac.physics import Engine
from trundle.testing.isaac.stage import Context


class DofType(enum.IntEnum):
    """omni.physics.tensors.DofType."""

    Rotation = 0
    Translation = 1
    Invalid = 255


class JointType(enum.IntEnum):
    """omni.physics.tensors.JointType."""

    Fixed = 0
    Revolute = 1
    Prismatic = 2
    Spherical = 3
    Invalid = 255


_ARTICULATION = {
    "root_transforms": "ROOT_POSE", "root_velocities": "ROOT_VELOCITY", "link_transforms": "LINK_POSE",
    "link_velocities": "LINK_VELOCITY", "link_accelerations": "LINK_ACCELERATION", "dof_positions": "DOF_POSITION",
    "dof_velocities": "DOF_VELOCITY", "dof_position_targets": "DOF_POSITION_TARGET",
    "dof_velocity_targets": "DOF_VELOCITY_TARGET", "dof_actuation_forces": "DOF_ACTUATION_FORCE",
    "dof_stiffnesses": "DOF_STIFFNESS", "dof_dampings": "DOF_DAMPING", "dof_limits": "DOF_LIMIT",
    "dof_max_velocities": "DOF_MAX_VELOCITY", "dof_max_forces": "DOF_MAX_FORCE", "dof_armatures": "DOF_ARMATURE",
    "dof_friction_properties": "DOF_FRICTION_PROPERTIES", "dof_drive_model_properties": "DOF_DRIVE_MODEL",
    "drive_types": "DOF_DRIVE_TYPE", "masses": "BODY_MASS", "coms": "BODY_COM_POSE", "inertias": "BODY_INERTIA",
    "inv_masses": "BODY_INV_MASS", "inv_inertias": "BODY_INV_INERTIA", "disable_gravities": "BODY_DISABLE_GRAVITY",
    "jacobians": "JACOBIAN", "generalized_mass_matrices": "MASS_MATRIX",
    "coriolis_and_centrifugal_compensation_forces": "CORIOLIS_AND_CENTRIFUGAL_FORCE",
    "gravity_compensation_forces": "GRAVITY_FORCE", "link_incoming_joint_force": "LINK_INCOMING_JOINT_FORCE",
    "dof_projected_joint_forces": "DOF_PROJECTED_JOINT_FORCE", "material_properties": "SHAPE_FRICTION_AND_RESTITUTION",
    "contact_offsets": "CONTACT_OFFSET", "rest_offsets": "REST_OFFSET",
}  # fmt: skip
_BODY = {
    "transforms": "POSE", "velocities": "VELOCITY", "accelerations": "ACCELERATION", "masses": "MASS",
    "inertias": "INERTIA", "coms": "COM_POSE", "inv_masses": "INV_MASS", "inv_inertias": "INV_INERTIA",
    "disable_simulations": "DISABLE_SIMULATION", "disable_gravities": "DISABLE_GRAVITY",
    "material_properties": "SHAPE_FRICTION_AND_RESTITUTION", "contact_offsets": "CONTACT_OFFSET",
    "rest_offsets": "REST_OFFSET",
}  # fmt: skip
"""Quantities by the names of omni.physics.tensors' methods, after `get_` or `set_`, and those of ovphysx."""


class View:
    """Quantities of prims, read and written as arrays.

    Args:
        engine: PhysX.
        stage: Gives the stage.
        paths: Paths of the prims.
        prefix: That of ovphysx's names.
        names: ovphysx's name of each quantity.
        convert: Makes the frontend's array of a NumPy array.
    """

    _backend = "physx"
    max_fixed_tendons = 0
    is_homogeneous = True

    def __init__(
        self, engine: Engine, stage: Context, paths: list[str], prefix: str, names: dict[str, str],
        convert: Callable[[np.ndarray], Any],
    ) -> None:  # fmt: skip
        self._engine, self._stage, self._prefix, self._names, self._convert = engine, stage, prefix, names, convert
        self.prim_paths, self.count = paths, len(paths)
        self._bindings: dict[str, Any] = {}
        self._run = engine.runs

    def check(self) -> bool:
        """Return whether all of the prims are there."""
        return self._engine.loaded

    def binding(self, quantity: str) -> Any:
        """Return PhysX's view of a quantity."""
        if self._run != self._engine.runs:
            self._bindings, self._run = {}, self._engine.runs
        if quantity not in self._bindings:
            kind = TensorType[f"{self._prefix}_{self._names[quantity]}"]
            self._bindings[quantity] = self._engine.bind(self.prim_paths, kind)
        return self._bindings[quantity]

    def get(self, quantity: str) -> Any:
        """Read a quantity."""
        self._engine.flush()
        binding = self.binding(quantity)
        values = np.zeros(binding.shape, np.dtype(str(binding.dtype)))
        binding.read(values)
        return self._convert(values)

    def set(self, quantity: str, data: Any, indices: Any = None) -> bool:
        """Write a quantity for the prims of these indices."""
        self._engine.flush()
        binding = self.binding(quantity)
        values = np.ascontiguousarray(to_numpy(data), np.dtype(str(binding.dtype))).reshape(binding.shape)
        chosen = None if indices is None else np.ascontiguousarray(to_numpy(indices), np.int32)
        binding.write(values, indices=chosen)
        paths = self.prim_paths if chosen is None else [self.prim_paths[index] for index in chosen]
        self._engine.keep(paths, TensorType[f"{self._prefix}_{self._names[quantity]}"])
        return True

    def apply_forces(self, data: Any, indices: Any, is_global: bool = True) -> bool:
        """Push the centres of mass with these forces [N] during the next step."""
        binding = self._engine.bind(self.prim_paths, TensorType.RIGID_BODY_FORCE)
        binding.write(np.ascontiguousarray(to_numpy(data), np.float32).reshape(binding.shape))
        return True

    @property
    def max_shapes(self) -> int:
        """Number of colliders of a prim."""
        return int(self.binding("contact_offsets").shape[1])

    def __getattr__(self, name: str) -> Callable[..., Any]:
        verb, _, quantity = name.partition("_")
        if verb in ("get", "set") and quantity in self._names:
            return lambda *arguments: getattr(self, verb)(quantity, *arguments)
        raise AttributeError(f"{name} of omni.physics.tensors is not there without Isaac Sim")


class ArticulationView(View):
    """omni.physics.tensors.ArticulationView."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        binding = self.binding("dof_positions")
        dofs, links, joints = list(binding.dof_names), list(binding.body_names), list(binding.joint_names)
        self.max_dofs, self.max_links = len(dofs), len(links)
        prims = [self._parts(path) for path in self.prim_paths]
        self.dof_paths = [[str(found[name].GetPath()) for name in dofs] for found in prims]
        self.link_paths = [[str(found[name].GetPath()) for name in links] for found in prims]
        kinds = [_joint_type(prims[0].get(name)) for name in joints]
        dof_kinds = [
            DofType.Translation if _joint_type(prims[0][name]) is JointType.Prismatic else DofType.Rotation
            for name in dofs
        ]
        self.shared_metatype = types.SimpleNamespace(
            link_names=links, link_count=len(links), link_indices=_numbered(links),
            joint_names=joints, joint_count=len(joints), joint_indices=_numbered(joints), joint_types=kinds,
            dof_names=dofs, dof_count=len(dofs), dof_indices=_numbered(dofs), dof_types=dof_kinds,
        )  # fmt: skip

    @property
    def jacobian_shape(self) -> tuple[int, ...]:
        """Shape of a Jacobian."""
        return tuple(self.binding("jacobians").shape[1:])

    @property
    def generalized_mass_matrix_shape(self) -> tuple[int, ...]:
        """Shape of a mass matrix."""
        return tuple(self.binding("generalized_mass_matrices").shape[1:])

    def _parts(self, root: str) -> dict[str, Usd.Prim]:
        """Return bodies and joints of the articulation by name, in the tree that its root or a parent of it spans."""
        prim = self._stage.stage.GetPrimAtPath(root)
        if prim.HasAPI(UsdPhysics.RigidBodyAPI) or prim.IsA(UsdPhysics.Joint):
            prim = prim.GetParent()
        found: dict[str, Usd.Prim] = {}
        wanted = {*self.binding("dof_positions").joint_names, *self.binding("dof_positions").body_names}
        while prim and not wanted <= found.keys():
            for part in Usd.PrimRange(prim):
                if part.HasAPI(UsdPhysics.RigidBodyAPI) or part.IsA(UsdPhysics.Joint):
                    found.setdefault(part.GetName(), part)
            prim = prim.GetParent()
        return found


class SimulationView:
    """omni.physics.tensors.SimulationView.

    Args:
        frontend: `numpy` or `warp`: the kind of arrays.
    """

    def __init__(self, engine: Engine, stage: Context, frontend: str) -> None:
        self._engine, self._stage, self._convert = engine, stage, _frontend(frontend)
        self.is_valid = True

    def invalidate(self) -> None:
        """End it."""
        self.is_valid = False

    def set_subspace_roots(self, _: str) -> bool:
        """Take positions in the world's frame; there is no other here."""
        return True

    def update_articulations_kinematic(self) -> bool:
        """Update the links' poses; PhysX on the CPU does so by itself."""
        return True

    def create_articulation_view(self, pattern: str | list[str]) -> ArticulationView | None:
        """Return a view of articulations; None if there is none."""
        return self._create(ArticulationView, pattern, "ARTICULATION", _ARTICULATION, UsdPhysics.ArticulationRootAPI)

    def create_rigid_body_view(self, pattern: str | list[str]) -> View | None:
        """Return a view of rigid bodies; None if there is none."""
        return self._create(View, pattern, "RIGID_BODY", _BODY, UsdPhysics.RigidBodyAPI)

    def _create(
        self, kind: type[Any], pattern: str | list[str], prefix: str, names: dict[str, str], api: type[Any]
    ) -> Any:
        self._engine.load()
        self._engine.flush()
        patterns = [pattern] if isinstance(pattern, str) else list(pattern)
        paths = [path for one in patterns for path in self._stage.match(one)]
        stage = self._stage.stage
        paths = [path for path in paths if stage.GetPrimAtPath(path).HasAPI(api)]
        return kind(self._engine, self._stage, paths, prefix, names, self._convert) if paths else None


def modules(engine: Engine, stage: Context) -> dict[str, dict[str, object]]:
    """Return the members of the modules that this file stands in for."""

    def create_simulation_view(frontend: str, stage_id: int = -1, backend: str = "physx") -> SimulationView:
        return SimulationView(engine, stage, frontend)

    members: dict[str, object] = {
        "create_simulation_view": create_simulation_view, "DofType": DofType, "JointType": JointType,
        "SimulationView": SimulationView, "ArticulationView": ArticulationView, "RigidBodyView": View,
    }  # fmt: skip
    return {"omni.physics.tensors": members, "omni.physics.tensors.api": members}


def to_numpy(data: Any) -> np.ndarray:
    """Return an array of Warp or NumPy as NumPy's."""
    return data.numpy() if hasattr(data, "numpy") else np.asarray(data)


def _frontend(name: str) -> Callable[[np.ndarray], Any]:
    if name == "numpy":
        return lambda values: values
    warp: Any = importlib.import_module("warp")
    kinds = {"f": warp.float32, "u": warp.uint8, "i": warp.int32}
    return lambda values: warp.array(values, dtype=kinds[values.dtype.kind], device="cpu")


def _numbered(names: list[str]) -> dict[str, int]:
    return {name: number for number, name in enumerate(names)}


def _joint_type(prim: Usd.Prim | None) -> JointType:
    for schema, kind in (
        (UsdPhysics.RevoluteJoint, JointType.Revolute), (UsdPhysics.PrismaticJoint, JointType.Prismatic),
        (UsdPhysics.SphericalJoint, JointType.Spherical), (UsdPhysics.FixedJoint, JointType.Fixed),
    ):  # fmt: skip
        if prim and prim.IsA(schema):
            return kind
    return JointType.Invalid
