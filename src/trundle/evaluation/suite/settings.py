"""`CrossedSettings`: the settings of a scenario, each one value or a list that is crossed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, create_model

from trundle.costmap import CostmapSettings
from trundle.evaluation.suite.parts import read_items, read_lists
from trundle.files.field_docs import describe_fields
from trundle.files.yaml_config import Config
from trundle.mission import Scenario
from trundle.navigation import NavigatorSettings

_ROBOT_AND_SENSORS = (
    "assumed",
    "lidar",
    "odometry",
    "unmapped",
    "movers",
    "known_map",
    "localizer",
    "layers",
    "latency",
    "collision_monitor",
    "rules",
)

CROSSED = tuple(
    name
    for name in (*CostmapSettings.model_fields, *NavigatorSettings.model_fields, "resolution", *_ROBOT_AND_SENSORS)
    if name != "planning_deadline_s"
)
"""Settings of a scenario that a suite may cross."""


def _field(name: str) -> tuple[Any, Any]:
    """Type and default of a setting, of a type that takes a list of what the scenario's field takes."""
    field = Scenario.model_fields[name]
    item: Any = field.annotation
    for constraint in field.metadata:
        item = Annotated[item, constraint]
    several = tuple[item, ...]
    read = read_lists if name == "movers" else read_items
    one_or_several = BeforeValidator(read, json_schema_input_type=item | list[item])
    return Annotated[several, one_or_several], (field.default,)


def _docstring() -> str:
    texts = describe_fields(Scenario)
    lines = "\n".join(f"    {name}: {texts[name]}" for name in CROSSED)
    return f"The settings of a scenario, each one value or a list that is crossed.\n\nAttributes:\n{lines}\n"


if TYPE_CHECKING:
    CrossedSettings = Config
else:
    CrossedSettings = create_model(
        "CrossedSettings",
        __base__=Config,
        __module__=__name__,
        __doc__=_docstring(),
        **{name: _field(name) for name in CROSSED},
    )
