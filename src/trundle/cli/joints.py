"""`trundle joints`: the joints of a robot."""

from __future__ import annotations

from typing import Annotated, Literal

from cyclopts import App, Parameter

from trundle.cli.shared import isaac, options, output, sources
from trundle.files.kinds import ROBOT

MODEL_SUFFIXES = (".xml", ".mjcf", ".urdf", ".usd", ".usda", ".usdc", ".usdz")

app = App(
    name="joints",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle joints nova_carter\n"
        "  trundle joints my_robot.usd --json\n"
        "  python.sh -m trundle joints nova_carter --backend isaac --headless"
    ),
)


@app.default
def joints(
    robot: str,
    /,
    *,
    backend: Annotated[
        Literal["mujoco", "physx", "isaac"], Parameter(help="The joints of this simulator's model.")
    ] = "mujoco",
    json: options.Json = False,
    quiet: options.Quiet = False,
    isaac_options: isaac.IsaacOptions | None = None,
) -> int:
    """List a robot's joints: name, type, axis, limits, parent, child, and which ones drive it.

    With --backend isaac or physx: the joints that it moves in the robot's USD, in its order.

    Args:
        robot: A robot (nova_carter, jackal, turtlebot3_burger, turtlebot3_waffle, a plug-in's), or the path of a
            robot's YAML, an MJCF, a URDF or a USD file.
    """
    given = isaac.simulator_options(isaac_options, backend)
    if isaac.opens_usd(backend):
        return isaac.print_joints(robot, backend, given, json=json)
    from trundle.sim.mujoco.engine import import_engine

    import_engine()
    from trundle.sim.mujoco.joints import list_joints
    from trundle.sim.mujoco.simulator import check_stands

    if robot.lower().endswith(MODEL_SUFFIXES):
        sources.check_file_exists(robot, ROBOT)
        found = list_joints(robot)
    else:
        machine = sources.load_robot(robot)
        check_stands(machine)
        found = list_joints(machine)
    if json:
        output.print_json(found)
        return 0
    output.print_table(
        ("name", "type", "axis", "limits", "parent", "child", "drives"),
        [
            (
                joint.name or "-",
                joint.type,
                " ".join(f"{number:g}" for number in joint.axis) if joint.axis else "-",
                "-" if joint.limits is None else f"{joint.limits[0]:g} to {joint.limits[1]:g}",
                joint.parent,
                joint.child,
                "yes" if joint.drives else "no",
            )
            for joint in found
        ],
    )
    return 0
