"""What an adapter to one generation of Isaac Sim's API does: the least that a simulator needs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from trundle.geometry import FloatArray
from trundle.robots import Robot


@dataclass(frozen=True, slots=True)
class BodyState:
    """How the robot's base moves, in the world frame.

    Attributes:
        position: [m], shape (3,).
        quaternion: wxyz, shape (4,).
        linear: Velocity [m/s], shape (3,).
        angular: Velocity [rad/s], shape (3,).
    """

    position: FloatArray
    quaternion: FloatArray
    linear: FloatArray
    angular: FloatArray


class Adapter(Protocol):
    """One robot in one stage. Calls come in this order: open_stage, load_robot, then place, and steps after it."""

    def open_stage(self, path: str) -> bool:
        """Open a USD file in the place of the present stage; False where that did not work."""
        ...

    def is_loading(self) -> bool:
        """Whether the stage is still being loaded."""
        ...

    def stage_units(self) -> tuple[float, str]:
        """Return metres per unit, and the axis that is up."""
        ...

    def add_robot(self, usd: str, path: str) -> None:
        """Reference a robot's USD file at a prim's path."""
        ...

    def load_robot(self, robot: Robot, path: str, timestep: float) -> None:
        """Take the articulation at a prim's path, and prepare physics with steps of `timestep` [s]."""
        ...

    def place(self, position: FloatArray, quaternion: FloatArray) -> None:
        """Stop, write a pose (wxyz) on the robot's prim, and play: everything starts anew from there."""
        ...

    def joint_names(self) -> list[str]:
        """Return the names of the articulation's degrees of freedom, in its order."""
        ...

    def drive(self, v: float, w: float) -> None:
        """Command a twist [m/s, rad/s] through Isaac Sim's DifferentialController."""
        ...

    def step(self) -> None:
        """Do one physics step, and draw nothing."""
        ...

    def draw(self) -> None:
        """Draw, and answer the window; physics stands still."""
        ...

    def is_playing(self) -> bool:
        """Whether the timeline runs; somebody may have paused or stopped it in the window."""
        ...

    def is_stopped(self) -> bool:
        """Whether the timeline was stopped."""
        ...

    def halt(self) -> None:
        """Take all speed from the robot where it stands."""
        ...

    def body(self) -> BodyState:
        """Return how the base moves."""
        ...

    def wheel_positions(self) -> tuple[float, float]:
        """Return the angles [rad] of the left and the right wheel."""
        ...

    def wheel_speeds(self) -> tuple[float, float]:
        """Return the speeds [rad/s] of the left and the right wheel."""
        ...

    def look(self, eye: FloatArray, target: FloatArray, camera: str) -> None:
        """Put a camera at `eye` [m], looking at `target` [m]."""
        ...

    def close(self) -> None:
        """Stop, and let go of the world; the application goes on."""
        ...
