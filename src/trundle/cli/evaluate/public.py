"""`trundle evaluate barn` and `dynabarn`: the public benchmarks, driven by lidar alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from cyclopts import App, Parameter

from trundle.cli.evaluate.execution import TimeBudget, carry_out, parse_time_budget
from trundle.cli.evaluate.results import Require, report_evaluation
from trundle.cli.shared import options
from trundle.cli.shared.field_options import EXAMPLES, spelt
from trundle.cli.shared.output import remark
from trundle.cli.shared.scenario_options import PARAMETERS
from trundle.cli.shared.termination import INTERRUPTED
from trundle.errors import InputError, OutputError
from trundle.evaluation import Evaluation, Suite
from trundle.evaluation.public.barn import barn_figures, barn_suite
from trundle.evaluation.public.conditions import Conditions, benchmark_robot, write_robot
from trundle.evaluation.public.dynabarn import check_levels, dynabarn_figures, dynabarn_suite
from trundle.evaluation.report.text import table_lines
from trundle.evaluation.statistics import Table
from trundle.evaluation.statistics.table import ARRIVED
from trundle.evaluation.store.folder import MANIFEST, check_free_for_evaluation
from trundle.files.choice import Choice
from trundle.files.opening import exists
from trundle.files.writing import make_folder, new_folder

_MOST_LISTED = 1000

barn_app = App(
    name="barn",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle evaluate barn --worlds BARN\n"
        "  trundle evaluate barn --worlds BARN --only 0:300:15 --controller mppi --seeds 10 -o runs/barn\n"
        "  trundle evaluate barn --worlds BARN --controller mppi --scan-age 0.05 --command-delay 0.05"
    ),
)
dynabarn_app = App(
    name="dynabarn",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle evaluate dynabarn --worlds worlds.json\n"
        "  trundle evaluate dynabarn --worlds worlds.json --levels hard --controller mppi -o runs/hard"
    ),
)


def _crossed(name: str, help: str) -> Parameter:
    return Parameter(name=[f"--{name}", f"--{name}s"], help=help)


def _flag(help: str, negative: str = "") -> Parameter:
    return Parameter(help=help, negative=negative)


@dataclass(frozen=True, kw_only=True)
class DriveOptions:
    """Options of the robot, of what drives it, and of the errors of its sensors."""

    robot: Annotated[str, _crossed("robot", options.ROBOT_HELP)] = "jackal"
    speed: Annotated[
        str, _crossed("speed", "The robot's top speed, forwards and backwards [m/s]; 2,3,4 crosses several.")
    ] = "2"
    noise: Annotated[float, Parameter(help="Standard deviation of its lidar's ranges [m].")] = 0.01
    drift: Annotated[
        bool | None,
        _flag("Odometry alone, which drifts by 5 mm and 5 mrad per √m, instead of the true pose.", "--no-drift"),
    ] = None
    scan_age: Annotated[float, Parameter(help="Age of the scans when they arrive [s].")] = 0.0
    command_delay: Annotated[float, Parameter(help="Delay of the commands [s].")] = 0.0
    planner: Annotated[str, _crossed("planner", f"{PARAMETERS['planner'].help} Commas cross several.")] = "auto"
    planner_option: Annotated[list[str] | None, PARAMETERS["planner_options"]] = None
    controller: Annotated[str, _crossed("controller", f"{PARAMETERS['controller'].help} Commas cross several.")] = (
        "regulated_pure_pursuit"
    )
    controller_option: Annotated[list[str] | None, PARAMETERS["controller_options"]] = None
    collision_monitor: Annotated[
        bool | None, _flag("Check every command against the scans.", "--no-collision-monitor")
    ] = None
    backend: Annotated[str, _crossed("backend", "The simulator: mujoco, kinematic or physx. Commas cross several.")] = (
        "mujoco"
    )

    def conditions(self, robots: Sequence[str], *, seeds: str, drift: bool, monitor: bool) -> Conditions:
        """Return the conditions of the runs, for robots by name or file; `drift` and `monitor` are defaults.

        Raises:
            InputError: If a value cannot be read.
        """
        return Conditions(
            robots=robots,
            seeds=options.parse_seeds(seeds),
            planners=_choices("planner", self.planner, self.planner_option),
            controllers=_choices("controller", self.controller, self.controller_option),
            backends=options.parse_list(self.backend),
            drift=drift if self.drift is None else self.drift,
            scan_age_s=self.scan_age,
            command_delay_s=self.command_delay,
            collision_monitor=monitor if self.collision_monitor is None else self.collision_monitor,
        )

    def robots(self) -> list[dict[str, Any]]:
        """Return the settings of the robots, one for each speed.

        Raises:
            InputError: If they cannot be used.
        """
        speeds = options.parse_numbers("--speed", self.speed, "speeds [m/s]", at_least=1, at_most=20)
        return [benchmark_robot(self.robot, speed=speed, noise=self.noise) for speed in speeds]


@dataclass(frozen=True, kw_only=True)
class OutputOptions:
    """Options of what is written, and of how the benchmark is run."""

    out: Annotated[
        Path | None, Parameter(name=["--out", "-o"], help="Folder to write or continue; default: a new one under runs.")
    ] = None
    workers: Annotated[options.Integer | None, Parameter(help="Number of processes; default: one for each CPU.")] = None
    require: Require = ()
    mixed: Annotated[bool, _flag("Continue although the code has changed since the earlier rows.")] = False
    overwrite: Annotated[bool, _flag("Delete the evaluation that the folder holds, and start again.")] = False
    time_budget: TimeBudget = None
    json: options.Json = False
    quiet: options.Quiet = False

    def folder(self, name: str) -> Path:
        """Make the folder, or check the one that is given.

        Raises:
            OutputError: If it holds something else, or cannot be made.
        """
        if self.out is None:
            return new_folder("runs", name)
        if exists(self.out) and not exists(self.out / MANIFEST):
            check_free_for_evaluation(self.out)
        try:
            return make_folder(self.out)
        except OutputError as error:
            raise OutputError(f"{error}; give another folder with -o") from error


@barn_app.default
def barn(
    *,
    worlds: Path,
    only: str | None = None,
    seeds: Annotated[str, Parameter(name=["--seeds", "--seed"])] = "10",
    drive: Annotated[DriveOptions, Parameter(name="*")] = DriveOptions(),
    output: Annotated[OutputOptions, Parameter(name="*")] = OutputOptions(),
) -> int:
    """Drive in BARN's worlds without a map, and score each run as BARN does.

    The robot gets its scans and its odometry. A run succeeds when the robot is within 1 m of the goal before 100 s,
    with no contact. Below the figures is every failure, with the command that runs it again. Without other options the
    odometry drifts, and every command passes the collision monitor.

    Args:
        worlds: Folder with world_N.world of the BARN data set, and path_N.npy beside them or in path_files.
        only: Numbers of the worlds to drive in: 0,15,30 or 0:300:15; left out: all that are there.
        seeds: Seeds of the runs in each world: 10, 0:50 or 3,7,9.
    """
    numbers = read_numbers(only)

    def make(robots: Sequence[str]) -> Suite:
        return barn_suite(worlds, drive.conditions(robots, seeds=seeds, drift=True, monitor=True), numbers=numbers)

    return run_benchmark("barn", make, drive, output, barn_figures)


@dynabarn_app.default
def dynabarn(
    *,
    worlds: Path,
    only: str | None = None,
    levels: Annotated[str | None, Parameter(name=["--levels", "--level"])] = None,
    phases: Annotated[str, Parameter(name=["--phases", "--phase"])] = "5",
    drive: Annotated[DriveOptions, Parameter(name="*")] = DriveOptions(),
    output: Annotated[OutputOptions, Parameter(name="*")] = OutputOptions(),
) -> int:
    """Drive among DynaBARN's moving cylinders without a map; success and time are reported.

    The robot gets its scans and its pose. A run succeeds when the robot is within 1 m of the goal before 100 s, with no
    contact, not even while it stands; so without other options no collision monitor stops it in front of what comes
    towards it. Below the figures is every failure, with the command that runs it again.

    Args:
        worlds: JSON file of the worlds: the key frames of each obstacle.
        only: Numbers of the worlds to drive in: 0,2,4 or 0:60; left out: all that are there.
        levels: Levels of the worlds to drive in, separated by commas: easy, medium, hard; left out: all.
        phases: Runs in each world: a number of them, or their seeds as 0:50 or 3,7,9. The seed draws how far the
            obstacles' motions are when the run begins.
    """
    numbers = read_numbers(only)
    chosen = None if levels is None else check_levels([level.strip() for level in levels.split(",")])

    def make(robots: Sequence[str]) -> Suite:
        conditions = drive.conditions(robots, seeds=phases, drift=False, monitor=False)
        return dynabarn_suite(worlds, conditions, numbers=numbers, levels=chosen)

    return run_benchmark("dynabarn", make, drive, output, dynabarn_figures)


def run_benchmark(
    name: str,
    make: Callable[[Sequence[str]], Suite],
    drive: DriveOptions,
    given: OutputOptions,
    figures: Callable[[Table], Mapping[str, float | None]],
) -> int:
    """Run a benchmark, print its figures and every failure, and return the exit code.

    Args:
        name: Its name.
        make: Makes its suite of robots.
        drive: What drives.
        given: What to write.
        figures: Computes its figures.
    """
    budget_s = parse_time_budget(given.time_budget)
    robots = drive.robots()
    make([drive.robot]).check()  # before a folder is made
    folder = given.folder(name)
    suite = make([write_robot(folder, robot) for robot in robots])
    if given.require:
        suite = suite.with_fields(require=given.require)
    evaluation = carry_out(
        suite,
        folder,
        json=given.json,
        quiet=given.quiet,
        workers=given.workers,
        mixed=given.mixed,
        overwrite=given.overwrite,
        time_budget_s=budget_s,
    )
    if evaluation is None:
        return INTERRUPTED
    code = report_evaluation(evaluation, json=given.json, figures=figures(evaluation.table))
    if not given.json:
        _list_failures(evaluation)
    return code


def _list_failures(evaluation: Evaluation) -> None:
    failed = [row for row in evaluation.rows() if row.outcome != ARRIVED]
    if failed:
        print("\n" + "\n".join(table_lines(failed[:_MOST_LISTED], evaluation.folder)))
    if len(failed) > _MOST_LISTED:
        remark(f"{len(failed) - _MOST_LISTED:,} more: trundle evaluate show {evaluation.folder} --failed", quiet=False)


def read_numbers(text: str | None) -> list[int] | None:
    """Read `0,15,30` or `0:60` or both: numbers of worlds; a range ends before its second number.

    Raises:
        InputError: If it is none of these.
    """
    if text is None:
        return None
    numbers: list[int] = []
    for part in options.parse_list(text):
        pieces = part.split(":")
        if not all(piece.isdecimal() for piece in pieces) or len(pieces) > 3 or pieces[2:] == ["0"]:
            raise InputError(f"--only {text}: give numbers of worlds, as in 0,15,30 or 0:60 or 0:300:15")
        numbers += [int(part)] if len(pieces) == 1 else range(*map(int, pieces))
    if not numbers or len(set(numbers)) < len(numbers):
        raise InputError(
            f"--only {text}: {'a world is there twice' if numbers else 'this names no world'}; "
            "give numbers of worlds, as in 0,15,30 or 0:60"
        )
    return numbers


def _choices(kind: str, names: str, pairs: list[str] | None) -> list[str | Choice]:
    given = [spelt(kind, name) for name in options.parse_list(names)]
    settings = options.parse_pairs(f"--{kind}-option", pairs, EXAMPLES[kind])
    if settings and len(given) > 1:
        raise InputError(f"--{kind}-option: with several {kind}s it is unclear which one it is for; give one --{kind}")
    return [Choice(name=name, options=dict(settings)) if settings else name for name in given]
