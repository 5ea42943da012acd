"""`trundle compare`: the difference between two runs of the same commands."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import options, output
from trundle.cli.shared.sources import check_given
from trundle.files.kinds import ARRAYS, DRIVE, RUN, TABLE

_LONGER_S = 0.5
"""Runs whose ends differ by more than this are said to be compared only up to the end of the shorter one."""

app = App(
    name="compare",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle drive nova_carter --command 0.4,0.3,5 --backend mujoco -o one\n"
        "  trundle drive nova_carter --like one --backend kinematic -o other\n"
        "  trundle compare one other -o compare.png"
    ),
)


@app.default
def compare(
    first: Path,
    second: Path,
    /,
    *,
    align: options.Flag = False,
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path("compare.png"),
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Compare two runs, or two drives, over time, and draw both.

    Args:
        first: The folder that a run or a drive wrote: the reference.
        second: The folder of the other run.
        align: Align both runs at their starts.
        out: The picture, or a folder for compare.png.
    """
    from trundle.record.compare import compare_motions, draw_comparison
    from trundle.record.motion import Motion
    from trundle.record.run_folder import save_png

    target = options.output_file(out, "compare.png", (".png",))
    for run in (first, second):
        check_given(run, RUN, DRIVE, TABLE, ARRAYS)
    motions = Motion.load(first), Motion.load(second)
    comparison = compare_motions(*motions, align=align)
    one, other = first.resolve().name, second.resolve().name
    names = (one, other) if one != other else (str(first), str(second))
    save_png(draw_comparison(comparison, names), target)
    if comparison.max_command_difference > 1e-6:
        output.remark(
            f"trundle: the runs were not driven by the same commands: they differ by up to "
            f"{comparison.max_command_difference:.3f} (see trundle drive --like RUN)",
            quiet=quiet,
        )
    ends = [float(motion.time[-1]) for motion in motions]
    if max(ends) - comparison.time[-1] > _LONGER_S:
        output.remark(
            f"trundle: the runs end after {ends[0]:.2f} and {ends[1]:.2f} s, and are compared up to "
            f"{comparison.time[-1]:.2f} s",
            quiet=quiet,
        )
    facts = {
        "max_position_error_m": comparison.max_position_error_m,
        "max_yaw_error_rad": comparison.max_yaw_error_rad,
        "final_position_error_m": comparison.final_position_error_m,
        "final_yaw_error_rad": comparison.final_yaw_error_rad,
        "rms_position_error_m": comparison.rms_position_error_m,
        "max_command_difference": comparison.max_command_difference,
        "duration_s": float(comparison.time[-1] - comparison.time[0]),
        "picture": target,
    }
    if json:
        output.print_json(
            {
                **facts,
                "time": comparison.time,
                "position_error": comparison.position_error,
                "yaw_error": comparison.yaw_error,
            }
        )
        return 0
    output.print_facts(
        {
            "largest distance": f"{1000.0 * comparison.max_position_error_m:.1f} mm",
            "largest yaw difference": f"{comparison.max_yaw_error_rad:.4f} rad",
            "distance at the end": f"{1000.0 * comparison.final_position_error_m:.1f} mm",
            "yaw difference at the end": f"{comparison.final_yaw_error_rad:.4f} rad",
            "RMS distance": f"{1000.0 * comparison.rms_position_error_m:.1f} mm",
            "time": f"{facts['duration_s']:.2f} s",
            "picture": target,
        }
    )
    return 0
