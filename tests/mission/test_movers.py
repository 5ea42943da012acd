from __future__ import annotations

import pytest

from trundle import World
from trundle.errors import ScenarioError, WorldError
from trundle.mission import Scenario
from trundle.mission.setup import make_place, place_key
from trundle.worlds.movers import AlongPath, Crowd, Mover, Waypoints

HEAD = "world: {name: warehouse, options: {size: [16, 12]}}\nmovers:\n"
LINES = """\
  - {crowd: forklift, count: 2, speed: 1.2, sees_robot: false}
  - {crowd: person, count: 3, area: [-8, -6, 8, 6], seed: 4}
  - {name: cart, body: forklift, path: [[6, -2], [6, 2]], speed: 0.8, repeat: back_and_forth, start_s: 1}
  - {name: door, box: [1.0, 0.1, 2.0], waypoints: [[0, 6, 4], [5, 6.5, 4]], interpolation: catmull_rom}
  - {name: post, cylinder: [0.2, 1.0], waypoints: [[0, 6, -4, 0]]}
"""


def load(tmp_path, lines, head=HEAD):
    (tmp_path / "s.yaml").write_text(head + lines)
    return Scenario.load(tmp_path / "s.yaml")


def test_every_form_of_a_mover_becomes_part_of_the_world(tmp_path):
    scenario = load(tmp_path, LINES)
    forklifts, people, cart, door, post = make_place(scenario).world.movers
    assert forklifts == Crowd("forklifts", 2, "forklift", 1.2, False)
    assert people == Crowd("people", 3, area=(-8.0, -6.0, 8.0, 6.0), seed=4)
    assert isinstance(cart, Mover)
    assert cart.motion == AlongPath(((6.0, -2.0), (6.0, 2.0)), 0.8, repeat="back_and_forth", start_s=1.0)
    assert cart.kind == "forklift"
    assert isinstance(door, Mover)
    assert door.motion == Waypoints(((0.0, 6.0, 4.0), (5.0, 6.5, 4.0)), "catmull_rom")
    assert isinstance(post, Mover)
    assert post.parts[0].bounds()[1][2] == 1.0


def test_movers_survive_saving(tmp_path):
    scenario = load(tmp_path, LINES)
    scenario.save(tmp_path / "again.yaml")
    assert Scenario.load(tmp_path / "again.yaml").movers == scenario.movers


def test_scenarios_with_other_movers_have_other_places(tmp_path):
    first = load(tmp_path, LINES)
    second = first.model_copy(update={"movers": first.movers[:1]})
    assert place_key(first) != place_key(second)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("  - {name: a, body: person, waypoints: [[0, 1, 1], [0, 2, 2]]}", "s.yaml:3:5: .*must increase: number 2"),
        ("  - {name: a, body: person}", "give either waypoints or path"),
        ("  - {name: a, path: [[0, 0], [1, 1]]}", "give one of body, box and cylinder"),
        ("  - {body: person, path: [[0, 0], [1, 1]]}", "a mover needs a name"),
        ("  - {crowd: person, path: [[0, 0], [1, 1]]}", "path: not of a crowd"),
        ("  - {name: a, body: person, count: 3, path: [[0, 0], [1, 1]]}", "count: only of a crowd"),
        ("  - {name: a, body: person, waypoints: [[0, 1, 1]], speed: 1}", "waypoints have times"),
        ("  - {name: a, body: cat, waypoints: [[0, 1, 1]]}", "s.yaml:3:21: "),
        ("  - {crowd: person, area: [1, 0, 0, 1]}", "area must be"),
    ],
)
def test_mistakes_are_refused_with_their_place(tmp_path, line, words):
    with pytest.raises(ScenarioError, match=words):
        load(tmp_path, line)


def test_a_warehouse_has_forklifts_and_people_as_asked():
    plain = World.generate("warehouse", seed=2)
    assert World.generate("warehouse", seed=2, people=8).solids == plain.solids
    busy = World.generate("warehouse", seed=2, forklifts=6, people=8, mover_speed=2.0, sees_robot=False)
    assert busy.movers == (
        Crowd("forklifts", 6, "forklift", 2.0, False),
        Crowd("people", 8, "person", 2.0, False),
    )
    with pytest.raises(WorldError, match="people"):
        World.generate("warehouse", people=-1)


def test_a_run_among_people_who_yield_has_no_contact(tmp_path):
    scenario = load(
        tmp_path,
        "  - {crowd: person, count: 3}\nbackend: kinematic\nstart: [6.5, 3, -1.57]\ngoal: [6.5, 0]\n",
        head="world: {name: warehouse, seed: 1, options: {size: [16, 12]}}\nmovers:\n",
    )
    with scenario.build() as mission:
        first = mission.run()
    with scenario.build() as mission:
        second = mission.run()
    assert first.metrics.contacts == ()
    assert (first.trajectory.poses == second.trajectory.poses).all()
