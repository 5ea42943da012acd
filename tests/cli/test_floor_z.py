"""`--floor-z`, and the floor that is found without it, in every verb that takes a world."""

import pytest

from trundle.maps import OccupancyGrid
from trundle.worlds import World

BOX = "<collision name='{name}'><pose>{at} 0 0 0</pose><geometry><box><size>{size}</size></box></geometry></collision>"
HALL = [("slab", "0 0 0.4", "8 6 0.2"), ("wall", "4 0 1.5", "0.2 6 2"), ("rail", "0 -2.8 0.575", "8 0.1 0.15")]
UPPER = ("upper", "0 0 2", "8 6 0.1")


@pytest.fixture
def write(tmp_path):
    """Write an SDF world whose floor is at 0.5 m."""

    def make(boxes):
        body = "".join(BOX.format(name=name, at=at, size=size) for name, at, size in boxes)
        file = tmp_path / "hall.sdf"
        file.write_text(
            f"<sdf version='1.9'><world name='hall'><model name='hall'><static>1</static><link name='l'>{body}"
            "</link></model></world></sdf>"
        )
        return file

    return make


def test_a_map_is_built_over_the_floor(trundle, write):
    hall = write(HALL)
    done = trundle("map", "build", hall, "--json")
    assert done.code == 0
    assert done.json["floor_z_m"] == pytest.approx(0.5)
    found = OccupancyGrid.load("map.yaml")
    assert (found.data == 0).any()
    assert trundle("map", "build", hall, "--floor-z", 0.5, "-o", "given.yaml").code == 0
    assert (OccupancyGrid.load("given.yaml").data == found.data).all()
    assert trundle("map", "build", hall, "--free", "0,0", "--json").json["floor_z_m"] == pytest.approx(0.5)


def test_a_map_is_checked_against_the_world_over_its_floor(trundle, write):
    hall = write(HALL)
    assert trundle("map", "build", hall).code == 0
    done = trundle("map", "check", "map.yaml", "--world", hall, "--json")
    assert {finding["kind"] for finding in done.json["findings"]} == {"leak"}
    wrong = trundle("map", "check", "map.yaml", "--world", hall, "--floor-z", 0.0, "--json")
    assert {finding["kind"] for finding in wrong.json["findings"]} - {"leak"}
    assert "--world" in trundle("map", "check", "map.yaml", "--floor-z", 0.5).err


def test_a_robot_drives_runs_and_is_seen_on_the_floor(trundle, write):
    hall = write(HALL)
    driven = trundle("drive", "nova_carter", "--world", hall, "--command", "0.4,0,1", "--start", "-2,0", "--json")
    assert driven.code == 0
    run = ("run", hall, "--start", "-2,0,0", "--goal", "1,0.5", "--no-video", "--json", "-o")
    done = trundle(*run, "found")
    assert done.code == 0
    assert done.json["outcome"] == "arrived"
    assert trundle(*run, "given", "--floor-z", 0.5).code == 0
    assert trundle("view", "nova_carter", "--world", hall, "--size", "64x48", "-o", "scene.png").code == 0


def test_a_wrong_floor_says_what_to_give(trundle, write):
    done = trundle(
        "run", write(HALL), "--start", "-2,0", "--goal", "1,0", "--floor-z", 0.45, "--no-video", "-o", "runs/a"
    )
    assert done.code != 0
    assert "--floor-z" in done.out + done.err


def test_two_floors_are_asked_for(trundle, write):
    hall = write([*HALL, UPPER])
    done = trundle("run", hall, "--start", "-2,0", "--goal", "1,0", "--no-video")
    assert done.code == 2
    assert "0.500, 2.050" in done.err
    assert "--floor-z" in done.err
    assert trundle("drive", "nova_carter", "--world", hall, "--command", "0.4,0,1", "--start", "-2,0").code == 2
    assert (
        trundle(
            "drive", "nova_carter", "--world", hall, "--command", "0.4,0,1", "--start", "-2,0", "--floor-z", 0.5
        ).code
        == 0
    )


def test_an_export_moves_the_floor_to_zero(trundle, write):
    hall = write(HALL)
    assert trundle("export", hall, "--to", "mjcf", "--floor-z", 0.5, "-o", "low.xml").code == 0
    assert World.load("low.xml").bounds[0][2] == pytest.approx(-0.2)
    assert trundle("export", hall, "--to", "map", "-o", "map.yaml").code == 0
    assert (OccupancyGrid.load("map.yaml").data == 0).any()
    assert trundle("export", "nova_carter", "--to", "urdf", "--floor-z", 0.5, "-o", "a.urdf").code == 2
