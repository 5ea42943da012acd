"""A robot and a world as one MuJoCo model.

The settings were measured: the discrete integrator with elliptic friction cones keeps stiff wheel servos from slipping
while the robot speeds up, and one floor plane keeps wheels from bouncing on seams.
"""

from __future__ import annotations

from dataclasses import replace

import mujoco

from trundle.robots import Robot
from trundle.sim.mujoco.robot_parts import add_robot
from trundle.sim.mujoco.world_parts import add_floor, add_movers, add_solids
from trundle.worlds import World

TIMESTEP = 0.005
"""Length of a physics step [s]."""

HEADROOM = 0.2
"""Height above the robot [m] above which meshes do not collide."""

_ROOM_ABOVE = 0.1
"""How far a robot may rise when it rides up on something [m]."""


def build_spec(world: World, robot: Robot, *, timestep: float = TIMESTEP, looks: bool = True) -> mujoco.MjSpec:
    """Compose a world and a robot; the robot's base_link starts at the origin, on the floor, facing x.

    Names of geoms: a solid's geom has the solid's name, the floor is `world:floor`, those of movers start with
    `mover:`, and the robot's with `robot:` (`robot:chassis`, `robot:wheel_left`, `robot:caster_0`, …). Geom groups: 0
    world, 1 blocked cells, 2 the robot's visuals, 3 hidden colliders: the robot's, and pieces of meshes.

    Args:
        world: The world.
        robot: The robot.
        timestep: Length of a physics step [s].
        looks: Include the robot's visuals; without them its motion is the same, and faster to compute.

    Raises:
        WorldError: If a solid cannot be modelled.
    """
    spec = _empty_spec(f"{robot.name} in {world.name}", timestep)
    add_floor(spec)
    add_solids(spec, world, ceiling=robot.body.height + HEADROOM)
    add_movers(spec, world, ceiling=robot.body.height + HEADROOM)
    add_robot(spec, robot, looks=looks)
    return spec


def world_spec(world: World) -> mujoco.MjSpec:
    """Compose a world alone, with all that is in it, as high as it is.

    Raises:
        WorldError: If a solid cannot be modelled.
    """
    spec = _empty_spec(world.name, TIMESTEP)
    add_floor(spec)
    add_solids(spec, world)
    add_movers(spec, world)
    return spec


def robot_spec(robot: Robot, *, floor: bool = False, timestep: float = TIMESTEP, looks: bool = True) -> mujoco.MjSpec:
    """Model a robot alone, with or without a floor under it; see `build_spec`."""
    spec = _empty_spec(robot.name, timestep)
    if floor:
        add_floor(spec)
    add_robot(spec, robot, looks=looks)
    return spec


def within_reach(world: World, robot: Robot) -> World:
    """Leave out solids entirely above the robot: they cannot be touched, and each costs time at every step."""
    top = robot.body.height + _ROOM_ABOVE
    return replace(world, solids=tuple(solid for solid in world.solids if solid.bounds()[0][2] < top))


def _empty_spec(name: str, timestep: float) -> mujoco.MjSpec:
    spec = mujoco.MjSpec()
    spec.modelname = name
    spec.option.timestep = timestep
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_DISCRETE
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10.0
    # With a dozen degrees of freedom, sparse matrices and contact islands cost more than they save.
    spec.option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_ISLAND
    # A reset in the middle of a run would look like a jump of the robot: the simulator reports the divergence instead.
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    _set_looks(spec)
    return spec


def _set_looks(spec: mujoco.MjSpec) -> None:
    view = spec.visual
    view.global_.offwidth, view.global_.offheight = 1920, 1080
    view.quality.shadowsize = 2048
    view.headlight.ambient = (0.38, 0.38, 0.40)
    view.headlight.diffuse = (0.35, 0.35, 0.35)
    view.headlight.specular = (0.05, 0.05, 0.05)
    # For an extent of 10 m: clip from 5 cm to 300 m, shadows within 7 m of the robot.
    spec.stat.extent = 10.0
    view.map.znear = 0.005
    view.map.zfar = 30.0
    view.map.shadowclip = 0.7
    view.rgba.haze = (0.80, 0.84, 0.88, 1.0)
    spec.add_texture(
        name="world:sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=(0.72, 0.80, 0.88),
        rgb2=(0.93, 0.95, 0.97),
        width=256,
        height=1536,
    )
