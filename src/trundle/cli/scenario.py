"""`trundle scenario`: write the options of `trundle run` as a file to edit."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import nav2, options, output, scenario_options
from trundle.errors import InputError

app = App(
    name="scenario",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle scenario map.yaml --start 0,0 --goal 5,3 -o scenario.yaml\n"
        "  trundle scenario warehouse --set aisle_width=1.4 --planner least_cost -o aisles.yaml\n"
        "  trundle scenario map.yaml --nav2-params nav2_params.yaml -o nav2.yaml\n"
        "  trundle scenario --schema > scenario.schema.json"
    ),
)


@app.default
def scenario(
    source: str | None = None,
    /,
    *,
    given: scenario_options.ScenarioOptions = scenario_options.DEFAULTS,
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path("scenario.yaml"),
    overwrite: options.OverwriteFile = False,
    schema: options.Flag = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Write a scenario with the options of trundle run, with a comment on every field.

    trundle run drives it. Fields that have their default are commented out.

    Args:
        source: As in trundle run: a map, a world by name or file, or another scenario.
        out: The file.
        schema: Print the JSON Schema of scenarios instead, for editors that validate YAML.
    """
    from trundle.files.field_docs import json_schema
    from trundle.mission import Scenario

    if schema:
        output.print_json(json_schema(Scenario, "trundle scenario"))
        return 0
    if source is None:
        raise InputError("give a map, a world by name or file, or another scenario")
    target = options.new_yaml_file(out, "scenario.yaml", overwrite=overwrite)
    told = nav2.Nav2Report()
    given.make(source, told).save_commented(target)
    told.tell(quiet=quiet)
    facts = {"scenario": target, **(told.facts if json else {})}
    output.report_written(facts, f"To drive it: trundle run {target}", json=json, quiet=quiet)
    return 0
