"""The interface of every simulator, and the simulators by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, Self, cast, runtime_checkable

from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D
from trundle.geometry.solids import Solid
from trundle.registry import Registry
from trundle.robots import Robot
from trundle.sim.state import RobotState, Substep
from trundle.values import check_kind, check_number
from trundle.worlds import World

SIMULATORS: Registry[Simulator] = Registry(
    "backend",
    "trundle.simulators",
    {
        "isaac": "trundle.sim.isaac:IsaacSimulator",
        "mujoco": "trundle.sim.mujoco.simulator:MujocoSimulator",
        "kinematic": "trundle.sim.kinematic:KinematicSimulator",
    },
)


@runtime_checkable
class Simulator(Protocol):
    """Moves a robot through a world. The robot's limits in speed and acceleration are applied here, at every step."""

    @property
    def robot(self) -> Robot:
        """The simulated robot."""
        ...

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame) and set the time to 0. The same seed gives the same run."""
        ...

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period of `dt` [s] with a commanded twist.

        Raises:
            SimulationError: If it was closed, or the physics diverged.
        """
        ...

    def close(self) -> None:
        """Release its resources; closing twice does nothing."""
        ...

    def __enter__(self) -> Self:
        """Return self; `with simulate(…) as sim` closes it at the end."""
        ...

    def __exit__(self, *_: object) -> None:
        """Close."""
        ...


def world_of(simulator: Simulator) -> World | None:
    """The world of a simulator; None if it does not provide one.

    It is an optional attribute `world`, not part of `Simulator`: a real robot and older simulators do not have it. Some
    metrics of a run depend on it; see `trundle.mission.Metrics`.
    """
    return getattr(simulator, "world", None)


def timestep_of(simulator: Simulator) -> float | None:
    """Length of the physics steps of a simulator [s]; None if it does not say.

    It is an optional attribute `timestep` of a simulator, which may be within others that have it as `inner`. Control
    periods that are a multiple of it can be driven in parts, so that a late command takes effect in between.

    Raises:
        InputError: If it is not a positive number.
    """
    while (inner := getattr(simulator, "inner", None)) is not None:
        simulator = inner
    timestep = getattr(simulator, "timestep", None)
    if timestep is None:
        return None
    return check_number("the timestep of a simulator", timestep, 1e-6, 10.0, "s")


def watch_substeps(simulator: Simulator, watch: Callable[[Substep], None] | None) -> bool:
    """Let a simulator report every physics step from now on, or no longer (None); False if it cannot.

    It is an optional attribute `on_substep` of a simulator, which may be within others that have it as `inner`.
    """
    while (inner := getattr(simulator, "inner", None)) is not None:
        simulator = inner
    if not hasattr(simulator, "on_substep"):
        return False
    simulator.on_substep = watch  # pyright: ignore[reportAttributeAccessIssue] - optional
    return True


def add_solid(simulator: Simulator, solid: Solid) -> None:
    """Put a solid into the world of a simulator, in the middle of a run; its next reset takes it out again.

    It is an optional method `add_solid(solid)` of a simulator, which may be within others that have it as `inner`.
    `kinematic` and `mujoco` have it. Moving obstacles pass through what is added.

    Raises:
        InputError: If the simulator cannot add solids.
    """
    while (inner := getattr(simulator, "inner", None)) is not None:
        simulator = inner
    add = getattr(simulator, "add_solid", None)
    if not callable(add):
        raise InputError(
            f"{type(simulator).__name__} cannot put anything into its world during a run; use the backend mujoco or "
            "kinematic"
        )
    add(solid)


def place_robot(simulator: Simulator, pose: Pose2D) -> RobotState:
    """Put the robot of a simulator somewhere else, at rest, in the middle of a run; the time stays.

    The wheels do not turn, and the odometry does not change. It is an optional method `place(pose)` of a simulator,
    which may be within others that have it as `inner`. `kinematic` and `mujoco` have it.

    Args:
        simulator: The simulator.
        pose: The pose, map frame.

    Returns:
        The state there, without scans.

    Raises:
        InputError: If the simulator cannot place the robot.
    """
    while (inner := getattr(simulator, "inner", None)) is not None:
        simulator = inner
    place = getattr(simulator, "place", None)
    if not callable(place):
        raise InputError(
            f"{type(simulator).__name__} cannot place the robot during a run; use the backend mujoco or kinematic"
        )
    return cast("RobotState", place(pose))


def simulator_names() -> list[str]:
    """Names that `simulate` takes as a backend, sorted."""
    return SIMULATORS.names()


def simulate(world: World, robot: str | Robot, *, backend: str = "mujoco", **options: Any) -> Simulator:
    """Create a simulator of a robot in a world.

    Args:
        world: The world.
        robot: A robot, a catalogue name or the path of a YAML file.
        backend: "mujoco", "kinematic", "isaac" (in Isaac Sim's own Python), or a name registered by another package.
        options: Passed to the backend (`lidar=True` enables lidars in "mujoco" and "kinematic").

    Raises:
        UnknownNameError: If there is no such backend or robot.
        InputError: If the backend does not take these options, or the world is not a `World`.
    """
    check_kind(world, World, "a simulator's world", "World.load(path) and World.generate(name) make one")
    return SIMULATORS.make(backend, world, Robot.load(robot), **options)
