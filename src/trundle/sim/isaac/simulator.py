"""`IsaacSimulator`: the robot in Isaac Sim's physics, with the interface of every other simulator."""

from __future__ import annotations

import importlib
import math
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from trundle.errors import InputError, RobotError, SimulationError, WorldError
from trundle.geometry import Pose2D, Twist2D, integrate_twist, wrap_angle
from trundle.robots import Robot, WheelSpeeds
from trundle.sim.isaac.adapter import Adapter, BodyState, base_motion, placement, planar_pose
from trundle.sim.isaac.application import Application, running_application
from trundle.sim.isaac.assets import check_joints, check_units, environment_path, find_root, given_root, robot_path
from trundle.sim.isaac.signatures import differences
from trundle.sim.lidar import LidarChoice
from trundle.sim.ramp import CommandRamp, Motion, count_steps
from trundle.sim.state import Contact, RobotState
from trundle.sim.usd_simulator import SETTLE_S, UsdSimulator
from trundle.usd import GROUND_OFFSET, TIMESTEP
from trundle.usd.write import write_world
from trundle.values import check_seed
from trundle.worlds import World

if TYPE_CHECKING:
    import numpy.typing as npt
    from isaacsim import SimulationApp

    from trundle.sim.isaac.contacts import ContactReader

ROBOT_PATH = "/trundle_robot"

_ADAPTERS = {5: "trundle.sim.isaac.api5:Isaac5Adapter", 6: "trundle.sim.isaac.api6:Isaac6Adapter"}


class IsaacSimulator(UsdSimulator):
    """Drives a robot through a stage in Isaac Sim 5.1 or 6.x.

    The limits of the robot are applied at every physics step, and its wheels are commanded through Isaac Sim's own
    DifferentialController. The stage is an environment of Isaac Sim, any USD file, or the world itself, written as USD.
    Isaac Sim is started unless it is running, and closed with the simulator.

    Args:
        world: The world; contacts are reported with its solids and cells by name.
        robot: The robot.
        lidar: Must be False: Isaac Sim's lidars are not read.
        environment: An environment by name (`warehouse_with_forklifts`), or a USD file. If None, the world as USD.
            Its frame is the map frame.
        robot_usd: The robot's USD file. If None, that of Isaac Sim's assets.
        headless: Start Isaac Sim without a window.
        livestream: Start it without a window and stream by WebRTC.
        physics_dt: Length of a physics step [s].
        assets_root: Folder or address that contains Isaac/Environments and Isaac/Robots. If None,
            TRUNDLE_ISAAC_ASSETS, or Isaac Sim's own asset root.
        ground_offset: Initial height [m] of the robot's prim above z = 0, from which it settles.
        application: A running SimulationApp. It is not closed.

    Raises:
        InputError: If there is no Isaac Sim, an option is out of range, or assets are missing.
        UnknownNameError: If there is no such environment.
        WorldError: If the world has movers, or the stage cannot be opened, or is not in metres with z up.
        RobotError: If the robot's USD lacks the joints of its wheels.
        SimulationError: If Isaac Sim does not start.
    """

    def __init__(
        self,
        world: World,
        robot: Robot,
        *,
        lidar: LidarChoice = False,
        environment: str | None = None,
        robot_usd: str | None = None,
        headless: bool = False,
        livestream: bool = False,
        physics_dt: float = TIMESTEP,
        assets_root: str | None = None,
        ground_offset: float = GROUND_OFFSET,
        application: SimulationApp | None = None,
    ) -> None:
        super().__init__(robot, physics_dt=physics_dt, ground_offset=ground_offset)
        if robot.drive.axles:
            raise RobotError(
                f"the robot {robot.name!r} has several wheels per side, backend isaac supports one; use backend mujoco "
                "or kinematic"
            )
        if world.movers:
            raise WorldError(
                f"the world {world.name!r} has movers, and backend isaac has none yet; use backend mujoco or "
                "kinematic, or a world without movers"
            )
        if lidar:
            raise InputError(
                "backend isaac simulates no lidars; use backend mujoco or kinematic, or leave lidar out (--no-lidar)"
            )
        # Check everything that does not need Isaac Sim before its start, which takes a minute.
        scene = None if environment is None else (environment, environment_path(environment))
        machine = robot_path(robot.name, robot_usd)
        given_root(assets_root)
        self._world = world if world.solids or environment is None else None
        self._ramp = CommandRamp(robot, physics_dt)
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._adapter: Adapter | None = None
        shared = running_application()
        self._owns_application = shared is None
        self._application = shared or Application(headless=headless, livestream=livestream, app=application)
        self._closed = False
        try:
            root = find_root(assets_root) if machine is not None or (scene is not None and scene[1]) else ""
            usd = robot_usd if machine is None else f"{root}/{machine}"
            self._load(world, scene and (f"{root}/{scene[1]}" if scene[1] else scene[0]), cast("str", usd))
            self.reset(Pose2D(*world.seeds[0]) if world.seeds else Pose2D(0.0, 0.0))
        except (AttributeError, TypeError, ImportError) as error:
            found = differences(self._application.generation)
            self.close()
            if not found:
                raise
            lines = "\n  ".join(found)
            raise SimulationError(f"this Isaac Sim differs from what trundle expects ({error}):\n  {lines}") from error
        except BaseException:
            self.close()
            raise

    @property
    def application(self) -> Application:
        """The Isaac Sim that it runs in."""
        return self._application

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame) and set the time to 0. Nothing here is random.

        The pose is written to the robot's prim at the ground offset while the timeline is stopped; then the robot
        settles on the floor, which does not count as simulated time. A robot that is put into a collider touches it in
        the first physics step, and PhysX then pushes it out; so it is put there again, does not settle, and the
        state's contacts name the collider.

        Raises:
            SimulationError: If it was closed, or the robot does not settle.
        """
        adapter = self._check_open()
        pose = Pose2D.of(pose)
        check_seed(seed)
        self._place(adapter, pose)
        # The prim is base_link; Isaac Sim reports the pose of the articulation's root, which may be elsewhere.
        body = adapter.body()
        self._check_sound(body)
        self._root = pose.inverse() @ planar_pose(body)
        if math.hypot(self._root.x, self._root.y) > self._robot.circumscribed_radius:
            raise SimulationError(
                f"the robot was put at {pose}, and its root is {math.hypot(self._root.x, self._root.y):.2f} m away: is "
                "the articulation's root a body of the robot, and is the robot's prim at base_link?"
            )
        self._ramp.reset()
        self._told = Motion(0.0, 0.0, 0.0, 0.0)
        touched = self._settle(adapter, pose)
        self._steps = 0
        self._angles = adapter.wheel_positions()
        self._turned = (0.0, 0.0)
        self._odometry = (pose.x, pose.y, pose.yaw)
        if self._application.draws:
            adapter.draw()
        pose, _ = base_motion(adapter.body(), self._root)
        return self._state(pose, Twist2D(0.0, 0.0), WheelSpeeds(0.0, 0.0), touched)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period of `dt` [s], a multiple of the physics step, with a commanded twist.

        It waits while the timeline is paused in the window.

        Raises:
            SimulationError: If it or Isaac Sim was closed, the timeline was stopped, or the physics diverged.
            InputError: If `dt` is not a multiple of the physics step.
        """
        adapter = self._check_open()
        motions = self._ramp.advance(command, count_steps(dt, self._physics_dt))
        self._wait_for_timeline(adapter)
        touched: dict[tuple[str, str], Contact] = {}
        for motion in motions:
            if motion is not self._told:
                adapter.drive(motion.v, motion.w)
            self._told = motion
            adapter.step()
            self._steps += 1
            self._follow_wheels(adapter.wheel_positions())
            self._contacts.read(touched)
        if self._application.draws:
            adapter.draw()
        body = adapter.body()
        self._check_sound(body)
        pose, twist = base_motion(body, self._root)
        return self._state(pose, twist, WheelSpeeds(*adapter.wheel_speeds()), touched)

    def picture(
        self, eye: tuple[float, float, float], target: tuple[float, float, float], size: tuple[int, int] = (1280, 720)
    ) -> npt.NDArray[np.uint8]:
        """Take a picture from `eye` towards `target` [m], map frame.

        Returns:
            RGB, uint8, shape (height, width, 3).

        Raises:
            SimulationError: If it was closed, or there is no picture.
        """
        self.look(eye, target)
        from trundle.sim.isaac.picture import take_picture

        return take_picture(size, self._check_open().draw)

    def look(self, eye: tuple[float, float, float], target: tuple[float, float, float]) -> None:
        """Put the camera of Isaac Sim's viewport at `eye`, looking at `target` [m], map frame."""
        from trundle.sim.isaac.picture import CAMERA

        self._check_open().look(np.array(eye), np.array(target), CAMERA)

    def joint_names(self) -> list[str]:
        """Return the names of the joints that Isaac Sim moves, in its order."""
        return self._check_open().joint_names()

    def wait(self) -> None:
        """Process window events until the window is closed."""
        adapter = self._check_open(alive=False)
        while self._application.is_running:
            adapter.draw()

    def close(self) -> None:
        """Release the world, and close Isaac Sim if it was started here; closing twice does nothing."""
        if self._closed:
            return
        self._closed = True
        adapter, self._adapter = self._adapter, None
        try:
            if adapter is not None and self._application.is_running:
                adapter.close()
        finally:
            if self._folder is not None:
                self._folder.cleanup()
            if self._owns_application:
                self._application.close()

    def _place(self, adapter: Adapter, pose: Pose2D) -> None:
        """Stop, put the robot's prim at a pose above the floor, and play with its wheels held."""
        adapter.place(*placement(pose, self._ground_offset))
        adapter.drive(0.0, 0.0)

    def _settle(self, adapter: Adapter, pose: Pose2D) -> dict[tuple[str, str], Contact]:
        """Let the robot come to rest on the floor; return what it touches.

        The contacts of the first step say what it is inside of: later it has been pushed out, or its pose is NaN.
        """
        adapter.step()
        first = self._contacts.touching()
        for _ in range(round(SETTLE_S / self._physics_dt) - 1):
            adapter.step()
        self._contacts.find_floor(first)
        touched: dict[tuple[str, str], Contact] = {}
        # At first it is ground_offset higher than it stands: its top may touch what is above it then.
        self._contacts.add(first, touched, height=self._robot.body.height)
        if touched:
            self._place(adapter, pose)
            return touched
        body = adapter.body()
        self._check_sound(body)
        self._check_stands(float(body.position[2]), SETTLE_S)
        adapter.halt()
        self._contacts.read(touched)
        return touched

    def _load(self, world: World, scene: str | None, usd: str) -> None:
        """Open the stage and put the robot into it."""
        module, _, name = _ADAPTERS[self._application.generation].partition(":")
        adapter = cast("Adapter", getattr(importlib.import_module(module), name)())
        self._open_stage(adapter, scene if scene is not None else self._write(world))
        try:
            adapter.add_robot(usd, ROBOT_PATH)
        except (FileNotFoundError, ValueError) as error:
            raise RobotError(f"the robot's USD {usd} cannot be read: {error}") from error
        self._wait_for_loading(adapter)
        from trundle.sim.isaac.contacts import ContactReader

        check_joints(self._robot, usd, ROBOT_PATH)
        adapter.load_robot(self._robot, ROBOT_PATH, self._physics_dt)
        self._adapter = adapter
        self._contacts: ContactReader = ContactReader(world, ROBOT_PATH)

    def _open_stage(self, adapter: Adapter, path: str) -> None:
        try:
            done = adapter.open_stage(path)
        except ValueError as error:
            raise WorldError(f"{path}: Isaac Sim cannot open it: {error}") from error
        if not done:
            raise WorldError(f"{path}: Isaac Sim cannot open it; do the file and its references exist?")
        self._wait_for_loading(adapter)
        check_units(path, *adapter.stage_units())

    def _write(self, world: World) -> str:
        """Write the world as USD, for Isaac Sim to open."""
        self._folder = tempfile.TemporaryDirectory(prefix="trundle-")
        path = Path(self._folder.name) / "world.usd"
        write_world(world, path, profile="isaac")
        return str(path)

    def _wait_for_loading(self, adapter: Adapter) -> None:
        self._application.update()
        while adapter.is_loading():
            if not self._application.is_running:
                raise SimulationError("Isaac Sim was closed while it loaded the stage")
            self._application.update()

    def _wait_for_timeline(self, adapter: Adapter) -> None:
        """Keep the window responsive while the timeline is paused."""
        while not adapter.is_playing():
            if adapter.is_stopped() or not self._application.draws:
                raise SimulationError("the timeline of Isaac Sim was stopped; a stopped run cannot be resumed")
            self._check_open()
            adapter.draw()
            time.sleep(0.02)

    def _check_open(self, *, alive: bool = True) -> Adapter:
        if self._closed or self._adapter is None:
            raise SimulationError("this simulator was closed; make a new one with trundle.simulate")
        if alive and not self._application.is_running:
            raise SimulationError("Isaac Sim was closed")
        return self._adapter

    def _check_sound(self, body: BodyState) -> None:
        numbers = np.concatenate([body.position, body.quaternion, body.linear, body.angular])
        if not np.isfinite(numbers).all():
            raise SimulationError(
                "the physics of Isaac Sim diverged: a pose or a speed is not finite; use a smaller --physics-dt "
                f"than {self._physics_dt} s, and check the robot's masses and colliders"
            )

    def _follow_wheels(self, angles: tuple[float, float]) -> None:
        """Add the wheels' rotation in a physics step; angles that Isaac Sim wraps at a full turn are unwrapped."""
        by_left, by_right = (math.remainder(new - old, math.tau) for new, old in zip(angles, self._angles, strict=True))
        self._angles = angles
        self._turned = (self._turned[0] + by_left, self._turned[1] + by_right)
        radius, track = self._robot.drive.wheel_radius, self._robot.drive.track_width
        x, y, yaw = integrate_twist(
            *self._odometry, radius * (by_left + by_right) / 2.0, radius * (by_right - by_left) / track, 1.0
        )
        self._odometry = (float(x), float(y), float(yaw))

    def _state(
        self, pose: Pose2D, twist: Twist2D, speeds: WheelSpeeds, touched: dict[tuple[str, str], Contact]
    ) -> RobotState:
        return RobotState(
            time=self._steps * self._physics_dt,
            pose=pose,
            twist=twist,
            wheel_positions=WheelSpeeds(*self._turned),
            wheel_speeds=speeds,
            odometry=Pose2D(self._odometry[0], self._odometry[1], wrap_angle(self._odometry[2])),
            contacts=tuple(touched.values()),
            odometry_twist=self._robot.twist(speeds),
        )
