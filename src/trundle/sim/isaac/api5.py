"""Isaac Sim 5.1: isaacsim.core.api's World, WheeledRobot and DifferentialController.

Imported only once the application runs.
"""

from __future__ import annotations

import numpy as np
from isaacsim.core.api import World
from isaacsim.core.prims import Articulation
from isaacsim.core.utils import stage as stage_utils
from isaacsim.core.utils.viewports import set_camera_view
from isaacsim.robot.wheeled_robots.controllers.differential_controller import DifferentialController
from isaacsim.robot.wheeled_robots.robots import WheeledRobot

from trundle.geometry import FloatArray
from trundle.robots import Robot
from trundle.sim.isaac.adapter import BodyState


class Isaac5Adapter:
    """One robot in one stage of Isaac Sim 5.1; see `Adapter`."""

    def __init__(self) -> None:
        self._has_world = False

    def open_stage(self, path: str) -> bool:
        """Open a USD file instead of the current stage."""
        return stage_utils.open_stage(path)

    def is_loading(self) -> bool:
        """Return whether the stage is still being loaded."""
        return stage_utils.is_stage_loading()

    def stage_units(self) -> tuple[float, str]:
        """Return metres per unit, and the up axis."""
        return stage_utils.get_stage_units(), str(stage_utils.get_stage_up_axis()).upper()

    def add_robot(self, usd: str, path: str) -> None:
        """Add a reference to a robot's USD file at a prim path."""
        stage_utils.add_reference_to_stage(usd_path=usd, prim_path=path)

    def load_robot(self, robot: Robot, path: str, timestep: float) -> None:
        """Create the world; the robot is not added to its scene, whose reset would move it to a default pose."""
        drive = robot.drive
        self._world = World(physics_dt=timestep, rendering_dt=timestep, stage_units_in_meters=1.0)
        self._has_world = True
        self._robot = WheeledRobot(
            prim_path=path, name=robot.name, wheel_dof_names=[drive.left_joint, drive.right_joint]
        )
        # WheeledRobot does not give the links' centres of mass; a view of the same articulation does.
        self._links = Articulation(path, name=f"{robot.name}_links", reset_xform_properties=False)
        self._controller = _controller(robot)

    def place(self, position: FloatArray, quaternion: FloatArray) -> None:
        """Write a pose to the robot's prim while the timeline is stopped, and play."""
        self._world.stop()
        self._robot.set_world_pose(position=position, orientation=quaternion)
        self._world.reset()
        # A robot outside any scene must be initialized again after every stop.
        self._robot.initialize()
        self._links.initialize()
        centers, _ = self._links.get_body_coms(body_indices=[0])
        self._center = centers[0, 0]

    def joint_names(self) -> list[str]:
        """Return the names of the articulation's degrees of freedom, in its order."""
        return list(self._robot.dof_names)

    def drive(self, v: float, w: float) -> None:
        """Command a twist; all joints except the wheels are commanded 0, as in WheeledRobot of 5.1."""
        self._robot.apply_wheel_actions(self._controller.forward(np.array([v, w])))

    def step(self) -> None:
        """Do one physics step."""
        self._world.step(render=False)

    def draw(self) -> None:
        """Render without physics."""
        self._world.render()

    def is_playing(self) -> bool:
        """Return whether the timeline runs."""
        return self._world.is_playing()

    def is_stopped(self) -> bool:
        """Return whether the timeline was stopped."""
        return self._world.is_stopped()

    def halt(self) -> None:
        """Set the robot's velocities to 0."""
        self._robot.set_linear_velocity(np.zeros(3))
        self._robot.set_angular_velocity(np.zeros(3))
        self._robot.set_joint_velocities(np.zeros(self._robot.num_dof))

    def body(self) -> BodyState:
        """Return the motion of the articulation's root."""
        position, quaternion = self._robot.get_world_pose()
        return BodyState(
            position,
            quaternion,
            self._robot.get_linear_velocity(),
            self._robot.get_angular_velocity(),
            self._center,
        )

    def wheel_positions(self) -> tuple[float, float]:
        """Return the angles of the wheels."""
        left, right = self._robot.get_wheel_positions()
        return float(left), float(right)

    def wheel_speeds(self) -> tuple[float, float]:
        """Return the speeds of the wheels."""
        left, right = self._robot.get_wheel_velocities()
        return float(left), float(right)

    def look(self, eye: FloatArray, target: FloatArray, camera: str) -> None:
        """Put a camera at `eye`, looking at `target`."""
        set_camera_view(eye=eye, target=target, camera_prim_path=camera)

    def close(self) -> None:
        """Stop, and clear World, a singleton of the process, for the next simulator."""
        if self._has_world:
            self._world.stop()
            World.clear_instance()


def _controller(robot: Robot) -> DifferentialController:
    drive = robot.drive
    if drive.max_wheel_speed is None:
        return DifferentialController(robot.name, wheel_radius=drive.wheel_radius, wheel_base=drive.track_width)
    return DifferentialController(
        robot.name,
        wheel_radius=drive.wheel_radius,
        wheel_base=drive.track_width,
        max_wheel_speed=drive.max_wheel_speed,
    )
