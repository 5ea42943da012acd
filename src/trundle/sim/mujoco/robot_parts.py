"""A `Robot` as MuJoCo bodies, joints and actuators."""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np

from trundle.geometry import FloatArray
from trundle.robots import Caster, CasterFrame, DriveWheel, Robot
from trundle.sim.mujoco.robot_looks import add_looks, add_prism_mesh
from trundle.sim.mujoco.world_parts import FLOOR_TYPE, SOLIDS_TYPE
from trundle.sim.ramp import Motion

BASE = "base_link"
GROUP_COLLIDERS = 3
GRAVITY = 9.81

# Rubber on concrete.
_WHEEL_FRICTION = 1.0
_CASTER_FRICTION = 0.7
_CHASSIS_FRICTION = 0.8

_GUARD = ":guard"
_GUARD_SCALE = 0.98
"""Scale of a wheel's ellipsoid that collides with solids: smaller than the tread, so that a chassis of the same length
collides first."""

_TRACTION_MASS = 1e-3
"""Mass of a hidden wheel [kg]."""

_HOLD = 0.65
"""Share of the traction that a servo applies to a blocked wheel; with more, the wheels of a robot that pushes a wall
slip, climb and throw it back."""
# As stiff as the timestep allows: wheels that sink into the floor roll on a smaller radius.
_STIFF_SOLREF = (0.01, 1.0)
_STIFF_SOLIMP = (0.95, 0.99, 0.001, 0.5, 2.0)
# As stiff, but with slow recovery: a part that penetrates a wall within one step is not thrown back.
_BUMPER_SOLREF = (0.01, 4.0)
# MuJoCo's defaults.
_SOFT_SOLREF = (0.02, 1.0)
_SOFT_SOLIMP = (0.9, 0.95, 0.001, 0.5, 2.0)


@dataclass(frozen=True, slots=True)
class Servo:
    """Settings of the wheels' velocity servos, scaled from those measured on Nova Carter by mass times radius².

    Attributes:
        gain: Torque per speed error [N·m·s/rad].
        torque: Largest torque [N·m].
        error: Largest speed error [rad/s] that is corrected in full.
        armature: Inertia of the motor at the wheel's axle [kg·m²].
    """

    gain: float
    torque: float
    error: float
    armature: float

    @classmethod
    def of(cls, robot: Robot) -> Servo:
        """Choose the settings for a robot."""
        inertia = robot.total_mass * robot.drive.wheel_radius**2
        gain = 180.0 * inertia
        traction = _WHEEL_FRICTION * robot.total_mass * GRAVITY * robot.drive.wheel_radius / 2.0
        return cls(gain=gain, torque=4.0 * traction, error=_HOLD * traction / gain, armature=0.045 * inertia)


@dataclass(frozen=True, slots=True)
class FeedForward:
    """Torque feed-forward of the wheels' servos for changes of speed, so that these cause no speed error.

    A blocked wheel, whose speed differs from the command by more than the servo's largest error, gets the torque of
    that error without feed-forward, because it does not accelerate.

    Attributes:
        mass: Mass of the whole robot [kg].
        moment: Moment of inertia of the whole robot about z at base_link [kg·m²].
        arm: Mass times how far the centre of mass is ahead of base_link [kg·m].
        wheel: Inertia of one wheel and its motor about the axle [kg·m²].
        radius: Radius of a wheel [m].
        track: Distance between the wheels [m].
        gain: Gain of the servos [N·m·s/rad].
        error: Largest speed error [rad/s] that they correct in full.
        timestep: [s].
    """

    mass: float
    moment: float
    arm: float
    wheel: float
    radius: float
    track: float
    gain: float
    error: float
    timestep: float

    @classmethod
    def of(cls, model: mujoco.MjModel, robot: Robot) -> FeedForward:
        """Compute the inertias from a compiled model with this robot."""
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        inertia = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, inertia)
        base = int(model.body(BASE).dofadr[0])
        wheel = int(model.joint(traction_joints(robot)[0]).dofadr[0])
        servo = Servo.of(robot)
        return cls(
            mass=float(inertia[base, base]),
            moment=float(inertia[base + 5, base + 5]),
            arm=float(inertia[base + 1, base + 5]),
            wheel=float(inertia[wheel, wheel]),
            radius=robot.drive.wheel_radius,
            track=robot.drive.track_width,
            gain=servo.gain,
            error=servo.error,
            timestep=float(model.opt.timestep),
        )

    def free(self, before: Motion, now: Motion) -> tuple[float, float]:
        """Return the servo setpoints [rad/s] for the step from one motion to the next, if both wheels follow."""
        v_rate, w_rate = (now.v - before.v) / self.timestep, (now.w - before.w) / self.timestep
        # Newton and Euler at base_link, whose origin is not the centre of mass.
        force = self.mass * v_rate - self.arm * now.w * now.w
        moment = self.moment * w_rate + self.arm * now.v * now.w
        along, across = force * self.radius / 2.0, moment * self.radius / self.track
        left = along - across + self.wheel * (now.left - before.left) / self.timestep
        right = along + across + self.wheel * (now.right - before.right) / self.timestep
        return now.left + left / self.gain, now.right + right / self.gain

    def held(self, free: float, commanded: float, speed: float) -> float:
        """Return the setpoint [rad/s] of a servo.

        The error is limited instead of the torque: at its torque limit MuJoCo does not damp a servo, and it chatters.

        Args:
            free: Setpoint from `free`, for a wheel that follows.
            commanded: Commanded speed of the previous step [rad/s].
            speed: Actual speed [rad/s].
        """
        error = commanded - speed
        if -self.error <= error <= self.error:
            return free
        return speed + math.copysign(self.error, error)


def scale_robot(model: mujoco.MjModel, *, mass: float = 1.0, friction: float = 1.0) -> None:
    """Multiply the masses and inertias of the robot in a compiled model, and the sliding friction of its geoms."""
    if friction != 1.0:
        for geom in range(model.ngeom):
            if model.geom(geom).name.startswith("robot:"):
                model.geom_friction[geom, 0] *= friction
    if mass != 1.0:
        base = int(model.body(BASE).id)
        of_robot = model.body_rootid == base
        model.body_mass[of_robot] *= mass
        model.body_inertia[of_robot] *= mass
        mujoco.mj_setConst(model, mujoco.MjData(model))


def part_of(geom: str) -> str:
    """Name of the robot's part that a geom belongs to."""
    return geom.removeprefix("robot:").removesuffix(_GUARD)


def add_robot(spec: mujoco.MjSpec, robot: Robot, *, looks: bool = True) -> None:
    """Add a robot as one free body `base_link` with its wheels and casters, and a velocity actuator per drive wheel."""
    base = spec.worldbody.add_body(name=BASE)
    base.add_freejoint(name="base_link")
    _add_chassis(spec, base, robot)
    servo = Servo.of(robot)
    several = bool(robot.drive.axles)
    for side, sign, joint in zip(("left", "right"), (1, -1), traction_joints(robot), strict=True):
        add_wheel = _add_traction if several else _add_wheel
        add_wheel(base, robot, f"wheel_{side}", DriveWheel(joint, sign, 0.0), servo)
        _add_servo(spec, joint, servo)
    for wheel, name in named_wheels(robot) if several else ():
        _add_carrying_wheel(base, robot, name, wheel)
        _add_servo(spec, wheel.joint, servo)
    carrier = base if robot.caster_frame is None else _add_caster_frame(base, robot, robot.caster_frame)
    for index, caster in enumerate(robot.casters):
        if caster.is_swivel:
            _add_swivel_caster(carrier, caster, index)
        else:
            _add_ball(carrier, caster, index)
    if looks:
        add_looks(spec, base, robot, [(name, wheel.side) for wheel, name in named_wheels(robot)])


def traction_joints(robot: Robot) -> tuple[str, str]:
    """Joints of the two wheels with traction: the drive's, or with several axles those of a hidden pair in the middle.

    Wheels on several axles would scrub in every turn. So they carry the robot and rotate as commanded, without
    friction, and the pair in the middle drives it.
    """
    drive = robot.drive
    return ("traction_left", "traction_right") if drive.axles else (drive.left_joint, drive.right_joint)


def named_wheels(robot: Robot) -> list[tuple[DriveWheel, str]]:
    """Return the visible wheels of a robot, with their bodies' names."""
    if not robot.drive.axles:
        return list(zip(robot.drive.wheels, ("wheel_left", "wheel_right"), strict=True))
    words = {1: "left", -1: "right"}
    return [(wheel, f"wheel_{words[wheel.side]}_{index // 2}") for index, wheel in enumerate(robot.drive.wheels)]


def _add_servo(spec: mujoco.MjSpec, joint: str, servo: Servo) -> None:
    actuator = spec.add_actuator(
        name=joint,
        target=joint,
        trntype=mujoco.mjtTrn.mjTRN_JOINT,
        forcerange=(-servo.torque, servo.torque),
        forcelimited=True,
    )
    actuator.set_to_velocity(kv=servo.gain)


def chassis_inertial(robot: Robot) -> tuple[FloatArray, FloatArray]:
    """Centre of mass [m] in base_link and principal moments [kg·m²] of the chassis, given or by the stated defaults."""
    body = robot.body
    low, high = robot.outline.min(axis=0), robot.outline.max(axis=0)
    center = (*((low + high) / 2.0), 0.4 * body.height) if body.center_of_mass is None else body.center_of_mass
    x, y, z = (*(high - low), body.height - body.clearance)
    box = np.array([y * y + z * z, x * x + z * z, x * x + y * y]) * body.mass / 12.0
    return np.asarray(center), box if body.inertia is None else np.asarray(body.inertia)


def _add_chassis(spec: mujoco.MjSpec, base: mujoco.MjsBody, robot: Robot) -> None:
    center, inertia = chassis_inertial(robot)
    base.mass = robot.body.mass
    base.ipos = center
    base.inertia = inertia
    base.explicitinertial = True
    outline, low, high = robot.outline, robot.body.clearance, robot.body.height
    size = (0.1, 0.1, 0.1)
    geom = _add_collider(base, "robot:chassis", mujoco.mjtGeom.mjGEOM_BOX, size, friction=_CHASSIS_FRICTION)
    geom.solref = _BUMPER_SOLREF
    corner, opposite = outline.min(axis=0), outline.max(axis=0)
    if len(outline) == 4 and bool(((outline == corner) | (outline == opposite)).all()):
        geom.size = (*((opposite - corner) / 2.0), (high - low) / 2.0)
        geom.pos = (*((opposite + corner) / 2.0), (high + low) / 2.0)
    else:
        add_prism_mesh(spec, "robot:chassis", outline, low, high)
        geom.type = mujoco.mjtGeom.mjGEOM_MESH
        geom.meshname = "robot:chassis"


def _add_wheel(base: mujoco.MjsBody, robot: Robot, name: str, wheel: DriveWheel, servo: Servo) -> None:
    body = _add_wheel_body(base, robot, name, wheel)
    body.joints[0].armature = servo.armature
    # An ellipsoid touches at one point, in its middle: a wide cylinder scrubs along a line, and yaw is 12 % short.
    tread = _add_tread(body, robot, name)
    tread.contype = FLOOR_TYPE
    _add_guard(body, robot, name)


def _add_traction(base: mujoco.MjsBody, robot: Robot, name: str, wheel: DriveWheel, servo: Servo) -> None:
    """A hidden wheel in the middle with the traction of several: almost massless, it touches only the floor."""
    body = _add_wheel_body(base, robot, name, wheel)
    _set_cylinder_inertia(body, _TRACTION_MASS, robot.drive.wheel_radius, robot.drive.wheel_width)
    body.joints[0].armature = servo.armature
    _add_tread(body, robot, name).contype = FLOOR_TYPE


def _add_carrying_wheel(base: mujoco.MjsBody, robot: Robot, name: str, wheel: DriveWheel) -> None:
    """One of several wheels on a side: it carries load and rotates, but slides without friction."""
    body = _add_wheel_body(base, robot, name, wheel)
    tread = _add_tread(body, robot, name)
    tread.contype = FLOOR_TYPE
    tread.friction = (0.0, 0.005, 0.0001)
    tread.condim = 1
    # Softer, so that the pair with traction carries most of the load.
    tread.solref, tread.solimp = _SOFT_SOLREF, _SOFT_SOLIMP
    _add_guard(body, robot, name)


def _add_wheel_body(base: mujoco.MjsBody, robot: Robot, name: str, wheel: DriveWheel) -> mujoco.MjsBody:
    drive = robot.drive
    body = base.add_body(name=name, pos=(wheel.x, wheel.side * drive.track_width / 2.0, drive.wheel_radius))
    _set_cylinder_inertia(body, drive.wheel_mass, drive.wheel_radius, drive.wheel_width)
    body.add_joint(name=wheel.joint, type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0.0, 1.0, 0.0))
    return body


def _add_tread(body: mujoco.MjsBody, robot: Robot, name: str) -> mujoco.MjsGeom:
    radius, width = robot.drive.wheel_radius, robot.drive.wheel_width
    kind = mujoco.mjtGeom.mjGEOM_ELLIPSOID
    return _add_collider(body, f"robot:{name}", kind, (radius, width / 2.0, radius), friction=_WHEEL_FRICTION)


def _add_guard(body: mujoco.MjsBody, robot: Robot, name: str) -> None:
    """The frictionless collider of a wheel against solids: a wheel with friction would climb them."""
    radius, width = _GUARD_SCALE * robot.drive.wheel_radius, robot.drive.wheel_width
    kind = mujoco.mjtGeom.mjGEOM_ELLIPSOID
    guard = _add_collider(body, f"robot:{name}{_GUARD}", kind, (radius, width / 2.0, radius), friction=0.0)
    guard.contype = SOLIDS_TYPE
    guard.condim = 1
    guard.solref = _BUMPER_SOLREF


def _add_caster_frame(base: mujoco.MjsBody, robot: Robot, frame: CasterFrame) -> mujoco.MjsBody:
    """Add what carries the casters: a beam across them that rocks about x on a spring."""
    body = base.add_body(name="caster_frame", pos=(frame.x, 0.0, frame.z))
    body.mass = frame.mass
    body.ipos = (0.0, 0.0, 0.0)
    # A box with the proportions that the inertia of Nova Carter's has.
    across = 2.25 * max([0.02, *(abs(caster.y) for caster in robot.casters)])
    deep, high = 0.3 * across, 0.2 * across
    squares = np.array([across**2 + high**2, deep**2 + high**2, deep**2 + across**2])
    body.inertia = frame.mass * squares / 12.0
    body.explicitinertial = True
    body.add_joint(
        name=frame.joint,
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=(1.0, 0.0, 0.0),
        limited=mujoco.mjtLimited.mjLIMITED_TRUE,
        range=(-math.degrees(frame.limit), math.degrees(frame.limit)),  # a spec's angles are in degrees
        stiffness=frame.stiffness,
        damping=frame.damping,
        frictionloss=frame.friction,
    )
    return body


def _add_swivel_caster(carrier: mujoco.MjsBody, caster: Caster, index: int) -> None:
    """A fork that turns about z and, `trail` behind it, a wheel that rolls; each has half of the caster's mass."""
    at = np.array([caster.x, caster.y, caster.radius]) - carrier.pos
    fork = carrier.add_body(name=f"caster_{index}_fork", pos=at)
    half = caster.mass / 2.0
    fork.mass = half
    fork.ipos = (-caster.trail / 2.0, 0.0, caster.radius / 2.0)
    fork.inertia = np.full(3, half * caster.radius**2 / 4.0)
    fork.explicitinertial = True
    armature = 0.1 * half * caster.radius**2
    fork.add_joint(name=caster.swivel_joint, type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0.0, 0.0, 1.0), armature=armature)
    wheel = fork.add_body(name=f"caster_{index}", pos=(-caster.trail, 0.0, 0.0))
    _set_cylinder_inertia(wheel, half, caster.radius, caster.width)
    wheel.add_joint(name=caster.wheel_joint, type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0.0, 1.0, 0.0), armature=armature)
    size = (caster.radius, caster.width / 2.0, caster.radius)
    name = f"robot:caster_{index}"
    _add_collider(wheel, name, mujoco.mjtGeom.mjGEOM_ELLIPSOID, size, friction=_CASTER_FRICTION)


def _add_ball(carrier: mujoco.MjsBody, caster: Caster, index: int) -> None:
    """A ball that slides without friction, fixed to what carries it."""
    at = np.array([caster.x, caster.y, caster.radius]) - carrier.pos
    body = carrier.add_body(name=f"caster_{index}", pos=at)
    body.mass = caster.mass
    body.ipos = (0.0, 0.0, 0.0)
    body.inertia = np.full(3, 0.4 * caster.mass * caster.radius**2)
    body.explicitinertial = True
    size = (caster.radius, 0.0, 0.0)
    geom = _add_collider(body, f"robot:caster_{index}", mujoco.mjtGeom.mjGEOM_SPHERE, size, friction=0.0)
    geom.condim = 1
    # Softer than the wheels, so that with redundant supports the driven wheels carry most of the load.
    geom.solref, geom.solimp = _SOFT_SOLREF, _SOFT_SOLIMP


def _add_collider(
    body: mujoco.MjsBody,
    name: str,
    kind: mujoco.mjtGeom,
    size: tuple[float, float, float],
    *,
    friction: float,
) -> mujoco.MjsGeom:
    """Add an invisible geom that collides with the world but not with the robot.

    MuJoCo takes the larger friction of two geoms of equal priority; the robot's have a higher one, so theirs is used.
    """
    return body.add_geom(
        name=name,
        type=kind,
        size=size,
        friction=(friction, 0.005, 0.0001),
        priority=1,
        condim=3,
        solref=_STIFF_SOLREF,
        solimp=_STIFF_SOLIMP,
        mass=0.0,
        contype=FLOOR_TYPE | SOLIDS_TYPE,
        conaffinity=0,
        group=GROUP_COLLIDERS,
        rgba=(0.9, 0.3, 0.2, 0.4),
    )


def _set_cylinder_inertia(body: mujoco.MjsBody, mass: float, radius: float, width: float) -> None:
    across = mass * (3.0 * radius**2 + width**2) / 12.0
    body.mass = mass
    body.ipos = (0.0, 0.0, 0.0)  # By default the body's position, which would unbalance the wheel.
    body.inertia = (across, mass * radius**2 / 2.0, across)
    body.explicitinertial = True
