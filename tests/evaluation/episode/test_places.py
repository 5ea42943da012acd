import pytest

from trundle.evaluation.episode import EpisodeTask
from trundle.evaluation.episode.places import Places
from trundle.evaluation.suite import Suite
from trundle.mission import Scenario
from trundle.sim import world_of


def scenario(seed=1, **settings):
    world = {"name": "cylinders", "options": {"length": 6.0}}
    return Scenario.make(**{"world": world, "seed": seed, "backend": "kinematic"} | settings)


def test_scenarios_of_one_place_share_it():
    places = Places()
    first = places.get(scenario())
    assert places.get(scenario(planner="astar", inflation_radius=1.0, start=(0, 0), goal_tolerance=0.1)) is first
    assert places.get(scenario(seed=2)) is not first
    assert places.get(scenario(robot="jackal")) is not first
    assert places.get(scenario(resolution=0.1)) is not first
    assert places.get(scenario()) is first


def test_what_a_map_is_extruded_into_depends_on_its_unknown_cells(room, tmp_path):
    room.save(tmp_path / "room.yaml")
    places = Places()
    blocked = places.get(scenario(world=None, map=str(tmp_path / "room.yaml")))
    free = places.get(scenario(world=None, map=str(tmp_path / "room.yaml"), unknown="free"))
    assert free is not blocked


def test_the_places_used_last_are_kept():
    places = Places(most_places=2)
    first = places.get(scenario(1))
    places.get(scenario(2))
    assert places.get(scenario(1)) is first
    places.get(scenario(3))
    assert len(places) == 2
    assert places.get(scenario(1)) is first
    cells = first.place.grid.data.size
    narrow = Places(most_cells=cells)
    for seed in (1, 2, 3):
        narrow.get(scenario(seed))
    assert len(narrow) == 1


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_a_simulator_serves_again_where_its_backend_is_the_same(backend):
    kept = Places().get(scenario())
    first = kept.simulator(scenario(backend=backend), kept.place.world)
    kept.release(first)
    assert kept.simulator(scenario(backend=backend), kept.place.world) is first
    late = kept.simulator(scenario(backend=backend, actuation={"wheel_radius": 1.02}), kept.place.world)
    assert late.inner is first
    kept.release(late)
    other = kept.simulator(scenario(backend={"name": backend, "options": {"timestep": 0.01}}), kept.place.world)
    assert other is not first
    assert world_of(first) is kept.place.world


HALL = """<?xml version='1.0'?>
<sdf version='1.9'><world name='hall'>
<model name='floor'><static>1</static><link name='l'><pose>0 0 1 0 0 0</pose>
<collision name='c'><geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model>
<model name='block'><static>1</static><link name='l'><pose>1 1 1.5 0 0 0</pose>
<collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision></link></model>
<model name='wall'><static>1</static><link name='l'><pose>8 8 1.5 0 0 0</pose>
<collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision></link></model>
</world></sdf>
"""


def test_missions_in_a_worlds_file_stand_on_its_common_floor(tmp_path, monkeypatch):
    monkeypatch.setenv("TRUNDLE_TRUSTED", "1")
    (tmp_path / "hall.sdf").write_text(HALL)
    task = EpisodeTask(Suite.make(worlds=str(tmp_path / "hall.sdf"), backends="kinematic", seeds=2))
    rows = [task(index) for index in range(2)]
    exact = task.scenario_of(1)
    assert exact.floor_z == 1.0
    with exact.build() as mission:
        episode = mission.run()
    assert episode.metrics.distance_m == rows[1].distance_m
    assert episode.metrics.min_clearance_m == rows[1].min_clearance_m
    assert {row.outcome for row in rows} == {"arrived"}
