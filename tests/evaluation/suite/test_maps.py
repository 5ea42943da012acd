import pytest

from trundle.errors import InputError
from trundle.evaluation import Suite, evaluate, maps_suite


@pytest.fixture
def folder(room, tmp_path):
    changed = room.data.copy()
    changed[60:64, 60:64] = 100
    grids = {"hall": room, "floors/keepout_mask": room, "floors/first": type(room)(changed, room.resolution)}
    for name, grid in grids.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        grid.save(tmp_path / f"{name}.yaml")
    (tmp_path / "notes.yaml").write_text("a: 1\n")
    return tmp_path


def test_each_map_of_a_folder_has_missions_tight_ends_and_boxes(folder):
    suite = maps_suite([folder], seeds=3, planners=["auto", "astar"])
    suite.check()
    assert suite.expansion.worlds == ["floors/first", "floors/first, tight", "hall", "hall, tight"]
    assert len(suite) == 4 * 3 * 2 * 2
    specs = [suite.spec(index) for index in range(len(suite))]
    assert {spec.missions.ends for spec in specs} == {"roomy", "tight"}
    assert {spec.scenario.unmapped is None for spec in specs} == {True, False}


@pytest.mark.parametrize(("given", "said"), [([], "give a folder"), (["gone"], "no folder"), (["empty"], "no ROS map")])
def test_what_is_no_folder_of_maps_is_refused(tmp_path, monkeypatch, given, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=said):
        maps_suite(given)


@pytest.mark.parametrize("take", [Suite.load, evaluate])
def test_without_a_folder_it_says_how_to_give_one(take):
    with pytest.raises(InputError, match=r"maps_suite\(\['FOLDER'\]\), or trundle evaluate maps FOLDER"):
        take("maps")
