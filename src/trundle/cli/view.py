"""`trundle view`: a robot, alone or in a world, in a window or as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, Parameter

from trundle.cli import options, output, sources
from trundle.cli.engine import import_engine

app = App(
    name="view",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle view nova_carter\n"
        "  trundle view nova_carter --world warehouse --camera overview -o scene.png"
    ),
)


@app.default
def view(
    robot: str,
    /,
    *,
    world: str | None = None,
    start: options.Pose = None,
    camera: Literal["chase", "robot", "overview", "top"] | None = None,
    size: Annotated[str, Parameter(metavar="WIDTHxHEIGHT")] = "1280x720",
    seed: options.Seed = 0,
    settings: options.Settings = None,
    exclude: options.Exclude = None,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Show a robot, alone or in a world: in a window where there is a screen, else as a picture.

    With --out or --json it is always a picture.

    Args:
        robot: A robot by name, or the path of its YAML.
        world: Where it stands: a world by name, or its file (SDF, MJCF, a mesh, a map's YAML); left out: a floor.
        camera: Where the picture is taken from; left out: robot, or overview in a world.
        size: Of the picture, in pixels.
        out: Write this PNG (or scene.png in this folder) and open no window.
    """
    import_engine()
    from trundle.robots import Robot
    from trundle.viewer.offscreen import render

    machine = Robot.load(robot)
    place = sources.load_place(world, seed=seed, settings=options.parse_settings(settings, exclude))
    pose = sources.start_pose(place, start)
    width, height = parse_size(size)
    if out is None and not json:
        from trundle.viewer.native import NativeWindow, has_screen

        if has_screen():
            with NativeWindow(place, machine, pose) as window:
                output.remark("close the window to end", quiet=quiet)
                window.wait()
            return 0
    target = options.output_file(out or Path("scene.png"), "scene.png", (".png",))
    picture = render(
        place, machine, pose, size=(width, height), camera=camera or ("robot" if world is None else "overview")
    )
    picture.save(target)
    if picture.advice:
        output.remark(picture.advice, quiet=quiet)
    if json:
        output.print_json(
            {"picture": target, "renderer": picture.kind, "width": width, "height": height, "advice": picture.advice}
        )
    else:
        output.print_facts({"picture": target, "renderer": picture.kind})
    return 0


def parse_size(text: str) -> tuple[int, int]:
    """Read `WIDTHxHEIGHT`; the renderer says which sizes it takes."""
    from trundle.errors import InputError

    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise InputError(f"--size {text!r}: give WIDTHxHEIGHT in pixels, for example 1280x720")
    return int(width), int(height)
