"""`trundle view`: a robot, alone or in a world, in a window or as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import App, Parameter

from trundle.cli.shared import isaac, options, output, sources

if TYPE_CHECKING:
    from trundle.geometry import Pose2D
    from trundle.robots import Robot
    from trundle.worlds import World

app = App(
    name="view",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle view nova_carter\n"
        "  trundle view nova_carter --world warehouse --camera overview -o scene.png\n"
        "  python.sh -m trundle view nova_carter --backend isaac --environment warehouse_with_forklifts"
    ),
)


@app.default
def view(
    robot: options.RobotArgument,
    /,
    *,
    world: options.WorldName = None,
    start: options.Pose = None,
    camera: Literal["chase", "robot", "overview", "top"] = "robot",
    size: Annotated[str, Parameter(metavar="WIDTHxHEIGHT")] = "1280x720",
    seed: options.Seed = 0,
    settings: options.Settings = None,
    exclude: options.Exclude = None,
    floor_z: options.FloorZ = None,
    paths: options.Paths = None,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    backend: Annotated[Literal["mujoco", "isaac"], Parameter(help="The simulator that shows it.")] = "mujoco",
    json: options.Json = False,
    quiet: options.Quiet = False,
    isaac_options: isaac.IsaacOptions | None = None,
) -> int:
    """Show a robot, alone or in a world: in a window if there is a screen, else as a picture.

    With --out or --json it is always a picture.

    Args:
        camera: The viewpoint: close in front of the robot, behind it, or the whole world.
        size: Size of the picture, in pixels.
        out: Write this PNG (or scene.png in this folder) and open no window.
    """
    from trundle.sim.mujoco.engine import import_engine

    given = isaac.simulator_options(isaac_options, backend)
    machine = sources.load_robot(robot, paths)
    width, height = parse_size(size)
    if backend == "mujoco":
        import_engine()
    kept = sources.read_settings(world, settings, exclude, paths, robot=robot)
    with isaac.open_place(world, settings=kept, seed=seed, backend=backend, given=given) as place:
        pose = sources.start_pose(place, start)
        if backend != isaac.BACKEND or floor_z is not None:
            place = sources.stand_on_floor(place, world, machine, pose, floor_z)
        in_window = out is None and not json
        if backend == isaac.BACKEND:
            target = None if in_window and not given.get("headless") else _target(out)
            facts = isaac.show(place, machine, pose, given, camera=camera, size=(width, height), target=target)
        elif in_window and _show_window(place, machine, pose, quiet=quiet):
            return 0
        else:
            facts = _draw(place, machine, pose, camera, (width, height), _target(out), quiet=quiet)
    if json:
        output.print_json(facts)
    elif facts:
        output.print_facts({"picture": facts["picture"], "renderer": facts["renderer"]})
    return 0


def _target(out: Path | None) -> Path:
    return options.output_file(out or Path("scene.png"), "scene.png", (".png",))


def _show_window(place: World, machine: Robot, pose: Pose2D, *, quiet: bool) -> bool:
    """Show it in MuJoCo's window until it is closed; False without a screen."""
    from trundle.viewer.native import NativeWindow, has_screen

    if not has_screen():
        return False
    with NativeWindow(place, machine, pose) as window:
        output.remark("close the window to end", quiet=quiet)
        window.wait()
    return True


def _draw(
    place: World, machine: Robot, pose: Pose2D, camera: str, size: tuple[int, int], target: Path, *, quiet: bool
) -> dict[str, object]:
    """Write a picture, and say what it is of."""
    from trundle.viewer.scene import render

    picture = render(place, machine, pose, size=size, camera=camera)
    picture.save(target)
    if picture.advice:
        output.remark(picture.advice, quiet=quiet)
    width, height = size
    return {
        "picture": target,
        "renderer": picture.kind,
        "width": width,
        "height": height,
        "advice": picture.advice,
    }


def parse_size(text: str) -> tuple[int, int]:
    """Read `WIDTHxHEIGHT`; the renderer says which sizes it takes."""
    from trundle.errors import InputError

    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise InputError(f"--size {text!r}: give WIDTHxHEIGHT in pixels, for example 1280x720")
    return int(width), int(height)
