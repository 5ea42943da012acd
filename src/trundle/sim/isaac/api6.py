"""Isaac Sim 6.x: SimulationManager and the experimental WheeledRobot.

Imported only once the application runs.
"""

from __future__ import annotations

import numpy as np
from isaacsim.core.experimental.utils import app as app_utils
from isaacsim.core.experimental.utils import stage as stage_utils
from isaacsim.core.rendering_manager import RenderingManager, ViewportManager
from isaacsim.core.simulation_manager import SimulationManager
from isaacsim.robot.experimental.wheeled_robots.controllers import DifferentialController
from isaacsim.robot.experimental.wheeled_robots.robots import WheeledRobot

from trundle.errors import SimulationError
from trundle.geometry import FloatArray
from trundle.robots import Robot
from trundle.sim.isaac.adapter import BodyState

_ROUNDS = 60
"""Limit on application updates until physics has initialized the robot."""


class Isaac6Adapter:
    """One robot in one stage of Isaac Sim 6.x; see `Adapter`."""

    def open_stage(self, path: str) -> bool:
        """Open a USD file instead of the current stage."""
        done, _ = stage_utils.open_stage(path)
        return done

    def is_loading(self) -> bool:
        """Return whether the stage is still being loaded."""
        return stage_utils.is_stage_loading()

    def stage_units(self) -> tuple[float, str]:
        """Return metres per unit, and the up axis."""
        meters, _ = stage_utils.get_stage_units()
        return meters, str(stage_utils.get_stage_up_axis()).upper()

    def add_robot(self, usd: str, path: str) -> None:
        """Add a reference to a robot's USD file at a prim path."""
        stage_utils.add_reference_to_stage(usd, path)

    def load_robot(self, robot: Robot, path: str, timestep: float) -> None:
        """Load the articulation, and run physics on the CPU: one robot does not justify a GPU."""
        self._wheel_names = [robot.drive.left_joint, robot.drive.right_joint]
        # Passing a pose also replaces the transform operations of the asset's prim by the standard ones that
        # `place` writes.
        self._robot = WheeledRobot(
            path, wheel_dof_names=self._wheel_names, positions=[[0.0, 0.0, 0.0]], orientations=[[1.0, 0.0, 0.0, 0.0]]
        )
        self._controller = _controller(robot)
        SimulationManager.setup_simulation(dt=timestep, device="cpu")

    def place(self, position: FloatArray, quaternion: FloatArray) -> None:
        """Write a pose to the robot's prim while the timeline is stopped, and play."""
        app_utils.stop()
        RenderingManager.render()
        self._robot.set_world_poses(positions=[position], orientations=[quaternion])
        app_utils.play()
        for _ in range(_ROUNDS):
            if self._robot.is_physics_tensor_entity_valid():
                break
            RenderingManager.render()
        else:
            raise SimulationError("Isaac Sim's physics did not initialize the robot: is it an articulation?")
        self._wheels = [int(index) for index in self._robot.get_dof_indices(self._wheel_names).numpy()]
        centers, _ = self._robot.get_link_coms(link_indices=[0])
        self._center = centers.numpy()[0, 0]

    def joint_names(self) -> list[str]:
        """Return the names of the articulation's degrees of freedom, in its order."""
        return list(self._robot.dof_names)

    def drive(self, v: float, w: float) -> None:
        """Command a twist; joints other than the wheels are not commanded."""
        self._robot.apply_wheel_actions(self._controller.forward(np.array([v, w])))

    def step(self) -> None:
        """Do one physics step."""
        SimulationManager.step(steps=1)

    def draw(self) -> None:
        """Render without physics."""
        RenderingManager.render()

    def is_playing(self) -> bool:
        """Return whether the timeline runs."""
        return app_utils.is_playing()

    def is_stopped(self) -> bool:
        """Return whether the timeline was stopped."""
        return app_utils.is_stopped()

    def halt(self) -> None:
        """Set the robot's velocities to 0."""
        self._robot.set_velocities(linear_velocities=[[0.0, 0.0, 0.0]], angular_velocities=[[0.0, 0.0, 0.0]])
        self._robot.set_dof_velocities(0.0)

    def body(self) -> BodyState:
        """Return the motion of the articulation's root."""
        positions, quaternions = self._robot.get_world_poses()
        linear, angular = self._robot.get_velocities()
        return BodyState(
            positions.numpy()[0], quaternions.numpy()[0], linear.numpy()[0], angular.numpy()[0], self._center
        )

    def wheel_positions(self) -> tuple[float, float]:
        """Return the angles of the wheels."""
        left, right = self._robot.get_dof_positions(dof_indices=self._wheels).numpy()[0]
        return float(left), float(right)

    def wheel_speeds(self) -> tuple[float, float]:
        """Return the speeds of the wheels."""
        left, right = self._robot.get_dof_velocities(dof_indices=self._wheels).numpy()[0]
        return float(left), float(right)

    def look(self, eye: FloatArray, target: FloatArray, camera: str) -> None:
        """Put a camera at `eye`, looking at `target`."""
        ViewportManager.set_camera_view(camera, eye=eye, target=target)

    def close(self) -> None:
        """Stop the timeline."""
        app_utils.stop()


def _controller(robot: Robot) -> DifferentialController:
    drive = robot.drive
    if drive.max_wheel_speed is None:
        return DifferentialController(wheel_radius=drive.wheel_radius, wheel_base=drive.track_width)
    return DifferentialController(
        wheel_radius=drive.wheel_radius, wheel_base=drive.track_width, max_wheel_speed=drive.max_wheel_speed
    )
