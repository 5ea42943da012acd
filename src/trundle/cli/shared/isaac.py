"""Shared by the verbs that use Isaac Sim or its physics: their options, and Isaac Sim's application."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

from cyclopts import Group, Parameter

from trundle.cli.shared import output, sources
from trundle.errors import InputError, UnknownNameError

if TYPE_CHECKING:
    from trundle.geometry import Pose2D
    from trundle.mission import Scenario
    from trundle.robots import Robot
    from trundle.sim.isaac import IsaacSimulator
    from trundle.sim.isaac.application import Application
    from trundle.worlds import World

BACKEND = "isaac"
PHYSX = "physx"

_WINDOW = ("headless", "livestream")
"""Options of Isaac Sim's window, which PhysX alone does not have."""

Profile = Annotated[str | None, Parameter(name="--profile", help="For usd: isaac adds what Isaac Sim needs.")]
ScriptEnvironment = Annotated[
    str | None,
    Parameter(
        name="--environment",
        help="For isaac-script: an environment of Isaac Sim by name, or a USD file; default: the scenario's world.",
    ),
]
ScriptRobot = Annotated[
    str | None,
    Parameter(
        name="--robot-usd",
        help="For isaac-script: the robot's USD file; default: Isaac Sim's own, if it has one.",
    ),
]
AssetsRoot = Annotated[
    str | None,
    Parameter(
        name="--assets-root",
        help="Folder of Isaac Sim's asset packs, the one that holds Isaac/Environments.",
    ),
]

_GROUP = Group(
    "Isaac Sim",
    help="With --backend isaac, run with Isaac Sim's own interpreter; all but its window also with --backend physx.",
    sort_key=1,
)


@Parameter(name="*", group=_GROUP)
@dataclass(frozen=True, slots=True)
class IsaacOptions:
    """Options of `--backend isaac` and `--backend physx`.

    Attributes:
        environment: The stage to open: an environment (warehouse_with_forklifts, warehouse, full_warehouse,
            hospital, office) or a USD file, in the map's frame; default: the world or the map, written as USD.
        robot_usd: The robot's USD file; default: that of Isaac Sim's assets; with physx trundle's own model.
        assets_root: Folder or address that holds Isaac/Environments and Isaac/Robots; default: TRUNDLE_ISAAC_ASSETS,
            or Isaac Sim's own asset root.
        physics_dt: Physics timestep [s]; default: 0.005.
        ground_offset: Initial height above the ground from which the robot settles [m]; default: 0.02.
        headless: Without a window.
        livestream: Without a window, streamed by WebRTC.
    """

    environment: Annotated[str | None, Parameter(negative="")] = None
    robot_usd: str | None = None
    assets_root: str | None = None
    physics_dt: float | None = None
    ground_offset: float | None = None
    headless: Annotated[bool, Parameter(negative="")] = False
    livestream: Annotated[bool, Parameter(negative="")] = False

    def given(self) -> dict[str, str | float | bool]:
        """Return the given options as the simulator takes them, with absolute paths: they are valid from any folder."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        for name in ("environment", "robot_usd", "assets_root"):
            text = values[name]
            if text is not None and Path(text).exists():
                values[name] = str(Path(text).resolve())
        return {name: value for name, value in values.items() if value is not None and value is not False}


def simulator_options(options: IsaacOptions | None, backend: str) -> dict[str, str | float | bool]:
    """Return the options to create a simulator with.

    Raises:
        InputError: If options of Isaac Sim are given to another backend.
    """
    given = options.given() if options is not None else {}
    others = [name for name in given if backend != BACKEND and (backend != PHYSX or name in _WINDOW)]
    if others:
        takes = "isaac" if others[0] in _WINDOW else "isaac or physx"
        raise InputError(f"--{others[0].replace('_', '-')} is for --backend {takes}, but the backend is {backend}")
    return given


def check_window(view: bool, backend: str) -> None:
    """Refuse MuJoCo's window on a run in Isaac Sim, which has its own.

    Raises:
        InputError: If `view` and the backend do not go together.
    """
    if view and backend == BACKEND:
        raise InputError("--view opens MuJoCo's window, but Isaac Sim has its own: leave out --view and --headless")


def adapt(scenario: Scenario, options: IsaacOptions | None) -> Scenario:
    """Give a scenario's backend the options of the command line; Isaac Sim and PhysX open a USD world directly.

    Raises:
        InputError: If they are given to another backend, or conflict with the scenario's world.
    """
    given = simulator_options(options, scenario.backend.name)
    if not opens_usd(scenario.backend.name):
        return scenario
    settings = {**scenario.backend.options, **given}
    settings |= _environment(scenario.world.name if scenario.world is not None else None, settings)
    return scenario.model_copy(update={"backend": scenario.backend.model_copy(update={"options": settings})})


def opens_usd(backend: str) -> bool:
    """Return whether a backend opens a USD world itself."""
    return backend in (BACKEND, PHYSX)


def _early_application(world: str | None, settings: Mapping[str, object]) -> AbstractContextManager[Application | None]:
    """Start Isaac Sim before a USD world is read: it brings its own USD library, and no other may be loaded first."""
    from trundle.sim.isaac.assets import is_usd

    if world is None or not is_usd(world):
        return nullcontext()
    from trundle.sim.isaac.application import Application

    return Application(headless=bool(settings.get("headless")), livestream=bool(settings.get("livestream")))


def start_for(scenario: Scenario) -> AbstractContextManager[Application | None]:
    """Start Isaac Sim before a scenario's world is read, if it drives in Isaac Sim through a USD world."""
    if scenario.backend.name != BACKEND:
        return nullcontext()
    return _early_application(scenario.world.name if scenario.world is not None else None, scenario.backend.options)


@contextmanager
def open_place(
    world: str | None,
    *,
    settings: Mapping[str, bool | int | float | str],
    seed: int,
    backend: str,
    given: dict[str, str | float | bool],
) -> Iterator[World]:
    """Load the world of a verb; Isaac Sim is started before if needed, and closed at the end.

    A USD world becomes the environment in `given`.

    Raises:
        InputError: If both an environment and another world are given.
    """
    if not opens_usd(backend):
        yield sources.load_place(world, seed=seed, settings=settings)
        return
    given |= _environment(world, given)
    if backend == PHYSX:
        yield sources.load_place(world, seed=seed, settings=settings)
        return
    with _early_application(world, given):
        yield sources.load_place(world, seed=seed, settings=settings)


def _environment(world: str | None, settings: Mapping[str, object]) -> dict[str, str]:
    """Return the environment for a USD world; empty for any other world, which is written as USD."""
    from trundle.sim.isaac.assets import is_usd

    own = str(Path(world).resolve()) if world is not None and is_usd(world) else None
    given = settings.get("environment")
    if world is not None and given not in (None, own):
        raise InputError(
            f"the world {world!r} and the environment {given!r} conflict. Give the environment's map instead of the "
            "world (trundle map build makes it from its USD), or leave --environment out"
        )
    return {} if own is None else {"environment": own}


def world_of(source: str, backend: str | None, options: IsaacOptions | None) -> str:
    """Return the USD file if the source names an environment for a run that opens it, else the source unchanged.

    Raises:
        InputError: If its file is not on this machine, so that no map can be built.
    """
    from trundle.sim.isaac.assets import ENVIRONMENTS, local_environment
    from trundle.worlds import world_names

    if backend is None or not opens_usd(backend) or source not in ENVIRONMENTS or source in world_names():
        return source
    try:
        return str(local_environment(source, options.assets_root if options is not None else None))
    except InputError as error:
        raise InputError(
            f"{error}; or use a map of it: trundle run map.yaml --backend {backend} --environment {source}"
        ) from error


def find_environment(name: str, assets_root: str | None) -> Path | None:
    """Return the file of an environment on this machine by its name; None for any other name.

    Raises:
        InputError: If the environment's file is not on this machine.
        UnknownNameError: If assets are given but none has this name.
    """
    from trundle.sim.isaac.assets import ENVIRONMENTS, local_environment
    from trundle.worlds import world_names

    if assets_root is None and (name not in ENVIRONMENTS or name in world_names()):
        return None
    if name not in ENVIRONMENTS:
        raise UnknownNameError("environment", name, ENVIRONMENTS)
    return local_environment(name, assets_root)


def open_simulator(
    world: World, robot: Robot, pose: Pose2D, settings: Mapping[str, str | float | bool]
) -> IsaacSimulator:
    """Start Isaac Sim with a robot at a pose."""
    from trundle.sim import simulate

    simulator = cast("IsaacSimulator", simulate(world, robot, backend=BACKEND, **settings))
    try:
        simulator.reset(pose)
    except BaseException:
        simulator.close()
        raise
    return simulator


def print_joints(robot: str, backend: str, settings: Mapping[str, str | float | bool], *, json: bool) -> int:
    """Print the joints that Isaac Sim or PhysX moves in a robot's USD, in its order; return the exit code."""
    from trundle.robots import Robot
    from trundle.sim import simulate
    from trundle.worlds import World

    machine = Robot.load(robot)
    wheels = (machine.drive.left_joint, machine.drive.right_joint)
    with cast("IsaacSimulator", simulate(World("empty", ()), machine, backend=backend, **settings)) as simulator:
        found = [
            {"index": index, "name": name, "drives": name in wheels}
            for index, name in enumerate(simulator.joint_names())
        ]
        if json:
            output.print_json(found)
        else:
            rows = [(joint["index"], joint["name"], "yes" if joint["drives"] else "no") for joint in found]
            output.print_table(("index", "name", "drives"), rows)
    return 0


def show(
    world: World,
    robot: Robot,
    pose: Pose2D,
    settings: Mapping[str, str | float | bool],
    *,
    camera: str,
    size: tuple[int, int],
    target: Path | None,
) -> dict[str, object]:
    """Show a robot in Isaac Sim's window until it is closed, or write a picture with its renderer.

    Returns:
        The facts about the picture; empty without one.
    """
    from PIL import Image

    from trundle.record.run_folder import save_png
    from trundle.viewer.cameras import aim

    with open_simulator(world, robot, pose, settings) as simulator:
        seen = aim(camera, world, robot, pose, size[0] / size[1], lambda *_: True)
        if target is None:
            print("close the window to end", file=sys.stderr, flush=True)
            simulator.look(seen.eye, seen.target)
            simulator.wait()
            return {}
        save_png(Image.fromarray(simulator.picture(seen.eye, seen.target, size)), target)
    return {"picture": target, "renderer": "Isaac Sim", "width": size[0], "height": size[1], "advice": None}


def script_options(scenario: Scenario) -> dict[str, object]:
    """Return the options of an Isaac Sim script for a scenario, from its USD world and its backend."""
    found: dict[str, object] = {}
    if scenario.world is not None and sources.is_usd(scenario.world.name) and not scenario.world.options:
        found["environment"] = scenario.world.name
    if scenario.backend.name == BACKEND:
        names = ("environment", "robot_usd")
        found |= {name: value for name, value in scenario.backend.options.items() if name in names}
    return found
