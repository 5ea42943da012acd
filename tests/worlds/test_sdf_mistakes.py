"""Mistakes in SDF files, and parts that are not read."""

from __future__ import annotations

import pytest

from support.sdf_texts import TETRAHEDRON, link, load, mesh, model, only
from trundle.errors import InputError, WorldError, WorldWarning
from trundle.worlds import World


def test_what_is_missing_is_named_or_skipped(tmp_path):
    body = model(link(mesh("model://gone/t.obj"))) + model(link(), "n")
    with pytest.raises(WorldError, match=r"w\.sdf:4: model 'm': the mesh 'model://gone/t\.obj' was not found"):
        load(tmp_path, body)
    with pytest.warns(WorldWarning, match="left out: a missing mesh of 'm'"):
        assert only(load(tmp_path, body, missing="skip")).name == "n"
    include = "<include><uri>https://fuel.gazebosim.org/1.0/x/models/y</uri></include>" + model(link())
    with pytest.raises(WorldError, match=r"w\.sdf:4: the model 'https://.*' was not found"):
        load(tmp_path, include)
    with pytest.warns(WorldWarning, match="left out: the model 'https"):
        assert only(load(tmp_path, include, missing="skip")).name == "m"


@pytest.mark.parametrize("tag", ["heightmap", "image", "polyline"])
def test_geometry_that_is_not_read_is_said(tmp_path, tag):
    body = model(link(f"<geometry><{tag}/></geometry>")) + model(link(), "wall")
    with pytest.warns(WorldWarning, match=f"left out: <{tag}> of 'm'"):
        assert only(load(tmp_path, body)).name == "wall"


def test_parts_of_a_world_that_are_not_read_are_said(tmp_path):
    with pytest.warns(WorldWarning, match="left out: <population>, <road>"):
        load(tmp_path, "<population name='p'/><road name='r'/>" + model(link()))


def test_a_world_of_looks_alone_says_how_to_take_them(tmp_path):
    body = model(link().replace("collision", "visual"))
    with pytest.warns(WorldWarning, match='contains no solids.*geometry="visual"'):
        load(tmp_path, body)


def test_one_of_several_worlds_is_picked_by_name(tmp_path):
    file = tmp_path / "w.sdf"
    worlds = "".join(f"<world name='{name}'>{model(link(), name)}</world>" for name in ("one", "two"))
    file.write_text(f"<sdf version='1.9'>{worlds}</sdf>")
    assert only(World.load(file)).name == "one"
    assert only(World.load(file, world="two")).name == "two"
    with pytest.raises(WorldError, match="it has no world 'three'; there are: one, two"):
        World.load(file, world="three")


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (
            model(link("<geometry><box><size>1 2</size></box></geometry>")),
            "w.sdf:4: model 'm': <size> must be 3 numbers",
        ),
        (model(link("<geometry><box><size>1 nan 1</size></box></geometry>")), "<size> must be 3 numbers, finite and"),
        (model(link("<geometry><box><size>1 -1 1</size></box></geometry>")), "above 0, got '1 -1 1'"),
        (model(link("<geometry><sphere><radius>x</radius></sphere></geometry>")), "<radius> must be number"),
        (model(link("<geometry><box/></geometry>")), "<box> needs <size>"),
        (model(link("<geometry><blob/></geometry>")), "it has <blob>"),
        (model(link("<geometry/>")), "it has nothing"),
        (model(link("")), "<collision> needs <geometry>"),
        (model("<pose>1 2 3</pose>" + link()), "<pose> must be 6 numbers"),
        (model("<pose>0 0 0 0 0 inf</pose>" + link()), "<pose> must be 6 numbers"),
        (model("<pose rotation_format='rpy'>0 0 0 0 0 0</pose>" + link()), "must be euler_rpy or quat_xyzw, got 'rpy'"),
        (model("<pose rotation_format='quat_xyzw'>0 0 0 0 0 0 0</pose>" + link()), "0 0 0 0 is not a unit quaternion"),
        (model("<pose degrees='yes'>0 0 0 0 0 0</pose>" + link()), "degrees of <pose> must be true or false"),
        (model(link("<geometry><plane><normal>0 0 0</normal></plane></geometry>")), "<normal> must not be 0 0 0"),
        ("<include merge='1'><uri>m.sdf</uri></include>", "is allowed only inside a model"),
        (model("<include merge='1'><uri>m.sdf</uri></include>" + link()), "there are two frames named 'l'"),
        (model("<pose relative_to='moon'>0 0 0 0 0 0</pose>" + link()), "w.sdf:4: there is no frame 'moon'"),
        (model("<pose relative_to='moon'>0 0 0 0 0 0</pose>" + link()), "no frame 'moon' here; there are: m"),
        (model(link(pose="<pose relative_to='moon'>0 0 0 0 0 0</pose>")), "model 'm': there is no frame 'moon'"),
        (
            model(
                link(name="a", pose="<pose relative_to='b'>0 0 0 0 0 0</pose>")
                + link(name="b", pose="<pose relative_to='a'>0 0 0 0 0 0</pose>")
            ),
            "refer to each other in a cycle: a -> b -> a",
        ),
        (model(link() + link()), "two frames named 'l'"),
        (model(link()) * 2, "two frames named 'm'"),
        ("<model><static>1</static></model>", "<model> has no name"),
        (model(link(), static="<static>maybe</static>"), "<static> must be true or false"),
        (model(link(mesh("t.obj", "<scale>1 0 1</scale>"))), "<scale> must not be 0 along any axis, got 1 0 1"),
        (model(link(mesh("bad.obj"))), "vertices that are not finite numbers"),
        (
            model(link("<geometry><mesh><uri>t.obj</uri><submesh><name>x</name></submesh></mesh></geometry>")),
            "no submesh 'x'",
        ),
        ("<include><uri>w.sdf</uri></include>", "an included file needs a <model>"),
        ("<include/>", "<include> needs <uri>"),
    ],
)
def test_mistakes_are_named_with_file_and_model(tmp_path, body, message):
    (tmp_path / "t.obj").write_text(TETRAHEDRON)
    (tmp_path / "bad.obj").write_text(TETRAHEDRON.replace("v 1 0 0", "v nan 0 0"))
    (tmp_path / "m.sdf").write_text(f"<sdf version='1.9'>{model(link(), 'inner')}</sdf>")
    with pytest.raises(WorldError) as caught:
        load(tmp_path, body)
    assert message in str(caught.value)
    assert "w.sdf:" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<sdf version='1.1'><world name='w'/></sdf>", "SDF version '1.1' is not known; 1.2 to 1.12 are supported"),
        ("<sdf version='2.0'><world name='w'/></sdf>", "SDF version '2.0' is not known"),
        ("<sdf><world name='w'/></sdf>", "<sdf> has no version"),
        ("<gazebo/>", "must start with <sdf version=…>, got <gazebo>"),
        ("<!DOCTYPE sdf [<!ENTITY a 'b'>]><sdf version='1.6'>&a;</sdf>", "a <!DOCTYPE …> is not accepted"),
        ("<sdf version='1.6'><world name='w'>", "not XML: no element found"),
        ("\0\1\2 garbage", "not XML: not well-formed"),
        ("<a>" * 1000, "w.sdf:1: elements nested more than 200 deep"),
        (
            "<!DOCTYPE b [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;&a;'>]><sdf version='1.6'>&b;</sdf>",
            "w.sdf:1: a <!DOCTYPE …> is not accepted",
        ),
    ],
)
def test_files_that_are_no_sdf_are_refused(tmp_path, text, message):
    (tmp_path / "w.sdf").write_text(text)
    with pytest.raises(WorldError) as caught:
        World.load(tmp_path / "w.sdf")
    assert str(caught.value).count("w.sdf") == 1
    assert message in str(caught.value)


def test_a_model_that_includes_itself_ends(tmp_path):
    text = "<sdf version='1.9'><model name='m'><include><uri>m.sdf</uri></include></model></sdf>"
    (tmp_path / "m.sdf").write_text(text)
    with pytest.raises(WorldError, match="does one include itself"):
        World.load(tmp_path / "m.sdf")


def test_options_are_checked(tmp_path):
    with pytest.raises(InputError, match="geometry is 'both'; it must be 'collision' or 'visual'"):
        load(tmp_path, model(link()), geometry="both")
