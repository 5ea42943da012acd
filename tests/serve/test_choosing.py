import pytest

from trundle.errors import InputError, ScenarioError
from trundle.mission import Scenario
from trundle.serve.choosing import Choices, choose
from trundle.serve.page_messages import Preview, Setup


def _base() -> Scenario:
    return Scenario.make(
        world={"name": "warehouse", "options": {"aisle_width": 1.6}},
        planner="astar",
        start=(-13, 0, 0),
        goal=(13, 0),
        lidar=True,
        seed=5,
    )


def test_what_is_not_chosen_is_that_of_the_source() -> None:
    assert choose(_base(), Setup(type="setup")) == _base()
    assert choose(_base(), Setup(type="setup", world="warehouse", planner="astar", robot="nova_carter")) == _base()


def test_another_world_leaves_the_start_and_the_options_of_the_source_behind() -> None:
    chosen = choose(_base(), Setup(type="setup", world="office", controller="mppi"))
    assert chosen.world is not None
    assert (chosen.world.name, chosen.world.options) == ("office", {})
    assert (chosen.start, chosen.goal, chosen.goals) == (None, None, None)
    assert (chosen.planner.name, chosen.controller.name, chosen.seed, chosen.lidar) == ("astar", "mppi", 5, True)


def test_start_goal_and_seed_are_taken() -> None:
    chosen = choose(_base(), Setup(type="setup", seed=9, start=(1.0, 2.0, 0.5), goal=(3.0, 4.0, None)))
    assert (chosen.seed, chosen.start, chosen.goal) == (9, (1.0, 2.0, 0.5), (3.0, 4.0))
    chosen = choose(_base(), Setup(type="setup", goal=(3.0, 4.0, 1.0)))
    assert chosen.goal == (3.0, 4.0, 1.0)


def test_a_map_is_a_choice_by_its_file_and_others_may_be_chosen() -> None:
    base = Scenario.make(map="rooms/map.yaml", robot="jackal")
    assert Choices(base).worlds[0] == "rooms/map.yaml"
    assert choose(base, Preview(type="preview", world="office")).map is None


def test_names_that_are_no_choice_are_refused() -> None:
    choices = Choices(_base())
    choices.check(Setup(type="setup", world="office", robot="jackal"))
    for field, name in (
        ("world", "/etc/passwd"),
        ("world", "secret.sdf"),
        ("robot", "my.yaml"),
        ("planner", "x"),
        ("controller", "y"),
    ):
        with pytest.raises(InputError, match=f"{field} '{name}' is not among the choices"):
            choices.check(Setup.model_validate({"type": "setup", field: name}))


def test_a_choice_that_cannot_be_used_is_an_error() -> None:
    with pytest.raises(ScenarioError):
        choose(Scenario.make(world="office", lidar=False), Setup.model_construct(type="setup", seed=-1))


def test_without_a_source_there_are_no_choices() -> None:
    choices = Choices(None)
    assert not any(choices.as_dict().values())
