"""The page on learning: its Python runs, and its tables have what there is."""

import re
from dataclasses import fields
from pathlib import Path

import pytest

pytest.importorskip("gymnasium", reason="needs Gymnasium, of the extra gym")

PAGE = (Path(__file__).parents[2] / "docs" / "learning.md").read_text()


def first_column(heading: str) -> list[str]:
    """Names in the first column of the table with this heading."""
    table = PAGE.partition(f"| {heading} |")[2].partition("\n\n")[0]
    return [name for line in table.splitlines()[2:] for name in re.findall(r"`(\w+)`", line.split("|")[1])]


def test_the_python_of_the_page_runs(capsys):
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL):
        exec(block, names)
    said = capsys.readouterr().out
    assert "['goal', 'ranges', 'velocity']" in said
    assert "(100, 3) (100, 720) 0 touch something" in said


def test_the_options_are_those_of_the_environment():
    from trundle.gym import NavigationSettings

    assert set(first_column("option of `trundle/Navigation-v0`")) == {each.name for each in fields(NavigationSettings)}


def test_the_reward_terms_are_those_that_there_are():
    from trundle.gym import REWARD_TERMS

    assert first_column("reward term") == list(REWARD_TERMS)
    assert all(f"| {text} |" in PAGE for text in REWARD_TERMS.values())


def test_the_observations_and_modes_are_those_that_there_are():
    from trundle.gym import NavigationEnv

    env = NavigationEnv(world="maze", worlds=1, path_points=1, costmap_cells=1, critic=True)
    assert set(first_column("name")) == set(env.observation_space.spaces)
