"""`--floor-z`, and the floor that is found without it, in every verb that takes a world."""

from pathlib import Path

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


@pytest.mark.slow
def test_a_map_is_checked_against_the_world_over_its_floor(trundle, write):
    hall = write(HALL)
    assert trundle("map", "build", hall).code == 0
    done = trundle("map", "check", "map.yaml", "--world", hall, "--json")
    assert {finding["kind"] for finding in done.json["findings"]} == {"leak"}
    wrong = trundle("map", "check", "map.yaml", "--world", hall, "--floor-z", 0.0, "--json")
    assert {finding["kind"] for finding in wrong.json["findings"]} - {"leak"}
    assert "--world" in trundle("map", "check", "map.yaml", "--floor-z", 0.5).err


@pytest.mark.slow
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


@pytest.fixture
def write_on_plane(write, tmp_path):
    """Write the hall's wall and rail on a plane at a height, without a slab."""

    def make(height):
        boxes = [("wall", f"0 0 {height + 1.0}", "0.2 6 2"), ("rail", f"0 -2.8 {height + 0.075}", "8 0.1 0.15")]
        file = write([(name, f"{4 if name == 'wall' else 0} {at[2:]}", size) for name, at, size in boxes])
        plane = f"<include><uri>model://ground_plane</uri><pose>0 0 {height} 0 0 0</pose></include>"
        file.write_text(file.read_text().replace("<model name='hall'>", plane + "<model name='hall'>"))
        return file.rename(tmp_path / f"plane_{height}.sdf")

    return make


@pytest.mark.slow
@pytest.mark.parametrize("height", [-0.5, 0.3])
def test_a_plane_is_the_floor_of_every_verb(trundle, write_on_plane, height):
    world = write_on_plane(height)
    assert trundle("map", "build", world, "--json").json["floor_z_m"] == pytest.approx(height)
    checked = trundle("map", "check", "map.yaml", "--world", world, "--json")
    assert {finding["kind"] for finding in checked.json["findings"]} <= {"leak"}
    start = ("--start", "-2,0,0")
    driven = trundle("drive", "nova_carter", "--world", world, *start, "--command", "0.4,0,1", "--json")
    assert driven.code == 0
    run = trundle("run", world, *start, "--goal", "1,0.5", "--no-video", "--json", "-o", "found")
    assert run.code == 0
    assert run.json["outcome"] == "arrived"
    for scene in (world, write_on_plane(0.0)):
        view = ("view", "nova_carter", "--world", scene, *start, "--size", "64x48", "-o", f"{scene.stem}.png")
        assert trundle(*view).code == 0
    assert Path(f"{world.stem}.png").read_bytes() == Path("plane_0.0.png").read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize(("form", "file"), [("sdf", "w.sdf"), ("mjcf", "w.xml"), ("usd", "w.usda")])
@pytest.mark.parametrize("height", [-0.5, 0.3])
def test_an_exported_world_has_the_plane_where_it_was(trundle, write_on_plane, form, file, height):
    if form == "usd":
        pytest.importorskip("pxr")
    world = write_on_plane(height)
    assert trundle("export", world, "--to", form, "-o", file).code == 0
    again = World.load(file)
    assert again.ground_z == pytest.approx(height)
    assert again.bounds[0][2] == pytest.approx(height)
    assert trundle("export", world, "--to", form, "--floor-z", height, "-o", file).code == 0
    again = World.load(file)
    assert again.ground_z == 0.0
    assert again.bounds[0][2] == pytest.approx(0.0, abs=1e-6)


def test_a_mesh_below_zero_collides_over_the_plane_in_mjcf(trundle, write_on_plane, tmp_path):
    """A concave mesh is written with convex pieces, which must not end at z = 0."""
    mujoco = pytest.importorskip("mujoco")
    bin_walls = (
        "v -1 -1 -0.5\nv 1 -1 -0.5\nv 1 1 -0.5\nv -1 1 -0.5\nv -1 -1 -0.1\nv 1 -1 -0.1\nv 1 1 -0.1\nv -1 1 -0.1\n"
    )
    (tmp_path / "bin.obj").write_text(bin_walls + "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n")
    file = write_on_plane(-0.5)
    mesh = "<collision name='bin'><geometry><mesh><uri>bin.obj</uri></mesh></geometry></collision></link>"
    file.write_text(file.read_text().replace("</link>", mesh))
    assert trundle("export", file, "--to", "mjcf", "-o", "w.xml").code == 0
    model = mujoco.MjModel.from_xml_path("w.xml")
    assert sum("piece" in model.geom(geom).name for geom in range(model.ngeom)) == 8


@pytest.mark.parametrize(("height", "why"), [(30.0, "has nothing on it"), (-30.0, "has nothing on it")])
def test_a_floor_far_off_is_refused(trundle, write, height, why):
    done = trundle("run", write(HALL), "--start", "-2,0", "--goal", "1,0", "--floor-z", height, "--no-video")
    assert done.code == 2
    assert why in done.err
    assert "0.3 to 2.5 m" in done.err


def test_a_floor_below_the_ground_plane_is_refused(trundle, write_on_plane):
    done = trundle("map", "build", write_on_plane(0.3), "--floor-z", 0.0)
    assert done.code == 2
    assert "below the ground plane" in done.err
    assert "0.3 m" in done.err
