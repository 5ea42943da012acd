"""A robot as a USD stage, with the bodies, joints and colliders of its simulation model."""

from __future__ import annotations

import math
from typing import Any

import mujoco
import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdPhysics

from trundle.errors import OutputError
from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Mesh
from trundle.robots import Robot
from trundle.sim.mujoco.model import robot_spec
from trundle.sim.mujoco.robot_parts import BASE, GROUP_COLLIDERS
from trundle.sim.mujoco.world_parts import SOLIDS_TYPE
from trundle.usd.stage import (
    PrimNames,
    bind_friction,
    define_mesh,
    friction_material,
    make_collider,
    new_stage,
    set_color,
    set_extent,
    set_pose,
)
from trundle.worlds.affine import pose_of

_DEGREE = math.pi / 180.0
_TREAD = 0.004
"""Width of a wheel's collider [m]: one as wide as the wheel scrubs on a line; in Newton turns fell 10 to 46 % short."""

_AXES = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}


def robot_stage(robot: Robot) -> Any:
    """Make the stage of a robot; see `trundle.export.usd.export_robot`."""
    model = robot_spec(robot).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    root = Tf.MakeValidIdentifier(robot.name)
    stage = new_stage(root)
    Usd.ModelAPI(stage.GetDefaultPrim()).SetKind("component")
    writer = _Writer(stage, f"/{root}", model)
    bodies = [int(body) for body in range(1, model.nbody)]
    for body in bodies:
        writer.add_body(body, data)
    UsdGeom.Scope.Define(stage, f"/{root}/joints")
    for body in bodies:
        writer.add_joint(body)
    _add_lidars(stage, f"/{root}/{BASE}", robot)
    base = stage.GetPrimAtPath(f"/{root}/{BASE}")
    UsdPhysics.ArticulationRootAPI.Apply(base)
    # The robot does not collide with itself; bodies connected by a joint are already excluded.
    others = [Sdf.Path(writer.paths[body]) for body in bodies if writer.paths[body] != str(base.GetPath())]
    UsdPhysics.FilteredPairsAPI.Apply(base).CreateFilteredPairsRel().SetTargets(others)
    return stage


class _Writer:
    """Writes a model's bodies and joints under one prim, as siblings: rigid bodies must not be nested."""

    def __init__(self, stage: Any, root: str, model: mujoco.MjModel) -> None:
        self.stage, self.root, self.model = stage, root, model
        self.paths: dict[int, str] = {}
        self._names = PrimNames()
        self._joint_names = PrimNames()
        self._materials: dict[float, Any] = {}

    def add_body(self, body: int, data: mujoco.MjData) -> None:
        """Write a body with its mass and geometry at its pose."""
        model = self.model
        path = self.paths[body] = f"{self.root}/{self._names.take(model.body(body).name)}"
        xform = UsdGeom.Xform.Define(self.stage, path)
        set_pose(xform, Pose3D(tuple(data.xpos[body].tolist()), tuple(data.xquat[body].tolist())))
        prim = xform.GetPrim()
        UsdPhysics.RigidBodyAPI.Apply(prim)
        mass = UsdPhysics.MassAPI.Apply(prim)
        mass.CreateMassAttr(float(model.body_mass[body]))
        mass.CreateCenterOfMassAttr(_vector(model.body_ipos[body]))
        mass.CreateDiagonalInertiaAttr(_vector(model.body_inertia[body]))
        mass.CreatePrincipalAxesAttr(_quaternion(model.body_iquat[body]))
        names = PrimNames()
        first = int(model.body_geomadr[body])
        for geom in range(first, first + int(model.body_geomnum[body])):
            is_collider = int(model.geom_group[geom]) == GROUP_COLLIDERS
            if is_collider and int(model.geom_contype[geom]) == SOLIDS_TYPE:
                continue  # Wheels' extra colliders against solids; in USD the treads serve for both.
            name = model.geom(geom).name.partition(":")[2] or f"{model.body(body).name}_look"
            self._add_geom(f"{path}/{names.take(f'{name}_collider' if is_collider else name)}", geom, is_collider)

    def add_joint(self, body: int) -> None:
        """Write the joint that holds a body: as the model has it, or a fixed one. base_link is free."""
        model, parent = self.model, int(self.model.body_parentid[body])
        if parent == 0:
            return
        offset, turn = model.body_pos[body].copy(), model.body_quat[body]
        rotation = Pose3D(quaternion=tuple(turn.tolist())).rotation()
        if model.body_jntnum[body] == 0:
            path = f"{self.root}/joints/{self._joint_names.take(f'{model.body(body).name}_mount')}"
            joint = UsdPhysics.FixedJoint.Define(self.stage, path)
            frame, anchor = np.eye(3), np.zeros(3)
        else:
            index = int(model.body_jntadr[body])
            joint = self._add_hinge(index)
            frame, anchor = _frame(model.jnt_axis[index]), model.jnt_pos[index]
        joint.CreateBody0Rel().SetTargets([Sdf.Path(self.paths[parent])])
        joint.CreateBody1Rel().SetTargets([Sdf.Path(self.paths[body])])
        joint.CreateLocalPos0Attr(_vector(offset + rotation @ anchor))
        joint.CreateLocalRot0Attr(_quaternion(pose_of(np.zeros(3), rotation @ frame).quaternion))
        joint.CreateLocalPos1Attr(_vector(anchor))
        joint.CreateLocalRot1Attr(_quaternion(pose_of(np.zeros(3), frame).quaternion))

    def _add_hinge(self, index: int) -> Any:
        model = self.model
        name = model.joint(index).name
        path = f"{self.root}/joints/{self._joint_names.take(name)}"
        joint = UsdPhysics.RevoluteJoint.Define(self.stage, path)
        joint.CreateAxisAttr(_axis(model.jnt_axis[index]) or "X")
        prim = joint.GetPrim()
        # PhysX's own schemas are not in usd-core; their attributes can still be written. PhysX of Isaac Sim 6 reads
        # only those of the axis: without armature the casters chatter, and a spin's rate varies by a tenth.
        prim.AddAppliedSchema("PhysxJointAPI")
        prim.AddAppliedSchema("PhysxJointAxisAPI:angular")
        degree_of_freedom = int(model.jnt_dofadr[index])
        armature = float(model.dof_armature[degree_of_freedom])
        friction = float(model.dof_frictionloss[degree_of_freedom])
        for attribute, number in (
            ("physxJoint:armature", armature),
            ("physxJointAxis:angular:armature", armature),
            ("physxJointAxis:angular:staticFrictionEffort", friction),
            ("physxJointAxis:angular:dynamicFrictionEffort", friction),
        ):
            prim.CreateAttribute(attribute, Sdf.ValueTypeNames.Float, False).Set(number)
        if model.jnt_limited[index]:
            low, high = (float(limit) / _DEGREE for limit in model.jnt_range[index])
            joint.CreateLowerLimitAttr(low)
            joint.CreateUpperLimitAttr(high)
        stiffness = float(model.jnt_stiffness[index])
        if stiffness > 0.0:
            spring = UsdPhysics.DriveAPI.Apply(prim, "angular")
            spring.CreateTypeAttr("force")
            spring.CreateStiffnessAttr(stiffness * _DEGREE)
            spring.CreateDampingAttr(float(model.dof_damping[degree_of_freedom]) * _DEGREE)
            spring.CreateTargetPositionAttr(0.0)
        for actuator in np.flatnonzero(model.actuator_trnid[:, 0] == index):
            drive = UsdPhysics.DriveAPI.Apply(prim, "angular")
            drive.CreateTypeAttr("force")
            drive.CreateStiffnessAttr(0.0)
            drive.CreateDampingAttr(float(model.actuator_gainprm[actuator, 0]) * _DEGREE)
            drive.CreateTargetVelocityAttr(0.0)
            drive.CreateMaxForceAttr(float(model.actuator_forcerange[actuator, 1]))
        return joint

    def _add_geom(self, path: str, geom: int, is_collider: bool) -> None:
        model = self.model
        gprim, scale = self._define(path, geom, is_collider)
        set_pose(gprim, Pose3D(tuple(model.geom_pos[geom].tolist()), tuple(model.geom_quat[geom].tolist())))
        if scale is not None:
            gprim.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*(float(edge) for edge in scale)))
        set_extent(gprim)
        red, green, blue, alpha = (float(value) for value in model.geom_rgba[geom])
        set_color(gprim, (red, green, blue, alpha))
        if not is_collider:
            return
        prim = gprim.GetPrim()
        gprim.CreatePurposeAttr(UsdGeom.Tokens.guide)
        make_collider(prim, approximation="convexHull")
        bind_friction(prim, self._material(float(model.geom_friction[geom, 0])))

    def _define(self, path: str, geom: int, is_collider: bool) -> tuple[Any, FloatArray | None]:
        """Define a geom's shape; the second value is its scale along its axes."""
        model, size = self.model, self.model.geom_size[geom]
        match mujoco.mjtGeom(int(model.geom_type[geom])):
            case mujoco.mjtGeom.mjGEOM_BOX:
                gprim = UsdGeom.Cube.Define(self.stage, path)
                gprim.CreateSizeAttr(1.0)
                return gprim, 2.0 * size
            case mujoco.mjtGeom.mjGEOM_SPHERE:
                gprim = UsdGeom.Sphere.Define(self.stage, path)
                gprim.CreateRadiusAttr(float(size[0]))
                return gprim, None
            case mujoco.mjtGeom.mjGEOM_ELLIPSOID if is_collider:
                # A wheel, which MuJoCo rolls on one point; PhysX cannot scale a collider to an ellipsoid.
                return self._cylinder(path, "Y", size[0], min(float(size[1]), _TREAD / 2.0)), None
            case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
                gprim = UsdGeom.Sphere.Define(self.stage, path)
                gprim.CreateRadiusAttr(1.0)
                return gprim, size
            case mujoco.mjtGeom.mjGEOM_CYLINDER:
                return self._cylinder(path, "Z", size[0], size[1]), None
            case mujoco.mjtGeom.mjGEOM_CAPSULE:
                gprim = UsdGeom.Capsule.Define(self.stage, path)
                gprim.CreateAxisAttr("Z")
                gprim.CreateRadiusAttr(float(size[0]))
                gprim.CreateHeightAttr(2.0 * float(size[1]))
                return gprim, None
            case mujoco.mjtGeom.mjGEOM_MESH:
                return define_mesh(self.stage, path, self._mesh(int(model.geom_dataid[geom]))), None
            case kind:
                raise OutputError(f"{model.geom(geom).name}: a geom of type {kind.name} cannot be written as USD")

    def _cylinder(self, path: str, axis: str, radius: float, half: float) -> Any:
        gprim = UsdGeom.Cylinder.Define(self.stage, path)
        gprim.CreateAxisAttr(axis)
        gprim.CreateRadiusAttr(float(radius))
        gprim.CreateHeightAttr(2.0 * float(half))
        return gprim

    def _mesh(self, mesh: int) -> Mesh:
        model = self.model
        vertex, vertices = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        face, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
        return Mesh(model.mesh_vert[vertex : vertex + vertices].astype(float), model.mesh_face[face : face + faces])

    def _material(self, friction: float) -> Any:
        """Return a material with a friction. Wheels combine it with the floor's; casters use the lower of the two."""
        if friction not in self._materials:
            UsdGeom.Scope.Define(self.stage, f"{self.root}/materials")
            path = f"{self.root}/materials/friction_{friction:g}".replace(".", "_")
            self._materials[friction] = friction_material(self.stage, path, friction, lowest=friction < 1.0)
        return self._materials[friction]


def _add_lidars(stage: Any, base: str, robot: Robot) -> None:
    """Add a frame for each lidar, to attach a sensor to."""
    names = PrimNames()
    for name, lidar in robot.lidars.items():
        frame = UsdGeom.Xform.Define(stage, f"{base}/{names.take(name if 'lidar' in name else f'lidar_{name}')}")
        set_pose(frame, Pose3D.planar(lidar.x, lidar.y, lidar.z, lidar.yaw))


def _axis(axis: FloatArray) -> str | None:
    """Return the USD axis equal to an axis; None if there is none."""
    return next((name for name, unit in _AXES.items() if np.allclose(axis, unit, atol=1e-12)), None)


def _frame(axis: FloatArray) -> FloatArray:
    """Return the rotation, shape (3, 3), from one of USD's axes to a joint's: identity if it is one, else from x."""
    if _axis(axis) is not None:
        return np.eye(3)
    x, y, z = (float(number) for number in axis)
    side = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]][int(np.abs(axis).argmin())])
    side /= math.sqrt(float(side @ side))
    return np.column_stack([axis, side, np.cross(axis, side).real])


def _vector(numbers: Any) -> Any:
    return Gf.Vec3f(*(float(number) for number in numbers))


def _quaternion(wxyz: Any) -> Any:
    w, x, y, z = (float(number) for number in wxyz)
    return Gf.Quatf(w, x, y, z)
