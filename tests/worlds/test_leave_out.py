from __future__ import annotations

import pytest
import trimesh

from trundle.errors import InputError, WorldWarning
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.worlds import World
from trundle.worlds.leave_out import leave_out


def box(name: str, z: float = 0.5, size: tuple[float, float, float] = (1.0, 1.0, 1.0), kind: str = "") -> Solid:
    return Solid(name, Box(size), Pose3D((0.0, 0.0, z)), kind=kind)


HALL = World(
    "hall",
    (
        box("shelf"),
        box("shelf#2"),
        box("shelf::board"),
        box("shelves"),
        box("/World/Rack[3]/Post", kind="Rack"),
        box("/World/Rack[30]/Post"),
        box("roof", 3.0, (9.0, 9.0, 0.1)),
        box("mast", 4.0, (0.1, 0.1, 3.0)),
        box("slab", -0.05, (9.0, 9.0, 0.1)),
    ),
    seeds=((1.0, 2.0),),
)


@pytest.mark.parametrize(
    ("words", "gone"),
    [
        ("", set()),
        ("shelf", {"shelf", "shelf#2", "shelf::board"}),
        ("shel*", {"shelf", "shelf#2", "shelf::board", "shelves"}),
        ("shelf::board", {"shelf::board"}),
        ("/World", {"/World/Rack[3]/Post", "/World/Rack[30]/Post"}),
        ("/World/Rack", {"/World/Rack[3]/Post", "/World/Rack[30]/Post"}),
        ("/World/Rack[3]", {"/World/Rack[3]/Post"}),
        ("*Rack[3?]", {"/World/Rack[30]/Post"}),
        ("rack", {"/World/Rack[3]/Post"}),
        ("Floor, ceiling", {"slab", "roof"}),
        (["mast", "slab"], {"mast", "slab"}),
    ],
)
def test_solids_are_left_out_by_name_kind_and_place(words, gone):
    left = leave_out(HALL, words, "hall")
    assert {solid.name for solid in HALL.solids} - {solid.name for solid in left.solids} == gone
    assert (left.name, left.seeds) == (HALL.name, HALL.seeds)


def test_words_that_nothing_is_left_out_by_are_said():
    with pytest.warns(WorldWarning, match=r"hall: nothing to exclude matches: shel, board$"):
        leave_out(HALL, ["shel", "mast", "board"], "hall")


@pytest.mark.parametrize("words", [3, [3], None])
def test_words_must_be_texts(words):
    with pytest.raises(InputError, match="give words as texts"):
        World.generate("warehouse", exclude=words or [None])


def test_every_kind_of_world_can_leave_things_out(tmp_path):
    scene = trimesh.Scene()
    for name in ("crate", "lamp"):
        scene.add_geometry(trimesh.creation.box(), node_name=name)
    scene.export(tmp_path / "w.glb")
    geom = "<geom name='{}' type='box' size='1 1 1'/>"
    (tmp_path / "w.xml").write_text(
        f"<mujoco><worldbody>{geom.format('crate')}{geom.format('lamp')}</worldbody></mujoco>"
    )
    shape = "<geometry><box><size>1 1 1</size></box></geometry>"
    model = "<model name='{0}'><static>1</static><link name='l'><collision name='c'>{1}</collision></link></model>"
    # What is wrong or missing in what is left out does not matter.
    body = model.format("crate", shape) + model.format("lamp", shape.replace("box>", "mesh>"))
    body += "<include><uri>model://lamp</uri></include>"
    (tmp_path / "w.sdf").write_text(f"<sdf version='1.9'><world name='w'>{body}</world></sdf>")
    for name in ("w.glb", "w.xml", "w.sdf"):
        assert [solid.name for solid in World.load(tmp_path / name, exclude="lamp").solids] == ["crate"]
    racks = World.generate("warehouse", seed=7)
    kinds = {solid.kind for solid in racks.solids}
    assert len(kinds) > 2
    word = sorted(kinds)[0]
    assert {solid.kind for solid in World.generate("warehouse", seed=7, exclude=word).solids} == kinds - {word}
