"""The interface of every simulator, and the simulators by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, Self, runtime_checkable

from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D
from trundle.geometry.solids import Solid
from trundle.registry import Registry
from trundle.robots import Robot
from trundle.sim.state import RobotState, Substep
from trundle.values import check_kind
from trundle.worlds import World

SIMULATORS: Registry[SomeSimulator] = Registry(
    "backend",
    "trundle.simulators",
    {
        "isaac": "trundle.sim.isaac:IsaacSimulator",
        "mujoco": "trundle.sim.mujoco.simulator:MujocoSimulator",
        "physx": "trundle.sim.physx.simulator:PhysxSimulator",
        "kinematic": "trundle.sim.kinematic:KinematicSimulator",
        "batch": "trundle.sim.kinematic:KinematicSimulator",  # a suite's missions are driven by a kernel instead
    },
)


@runtime_checkable
class Simulator(Protocol):
    """Moves a robot through a world. The robot's limits in speed and acceleration are applied here, at every step.

    `robot`, `reset`, `step`, `close` and the two methods of a `with` statement are what every simulator has. Every
    other member is optional: its default is the one of a simulator that does not know or cannot do it. `as_simulator`
    gives these defaults to a simulator of another package that lacks a member.
    """

    @property
    def robot(self) -> Robot:
        """The simulated robot."""
        ...

    @property
    def world(self) -> World | None:
        """The world, with what was added since the reset; None where it does not say, as of a real robot.

        Some metrics of a run depend on it; see `trundle.mission.Metrics`.
        """
        return None

    @property
    def timestep(self) -> float | None:
        """Length of a physics step [s]; None where it does not say.

        Control periods that are a multiple of it can be driven in parts, so that a late command takes effect in
        between.
        """
        return None

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame) and set the time to 0. The same seed gives the same run."""
        ...

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period of `dt` [s] with a commanded twist.

        Raises:
            SimulationError: If it was closed, or the physics diverged.
        """
        ...

    def watch_substeps(self, watch: Callable[[Substep], None] | None) -> bool:
        """Call `watch` after every physics step from now on, or no longer (None); return False if it cannot."""
        return False

    def add_solid(self, solid: Solid) -> None:
        """Put a solid into the world, in the middle of a run; the next reset takes it out again.

        Moving obstacles pass through what is added.

        Raises:
            InputError: If this simulator cannot add solids, as by default.
            WorldError: If the world has a solid or a mover of that name.
        """
        raise _cannot_add(self)

    def place(self, pose: Pose2D) -> RobotState:
        """Put the robot at rest at `pose` (map frame), in the middle of a run, and return the state without scans.

        The time stays. The wheels do not turn, and the odometry does not change.

        Raises:
            InputError: If this simulator cannot place the robot, as by default.
            SimulationError: If it was closed.
        """
        raise _cannot_place(self)

    def close(self) -> None:
        """Release its resources; closing twice does nothing."""
        ...

    def __enter__(self) -> Self:
        """Return self; `with simulate(…) as sim` closes it at the end."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close."""
        self.close()


@runtime_checkable
class SomeSimulator(Protocol):
    """The least that an object needs to be used as a simulator; `as_simulator` makes a `Simulator` of it."""

    @property
    def robot(self) -> Robot:
        """The simulated robot."""
        ...

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame) and set the time to 0."""
        ...

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period of `dt` [s] with a commanded twist."""
        ...

    def close(self) -> None:
        """Release its resources."""
        ...

    def __enter__(self) -> Any:
        """Begin a `with` statement."""
        ...

    def __exit__(self, *_: object) -> object:
        """Close."""
        ...


_INNER = "inner"


class SimulatorAdapter(Simulator):
    """Gives a simulator of another package the whole protocol.

    It hands on each optional member that the simulator has, or one that it keeps as `inner`, and has the default of
    `Simulator` for each other. A simulator that has no `watch_substeps` may have an attribute `on_substep`, which is
    set instead. What the simulator has besides can be read here as well.

    Args:
        simulator: The simulator to wrap.

    Attributes:
        simulator: The same.
    """

    def __init__(self, simulator: Any) -> None:
        self.simulator: Any = simulator

    def __getattr__(self, name: str) -> Any:
        if name == "simulator" or name.startswith("__"):  # a copy that is being made has none yet
            raise AttributeError(name)
        return getattr(self.simulator, name)

    def _owner(self, member: str) -> Any:
        """Return the simulator, or one within it, that has an optional member; None where none has."""
        simulator = self.simulator
        while simulator is not None and not hasattr(simulator, member):
            simulator = getattr(simulator, _INNER, None)
        return simulator

    @property
    def robot(self) -> Robot:
        """The simulated robot."""
        return self.simulator.robot

    @property
    def world(self) -> World | None:
        """The world, where the simulator says it; see `Simulator`."""
        owner = self._owner("world")
        return None if owner is None else owner.world

    @property
    def timestep(self) -> float | None:
        """Length of a physics step [s], where the simulator says it; see `Simulator`."""
        owner = self._owner("timestep")
        return None if owner is None else owner.timestep

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame); see `Simulator`."""
        return self.simulator.reset(pose, seed=seed)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period; see `Simulator`."""
        return self.simulator.step(command, dt)

    def watch_substeps(self, watch: Callable[[Substep], None] | None) -> bool:
        """Let the simulator report every physics step, where it can; see `Simulator`."""
        owner = self._owner("watch_substeps")
        if owner is not None:
            return bool(owner.watch_substeps(watch))
        owner = self._owner("on_substep")
        if owner is None:
            return False
        owner.on_substep = watch
        return True

    def add_solid(self, solid: Solid) -> None:
        """Put a solid into the simulator's world, where it can take one; see `Simulator`."""
        owner = self._owner("add_solid")
        if owner is None:
            raise _cannot_add(self.simulator)
        owner.add_solid(solid)

    def place(self, pose: Pose2D) -> RobotState:
        """Put the robot somewhere else, where the simulator can; see `Simulator`."""
        owner = self._owner("place")
        if owner is None:
            raise _cannot_place(self.simulator)
        return owner.place(pose)

    def close(self) -> None:
        """Close the simulator."""
        self.simulator.close()

    def __enter__(self) -> Self:
        self.simulator.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self.simulator.__exit__(*error)


def as_simulator(simulator: SomeSimulator, what: str = "a simulator") -> Simulator:
    """Return a simulator with every member of `Simulator`: itself where it has them all, and an adapter otherwise.

    Args:
        simulator: Any simulator.
        what: What it is, for the message of the error.

    Raises:
        InputError: If it lacks a member of `SomeSimulator`.
    """
    if not isinstance(simulator, SomeSimulator):
        found = type(simulator).__name__
        raise InputError(f"{what} must be of type Simulator, got {found}; trundle.simulate(world, robot) makes one")
    return _complete(simulator)


def _complete(simulator: SomeSimulator) -> Simulator:
    return simulator if isinstance(simulator, Simulator) else SimulatorAdapter(simulator)


def world_of(simulator: SomeSimulator) -> World | None:
    """Return the world of a simulator; None if it does not provide one. See `Simulator.world`."""
    return _complete(simulator).world


def add_solid(simulator: SomeSimulator, solid: Solid) -> None:
    """Put a solid into the world of a simulator until its next reset. See `Simulator.add_solid`.

    `kinematic`, `mujoco` and `physx` can.

    Raises:
        InputError: If the simulator cannot add solids.
    """
    _complete(simulator).add_solid(solid)


def place_robot(simulator: SomeSimulator, pose: Pose2D) -> RobotState:
    """Put the robot of a simulator somewhere else, at rest, in the middle of a run. See `Simulator.place`.

    `kinematic`, `mujoco` and `physx` can.

    Args:
        simulator: The simulator.
        pose: The pose, map frame.

    Returns:
        The state there, without scans.

    Raises:
        InputError: If the simulator cannot place the robot.
    """
    return _complete(simulator).place(pose)


def _cannot_add(simulator: object) -> InputError:
    return InputError(
        f"{type(simulator).__name__} cannot put anything into its world during a run; use the backend mujoco, "
        "physx or kinematic"
    )


def _cannot_place(simulator: object) -> InputError:
    return InputError(
        f"{type(simulator).__name__} cannot place the robot during a run; use the backend mujoco, physx or kinematic"
    )


def simulator_names() -> list[str]:
    """Return names that `simulate` takes as a backend, sorted."""
    return SIMULATORS.names()


def simulate(world: World, robot: str | Robot, *, backend: str = "mujoco", **options: Any) -> Simulator:
    """Create a simulator of a robot in a world.

    Args:
        world: The world.
        robot: A robot, a catalogue name or the path of a YAML file.
        backend: "mujoco", "kinematic", "physx", "isaac" (in Isaac Sim's own Python), or a name registered by another
            package.
        options: Passed to the backend (`lidar=True` enables lidars in all but "isaac").

    Raises:
        UnknownNameError: If there is no such backend or robot.
        InputError: If the backend does not take these options, or the world is not a `World`.
    """
    check_kind(world, World, "a simulator's world", "World.load(path) and World.generate(name) make one")
    return as_simulator(SIMULATORS.make(backend, world, Robot.load(robot), **options), f"backend {backend!r}")
