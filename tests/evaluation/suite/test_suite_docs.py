"""docs/evaluation.md's section on suites, the JSON Schema, and the suites that trundle ships agree."""

import json
import re
from pathlib import Path

import jsonschema
import pytest
import yaml

from trundle.control import controller_names
from trundle.evaluation.suite import Suite, suite_names
from trundle.evaluation.suite.suite import shipped_folder
from trundle.planning import planner_names

DOCS = Path(__file__).parents[3] / "docs"
SECTION = (DOCS / "evaluation.md").read_text().partition("\n## Suites\n")[2]
EXAMPLE = re.search(r"```yaml\n(.*?)```", SECTION, re.DOTALL)[1]
SCHEMA = json.loads((DOCS / "schemas" / "suite.schema.json").read_text())


def test_the_example_of_the_docs_loads(tmp_path):
    (tmp_path / "aisles.yaml").write_text(EXAMPLE)
    suite = Suite.load(tmp_path / "aisles.yaml")
    assert len(suite) == (500 + 500 + 20) * 3 * 2


@pytest.mark.parametrize(
    "text", [EXAMPLE, *(shipped_folder().joinpath(f"{n}.yaml").read_text() for n in suite_names())]
)
def test_the_schema_takes_what_loads(text):
    jsonschema.validate(yaml.safe_load(text), SCHEMA)


@pytest.mark.parametrize("change", [{"planers": "auto"}, {"goal_tolerance": "near"}, {"missions": {"ends": "wide"}}])
def test_the_schema_refuses_mistakes(change):
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"worlds": "warehouse"} | change, SCHEMA)


def test_the_page_names_every_suite_that_is_shipped():
    page = (DOCS / "evaluation.md").read_text()
    assert [name for name in suite_names() if f"`{name}`" not in page] == []


def test_the_suites_of_the_benchmarks_have_every_planner_and_controller():
    suites = [Suite.load(DOCS.parent / "benchmarks" / "evaluation" / f"{n}.yaml") for n in ("planners", "controllers")]
    for suite in suites:
        suite.check()
    assert sorted(suites[0].expansion.planners) == planner_names()
    assert sorted(suites[1].expansion.controllers) == controller_names()
