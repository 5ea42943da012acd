"""`PhysxSimulator`: the robot in NVIDIA PhysX, the physics of Isaac Sim, on the CPU and without its application."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from trundle.errors import SimulationError, WorldWarning
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Solid
from trundle.robots import Robot, WheelSpeeds
from trundle.sim.lidar import LidarChoice, LidarSet, SceneBeams
from trundle.sim.movers import MoverField
from trundle.sim.physx.body import RobotBody, WheelOdometry, tilt_of
from trundle.sim.physx.engine import check_installation
from trundle.sim.ramp import CommandRamp, Motion, count_steps
from trundle.sim.state import Contact, RobotState, Substep
from trundle.sim.usd_simulator import SETTLE_S, UsdSimulator
from trundle.usd import GROUND_OFFSET, TIMESTEP
from trundle.values import check_seed
from trundle.worlds import World
from trundle.worlds.usd import need_usd

if TYPE_CHECKING:
    from trundle.sim.physx.stage import RunningStage

_SHORT_SETTLE_S = 0.05
"""Time in which a robot comes to rest that was put on the floor [s]."""

_FAR = 10.0
"""Distance from everything at which the robot first settles [m]."""

_LARGEST_TILT = 0.05
"""Largest tilt of a robot on a level floor [rad]."""


class PhysxSimulator(UsdSimulator):
    """Drives a robot through a stage in NVIDIA PhysX.

    The limits of the robot are applied at every physics step, and its wheels are driven by PhysX's velocity drives.
    The stage is the world and the robot as trundle writes them for Isaac Sim, or USD files of the user. A run is the
    same to the last bit each time on one machine.

    Args:
        world: The world; contacts are reported with its solids, cells and movers by name.
        robot: The robot.
        lidar: Lidars to simulate: all of the robot's, none, or those named. Their beams meet the world's solids; in an
            environment the colliders of its USD file, where they stand at the start.
        environment: An environment of Isaac Sim by name (`warehouse_with_forklifts`) whose file is on this machine, or
            a USD file. If None, the world as USD. Its frame is the map frame.
        robot_usd: The robot's USD file. If None, trundle's own model of the robot.
        physics_dt: Length of a physics step [s].
        assets_root: Folder that contains Isaac/Environments. If None, TRUNDLE_ISAAC_ASSETS.
        ground_offset: Initial height [m] of the robot above z = 0, from which it settles.

    Attributes:
        on_substep: Called with a `Substep` after every physics step; None by default.

    Raises:
        InputError: If an option is out of range, a file is missing, or PhysX cannot run here.
        MissingExtraError: If ovphysx or usd-core is not installed.
        UnknownNameError: If there is no such environment, or the robot has no lidar of a chosen name.
        WorldError: If the stage cannot be simulated: not in metres with z up, or without a collider.
        RobotError: If the robot's USD lacks the joints of its wheels.
        SimulationError: If there is no floor under the robot.
    """

    def __init__(
        self,
        world: World,
        robot: Robot,
        *,
        lidar: LidarChoice = False,
        environment: str | None = None,
        robot_usd: str | None = None,
        physics_dt: float = TIMESTEP,
        assets_root: str | None = None,
        ground_offset: float = GROUND_OFFSET,
    ) -> None:
        super().__init__(robot, physics_dt=physics_dt, ground_offset=ground_offset)
        check_installation()
        need_usd("backend physx")
        from trundle.sim.physx.body import ContactReader
        from trundle.sim.physx.files import choose_files, write_scene
        from trundle.sim.physx.stage import RunningStage

        files = choose_files(robot, environment=environment, robot_usd=robot_usd, assets_root=assets_root)
        self._ramp = CommandRamp(robot, physics_dt)
        self._field = MoverField(world, robot) if world.movers else None
        seen: World | None = world
        if files.environment is not None:
            loaded = replace(World.load(files.environment), movers=world.movers) if lidar else None
            seen = loaded or (world if world.solids else None)
        self._world = self._first_world = seen
        self._beams = SceneBeams(seen or world, self._field)
        self._lidars = LidarSet(robot, lidar, self._beams.cast)
        self._beams.prepare(self._lidars.heights)
        self._stage: RunningStage | None = None
        self._settle_s = SETTLE_S
        self._has_warned = False
        self._pairs = 1
        self._odometry = WheelOdometry(robot, physics_dt)
        self.on_substep: Callable[[Substep], None] | None = None
        self._folder = TemporaryDirectory(prefix="trundle-")
        try:
            scene = write_scene(
                Path(self._folder.name), world, robot, files, self._field, height=ground_offset, timestep=physics_dt
            )
            self._scene, self._pairs = scene, len(scene.wheels) // 2
            self._contacts = ContactReader(scene, seen or world)
            self._stage = RunningStage(scene)
            self._body = RobotBody(
                self._stage.attachment,
                robot,
                height=ground_offset,
                centre=self._stage.centre_of_mass,
                timestep=physics_dt,
            )
            if scene.knows_floor:
                self._settle_beside(world)
            self.reset(Pose2D(*world.seeds[0]) if world.seeds else Pose2D(0.0, 0.0))
        except BaseException:
            self.close()
            raise

    def _settle_beside(self, world: World) -> None:
        """Settle the robot beside a world with a level floor: from now on it starts as it stands there.

        That saves half of a reset's time, and a robot that starts in a solid is not pushed far before it is told.
        """
        _, high = world.bounds
        self._body.stand(self._running.attachment, Pose2D(high[0] + _FAR, high[1] + _FAR))
        self._settle(SETTLE_S)
        self._body.keep_rest(self._running.attachment)
        self._settle_s = _SHORT_SETTLE_S

    def _settle(self, duration: float) -> None:
        """Let the robot come to rest.

        Raises:
            SimulationError: If it falls.
        """
        attachment = self._running.attachment
        for _ in range(round(duration / self._physics_dt)):
            attachment.step(self._physics_dt)
        self._check_stands(self._body.pose(attachment).position[2], duration)

    def watch_substeps(self, watch: Callable[[Substep], None] | None) -> bool:
        """Call `watch` after every physics step from now on, or no longer (None)."""
        self.on_substep = watch
        return True

    def base_pose(self) -> Pose3D:
        """Return the pose of base_link in space, map frame."""
        return self._body.pose(self._running.attachment)

    def joint_names(self) -> list[str]:
        """Return the names of the joints that PhysX moves, in its order."""
        return self._check_open().attachment.joint_names()

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame) and set the time to 0. The same seed gives the same run.

        The robot is put on the floor, or in an environment at the ground offset, and settles, which does not count as
        simulated time. A pose inside a solid is accepted; the state's contacts then name the solid.

        Raises:
            SimulationError: If it was closed, or there is no floor under the robot.
        """
        stage = self._check_open()
        pose, seed = Pose2D.of(pose), check_seed(seed)
        attachment = stage.begin()
        self._contacts.attached()
        if self._world is not self._first_world:
            self._change_world(self._first_world)
        if self._field is not None:
            # Before the robot: a mover that is parked in it makes its pose NaN.
            self._field.reset(seed, pose)
            attachment.put_movers(self._field.state)
        if not self._scene.knows_floor:
            self._body.rest = Pose3D((0.0, 0.0, self._ground_offset))
        self._body.stand(attachment, pose)
        self._told = Motion(0.0, 0.0, 0.0, 0.0)
        self._ramp.reset()
        self._lidars.reset(seed)
        touched: dict[tuple[str, str], Contact] = {}
        # Contacts first, as a robot that starts in a solid is pushed out of it while it settles.
        attachment.step(self._physics_dt)
        self._contacts.read(attachment, touched)
        self._settle(_SHORT_SETTLE_S if touched else self._settle_s)
        self._contacts.find_floor(attachment)
        self._contacts.read(attachment, touched)
        self._come_to_rest(None if touched else pose)
        self._steps = 0
        self._odometry.reset(pose)
        return self._state(touched, since=-1.0, at_rest=True)

    def place(self, pose: Pose2D) -> RobotState:
        """Put the robot at rest at `pose` (map frame); time, wheels and odometry stay as they are.

        Raises:
            SimulationError: If it was closed.
        """
        stage = self._check_open()
        pose = Pose2D.of(pose)
        self._told = Motion(0.0, 0.0, 0.0, 0.0)
        self._ramp.reset()
        attachment = stage.attachment
        self._drive(self._told)
        self._body.stand(attachment, pose)
        # Contacts are known after a step, which must not move it.
        attachment.step(self._physics_dt)
        touched: dict[tuple[str, str], Contact] = {}
        self._contacts.read(attachment, touched)
        self._body.stand(attachment, pose)
        self._odometry.skip_to(attachment.wheels()[0])
        return self._state(touched, since=self._steps * self._physics_dt, at_rest=True)

    def add_solid(self, solid: Solid) -> None:
        """Put a solid into the running stage until the next reset.

        Raises:
            WorldError: If the world has a solid or a mover of that name, or PhysX refuses it.
        """
        stage = self._check_open()
        world = self._world or World("added", ())
        changed = replace(world, solids=(*world.solids, solid))
        stage.add(solid)
        self._change_world(changed if self._world is not None else None, named=changed)

    def _change_world(self, world: World | None, named: World | None = None) -> None:
        self._world = world
        if named is None:
            named = world or World("none", ())
        self._contacts.change_world(named, self._running.added)
        self._beams.change_world(named)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period of `dt` [s], a multiple of the physics step, with a commanded twist.

        Raises:
            SimulationError: If it was closed, or the physics diverged.
            InputError: If `dt` is not a multiple of the physics step.
        """
        attachment, timestep = self._check_open().attachment, self._physics_dt
        since = self._steps * timestep
        motions = self._ramp.advance(command, count_steps(dt, timestep))
        touched: dict[tuple[str, str], Contact] = {}
        for number, motion in enumerate(motions, 1):
            if motion is not self._told:
                self._drive(motion)
            if self._field is not None:
                attachment.aim_movers(self._field.advance((self._steps + 1) * timestep, self._robot_motion))
            attachment.step(timestep)
            self._steps += 1
            self._contacts.read(attachment, touched)
            if number % self._odometry.steps_between == 0 and number < len(motions):
                self._odometry.follow(attachment.wheels()[0])
            if self.on_substep is not None:
                self._report(self.on_substep)
        return self._state(touched, since)

    def _drive(self, motion: Motion) -> None:
        self._told = motion
        self._running.attachment.set_speeds((motion.left, motion.right) * self._pairs)

    def _report(self, watch: Callable[[Substep], None]) -> None:
        angles, speeds = self._running.attachment.wheels()
        self._odometry.follow(angles)
        pose, twist, _ = self._body.motion(self._running.attachment)
        watch(Substep(self._steps * self._physics_dt, pose, twist, self._odometry.turned, WheelSpeeds(*speeds)))

    def close(self) -> None:
        """Release the engine; closing twice does nothing."""
        stage, self._stage = self._stage, None
        try:
            if stage is not None:
                stage.close()
        finally:
            self._folder.cleanup()

    def _check_open(self) -> RunningStage:
        if self._stage is None:
            raise SimulationError("this simulator was closed; make a new one with trundle.simulate")
        return self._stage

    @property
    def _running(self) -> RunningStage:
        return self._check_open()

    def _come_to_rest(self, pose: Pose2D | None) -> None:
        """Stop the robot where it has settled, but exactly at a pose if one is given."""
        attachment = self._running.attachment
        if pose is None:
            self._body.put(attachment, self._body.pose(attachment))
        else:
            if not self._scene.knows_floor:
                self._warn_of_tilt(tilt_of(self._body.keep_rest(attachment)))
            self._body.stand(attachment, pose)
        self._odometry.skip_to(attachment.wheels()[0])

    def _warn_of_tilt(self, tilt: float) -> None:
        if tilt > _LARGEST_TILT and not self._has_warned:
            self._has_warned = True
            warnings.warn(
                f"{self._scene.source}: the robot stands tilted by {math.degrees(tilt):.1f}°. If the floor is level, "
                "its wheels have sunk in: PhysX loses narrow wheels in a box that is more than 100 times as long as "
                "thick. Make such a floor thicker, or a plane",
                WorldWarning,
                stacklevel=4,
            )

    def _robot_motion(self) -> tuple[Pose2D, float]:
        pose, twist, _ = self._body.motion(self._running.attachment)
        return pose, twist.v

    def _state(self, touched: dict[tuple[str, str], Contact], since: float, *, at_rest: bool = False) -> RobotState:
        pose, twist, tilt = self._body.motion(self._running.attachment)
        speeds = (0.0, 0.0)
        if at_rest:
            twist = Twist2D(0.0, 0.0)
        else:
            angles, speeds = self._running.attachment.wheels()
            self._odometry.follow(angles)
        time = self._steps * self._physics_dt
        return RobotState(
            time=time,
            pose=pose,
            twist=twist,
            wheel_positions=self._odometry.turned,
            wheel_speeds=WheelSpeeds(*speeds),
            odometry=self._odometry.pose,
            contacts=tuple(touched.values()),
            scans=self._lidars.scan(pose, since, time),
            odometry_twist=self._robot.twist(WheelSpeeds(*speeds)),
            movers=() if self._field is None else self._field.states(),
            tilt=tilt,
        )
