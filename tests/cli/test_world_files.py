from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from trundle.errors import RobotWarning, WorldWarning
from trundle.maps import OccupancyGrid

POST = """
<model name='post{i}'><static>1</static><pose>{x} {y} 0.5 0 0 0</pose><link name='l'><collision name='c'>
<geometry><cylinder><radius>0.1</radius><length>1</length></cylinder></geometry></collision></link></model>
"""
URDF = """
<robot name="box_bot">
  <link name="base"><collision><origin xyz="0 0 0.15"/><geometry><box size="0.4 0.3 0.2"/></geometry></collision>
    <inertial><origin xyz="0 0 0.12"/><mass value="10"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial></link>
  {wheels}
</robot>
"""
WHEEL = """
  <link name="{side}"><collision><geometry><sphere radius="0.08"/></geometry></collision>
    <inertial><mass value="0.5"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="{side}_wheel" type="continuous"><parent link="base"/><child link="{side}"/>
    <origin xyz="0 {y} 0.08"/><axis xyz="0 1 0"/></joint>
"""


@pytest.fixture
def field(tmp_path: Path) -> Path:
    """An SDF world of four posts around (1, 1)."""
    body = "".join(POST.format(i=i, x=2 * (i % 2), y=2 * (i // 2)) for i in range(4))
    file = tmp_path / "scenes" / "field.sdf"
    file.parent.mkdir()
    file.write_text(f"<sdf version='1.7'><world name='field'>{body}</world></sdf>")
    return file


@pytest.fixture
def box_bot(tmp_path: Path) -> Path:
    wheels = "".join(WHEEL.format(side=side, y=y) for side, y in (("left", 0.2), ("right", -0.2)))
    file = tmp_path / "box_bot.urdf"
    file.write_text(URDF.format(wheels=wheels))
    return file


def test_a_map_is_built_of_an_sdf_world(trundle, field):
    done = trundle("map", "build", field, "--robot", "jackal", "--json")
    assert done.code == 0
    assert done.json["world"] == "field"
    grid = OccupancyGrid.load("map.yaml")
    for x, y in ((0, 0), (2, 0), (0, 2), (2, 2)):
        row, col = grid.world_to_cell(x + 0.01, y + 0.01)
        assert grid.data[row, col] == 100
    assert (grid.data == 0).any()


def test_options_of_a_world_file_are_set(trundle, field):
    field.write_text(field.read_text().replace("<static>1</static>", ""))
    done = trundle("map", "build", field, "--robot", "jackal", "--set", "movable=true", "--json")
    assert done.json["occupied_cells"] > 0
    done = trundle("map", "build", field, "--set", "height=1")
    assert done.code == 2
    assert "'height' is not an option of a .sdf file; there are: geometry, movable, missing, paths, world" in done.err


def test_a_robot_runs_in_a_world_file_and_the_scenario_repeats_it(trundle, field):
    # Start and goal lie outside the posts, where the world's bounds end.
    ends = ("--start", "-1,1,0", "--goal", "3,1")
    done = trundle(
        "run", field, "--robot", "jackal", "--backend", "kinematic", *ends, "--no-video", "-o", "out", "--json"
    )
    assert done.code == 0
    assert done.json["outcome"] == "arrived"
    text = yaml.safe_load(Path("out/scenario.yaml").read_text())
    assert text["world"] == "../scenes/field.sdf"
    again = trundle("run", "out/scenario.yaml", "--no-video", "-o", "again", "--json")
    assert again.json["distance_m"] == done.json["distance_m"]


@pytest.mark.slow
def test_what_is_excluded_is_gone_in_every_verb(trundle, field):
    def built(*more: object) -> int:
        return trundle("map", "build", field, "--robot", "jackal", *more, "--json").json["occupied_cells"]

    assert built("--exclude", "post0", "--exclude", "*3") < built()
    with pytest.warns(WorldWarning, match="nothing to exclude matches: nobody"):
        assert trundle("map", "check", "map.yaml", "--world", field, "--exclude", "nobody").code in (0, 1)
    done = trundle(
        "view", "jackal", "--world", field, "--exclude", "post0", "--size", "160x90", "-o", "v.png", "--json"
    )
    assert done.code == 0
    # The straight path from (-1, 0) to (3, 0) is blocked by two posts.
    ends = ("--start", "-1,0,0", "--goal", "3,0", "--robot", "jackal", "--backend", "kinematic", "--no-video")
    out = ("--exclude", "post0", "--exclude", "post1", "-o", "out", "--json")
    done = trundle("run", field, *ends, *out)
    assert done.json["distance_m"] == pytest.approx(4.0, abs=0.05)
    again = trundle("run", "out/scenario.yaml", "--no-video", "-o", "again", "--json")
    assert again.json["distance_m"] == done.json["distance_m"]
    done = trundle("run", "out/scenario.yaml", "--exclude", "post2")
    assert done.code == 2
    assert "--set and --exclude are for worlds" in done.err


def test_a_robot_of_a_urdf_works_in_the_verbs(trundle, field, box_bot):
    with pytest.warns(RobotWarning):
        done = trundle("view", box_bot, "--world", field, "--size", "160x90", "-o", "v.png", "--json")
    assert done.code == 0
    with pytest.warns(RobotWarning):
        done = trundle("drive", box_bot, "--command", "0.4,0,2", "--json")
    assert done.json[0]["x"] == pytest.approx(0.8 - 0.08, abs=0.03)
    with pytest.warns(RobotWarning):
        done = trundle("run", field, "--robot", box_bot, "--start", "-1,1,0", "--goal", "3,1", "--no-video", "--json")
    assert done.json["outcome"] == "arrived"
    assert [joint["name"] for joint in trundle("joints", box_bot, "--json").json] == ["left_wheel", "right_wheel"]


def test_a_world_with_nothing_in_it_is_said(trundle, field):
    field.write_text("<sdf version='1.7'><world name='w'/></sdf>")
    with pytest.warns(WorldWarning, match="contains no solids"):
        done = trundle("map", "build", field)
    assert done.code == 2
    assert "no solids" in done.err


def test_a_broken_world_is_bad_input(trundle, field):
    field.write_text("<sdf version='9.9'/>")
    done = trundle("run", field)
    assert done.code == 2
    assert "SDF version '9.9' is not known" in done.err
    np.testing.assert_equal(len(done.err.strip().splitlines()), 1)


@pytest.mark.slow
def test_models_are_found_in_the_folders_of_paths_by_every_verb(trundle, field, tmp_path):
    posts = field.read_text().replace("<world name='field'>", "<model name='posts'><static>1</static>")
    (tmp_path / "mine" / "posts").mkdir(parents=True)
    (tmp_path / "mine" / "posts" / "model.sdf").write_text(posts.replace("</world>", "</model>"))
    field.write_text("<sdf version='1.7'><world name='field'><include><uri>model://posts</uri></include></world></sdf>")
    robot = ("--robot", "jackal")
    ends = ("--start", "-1,1,0", "--goal", "3,1", "--backend", "kinematic", "--no-video", "-o", "out", "--json")
    for verb in (
        ("map", "build", field, *robot, "--json"),
        ("map", "check", "map.yaml", "--world", field, "--json"),
        ("drive", "jackal", "--world", field, "--start", "-1,1", "--command", "0.2,0,0.1", "--json"),
        ("view", "jackal", "--world", field, "--start", "-1,1", "--size", "160x90", "-o", "v.png", "--json"),
        ("run", field, *robot, *ends),
        ("export", field, "-o", "field.glb", "--json"),
    ):
        refused = trundle(*verb)
        assert refused.code == 2, verb
        assert "'model://posts' was not found" in refused.err
        done = trundle(*verb, "--paths", f"{tmp_path / 'none'}:{tmp_path / 'mine'}")
        assert done.code == 0, done.err
    again = trundle("run", "out/scenario.yaml", "--no-video", "-o", "again", "--json")
    assert again.code == 0, again.err


def test_paths_that_nothing_uses_are_refused(trundle, field):
    done = trundle("drive", "jackal", "--command", "0.2,0,0.1", "--paths", "mine")
    assert done.code == 2
    assert "--paths is for files that refer to others" in done.err
    done = trundle("map", "build", field, "--paths", "a", "--set", "paths=b")
    assert done.code == 2
    assert "not both" in done.err


def test_the_meshes_of_a_robot_are_found_in_the_folders_of_paths(trundle, box_bot, tmp_path):
    (tmp_path / "mine" / "bot").mkdir(parents=True)
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    (tmp_path / "mine" / "bot" / "hull.obj").write_text(corners)
    hull = '<mesh filename="package://bot/hull.obj" scale="0.1 0.1 0.1"/>'
    box_bot.write_text(
        box_bot.read_text().replace(
            "<inertial><origin",
            f"<collision><origin xyz='0 0 0.1'/><geometry>{hull}</geometry></collision><inertial><origin",
            1,
        )
    )
    refused = trundle("drive", box_bot, "--command", "0.4,0,0.1")
    assert refused.code == 2
    assert "--paths FOLDER" in refused.err
    with pytest.warns(RobotWarning):
        done = trundle("drive", box_bot, "--command", "0.4,0,0.1", "--paths", tmp_path / "mine", "--json")
    assert done.code == 0, done.err
