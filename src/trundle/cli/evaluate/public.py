"""Options of the public benchmarks, and what their verbs do with a suite."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from trundle.cli.evaluate import verdict
from trundle.cli.evaluate.execution import INTERRUPTED, carry_out
from trundle.cli.shared import options
from trundle.cli.shared.output import remark
from trundle.errors import InputError, OutputError
from trundle.evaluation import Evaluation, Suite
from trundle.evaluation.public.conditions import Conditions, benchmark_robot, write_robot
from trundle.evaluation.report.text import table_lines
from trundle.evaluation.statistics import Table
from trundle.evaluation.statistics.table import ARRIVED
from trundle.evaluation.store.folder import MANIFEST, check_free_for_evaluation
from trundle.files.choice import Choice
from trundle.files.opening import exists
from trundle.files.writing import make_folder, new_folder

_MOST_LISTED = 1000


def _crossed(name: str, help: str) -> Parameter:
    return Parameter(name=[f"--{name}", f"--{name}s"], help=help)


def _flag(help: str, negative: str = "") -> Parameter:
    return Parameter(help=help, negative=negative)


@dataclass(frozen=True, kw_only=True)
class DriveOptions:
    """What drives, and what it has to live with."""

    robot: Annotated[str, _crossed("robot", options.ROBOT_HELP)] = "jackal"
    speed: Annotated[
        str, _crossed("speed", "Its largest speed forwards and backwards [m/s]; 2,3,4 crosses several.")
    ] = "2"
    noise: Annotated[float, Parameter(help="Standard deviation of its lidar's ranges [m].")] = 0.01
    drift: Annotated[
        bool | None,
        _flag("Odometry alone, which drifts by 5 mm and 5 mrad per √m, instead of the true pose.", "--no-drift"),
    ] = None
    scan_age: Annotated[float, Parameter(help="Age of the scans when they arrive [s].")] = 0.0
    command_delay: Annotated[float, Parameter(help="Delay of the commands [s].")] = 0.0
    planner: Annotated[str, _crossed("planner", f"{options.PLANNER_HELP} Commas cross several.")] = "auto"
    planner_option: options.PlannerOptions = None
    controller: Annotated[str, _crossed("controller", f"{options.CONTROLLER_HELP} Commas cross several.")] = (
        "regulated_pure_pursuit"
    )
    controller_option: options.ControllerOptions = None
    collision_monitor: Annotated[
        bool | None, _flag("Let every command pass the collision monitor.", "--no-collision-monitor")
    ] = None
    backend: Annotated[str, _crossed("backend", "The simulator: mujoco or kinematic. Commas cross several.")] = "mujoco"

    def conditions(self, robots: Sequence[str], *, seeds: str, drift: bool, monitor: bool) -> Conditions:
        """The conditions that they say, for robots by name or file; the last two where they say nothing.

        Raises:
            InputError: If a value cannot be read.
        """
        return Conditions(
            robots=robots,
            seeds=_read_seeds(seeds),
            planners=_choices("planner", self.planner, self.planner_option),
            controllers=_choices("controller", self.controller, self.controller_option),
            backends=_split(self.backend),
            drift=drift if self.drift is None else self.drift,
            scan_age_s=self.scan_age,
            command_delay_s=self.command_delay,
            collision_monitor=monitor if self.collision_monitor is None else self.collision_monitor,
        )

    def robots(self) -> list[dict[str, Any]]:
        """The settings of the robots.

        Raises:
            InputError: If they cannot be used.
        """
        speeds = options.parse_numbers("--speed", self.speed, "speeds [m/s]", at_least=1, at_most=20)
        return [benchmark_robot(self.robot, speed=speed, noise=self.noise) for speed in speeds]


@dataclass(frozen=True, kw_only=True)
class OutputOptions:
    """What to write, and how to run."""

    out: Annotated[
        Path | None, Parameter(name=["--out", "-o"], help="Folder to write or continue; default: a new one under runs.")
    ] = None
    workers: Annotated[options.Integer | None, Parameter(help="Number of processes; default: one for each CPU.")] = None
    require: verdict.Require = ()
    mixed: Annotated[bool, _flag("Continue although the code has changed since the earlier rows.")] = False
    overwrite: Annotated[bool, _flag("Delete the evaluation that the folder holds, and start again.")] = False
    time_budget: verdict.TimeBudget = None
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
    budget_s = verdict.parse_time_budget(given.time_budget)
    robots = drive.robots()
    make([drive.robot]).check()  # before a folder is made
    folder = given.folder(name)
    suite = make([write_robot(folder, robot) for robot in robots])
    if given.require:
        suite = Suite.make(
            **{**{name: getattr(suite, name) for name in suite.model_fields_set}, "require": given.require}
        )
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
    code = verdict.give(evaluation, json=given.json, figures=figures(evaluation.table))
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
    for part in _split(text):
        pieces = part.split(":")
        if not all(piece.isdecimal() for piece in pieces) or len(pieces) > 3 or pieces[2:] == ["0"]:
            raise InputError(f"--only {text}: give numbers of worlds, as in 0,15,30 or 0:60 or 0:300:15")
        numbers += [int(part)] if len(pieces) == 1 else range(*map(int, pieces))
    if not numbers or len(set(numbers)) < len(numbers):
        raise InputError(f"--only {text}: {'a world is there twice' if numbers else 'this names no world'}")
    return numbers


def _choices(kind: str, names: str, pairs: list[str] | None) -> list[str | Choice]:
    given = _split(names)
    settings = options.parse_pairs(f"--{kind}-option", pairs, options.EXAMPLES[kind])
    if settings and len(given) > 1:
        raise InputError(f"--{kind}-option: with several {kind}s it is unclear which one it is for; give one --{kind}")
    return [Choice(name=name, options=dict(settings)) if settings else name for name in given]


def _read_seeds(text: str) -> int | str | list[int]:
    parts = _split(text)
    if not all(part.isdecimal() for part in parts):
        return text
    return [int(part) for part in parts] if len(parts) > 1 else int(text)


def _split(text: str) -> list[str]:
    return [part.strip() for part in text.split(",") if part.strip()]
