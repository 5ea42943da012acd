"""`trundle evaluate dynabarn`: the public DynaBARN worlds, driven by lidar alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from trundle.cli.evaluate.public import DriveOptions, OutputOptions, read_numbers, run_benchmark
from trundle.evaluation import Suite
from trundle.evaluation.public.dynabarn import check_levels, dynabarn_figures, dynabarn_suite

app = App(
    name="dynabarn",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle evaluate dynabarn --worlds worlds.json\n"
        "  trundle evaluate dynabarn --worlds worlds.json --levels hard --controller mppi -o runs/hard"
    ),
)


@app.default
def dynabarn(
    *,
    worlds: Path,
    only: str | None = None,
    levels: Annotated[str | None, Parameter(name=["--levels", "--level"])] = None,
    phases: Annotated[str, Parameter(name=["--phases", "--phase"])] = "5",
    drive: Annotated[DriveOptions, Parameter(name="*")] = DriveOptions(),  # noqa: B008 - frozen
    output: Annotated[OutputOptions, Parameter(name="*")] = OutputOptions(),  # noqa: B008 - frozen
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
