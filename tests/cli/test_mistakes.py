"""Mistakes that users make on the command line: none ends in a traceback, and each message names the next step."""

from __future__ import annotations

import io
import shlex
import socket
import sys
from pathlib import Path

import pytest

from support.command_line import Trundle, room

XACRO = 'xmlns:xacro="http://ros.org/wiki/xacro"'

MISTAKES = """
runn warehouse | Did you mean 'run'?
drvie nova_carter | Did you mean 'drive'?
plann map.yaml | Did you mean 'plan'?
build map warehouse | trundle map build
check map map.yaml | trundle map check
--robot jackal run map.yaml | options come after the verb: trundle run … --robot
map biuld warehouse | Did you mean "build"?
map chek map.yaml | Did you mean "check"?
robot nwe my_robot | Did you mean "new"?
record inf run.mcap | Did you mean "info"?
ros2 serv | Did you mean "serve"?
evaluate | trundle evaluate --help
run | give a map, a world or a scenario
plan | See: trundle plan --help
view | See: trundle view --help
joints | See: trundle joints --help
drive | See: trundle drive --help
scenario | give a map, a world by name or file
export warehouse | give --to FORMAT
map convert map.yaml | See: trundle map convert --help
replay | See: trundle replay --help
compare one | See: trundle compare --help
run map.ymal | no such file; did you mean map.yaml?
run maps/map.yaml | there is no folder maps
plan mapp.yaml | did you mean map.yaml?
map check map.yml | did you mean map.yaml?
map build hall.gbl | give the file of a world or a map
evaluate suit.yaml | did you mean suite.yaml?
joints arm.urdf | no such file; give the file of a robot
run warehouse --robot my.yml | did you mean my.yaml?
run map.yaml --keepout nowhere.yaml | give the file of a map
run map.png | give the map's YAML file
map check map.png | give the map's YAML file
run notes.txt | their names end in
run empty.yaml | the file is empty
run bad.yaml | bad.yaml:2:1: not valid YAML
run gone.yaml | correct the name or put the file there
run scenario.yaml | Did you mean 'planner'?
evaluate suite.yaml | Did you mean 'planners'?
run warehouse --robot robot.yaml | at least 0.001 and at most 5 m
run warehouse --robot map.yaml | this is a map, not a robot
run warehouse --robot ./notes.txt | has no `key: value` lines
run warehouse --robot robot.urdf.xacro | without ROS: pip install xacro, and xacro robot.urdf.xacro
run warehouse --robot bad.urdf | bad.urdf:1:17: not XML
run warehose | Did you mean 'warehouse'?
run Warehouse | Did you mean 'warehouse'?
serve ofice | Did you mean 'office'?
view nova_carter --world ofice | Did you mean 'office'?
run warehouse --robot jackl | Did you mean 'jackal'?
doctor robot nova | There are: jackal, nova_carter
run map.yaml --planner a-str | Did you mean 'astar'?
run map.yaml --planner dijkstra | There are: any_angle, astar
run map.yaml --controller purepursuit | Did you mean 'regulated_pure_pursuit'?
run map.yaml --smoother spline | There are: constrained
run map.yaml --backend Mujoco | Did you mean 'mujoco'?
run map.yaml --localizer gps | There are: amcl, odometry, slam
evaluate office --planners astr | Did you mean 'astar'?
evaluate smok | Did you mean 'smoke'?
export warehouse --to pdf | There are: glb
plan map.yaml --start 1 1 | write numbers with commas, without spaces: --start 1,1
plan map.yaml --start '1;1' | give X,Y or X,Y,YAW
plan map.yaml --start one,two | give X,Y or X,Y,YAW
plan map.yaml --goal nan,1 | as finite numbers
plan map.yaml --start 0,0 --goal 100,100 | outside the map of 8 x 5 m
plan map.yaml --start 100,0 --goal 1,1 | outside the map
plan map.yaml --start 1,1 --goal -0.9,-0.9 | nearest
run map.yaml --seed -1 | it must be at least 0
run map.yaml --seed ten | must be an integer
run map.yaml --time-limit 30s | write it without a unit
run map.yaml --speed fast | from 0.1 to 50, or max
run map.yaml --out | See: trundle run --help
run map.yaml -o notes.txt | give another folder with -o
run warehouse --set aisle_widht=2 | did you mean 'aisle_width'?
run warehouse --set aisle_width | give KEY=VALUE
run warehouse --set aisle_width=wide | must be a number from 1 to 10
run map.yaml --planner-option goal_tolerance | give KEY=VALUE
run map.yaml --inflation-radius -1 | it must be at least 0
run map.yaml --inflation-raduis 0.5 | Did you mean --inflation-radius?
run map.yaml --nav2-params none.yaml | no such file; did you mean gone.yaml?
run map.yaml --nav2-params nav2/params.yaml | no such file: there is no folder nav2
run map.yaml --nav2-params map.yaml | is not under ros__parameters: write NODE
run --from nightly | FOLDER:ID
run map.yaml --distro humble | give --record with it
run map.yaml --no-map | needs lidars
run warehouse office | See: trundle run --help
plan warehouse | trundle map build warehouse -o map.yaml
plan map.yaml -o out.jpg | give a file that ends in .png
plan map.yaml -o map.png | it is the image of the map big.yaml; give another name
plan map.yaml --deadline -1 | a positive number of seconds
map build warehouse --resolution 5cm | in metres, seconds or Hz: 0.05
map build warehouse --resolution -0.05 | 0.0001 to 5 m
map build warehouse -o out.png | give a file that ends in .yaml
map build warehouse --bounds 1,2,3 | give X0,Y0,X1,Y1
map build map.yaml -o my.yaml | replace it with --overwrite
map build nova_carter | give it with --robot nova_carter
map convert map.yaml -o map.yaml | give another name
map convert map.yaml -o my.yaml | replace it with --overwrite
map check map.yaml -o map.png | it is the image of the map big.yaml; give another name
map check map.yaml --fix map.yaml | this is the map that is checked; give another file, or replace it with --overwrite
map check map.yaml --fix my.yaml | Give another file with --fix, or replace it with --overwrite
export map.yaml --to map -o my.yaml | Give another file with -o, or replace it with --overwrite
record info run.mcap | give the .mcap file of a recording
record recover run.mcap | give the .mcap file of a recording
record to-run bag | give a .mcap or .db3 file
view warehouse | this with --world warehouse
joints ./notes.txt | has no `key: value` lines
drive nova_carter --command 0.4 | give V,W,SECONDS
drive nova_carter --command 0.4,0,-5 | must be above 0
drive nova_carter --like nowhere | give the folder that trundle run or trundle drive wrote
drive nova_carter | give one of: --command
drive nova_carter --teleop | use --command
evaluate office --seeds x | a range "0:500"
evaluate office --require success | success>=0.99
evaluate compare a b | give the folder that trundle evaluate wrote
replay none | give the folder that trundle run wrote
serve --port 99999 | give a port from 1 to 65535
robot new my | replace it with --overwrite
robot new ../x | use a plain name such as my_robot
"""
"""A command line and a part of its message, one a line; each ends with exit code 2."""


@pytest.fixture
def files(trundle: Trundle, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Trundle:
    """A folder as a user has it, with files of every kind, some of them wrong."""
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    room().save(tmp_path / "map.yaml")
    text = (tmp_path / "map.yaml").read_text()
    for name, content in {
        "notes.txt": "root:x:0:0\nof mine\n",
        "empty.yaml": "",
        "bad.yaml": "image: [map.png\n",
        "gone.yaml": text.replace("map.png", "gone.png"),
        "scenario.yaml": "world: warehouse\nplaner: astar\n",
        "suite.yaml": "worlds: [office]\nplaners: [astar]\n",
        "robot.yaml": "drive: {wheel_radius: -0.1}\n",
        "my.yaml": "x: 1\n",
        "big.yaml": text.replace("resolution: 0.05", "resolution: 5"),
        "robot.urdf.xacro": f'<robot {XACRO} name="r"><xacro:include filename="arm.xacro"/></robot>',
        "bad.urdf": '<robot name="r"><link',
    }.items():
        (tmp_path / name).write_text(content)
    return trundle


@pytest.mark.parametrize("line", [line for line in MISTAKES.splitlines() if line])
def test_a_mistake_is_one_message_that_names_the_next_step(files: Trundle, line: str) -> None:
    command, message = line.split(" | ")
    done = files(*shlex.split(command))
    assert message in done.err
    assert done.code == 2
    assert done.out == ""
    assert "Traceback" not in done.err
    assert "root:x" not in done.err


def test_there_are_at_least_ninety() -> None:
    assert len([line for line in MISTAKES.splitlines() if line]) >= 90


def test_a_port_that_is_taken_is_said(files: Trundle) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        done = files("serve", "--port", taken.getsockname()[1])
    assert done.code == 2
    assert "the port is in use; give another --port" in done.err


@pytest.mark.parametrize("verb", ["plan big.yaml", "scenario big.yaml -o new.yaml"])
def test_a_map_in_another_unit_is_planned_on_with_the_warning_of_map_check(files: Trundle, verb: str) -> None:
    with pytest.warns(UserWarning, match=r"big\.yaml:3:13: a cell of 5 m is unlikely.*check the unit"):
        assert files(*verb.split()).code == 0
    assert "big.yaml:3:13: a cell of 5 m is unlikely" in files("map", "check", "big.yaml").out


def test_degrees_for_radians_are_used_with_a_warning_that_says_how_to_write_them(files: Trundle) -> None:
    with pytest.warns(UserWarning, match="90deg"):
        assert files("plan", "map.yaml", "--start", "1,1,90", "--goal", "5,2").code == 0


@pytest.mark.parametrize("name", ["a*", "A*", "a-star", "AStar"])
def test_another_spelling_of_a_planner_is_that_planner(files: Trundle, name: str) -> None:
    done = files("plan", "map.yaml", "--planner", name, "--start", "1,1", "--goal", "5,2", "--json")
    assert done.code == 0
    assert done.json["planner"] == "astar"


def test_a_robot_named_by_its_file_is_written_there(files: Trundle) -> None:
    assert files("robot", "new", "cart.yaml").code == 0
    assert "name: cart\n" in Path("cart.yaml").read_text()
    assert not Path("cart.yaml.yaml").exists()


def test_a_map_is_built_again_until_it_is_edited(files: Trundle) -> None:
    assert files("map", "build", "office", "-o", "again.yaml").code == 0
    assert files("map", "build", "office", "-o", "again.yaml", "--resolution", "0.1").code == 0
    edited = Path("again.yaml").read_text().replace("0.65", "0.6")
    Path("again.yaml").write_text(edited)
    verbs = ("map build office -o", "map convert map.yaml -o", "export office --to map -o", "map check map.yaml --fix")
    for verb in verbs:
        done = files(*verb.split(), "again.yaml")
        assert done.code == 2
        assert "--overwrite" in done.err
        assert Path("again.yaml").read_text() == edited
    assert files("map", "build", "office", "-o", "again.yaml", "--overwrite").code == 0
    assert "0.65" in Path("again.yaml").read_text()


def test_a_map_is_fixed_in_place_when_asked_to(files: Trundle) -> None:
    before = Path("map.yaml").read_text().replace("0.65", "0.1")
    Path("map.yaml").write_text(before)
    assert files("map", "check", "map.yaml", "--fix", "map.yaml").code == 2
    assert Path("map.yaml").read_text() == before
    done = files("map", "check", "map.yaml", "--fix", "map.yaml", "--overwrite", "--json")
    assert done.json["fixed"] == "map.yaml"
    assert files("map", "check", "map.yaml").code == 0
    assert "occupied_thresh: 0.65" in Path("map.yaml").read_text()


def test_the_maps_for_nav2_are_kept_once_they_are_edited(files: Trundle) -> None:
    for name in ("keepout", "limits"):
        assert files("map", "convert", "map.yaml", "-o", f"{name}.yaml").code == 0
    with Path("limits.yaml").open("a") as limits:
        limits.write("type: 1\nbase: 100\nmultiplier: -0.5\n")
    Path("masks.yaml").write_text("map: map.yaml\nkeepout: keepout.yaml\nspeed_mask: limits.yaml\n")
    export = ("export", "masks.yaml", "--to", "nav2", "-o", "out", "--quiet")
    for _ in range(2):
        assert files(*export).code == 0
    for name in ("map", "keepout", "speed"):
        path = Path("out", f"{name}.yaml")
        written = path.read_text()
        path.write_text(written.replace("0.65", "0.6"))
        done = files(*export)
        assert done.code == 2
        assert f"out/{name}.yaml already exists" in done.err
        path.write_text(written)
    assert files(*export).code == 0


def test_a_movingai_map_is_replaced_only_by_the_same(files: Trundle) -> None:
    for _ in range(2):
        assert files("map", "convert", "map.yaml", "-o", "arena.map").code == 0
    done = files("map", "convert", "map.yaml", "-o", "arena.map", "--resolution", "0.1")
    assert done.code == 2
    assert "--overwrite" in done.err
    assert files("map", "convert", "map.yaml", "-o", "arena.map", "--resolution", "0.1", "--overwrite").code == 0
