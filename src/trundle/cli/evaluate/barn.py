"""`trundle evaluate barn`: the public BARN worlds, driven by lidar alone, with BARN's score."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from trundle.cli.evaluate.public import DriveOptions, OutputOptions, read_numbers, run_benchmark
from trundle.evaluation import Suite
from trundle.evaluation.public.barn import barn_figures, barn_suite

app = App(
    name="barn",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle evaluate barn --worlds BARN\n"
        "  trundle evaluate barn --worlds BARN --only 0:300:15 --controller mppi --seeds 10 -o runs/barn\n"
        "  trundle evaluate barn --worlds BARN --controller mppi --scan-age 0.05 --command-delay 0.05"
    ),
)


@app.default
def barn(
    *,
    worlds: Path,
    only: str | None = None,
    seeds: Annotated[str, Parameter(name=["--seeds", "--seed"])] = "10",
    drive: Annotated[DriveOptions, Parameter(name="*")] = DriveOptions(),  # noqa: B008 - frozen
    output: Annotated[OutputOptions, Parameter(name="*")] = OutputOptions(),  # noqa: B008 - frozen
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
