"""`trundle doctor`: checks of this machine, of a robot's drive against its configuration, and of its lidars."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import isaac, options, output, sources
from trundle.errors import InputError

if TYPE_CHECKING:
    from trundle.doctor import DriveCheck, LidarView, OdometryNeed
    from trundle.robots import DifferentialDrive, Robot

app = App(
    name="doctor",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle doctor\n"
        "  trundle doctor --backend mujoco\n"
        "  trundle doctor --backend physx\n"
        "  trundle doctor robot nova_carter --track-width 0.54"
    ),
)


@app.default
def doctor(
    *,
    backend: Annotated[str | None, Parameter(help="Check this simulator as well.")] = None,
    isaac_options: isaac.IsaacOptions | None = None,
    json: options.Json = False,
    quiet: Annotated[bool, Parameter(name="--quiet", negative="", help="Print only failed checks.")] = False,
) -> int:
    """Check this machine, and optionally a simulator. Exit code 1 if a check fails."""
    from trundle.doctor.machine import check_backend, check_machine
    from trundle.sim.mujoco.engine import import_engine

    given = isaac.simulator_options(isaac_options, backend or "none")
    if backend in (None, "mujoco"):
        import_engine()
    found = []
    checks = itertools.chain(
        check_machine(backend), check_backend(backend, robot="nova_carter", **given) if backend else ()
    )
    for check in checks:
        found.append(check)
        if not json and not (quiet and check.status == "pass"):
            print(f"{check.status:<7}  {check.name:<9}  {check.detail}", flush=True)
        if check.name == "isaac sim" and check.status == "fail":
            break
    passed = all(check.status != "fail" for check in found)
    if json:
        output.print_json({"passed": passed, "checks": found})
    return 0 if passed else 1


@app.command
def robot(
    name: str,
    /,
    *,
    backend: options.Backend = "mujoco",
    wheel_radius: float | None = None,
    track_width: float | None = None,
    start: options.Pose = None,
    isaac_options: isaac.IsaacOptions | None = None,
    json: options.Json = False,
) -> int:
    """Drive a straight, a spin and a circle, and derive the wheels' parameters from the robot's motion.

    Also says what each of its planar lidars cannot see, and how far wrong its odometry may be. Exit code 1: a parameter
    differs from the configuration.

    Args:
        name: A robot by name, or the path of its YAML, URDF or MJCF.
        wheel_radius: Check a controller configured with this radius [m] instead of the robot's own.
        track_width: The same for the track width [m], which Isaac Sim's controllers call wheel_base.
    """
    from trundle.doctor.drive_check import check_drive
    from trundle.sim import simulate
    from trundle.sim.mujoco.engine import import_engine
    from trundle.worlds import World

    simulator_options = isaac.simulator_options(isaac_options, backend)
    if backend == "mujoco":
        import_engine()
    machine = sources.load_robot(name)
    given = {"wheel_radius": wheel_radius, "track_width": track_width}
    changes = {key: value for key, value in given.items() if value is not None}
    for key, value in changes.items():
        if not 0.0 < value < math.inf:
            raise InputError(f"--{key.replace('_', '-')} {value:g}: give a positive number of metres")
    configured = machine.drive.model_copy(update=changes)
    empty = World("empty", ())
    with simulate(empty, machine, backend=backend, **simulator_options) as simulator:
        check = check_drive(simulator, configured=configured, start=sources.start_pose(empty, start))
        _report(check, machine, backend, configured, json=json)
    return 1 if check.findings else 0


def _report(check: DriveCheck, robot: Robot, backend: str, configured: DifferentialDrive, *, json: bool) -> None:
    from trundle.doctor.sensors import AMCL_BEARS, needed_odometry, view_of_lidars

    views, needs = view_of_lidars(robot), needed_odometry()
    localizer = "amcl" if views else None
    if json:
        output.print_json(
            {
                "robot": robot.name,
                "backend": backend,
                "configured": configured.model_dump(),
                **_plain(check),
                "lidars": [{**_plain(view), "message": view.message} for view in views],
                "odometry_needed": [{**_plain(need), "message": need.message} for need in needs],
                "localizer": localizer,
            }
        )
        return
    _print(check, configured)
    for view in views:
        print(f"lidar {view.message}")
    if not views:
        print(
            "no lidar: it does not sense obstacles that are not on its map, and no localizer can correct its odometry"
        )
    print("without a localizer:")
    for need in needs:
        print(f"  {need.message}")
    if localizer is not None:
        scale, heading = AMCL_BEARS
        print(
            f"with its lidars on a map, --localizer {localizer} bears odometry that is wrong by {100.0 * scale:g} % of "
            f"the distance and {math.degrees(heading):g}° per metre"
        )


def _plain(check: DriveCheck | LidarView | OdometryNeed) -> dict[str, object]:
    plain = output.plain(check)
    return plain if isinstance(plain, dict) else {}


def _print(check: DriveCheck, configured: DifferentialDrive) -> None:
    output.print_table(
        ("", "configured", "measured"),
        [
            ("wheel radius [m]", f"{configured.wheel_radius:.4f}", _rounded(check.wheel_radius)),
            ("track width [m]", f"{configured.track_width:.4f}", _rounded(check.track_width)),
            ("slip, largest acceleration", None, _rounded(check.slip)),
            ("slip, small acceleration", None, _rounded(check.slip_gentle)),
        ],
    )
    for finding in check.findings:
        print(f"{finding.kind}: {finding.message}")
    if not check.findings:
        print("drives as configured")


def _rounded(value: float | None) -> str | None:
    return None if value is None else f"{value:.4f}"
