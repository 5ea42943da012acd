"""The USD files of a simulation: the user's, or written from the world and the robot."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from trundle.errors import InputError, RobotError
from trundle.robots import Robot
from trundle.sim.isaac.assets import environment_path, local_environment, robot_path
from trundle.sim.movers import MoverField
from trundle.sim.physx.scene import Scene, compose
from trundle.usd.write import write_world
from trundle.worlds import World


@dataclass(frozen=True, slots=True)
class StageFiles:
    """The user's files.

    Attributes:
        environment: The stage to simulate; None for the world.
        robot: The robot's USD; None for trundle's own model of it.
    """

    environment: Path | None
    robot: Path | None


def choose_files(
    robot: Robot, *, environment: str | None, robot_usd: str | None, assets_root: str | None
) -> StageFiles:
    """Find the files that options name.

    Raises:
        InputError: If one is missing, or not on this machine.
        UnknownNameError: If there is no such environment.
        RobotError: If the robot's own USD cannot be driven: it has several wheels per side.
    """
    for option, value in (("environment", environment), ("robot_usd", robot_usd)):
        if value is not None and "://" in value:
            raise InputError(f"{option} {value}: backend physx opens files of this machine only; download it first")
    stage = None if environment is None else local_environment(environment, assets_root)
    if stage is not None and environment is not None:
        environment_path(environment)  # a file that is missing
    if robot_usd is None:
        return StageFiles(stage, None)
    robot_path(robot.name, robot_usd)
    if robot.drive.axles:
        raise RobotError(
            f"the robot {robot.name!r} has several wheels per side, and backend physx drives a USD file of the user "
            "with one; leave robot_usd out, or use backend mujoco or kinematic"
        )
    return StageFiles(stage, Path(robot_usd))


def write_scene(
    folder: Path,
    world: World,
    robot: Robot,
    files: StageFiles,
    field: MoverField | None,
    *,
    height: float,
    timestep: float,
) -> Scene:
    """Write the stage to simulate into a folder; see `compose`.

    Raises:
        WorldError: If the environment cannot be simulated.
        RobotError: If the robot cannot.
        MissingExtraError: If usd-core is not installed.
    """
    base, usd = files.environment, files.robot
    if base is None:
        base = folder / "world.usd"
        write_world(world, base, profile="isaac")
    joints = (robot.drive.left_joint, robot.drive.right_joint)
    if usd is None:
        usd = folder / "robot.usd"
        joints = _write_robot(robot, usd)
    return compose(
        folder,
        base,
        robot,
        str(usd),
        own_world=files.environment is None,
        own_robot=files.robot is None,
        source=f"the world {world.name!r}" if files.environment is None else str(base),
        joints=joints,
        field=field,
        height=height,
        timestep=timestep,
    )


def _write_robot(robot: Robot, path: Path) -> tuple[str, ...]:
    """Write trundle's model of a robot; return its driven joints: left, right, left, right and so on."""
    from trundle.sim.mujoco.robot_parts import traction_joints
    from trundle.sim.mujoco.robot_stage import robot_stage
    from trundle.usd.isaac import fit_for_isaac
    from trundle.usd.stage import save

    stage = robot_stage(robot)
    fit_for_isaac(stage)
    save(stage, path)
    traction = traction_joints(robot)
    others = [wheel for wheel in robot.drive.wheels if wheel.joint not in traction]
    sides = [[wheel.joint for wheel in others if wheel.side == side] for side in (1, -1)]
    return (*traction, *(joint for pair in zip(*sides, strict=True) for joint in pair))
