"""`trundle joints`: what moves on a robot."""

from __future__ import annotations

from cyclopts import App

from trundle.cli import options, output
from trundle.cli.engine import import_engine

MODEL_SUFFIXES = (".xml", ".mjcf", ".urdf", ".usd", ".usda", ".usdc", ".usdz")

app = App(
    name="joints",
    version_flags=[],
    help_epilogue="Examples:\n  trundle joints nova_carter\n  trundle joints my_robot.usd --json",
)


@app.default
def joints(
    robot: str,
    /,
    *,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """List a robot's joints: name, type, axis, limits, parent, child, and which ones drive it.

    Args:
        robot: A robot by name, or the path of a robot's YAML, an MJCF, a URDF or a USD file.
    """
    import_engine()
    from trundle.robots import Robot
    from trundle.sim.mujoco.joints import list_joints

    found = list_joints(robot if robot.lower().endswith(MODEL_SUFFIXES) else Robot.load(robot))
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
