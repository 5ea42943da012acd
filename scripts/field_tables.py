"""Write the tables of fields into scenario.md, robots.md and evaluation_reference.md of docs, and the JSON Schemas.

python scripts/field_tables.py
"""

from __future__ import annotations

import json
import re
from pathlib import Path

from trundle.evaluation.suite import Suite
from trundle.files.field_docs import fields_table, json_schema, models_in
from trundle.mission import Scenario
from trundle.robots import Robot
from trundle.robots.file_format import robot_schema

DOCS = Path(__file__).parents[1] / "docs"
_TABLE = re.compile(r"(<!-- fields: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def contents() -> dict[Path, str]:
    """What each file should hold."""
    schemas = {
        "scenario": json_schema(Scenario, "trundle scenario"),
        "robot": robot_schema(),
        "suite": json_schema(Suite, "trundle suite"),
    }
    files = {
        DOCS / "schemas" / f"{name}.schema.json": json.dumps(schema, indent=2, ensure_ascii=False) + "\n"
        for name, schema in schemas.items()
    }
    for page, model in (("scenario.md", Scenario), ("robots.md", Robot), ("evaluation_reference.md", Suite)):
        kinds = {kind.__name__: kind for kind in models_in(model)}
        text = (DOCS / page).read_text(encoding="utf-8")
        tables = {name: fields_table(kind) for name, kind in kinds.items()}
        files[DOCS / page] = _fill(text, tables)
    return files


def _fill(page: str, tables: dict[str, str]) -> str:
    return _TABLE.sub(lambda match: f"{match[1]}\n{tables[match[2]]}\n\n{match[3]}", page)


if __name__ == "__main__":
    for path, text in contents().items():
        path.write_text(text, encoding="utf-8")
        print(path)
