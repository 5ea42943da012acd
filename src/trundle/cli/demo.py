"""`trundle demo`: the whole pipeline, on the built-in warehouse."""

from __future__ import annotations

from cyclopts import App

from trundle.cli.shared import missions, options, output

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
    shown: missions.PresentationOptions = missions.PresentationOptions(),  # noqa: B008 - frozen
) -> int:
    """Generate a warehouse, build its map, plan for Nova Carter, drive it to the goal, and record the run.

    Needs no screen, no GPU and no ROS. The folder that it writes also holds the map (map.yaml, map.png) and a picture
    of the scene (scene.png).
    """
    from trundle.mission import Scenario

    scenario = Scenario.make(name="demo", world="warehouse", seed=seed, backend=backend)
    code = missions.drive(scenario, shown, with_place=True, narrate=True)
    if not shown.browser:
        output.remark("To watch and steer it live in the browser: trundle demo --browser", quiet=shown.quiet)
    return code
