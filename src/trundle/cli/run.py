"""`trundle run`: drive a robot to its goal, and record it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import missions, nav2, scenario_options
from trundle.cli.shared.sources import check_given
from trundle.errors import InputError
from trundle.files.kinds import EVALUATION

if TYPE_CHECKING:
    from trundle.mission import Scenario

app = App(
    name="run",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle run map.yaml --robot nova_carter --start -6,-1,3.14 --goal 5,3\n"
        "  trundle run warehouse --seed 7 --set aisle_width=1.4\n"
        "  trundle run map.yaml --set height=0.4 --set unknown=free\n"
        "  trundle run map.yaml --keepout zones.yaml --speed-mask limits.yaml\n"
        "  trundle run warehouse --planner least_cost --inflation-radius 0.8 --goal-tolerance 0.1\n"
        "  trundle run scene.usd --exclude /World/Robot --exclude ceiling\n"
        "  trundle run scenario.yaml --backend kinematic --json\n"
        "  trundle run office --robot jackal --browser\n"
        "  trundle run warehouse --lidar --record --distro kilted\n"
        "  trundle run map.yaml --nav2-params nav2_params.yaml\n"
        "  trundle run --from runs/nightly:7f3a21\n"
        "  python.sh -m trundle run map.yaml --backend isaac --environment warehouse_with_forklifts"
    ),
)


@app.default
def run(
    source: str | None = None,
    /,
    *,
    given: scenario_options.ScenarioOptions = scenario_options.DEFAULTS,
    from_: Annotated[str | None, Parameter(name="--from", metavar="FOLDER:ID")] = None,
    map_: Annotated[str | None, Parameter(name="--map")] = None,
    shown: missions.PresentationOptions = missions.PresentationOptions(),  # noqa: B008 - frozen
) -> int:
    """Drive a robot through a map, a generated world or a scenario to its goal.

    Writes a folder with episode.json, trajectory.npz, paths.npz, scenario.yaml (which repeats the run), report.html,
    overlay.png and video.mp4; with --record also run.mcap.
    Exit code 1: the robot did not reach the goal; 3: a plug-in raised an exception, and the folder says which.

    Args:
        source: The YAML of a scenario or of a ROS map (it has an image: key), a world by name (warehouse, office,
            maze, cylinders, corridors, lot), or a world's file. With
            --backend isaac also an environment of Isaac Sim whose file is on this machine.
        from_: An episode of an evaluation, to be run again exactly, by its folder and the start of its id.
        map_: With --from: the episode's map or world's file, or the folder that holds it, where it has moved; left out:
            where it was, or else beside the evaluation's suite.yaml.
    """
    told = nav2.Nav2Report()
    if map_ is not None and from_ is None:
        raise InputError("--map goes with --from; give the map to drive in as the first argument")
    if from_ is not None:
        if source is not None or given != scenario_options.DEFAULTS:
            raise InputError(
                "--from repeats an episode exactly: give no map, world or setting with it. To change something, give "
                "other options with the scenario.yaml that it writes"
            )
        scenario = _find_episode(from_, map_)
    elif source is None:
        raise InputError("give a map, a world or a scenario; or --from FOLDER:ID for an episode of an evaluation")
    else:
        scenario = given.make(source, told)
        told.tell(quiet=shown.quiet)
    return missions.drive(scenario, shown, facts=told.facts)


def _find_episode(text: str, map: str | None = None) -> Scenario:
    """Return the exact scenario of an episode, `FOLDER:ID`, with the map where that has moved.

    Raises:
        InputError: If the folder has no evaluation, or there is no such episode, or more than one.
    """
    folder, colon, identity = text.rpartition(":")
    if not colon or not folder or not identity:
        raise InputError(f"--from {text}: give the folder of an evaluation and the start of an episode's id, FOLDER:ID")
    check_given(folder, EVALUATION)
    from trundle.evaluation import Evaluation

    return Evaluation(folder).scenario_of(identity, map=map)
