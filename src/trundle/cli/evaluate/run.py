"""`trundle evaluate`: run the episodes of a suite, and judge them."""

from __future__ import annotations

from typing import Annotated, Any

from cyclopts import App, Parameter

from trundle.cli.evaluate.execution import TimeBudget, carry_out, parse_time_budget
from trundle.cli.evaluate.results import Require, report_evaluation
from trundle.cli.shared import nav2, options, sources
from trundle.cli.shared.field_options import OptionField, options_class, spelt
from trundle.cli.shared.sources import check_given
from trundle.cli.shared.termination import INTERRUPTED
from trundle.errors import InputError, UnknownNameError
from trundle.evaluation import Suite, maps_suite, suite_names
from trundle.evaluation.suite import MAPS
from trundle.files.kinds import MAP, SUITE, WORLD, find_kind
from trundle.files.yaml_config import Config
from trundle.worlds import world_names

app = App(
    name="evaluate",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle evaluate smoke\n"
        "  trundle evaluate map.yaml --planners auto,astar --backends kinematic --seeds 0:100\n"
        "  trundle evaluate maps FOLDER --seeds 0:10\n"
        "  trundle evaluate suite.yaml -o runs/nightly --workers 16 --require 'success>=0.99'\n"
        "  trundle evaluate map.yaml --nav2-params nav2_params.yaml\n"
        "  trundle evaluate show runs/nightly --failed\n"
        "  trundle evaluate compare runs/before runs/after"
    ),
)


def _list(field: str, help: str) -> OptionField:
    """Make the option of a field of a suite that takes several values, by its singular and its plural."""
    one = field.removesuffix("s")
    return field, Annotated[str | None, Parameter(name=[f"--{one}s", f"--{one}"], help=help, negative="")], None


_LISTS = (
    _list("robots", "Robots, separated by commas: names or files."),
    _list("planners", "Planners, separated by commas: auto,astar."),
    _list("controllers", "Controllers, separated by commas."),
    _list("agents", "Agents that drive instead of planner and controller, separated by commas."),
    _list("localizer", "Localizers, separated by commas; default: the true pose."),
    _list("backends", "Simulators, separated by commas: mujoco,kinematic; batch is kinematic at once."),
)
"""Fields of `Suite` that an option gives. A field that is added here has its option, and no more is needed."""


@Parameter(name="*")
class SuiteOptions(options_class(_LISTS)):
    """Options that give a suite several robots, planners, … to cross."""

    def changes(self) -> dict[str, Any]:
        """Return the fields whose options were given."""
        texts = {name: getattr(self, name) for name, _, _ in _LISTS}
        lists = {name: options.parse_list(text) for name, text in texts.items() if text is not None}
        return {name: [spelt(name.removesuffix("s"), one) for one in found] for name, found in lists.items()}


@app.default
def run(
    *given: str,
    crossed: SuiteOptions = SuiteOptions(),  # noqa: B008 - frozen
    seeds: Annotated[
        str | None,
        Parameter(name=["--seeds", "--seed"], help="Seeds of the missions: 100, 0:500 or 3,7,9.", negative=""),
    ] = None,
    lidar: options.Flag = False,
    time_limit: float | None = None,
    nav2_params: nav2.Nav2Params = None,
    out: Annotated[str | None, Parameter(name=["--out", "-o"])] = None,
    workers: options.Integer | None = None,
    ray: str | None = None,
    require: Require = (),
    mixed: options.Flag = False,
    overwrite: options.Flag = False,
    time_budget: TimeBudget = None,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Run thousands of missions, and judge them.

    Writes a folder with suite.yaml, the rows (journal.jsonl, parts/*.parquet), report.html, junit.xml and summary.json.
    Ctrl-C and SIGTERM stop it (exit code 130), as does --time-budget (with a report and the usual exit code); the same
    command continues it. Exit code 1 says that a requirement was not met.

    Args:
        given: What to drive: a suite (a file, or smoke, tight or warehouses, which come with trundle), the word maps
            and a folder of ROS maps, or maps and worlds, whose missions are picked by seed. A suite with maps or worlds
            drives in these, too.
        lidar: Simulate the robots' lidars, which the localizers amcl and slam need.
        time_limit: Simulated time after which an episode is stopped [s].
        out: Folder to write into, or to continue; left out: a new one under runs.
        workers: Number of processes; left out: one for each CPU.
        ray: Address of a Ray cluster to run on, or auto, which starts one on this machine.
        mixed: Continue although the code has changed since the earlier rows.
        overwrite: Delete the evaluation that the folder holds, and start again.
    """
    if len(given) == 0:
        raise InputError(
            f"give a suite ({', '.join(suite_names())}, or a file), maps and a folder of ROS maps, or maps and "
            "worlds; trundle evaluate --help has examples"
        )
    budget_s = parse_time_budget(time_budget)
    changes = crossed.changes()
    if seeds is not None:
        changes["missions"] = {"seeds": options.parse_seeds(seeds)}
    if lidar:
        changes["lidar"] = True
    if time_limit is not None:
        changes["limits"] = {"time_limit_s": time_limit}
    if require:
        changes["require"] = require
    told = nav2.Nav2Report()
    suite = _make_suite(given, changes)
    if nav2_params is not None:
        changes = nav2.add_to_suite(nav2_params, suite.robots, changes, told)
        suite = _make_suite(given, changes)
        told.tell(quiet=quiet)
    evaluation = carry_out(
        suite,
        out,
        json=json,
        quiet=quiet,
        workers=workers,
        ray=ray,
        mixed=mixed,
        overwrite=overwrite,
        time_budget_s=budget_s,
    )
    return INTERRUPTED if evaluation is None else report_evaluation(evaluation, json=json, facts=told.facts)


def _make_suite(given: tuple[str, ...], changes: dict[str, Any]) -> Suite:
    """Make the suite that is given, changed by the options; or one of maps and worlds."""
    if given[0] == MAPS:
        missions = changes.get("missions", {})
        rest = {name: value for name, value in changes.items() if name != "missions"}
        return maps_suite(given[1:], **missions, **rest)
    for text in given:
        check_given(text, SUITE, MAP, WORLD)
    suites = [text for text in given if text in suite_names() or find_kind(text) == SUITE]
    if not suites:
        unknown = [text for text in given if not sources.looks_like_file(text) and text not in world_names()]
        if unknown:
            raise UnknownNameError("suite or world", unknown[0], [*suite_names(), MAPS, *world_names()])
        return Suite.make(worlds=list(given), **changes)
    if len(suites) > 1:
        raise InputError(f"give one suite, with maps and worlds that it is to drive in besides; got {' '.join(given)}")
    base = Suite.load(suites[0])
    if others := [text for text in given if text != suites[0]]:
        base = base.with_fields(worlds=[*(_fields(world) for world in base.worlds), *others])
    if "missions" in changes:
        changes["worlds"] = [
            {**_fields(world), "missions": {**_fields(world.missions), **changes["missions"]}}
            if world.missions is not None
            else world
            for world in base.worlds
        ]
    for part in ("missions", "limits"):
        if part in changes:
            changes[part] = {**_fields(getattr(base, part)), **changes[part]}
    return base.with_fields(**changes)


def _fields(model: Config) -> dict[str, Any]:
    """Return the fields that were given."""
    return {name: getattr(model, name) for name in model.model_fields_set}
