from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
from cyclopts import App, CycloptsError, Parameter

from trundle.cli.shared.field_options import option_for, options_class
from trundle.files.choice import Choice, takes_name
from trundle.files.yaml_config import Config, PoseNumbers, Positive
from trundle.mission import Scenario


class Inner(Config):
    speed: float = 1.0


class Settings(Config):
    """Settings of a test.

    Attributes:
        count: How many
            there are.
    """

    count: int = 3
    time_limit_s: Positive | None = None
    mode: Literal["slow", "fast"] | None = None
    through: bool = False
    known_map: bool = True
    lidar: bool | tuple[str, ...] = False
    start: PoseNumbers | None = None
    goals: tuple[PoseNumbers, ...] | None = None
    planner: Annotated[Choice, takes_name(Choice)] = Choice(name="auto")
    inner: Inner | None = None
    mask: str | None = None


def parse(field: str, *arguments: str, **more: Any) -> Any:
    @Parameter(name="*")
    class Options(options_class([option_for(Settings, field, **more)])):
        pass

    app = App(result_action="return_value")

    @app.default
    def take(*, given: Options = Options()) -> Any:  # noqa: B008 - frozen
        return getattr(given, field)

    return app(list(arguments), exit_on_error=False, print_error=False)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("field", "arguments", "value"),
    [
        ("count", ["--count", "7"], 7),
        ("time_limit_s", ["--time-limit", "2.5"], 2.5),
        ("mode", ["--mode", "fast"], "fast"),
        ("through", ["--through"], True),
        ("lidar", ["--lidar"], True),
        ("lidar", ["--no-lidar"], False),
        ("start", ["--start", "-1,2"], "-1,2"),
        ("goals", ["--goals", "-1,2", "--goals", "3,4"], ["-1,2", "3,4"]),
        ("planner", ["--planner", "least_cost"], "least_cost"),
        ("inner", ["--inner", "speed=2", "--inner", "other=-1"], ["speed=2", "other=-1"]),
        ("mask", ["--mask", "zones.yaml"], "zones.yaml"),
    ],
)
def test_the_type_of_a_field_says_what_its_option_takes(field: str, arguments: list[str], value: object) -> None:
    assert parse(field, *arguments) == value
    assert parse(field) in (None, False)


def test_a_flag_that_is_on_by_default_is_turned_off_by_its_option() -> None:
    assert parse("known_map", "--no-map", name="--no-map") is True
    with pytest.raises(CycloptsError):
        parse("known_map", "--known-map", name="--no-map")


def test_a_text_may_be_the_path_of_a_file() -> None:
    assert parse("mask", "--mask", "zones.yaml", path=True) == Path("zones.yaml")


@pytest.mark.parametrize(
    ("field", "arguments"), [("count", ["--count", "1.5"]), ("mode", ["--mode", "idle"]), ("through", ["--no-through"])]
)
def test_other_values_are_refused(field: str, arguments: list[str]) -> None:
    with pytest.raises(CycloptsError):
        parse(field, *arguments)


def test_the_help_is_the_fields_unless_another_is_given() -> None:
    def help_of(**more: Any) -> str | None:
        _, kind, _ = option_for(Settings, "count", **more)
        return kind.__metadata__[-1].help

    assert help_of() == "How many there are."
    assert help_of(help="The number.") == "The number."


def test_options_of_a_scenario_have_the_choices_of_its_fields() -> None:
    _, kind, _ = option_for(Scenario, "compat")
    assert Literal["humble"] in kind.__origin__.__args__
