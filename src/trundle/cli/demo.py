"""`trundle demo`: the whole pipeline, on the built-in warehouse."""

from __future__ import annotations

from cyclopts import App

from trundle.cli.shared import missions, options, output, recordings

app = App(
    name="demo",
    version_flags=[],
    help_epilogue="Examples:\n  trundle demo\n  trundle demo --browser\n  trundle demo --seed 3 --no-video --json",
)


@app.default
def demo(
    *,
    seed: options.Seed = 4,
    backend: options.Backend = "mujoco",
    report: bool = True,
    video: bool = True,
    view: options.Flag = False,
    browser: options.Browser = False,
    speed: options.RunSpeed = None,
    record: options.Record = False,
    distro: options.Distro = None,
    out: options.Out = None,
    overwrite: options.Overwrite = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Generate a warehouse, build its map, plan for Nova Carter, drive it to the goal, and record the run.

    Needs no screen, no GPU and no ROS. The folder that it writes also holds the map (map.yaml, map.png) and a picture
    of the scene (scene.png).

    Args:
        report: Write report.html: one file with the replay, plots and figures of the run.
        video: Write video.mp4.
        view: Watch it drive in a window, if there is a screen.
        out: Output folder, which must not hold a run; default: a new one under runs.
    """
    from trundle.mission import Scenario

    scenario = Scenario.make(name="demo", world="warehouse", seed=seed, backend=backend)
    scenario = recordings.choose(scenario, record=record, distro=distro)
    factor = None if speed is None else options.parse_speed(speed)
    shown = missions.Presentation(
        out=out,
        overwrite=overwrite,
        page=report,
        video=video,
        view=view,
        browser=browser,
        speed=factor,
        json=json,
        quiet=quiet,
        with_place=True,
        narrate=True,
    )
    code = missions.drive(scenario, shown)
    if not browser:
        output.remark("To watch and steer it live in the browser: trundle demo --browser", quiet=quiet)
    return code
