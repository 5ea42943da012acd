"""What the verbs that drive in Isaac Sim share: its options, and its application."""

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

Profile = Annotated[str | None, Parameter(name="--profile", help="For usd: isaac, with what Isaac Sim wants.")]
ScriptEnvironment = Annotated[
    str | None,
    Parameter(
        name="--environment",
        help="For isaac-script: an environment of Isaac Sim by name, or a USD file; left out: the scenario's world.",
    ),
]
ScriptRobot = Annotated[
    str | None,
    Parameter(
        name="--robot-usd",
        help="For isaac-script: the robot's USD file; left out: Isaac Sim's own, where it has one.",
    ),
]
AssetsRoot = Annotated[
    str | None,
    Parameter(
        name="--assets-root",
        help="Folder of Isaac Sim's asset packs, the one that holds Isaac/Environments.",
    ),
]

_GROUP = Group("Isaac Sim", help="With --backend isaac, started by Isaac Sim's own interpreter.", sort_key=1)


@Parameter(name="*", group=_GROUP)
@dataclass(frozen=True, slots=True)
class IsaacOptions:
    """Options of `--backend isaac`.

    Attributes:
        environment: What Isaac Sim opens: an environment (warehouse_with_forklifts, warehouse, full_warehouse,
            hospital, office) or a USD file, in the map's frame; left out: the world or the map, written as USD.
        robot_usd: The robot's USD file; left out: that of Isaac Sim's assets.
        assets_root: Folder or address that holds Isaac/Environments and Isaac/Robots; left out: TRUNDLE_ISAAC_ASSETS,
            or what Isaac Sim finds.
        physics_dt: Length of a physics step [s]; left out: 0.005.
        ground_offset: Height above the ground that the robot is put at, to settle from [m]; left out: 0.02.
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
        """Those that were given, as the simulator takes them; paths in full, so that they hold from any folder."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        for name in ("environment", "robot_usd", "assets_root"):
            text = values[name]
            if text is not None and Path(text).exists():
                values[name] = str(Path(text).resolve())
        return {name: value for name, value in values.items() if value is not None and value is not False}


def simulator_options(options: IsaacOptions | None, backend: str) -> dict[str, str | float | bool]:
    """Return what a simulator is made with.

    Raises:
        InputError: If options of Isaac Sim are given to another backend.
    """
    given = options.given() if options is not None else {}
    if given and backend != BACKEND:
        name = next(iter(given)).replace("_", "-")
        raise InputError(f"--{name} is for --backend isaac, and this is {backend}")
    return given


def check_window(view: bool, backend: str) -> None:
    """Refuse MuJoCo's window on a run in Isaac Sim, which has its own.

    Raises:
        InputError: If `view` and the backend do not go together.
    """
    if view and backend == BACKEND:
        raise InputError("--view opens MuJoCo's window, and Isaac Sim has its own: leave --view and --headless out")


def adapt(scenario: Scenario, options: IsaacOptions | None) -> Scenario:
    """Give a scenario's backend the options of the command line; a world of USD is opened by Isaac Sim as it is.

    Raises:
        InputError: If they are given to another backend, or name another place than the scenario.
    """
    given = simulator_options(options, scenario.backend.name)
    if scenario.backend.name != BACKEND:
        return scenario
    settings = {**scenario.backend.options, **given}
    settings |= _environment(scenario.world.name if scenario.world is not None else None, settings)
    return scenario.model_copy(update={"backend": scenario.backend.model_copy(update={"options": settings})})


def _early_application(world: str | None, settings: Mapping[str, object]) -> AbstractContextManager[Application | None]:
    """Start Isaac Sim before a world of USD is read: it brings the library for that, and no other may come first."""
    from trundle.sim.isaac.assets import is_usd

    if world is None or not is_usd(world):
        return nullcontext()
    from trundle.sim.isaac.application import Application

    return Application(headless=bool(settings.get("headless")), livestream=bool(settings.get("livestream")))


def start_for(scenario: Scenario) -> AbstractContextManager[Application | None]:
    """Start Isaac Sim before a scenario's world is read, where it drives in Isaac Sim through a world of USD."""
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
    """Load the world of a verb; what Isaac Sim needs for it is started before, and closed at the end.

    A world of USD becomes the environment in `given`.

    Raises:
        InputError: If an environment is given besides another world.
    """
    if backend != BACKEND:
        yield sources.load_place(world, seed=seed, settings=settings)
        return
    given |= _environment(world, given)
    with _early_application(world, given):
        yield sources.load_place(world, seed=seed, settings=settings)


def _environment(world: str | None, settings: Mapping[str, object]) -> dict[str, str]:
    """The environment that a world of USD is; nothing for any other world, which is written as USD."""
    from trundle.sim.isaac.assets import is_usd

    own = str(Path(world).resolve()) if world is not None and is_usd(world) else None
    given = settings.get("environment")
    if world is not None and given not in (None, own):
        raise InputError(
            f"the world {world!r} and the environment {given!r} are two places. Give the environment's map in the "
            "world's stead (trundle map build makes it of its USD), or leave --environment out"
        )
    return {} if own is None else {"environment": own}


def world_of(source: str, backend: str | None, options: IsaacOptions | None) -> str:
    """Return the USD file of an environment that is named as the place of a run in Isaac Sim, else the source as it is.

    Raises:
        InputError: If its file is not on this machine, so that there is no map to drive by.
    """
    from trundle.sim.isaac.assets import ENVIRONMENTS, local_environment
    from trundle.worlds import world_names

    if backend != BACKEND or source not in ENVIRONMENTS or source in world_names():
        return source
    try:
        return str(local_environment(source, options.assets_root if options is not None else None))
    except InputError as error:
        raise InputError(
            f"{error}; or drive by a map of it: trundle run map.yaml --backend isaac --environment {source}"
        ) from error


def find_environment(name: str, assets_root: str | None) -> Path | None:
    """Return the file of an environment on this machine by its name; none where it is no environment's name.

    Raises:
        InputError: If it is one, and not on this machine.
        UnknownNameError: If assets are given, and none has this name.
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


def print_joints(robot: str, settings: Mapping[str, str | float | bool], *, json: bool) -> int:
    """Print the joints that Isaac Sim moves of a robot's USD, in its order; return the exit code."""
    from trundle.geometry import Pose2D
    from trundle.robots import Robot
    from trundle.worlds import World

    machine = Robot.load(robot)
    wheels = (machine.drive.left_joint, machine.drive.right_joint)
    with open_simulator(World("empty", ()), machine, Pose2D(0.0, 0.0), settings) as simulator:
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
    """Show a robot in Isaac Sim's window until that is closed, or write a picture by its renderer.

    Returns:
        What the picture is of; nothing where there is none.
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
    """What a script for Isaac Sim takes from a scenario: its world of USD, and what its backend names."""
    found: dict[str, object] = {}
    if scenario.world is not None and sources.is_usd(scenario.world.name) and not scenario.world.options:
        found["environment"] = scenario.world.name
    if scenario.backend.name == BACKEND:
        names = ("environment", "robot_usd")
        found |= {name: value for name, value in scenario.backend.options.items() if name in names}
    return found
