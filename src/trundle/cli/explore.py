"""`trundle explore`: a robot explores a world that it does not know, and makes its map."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import missions, options, output, scenario_options
from trundle.record.map_report_lines import tell_report

if TYPE_CHECKING:
    from trundle.maps.check import MapReport
    from trundle.mission import Episode, Exploration, Mission
    from trundle.record.run_folder import RunFolder

_MOST_GIVEN_UP = 5  # that are named
_MOST_LINES = 8  # of what the check of the map finds

app = App(
    name="explore",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle explore warehouse -o map.yaml\n"
        "  trundle explore office --seed 3 --time-limit 600 --posegraph site.posegraph\n"
        "  trundle explore warehouse --odometry scale=0.05 --odometry heading=5deg --set people=3\n"
        "  trundle explore maze --controller mppi --agent-option gain_exponent=0 --json\n"
        "  trundle explore hall.sdf --robot jackal --browser"
    ),
)


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class ShownOptions:
    """Options of how an exploration is shown, and of its folder."""

    folder: Annotated[
        Path | None,
        Parameter(name="--folder", help="Folder of the run, which must not hold one; default: a new one under runs."),
    ] = None
    report: bool = True
    video: bool = True
    view: options.Flag = False
    browser: options.Browser = False
    speed: options.RunSpeed = None
    record: options.Record = False
    distro: options.Distro = None

    def of_run(self, *, json: bool, quiet: bool, overwrite: bool) -> missions.PresentationOptions:
        """Return the same as options of a run."""
        return missions.PresentationOptions(
            report=self.report,
            video=self.video,
            view=self.view,
            browser=self.browser,
            speed=self.speed,
            record=self.record,
            distro=self.distro,
            out=self.folder,
            overwrite=overwrite,
            json=json,
            quiet=quiet,
        )


@app.default
def explore(
    source: str,
    /,
    *,
    out: options.Out = None,
    posegraph: Annotated[Path | None, Parameter(name="--posegraph")] = None,
    given: scenario_options.ScenarioOptions = scenario_options.DEFAULTS,
    shown: ShownOptions = ShownOptions(),
    overwrite: options.OverwriteMap = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Explore a world that the robot does not know: it drives to where its map ends until nothing is left to see.

    The robot has lidars, the localizer slam and no map, unless options say otherwise; the agent explorer drives it with
    planner and controller. In generated worlds there are no objects that its lidars do not see; --set low_objects=true
    puts them in.
    Writes the map, and the folder of the run, with pictures of the map as it grew. At the end the map is checked.
    Exit code 0: nothing that the robot can reach is left to see; 1: time or a contact ended it before, and the map has
    what was seen until then; 3: a plug-in raised an exception.

    Args:
        source: The world: a generated one by name (warehouse, office, maze, cylinders, corridors, lot), its file, the
            YAML of a map, which becomes a world, or of a scenario.
        out: The map's YAML, with its image beside it, or a folder for map.yaml; default: map.yaml.
        posegraph: Also write the poses, scans and loops that the map was drawn from, such as site.posegraph; trundle
            map continue goes on from there.
    """
    from trundle.mission.exploring import INSTEAD, conclude, exploring

    target = options.output_file(Path("map.yaml") if out is None else out, "map.yaml", (".yaml", ".yml"))
    if not overwrite:
        options.check_map_replaceable(target)
    graph_file = None if posegraph is None else options.output_file(posegraph, "site.posegraph", (".posegraph",))
    scenario = exploring(given.make(source, instead=INSTEAD))
    if scenario.name is None:
        scenario = scenario.model_copy(update={"name": f"explore-{scenario.title}"})
    facts: dict[str, object] = {}

    def finish(mission: Mission, episode: Episode, folder: RunFolder) -> int:
        exploration = conclude(mission, episode)
        report = _write(exploration, mission, target, graph_file, facts)
        _tell(exploration, report, target, folder, facts, json=json)
        return 0 if exploration.finished else 1

    run = shown.of_run(json=json, quiet=quiet, overwrite=overwrite)
    return missions.drive(scenario, run, finish=finish)


def _write(
    exploration: Exploration, mission: Mission, target: Path, graph_file: Path | None, facts: dict[str, object]
) -> MapReport | None:
    """Write the map and the pose graph, and check the map; None where there is none."""
    from trundle.mapping.pose_graph_file import save_pose_graph
    from trundle.maps.check import check_grid

    grid = exploration.grid
    facts["map"] = None
    if graph_file is not None:
        facts["posegraph"] = None
    if grid is None:
        return None
    grid.save(target)
    facts["map"] = target
    if graph_file is not None and exploration.graph is not None:
        save_pose_graph(exploration.graph, graph_file)
        facts["posegraph"] = graph_file
    return check_grid(grid, robot=mission.robot, start=mission.start)


def _tell(
    exploration: Exploration,
    report: MapReport | None,
    target: Path,
    folder: RunFolder,
    facts: dict[str, object],
    *,
    json: bool,
) -> None:
    """Print the result."""
    episode, lost = exploration.episode, exploration.given_up
    if json:
        output.print_json(
            {
                **(folder.record or {**episode.as_dict(), "run_dir": folder.path}),
                **facts,
                "finished": exploration.finished,
                "given_up": lost,
                "open_frontiers": exploration.open,
                "findings": () if report is None else report.findings,
            }
        )
        return
    metrics = episode.metrics
    outcome = "finished" if exploration.finished else episode.outcome.value
    output.print_facts(
        {
            "outcome": f"{outcome}: {episode.message}",
            "time": f"{metrics.time_s:.1f} s",
            "distance": f"{metrics.distance_m:.2f} m",
            "contacts": ", ".join(metrics.contacts) or "none",
            **missions.map_facts(episode),
            **{name: value for name, value in facts.items() if value is not None},
            "folder": folder.path,
        }
    )
    for one in lost[:_MOST_GIVEN_UP]:
        print(f"given up at ({one.x:.1f}, {one.y:.1f}): {one.reason}")
    if len(lost) > _MOST_GIVEN_UP:
        print(f"and {len(lost) - _MOST_GIVEN_UP} more, which --json lists")
    if exploration.open:
        print(f"{len(exploration.open)} frontiers were left to see")
    if exploration.grid is None:
        print("map: not written: no scan arrived, or the localizer makes no map; slam does")
    if report is not None:
        for line in tell_report(str(target), report, None, most=_MOST_LINES):
            print(line)
