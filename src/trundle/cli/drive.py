"""`trundle drive`: by a list of commands, or by hand."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from cyclopts import App, Parameter

from trundle.cli.shared import browser as page_in_browser
from trundle.cli.shared import isaac, options, output, sources
from trundle.cli.shared.recordings import FILE as RECORDING
from trundle.cli.shared.recordings import FolderRecording, choose_record
from trundle.cli.shared.sources import check_given
from trundle.errors import InputError
from trundle.files.kinds import ARRAYS, DRIVE, RUN, TABLE
from trundle.values import first_names

if TYPE_CHECKING:
    from trundle.geometry import Pose2D
    from trundle.mission import Episode, Observer, RunInfo, Session, Step
    from trundle.navigation import Agent, CommandScript
    from trundle.record.drive_log import DriveLog
    from trundle.sim import Simulator
    from trundle.viewer.native import NativeWindow
    from trundle.worlds import World

PERIOD_S = 0.05
"""Control period, that of a navigator with its default frequency of 20 Hz."""

STEP_S = 0.005
"""The simulators' physics step: a command lasts a whole number of them."""

MAX_SECONDS = 3600.0

Command: TypeAlias = tuple[float, float, float]
"""v [m/s], w [rad/s] and seconds."""

_CELL_M = 0.05  # that of the maps that trundle makes by default
_ROOM_M = 15.0
"""How far the map of an empty floor reaches from the start."""


app = App(
    name="drive",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle drive nova_carter --command 0.4,0,5 --command 0,0.8,5 --command 0.25,-0.5,5\n"
        "  trundle drive nova_carter --world warehouse --teleop\n"
        "  trundle drive nova_carter --world warehouse --browser\n"
        "  python.sh -m trundle drive nova_carter --backend isaac --environment warehouse --command 0.4,0,5"
    ),
)


@app.default
def drive(
    robot: options.RobotArgument,
    /,
    *,
    command: Annotated[
        list[str] | None,
        Parameter(name="--command", allow_leading_hyphen=True, negative="", metavar="V,W,SECONDS"),
    ] = None,
    like: Annotated[Path | None, Parameter(metavar="RUN")] = None,
    teleop: options.Flag = False,
    view: options.Flag = False,
    browser: options.Browser = False,
    speed: options.RunSpeed = None,
    world: options.WorldName = None,
    start: options.Pose = None,
    backend: options.Backend = "mujoco",
    seed: options.Seed = 0,
    settings: options.Settings = None,
    exclude: options.Exclude = None,
    floor_z: options.FloorZ = None,
    paths: options.Paths = None,
    record: options.Record = False,
    distro: options.Distro = None,
    out: options.Out = None,
    overwrite: options.Overwrite = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    isaac_options: isaac.IsaacOptions | None = None,
) -> int:
    """Drive a robot by a list of commands, or by hand; print and record its motion.

    The record, drive.csv, has a row every 0.05 s: pose, commanded and actual twist, wheel speeds, odometry.

    Args:
        command: Drive V [m/s] forward and W [rad/s] to the left for SECONDS; repeat it for several in a row.
        like: Replay the commands of a run or a drive (its folder), from its start, e.g. in another simulator.
        teleop: Drive by keys in this terminal: w/a/s/d, i/j/k/l or arrows; the robot stops on release, q quits. With
            --view, drive by the arrow keys in the window; close it to quit.
        view: Watch it in a window, in real time.
        out: Folder for drive.csv, which must not hold a run; default: a new one under runs.
    """
    from trundle.record.drive_log import DriveLog
    from trundle.record.folder_claim import FolderClaim, check_free
    from trundle.record.motion import Motion
    from trundle.sim import simulate
    from trundle.sim.mujoco.engine import import_engine
    from trundle.teleop.drive import drive_in_window
    from trundle.teleop.terminal import TextMap, check_terminal, drive_by_keys
    from trundle.viewer.native import open_window

    by_hand = teleop or (browser and not command and like is None)
    if sum((by_hand, bool(command), like is not None)) != 1:
        raise InputError("give one of: --command V,W,SECONDS (repeatable), --like RUN, --teleop, --browser")
    if speed is not None and by_hand and not browser:
        raise InputError("--speed is for --command, --like and --browser: by keys a robot is driven in real time")
    factor = None if speed is None else options.parse_speed(speed)
    check_free(out, overwrite=overwrite)
    recording = FolderRecording(choose_record(None, record=record, distro=distro), out, overwrite=overwrite)
    commands = [parse_command(text) for text in command or []]
    given = isaac.simulator_options(isaac_options, backend)
    isaac.check_window(view, backend)
    if view and browser:
        raise InputError("give --view or --browser, not both")
    machine = sources.load_robot(robot, paths)
    if teleop and not view and not browser:
        check_terminal()
    if backend == "mujoco":
        import_engine()
    log = DriveLog()
    with ExitStack() as stack:
        kept = sources.read_settings(world, settings, exclude, paths, robot=robot)
        place = stack.enter_context(isaac.open_place(world, settings=kept, seed=seed, backend=backend, given=given))
        pose = sources.start_pose(place, start)
        if like is not None:
            check_given(like, RUN, DRIVE, TABLE, ARRAYS)
            motion = Motion.load(like)
            try:
                commands, begin = motion.commands(STEP_S), motion.start
            except InputError as error:
                raise InputError(f"--like {like}: {error}") from error
            pose = begin if start is None else pose
        if (backend != isaac.BACKEND and "environment" not in given) or floor_z is not None:
            place = sources.stand_on_floor(place, world, machine, pose, floor_z)
        lidars = {"lidar": True} if browser and by_hand and backend != isaac.BACKEND and machine.lidars else {}
        simulator = stack.enter_context(simulate(place, machine, backend=backend, **given, **lidars))
        window = stack.enter_context(open_window(place, machine, pose)) if view else None
        claim = stack.enter_context(FolderClaim(out, "drive", overwrite=overwrite))
        observers = stack.enter_context(recording).start(claim.path)
        try:
            if browser:
                _drive_in_browser(
                    simulator,
                    pose,
                    None if by_hand else commands,
                    log,
                    observers=observers,
                    speed=1.0 if factor is None else factor,
                    seed=seed,
                    quiet=quiet,
                )
            elif not teleop:
                _drive_commands(simulator, pose, commands, log, window, seed=seed, observers=observers, speed=factor)
            elif window is None:
                chart = TextMap(place, machine, pose)
                drive_by_keys(simulator, pose, log, chart, period_s=PERIOD_S, seed=seed, observers=observers)
            else:
                drive_in_window(simulator, pose, log, window, period_s=PERIOD_S, seed=seed, observers=observers)
        finally:
            if len(log):
                with claim.replacing():
                    log.save(claim.path / "drive.csv")
                    recording.save(claim.path / RECORDING)
        # Before the simulator is closed: closing Isaac Sim may end the process.
        report = _report_drive if by_hand else _report_commands
        report(log, claim.path, json=json)
    return 0


def parse_command(text: str) -> Command:
    """Read `V,W,SECONDS`."""
    v, w, seconds = options.parse_numbers("--command", text, "V,W,SECONDS", at_least=3, at_most=3)
    if not 0.0 < seconds <= MAX_SECONDS:
        raise InputError(f"--command {text!r}: SECONDS must be above 0 and at most {MAX_SECONDS:g}")
    if abs(seconds / STEP_S - round(seconds / STEP_S)) > 1e-6:
        raise InputError(f"--command {text!r}: SECONDS must be a multiple of {STEP_S:g}, the physics step")
    return v, w, seconds


class _LegLogger:
    """Writes a drive into its log: a leg is a command of a script, or the whole of a drive by hand."""

    def __init__(self, log: DriveLog, script: CommandScript | None, commands: Sequence[Command]) -> None:
        self._log, self._script, self._commands = log, script, commands
        self._leg = -1

    def on_start(self, run: RunInfo) -> None:
        """Begin the leg of a drive by hand."""
        if self._script is None:
            self._log.begin(0.0, 0.0, 0.0)

    def on_step(self, step: Step) -> None:
        """Add the state, to the leg of the command that led to it."""
        script = self._script
        if script is not None and step.index and script.index != self._leg:
            self._leg = script.index
            self._log.begin(*self._commands[self._leg])
        self._log.add(step.state, step.sent)

    def on_end(self, episode: Episode) -> None:
        """Do nothing: the verb saves the log."""


def _drive_commands(
    simulator: Simulator,
    start: Pose2D,
    commands: Sequence[Command],
    log: DriveLog,
    window: NativeWindow | None,
    *,
    seed: int,
    observers: Sequence[Observer],
    speed: float | None,
) -> None:
    """Drive by a list of commands, as fast as it goes, or at a speed and in a window."""
    from trundle.mission import Session
    from trundle.navigation import CommandScript

    script = CommandScript(commands, period_s=PERIOD_S)
    logger = _LegLogger(log, script, commands)
    session = Session(
        simulator,
        script,
        start,
        monitor=False,
        seed=seed,
        stop_on_contact=False,
        measure=None,
        observers=[logger, *observers],
    )
    if speed is None:
        speed = math.inf if window is None else 1.0
    began = time.monotonic()
    try:
        while (step := session.step()) is not None:
            if window is not None:
                window.show(step.state)
            if speed < math.inf:
                time.sleep(max(0.0, began + step.state.time / speed - time.monotonic()))
    finally:
        session.finish()
    if session.error is not None:
        raise session.error


def _drive_in_browser(
    simulator: Simulator,
    start: Pose2D,
    commands: Sequence[Command] | None,
    log: DriveLog,
    *,
    observers: Sequence[Observer],
    speed: float,
    seed: int,
    quiet: bool,
) -> None:
    """Drive in the page, by hand or by clicking goals; or watch commands in it.

    By hand the robot knows the map of the world, so that its navigator stops it before walls.

    Args:
        simulator: Moves the robot.
        start: Where it starts.
        commands: The commands to watch. If None, the robot is driven by hand until the page or Ctrl-C ends it.
        log: Gets every state.
        observers: Observers of the drive, such as a recording.
        speed: Simulated seconds per second.
        seed: Seed of the simulator.
        quiet: Without remarks.
    """
    from trundle.mission import Session
    from trundle.navigation import CommandScript
    from trundle.serve.run_feed import Watch
    from trundle.serve.steerer import Steerer

    script = None if commands is None else CommandScript(commands, period_s=PERIOD_S)
    agent = _make_navigator(simulator, start) if script is None else script
    options: dict[str, Any] = {} if script is None else {"monitor": False}
    steerer = Steerer(speed=speed, restarts=False)

    def make(_seed: int | None) -> Session:
        watch = Watch(page.hub, 1, None, world=lambda: simulator.world, steering=steerer.steering)
        return Session(
            simulator,
            agent,
            start,
            seed=seed,
            stop_on_contact=False,
            measure=None,
            observers=[_LegLogger(log, script, commands or ()), *observers, watch, watch.recorded],
            steering=steerer.steering,
            **options,
        )

    with page_in_browser.serving(None) as page:
        page.hub.controls = steerer
        page_in_browser.announce(page, quiet=quiet)
        steerer.drive(make)
        error = None if steerer.session is None else steerer.session.error
        if error is not None and not isinstance(error, KeyboardInterrupt):
            raise error
        page_in_browser.linger(page, page_in_browser.wait_until, quiet=quiet)


def _make_navigator(simulator: Simulator, start: Pose2D) -> Agent:
    """Make a navigator without a goal, on the map of the simulated world."""
    import numpy as np

    from trundle.geometry import Pose2D
    from trundle.maps import OccupancyGrid
    from trundle.navigation import Navigator
    from trundle.worlds import World

    world: World = simulator.world or World(name="empty", solids=())
    low, high = world.bounds if world.solids else ((start.x, start.y, 0.0), (start.x, start.y, 0.0))
    bounds = (
        (min(low[0], start.x - _ROOM_M), min(low[1], start.y - _ROOM_M)),
        (max(high[0], start.x + _ROOM_M), max(high[1], start.y + _ROOM_M)),
    )
    robot = simulator.robot
    if not world.solids:
        cells = np.zeros((int(2.0 * _ROOM_M / _CELL_M), int(2.0 * _ROOM_M / _CELL_M)), dtype=np.int8)
        return Navigator(OccupancyGrid(cells, _CELL_M, Pose2D(start.x - _ROOM_M, start.y - _ROOM_M)), robot)
    grid = OccupancyGrid.from_world(
        world, resolution=_CELL_M, z_range=robot.z_range, bounds=bounds, seeds=[(start.x, start.y)]
    )
    return Navigator(grid, robot)


def _report_drive(log: DriveLog, folder: Path, *, json: bool) -> None:
    """Print the summary of a drive by hand; as JSON one leg, as for a command, that includes the summary."""
    summary = log.summary()
    if json:
        output.print_json([{**leg, "summary": summary, "run_dir": folder} for leg in log.legs()])
        return
    x, y, yaw = summary.pose.as_tuple()
    left, right = (math.degrees(angle) for angle in (summary.turned_left, summary.turned_right))
    output.print_facts(
        {
            "driven": f"{summary.distance:.2f} m in {summary.seconds:.1f} s",
            "top speed": f"{summary.top_speed:.2f} m/s",
            "turned": f"{left:.0f} deg left, {right:.0f} deg right",
            "contacts": f"{summary.contacts}: {first_names(summary.touched)}" if summary.contacts else "none",
            "final pose": f"x {x:.2f} m, y {y:.2f} m, yaw {math.degrees(yaw):.0f} deg",
            "record": folder / "drive.csv",
        }
    )


def _report_commands(log: DriveLog, folder: Path, *, json: bool) -> None:
    if json:
        output.print_json([{**leg, "run_dir": folder} for leg in log.legs()])
        return
    output.print_table(
        ("v", "w", "seconds", "x", "y", "yaw", "actual v", "actual w", "wheel left", "wheel right", "touched"),
        [
            (
                f"{leg['v']:g}",
                f"{leg['w']:g}",
                f"{leg['seconds']:g}",
                leg["x"],
                leg["y"],
                leg["yaw"],
                leg["twist"]["v"],
                leg["twist"]["w"],
                leg["wheel_speeds"]["left"],
                leg["wheel_speeds"]["right"],
                first_names(leg["contacts"]) or None,
            )
            for leg in log.legs()
        ],
    )
    print(f"record  {folder / 'drive.csv'}")
