"""`trundle export`: a world or a robot as a file of another program."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import App, Parameter

from trundle.cli import options, output, sources
from trundle.errors import InputError, UnknownNameError

if TYPE_CHECKING:
    from trundle.robots import Robot
    from trundle.worlds import World

app = App(
    name="export",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle export office --seed 3 --to sdf -o office.sdf\n"
        "  trundle export warehouse --robot nova_carter --to mjcf -o scene.xml\n"
        "  trundle export nova_carter --to urdf -o nova_carter.urdf\n"
        "  trundle export nova_carter --to usd -o nova_carter.usd"
    ),
)


@app.default
def export(
    source: str,
    /,
    *,
    to: Annotated[str | None, Parameter(metavar="FORMAT")] = None,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    robot: str | None = None,
    resolution: float | None = None,
    z_min: Annotated[float | None, Parameter(allow_leading_hyphen=True)] = None,
    z_max: Annotated[float | None, Parameter(allow_leading_hyphen=True)] = None,
    seed: options.Seed = 0,
    settings: options.Settings = None,
    exclude: options.Exclude = None,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Write a world or a robot as a file of another program; what is written loads back to the same solids.

    Args:
        source: A world by name or its file, or a robot by name or its YAML or URDF.
        to: The format by name: mjcf, sdf, usd, glb or map for a world, mjcf, urdf or usd for a robot; left out:
            as --out ends.
        out: The file; left out: the source's name, here.
        robot: For a world as mjcf: a robot that stands in it. For a map: the robot whose heights count.
        resolution: Edge of a map's cell [m]; left out: 0.05.
        z_min: Lower end of the band of heights that counts in a map [m]; left out: 0.10, or the robot's.
        z_max: Upper end of the band of heights that counts in a map [m]; left out: 0.62, or the robot's.
    """
    from trundle.export import export_robot, export_world
    from trundle.robots import Robot

    target, form = choose_file(source, to, out)
    thing = load_source(source, form, seed=seed, settings=options.parse_settings(settings, exclude))
    if isinstance(thing, Robot):
        if robot is not None or resolution is not None or z_min is not None or z_max is not None:
            raise InputError("--robot, --resolution, --z-min and --z-max are for worlds, and this is a robot")
        export_robot(thing, target, to=form)
    else:
        export_world(thing, target, to=form, **_world_options(form, robot, resolution, z_min, z_max))
    kind = "robot" if isinstance(thing, Robot) else "world"
    facts: dict[str, object] = {kind: thing.name, "format": form, "file": target, "bytes": target.stat().st_size}
    if not isinstance(thing, Robot):
        facts["solids"] = len(thing.solids)
    if json:
        output.print_json(facts)
    else:
        output.print_facts(facts)
    return 0


def choose_file(source: str, to: str | None, out: Path | None) -> tuple[Path, str]:
    """The file that is written, its folder made, and the format by name.

    Raises:
        UnknownNameError: If there is no such format; the nearest is offered.
        InputError: If neither says the format, or the file's suffix is another format's.
        OutputError: If its folder cannot be written to.
    """
    from trundle.export import FORMATS, format_of

    if to is None:
        if out is None:
            raise InputError(f"give --to FORMAT ({', '.join(sorted(FORMATS))}), or a file with -o")
        to = format_of(out)
    if to not in FORMATS:
        raise UnknownNameError("format", to, FORMATS)
    suffixes = FORMATS[to].suffixes
    name = Path(source).stem + suffixes[0]
    return options.output_file(Path(name) if out is None else out, name, suffixes), to


def load_source(source: str, form: str, *, seed: int, settings: dict[str, bool | int | float | str]) -> World | Robot:
    """Load what is to be written: a robot by name, YAML or URDF, else a world.

    An MJCF file is a world, and a URDF file a robot, unless the format holds only the other.

    Raises:
        UnknownNameError: If it is neither; the nearest of both is offered.
        InputError: If it cannot be used.
    """
    from trundle.export import FORMATS
    from trundle.robots import Robot, robot_names
    from trundle.worlds import world_names

    suffix = Path(source).suffix.lower()
    is_robot = source in robot_names() or (suffix in (".yaml", ".yml") and not sources.is_map(Path(source)))
    is_robot |= suffix == ".urdf" and FORMATS[form].robot is not None
    is_robot |= suffix in (".xml", ".mjcf") and FORMATS[form].world is None
    if is_robot:
        if settings:
            raise InputError("--set and --exclude are for worlds, and this is a robot")
        return Robot.load(source)
    if source not in world_names() and not sources.looks_like_file(source):
        raise UnknownNameError("world or robot", source, [*world_names(), *robot_names()])
    return sources.load_world(source, seed=seed, settings=settings)


def _world_options(
    form: str, robot: str | None, resolution: float | None, z_min: float | None, z_max: float | None
) -> dict[str, Any]:
    from trundle.robots import Robot

    machine = None if robot is None else Robot.load(robot)
    if form == "map":
        low, high = (0.10, 0.62) if machine is None else machine.z_range
        band = (low if z_min is None else z_min, high if z_max is None else z_max)
        return {"z_range": band} | ({} if resolution is None else {"resolution": resolution})
    if resolution is not None or z_min is not None or z_max is not None:
        raise InputError("--resolution, --z-min and --z-max are for --to map")
    if machine is None:
        return {}
    if form != "mjcf":
        raise InputError("--robot is for --to mjcf and --to map; export the robot by itself")
    return {"robot": machine}
