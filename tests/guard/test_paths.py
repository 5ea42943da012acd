"""Texts that cannot be paths, wherever a path is taken: one typed error."""

from __future__ import annotations

import subprocess
import sys

import pytest

from trundle.errors import TrundleError
from trundle.export import export_world
from trundle.files.writing import write_text
from trundle.maps import HeightField, KeepoutMask, OccupancyGrid, SpeedMask
from trundle.maps.check import check_map
from trundle.maps.movingai import load_scenarios
from trundle.mission import Scenario, Trajectory
from trundle.record.motion import Motion
from trundle.robots import Robot
from trundle.sim.mujoco.joints import list_joints
from trundle.worlds import World

STEMS = {"null": "a\0b", "long": "x" * 5_000, "folders": "x/" * 2_500 + "y"}
WORLD = World.generate("maze", seed=1)

READERS = {
    "world": (World.load, (".sdf", ".xml", ".urdf", ".glb", ".stl", ".obj", ".dae", ".usd", ".yaml", ".map")),
    "map as world": (World.from_map, (".yaml",)),
    "robot": (Robot.load, (".yaml", ".urdf", ".xml")),
    "joints": (list_joints, (".urdf", ".xml", ".usd")),
    "map": (OccupancyGrid.load, (".yaml", ".map", ".png")),
    "map check": (check_map, (".yaml", ".map")),
    "keep-out mask": (KeepoutMask.load, (".yaml",)),
    "speed mask": (SpeedMask.load, (".yaml",)),
    "height field": (HeightField.load, (".npz",)),
    "queries": (load_scenarios, (".scen",)),
    "scenario": (Scenario.load, (".yaml",)),
    "trajectory": (Trajectory.load, (".npz",)),
    "motion": (Motion.load, ("", ".csv")),
}
WRITERS = {
    "map": lambda path: OccupancyGrid.from_world(WORLD, resolution=0.2).save(path + ".yaml"),
    "world": lambda path: export_world(WORLD, path + ".sdf", to="sdf"),
    "text": lambda path: write_text(path, ""),
    "scenario": lambda path: Scenario.make(world="maze").save(path + ".yaml"),
}
CASES = [(name, suffix) for name, (_, suffixes) in READERS.items() for suffix in suffixes]


@pytest.mark.slow
@pytest.mark.parametrize("stem", STEMS)
@pytest.mark.parametrize(("name", "suffix"), CASES)
def test_readers_refuse_them(name, suffix, stem):
    with pytest.raises(TrundleError):
        READERS[name][0](STEMS[stem] + suffix)


@pytest.mark.parametrize("stem", STEMS)
@pytest.mark.parametrize("name", WRITERS)
def test_writers_refuse_them(name, stem):
    with pytest.raises(TrundleError):
        WRITERS[name](STEMS[stem])


@pytest.mark.parametrize("stem", STEMS)
def test_files_that_name_them_are_refused(tmp_path, stem, monkeypatch):
    monkeypatch.setenv("TRUNDLE_TRUSTED", "1")
    text = STEMS[stem].replace("\0", "%00")
    name = STEMS[stem].replace("\0", "\\0")
    (tmp_path / "r.urdf").write_text(
        f"<robot name='r'><link name='l'><collision><geometry><mesh filename='{text}.stl'/></geometry></collision>"
        "</link></robot>"
    )
    (tmp_path / "w.sdf").write_text(
        f"<sdf version='1.9'><world name='w'><include><uri>model://{text}</uri></include></world></sdf>"
    )
    (tmp_path / "r.yaml").write_text(f'model: "{name}.urdf"\n')
    (tmp_path / "m.yaml").write_text(
        f'image: "{name}"\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n'
    )
    (tmp_path / "s.yaml").write_text(f'map: "{name}.yaml"\nrobot: nova_carter\n')
    for load, file in ((World.load, "r.urdf"), (World.load, "w.sdf"), (Robot.load, "r.yaml"), (World.load, "m.yaml")):
        with pytest.raises(TrundleError):
            load(tmp_path / file)
    with pytest.raises(TrundleError):
        Scenario.load(tmp_path / "s.yaml").prepare()


LONG = "x" * 5_000
COMMANDS = [
    ["view", f"{LONG}.yaml"],
    ["view", "nova_carter", "--world", f"{LONG}.usd"],
    ["joints", f"{LONG}.urdf"],
    ["drive", f"{LONG}.yaml", "--headless"],
    ["map", "build", f"{LONG}.sdf", "-o", "m"],
    ["map", "build", "maze", "-o", LONG],
    ["map", "check", f"{LONG}.yaml"],
    ["map", "convert", f"{LONG}.yaml", "-o", "m.yaml"],
    ["plan", f"{LONG}.yaml"],
    ["plan", "maze", "-o", f"{LONG}.png"],
    ["run", f"{LONG}.yaml"],
    ["run", "maze", "-o", LONG],
    ["compare", LONG, LONG],
    ["export", f"{LONG}.sdf", "--to", "glb", "-o", "w.glb"],
    ["export", "maze", "--to", "sdf", "-o", f"{LONG}.sdf"],
    ["doctor", "--robot", f"{LONG}.yaml"],
]


@pytest.mark.slow
def test_every_verb_refuses_them(tmp_path):
    """In one process, which takes a second to start."""
    script = (
        "import sys, contextlib, io\nfrom trundle.cli.entry import run_command\n"
        f"for command in {COMMANDS!r}:\n"
        "    with contextlib.redirect_stderr(io.StringIO()) as said, contextlib.redirect_stdout(said):\n"
        "        code = run_command(command)\n"
        "    print(code, ' '.join(command)[:40], said.getvalue()[-2000:] if code != 2 else '')\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=tmp_path, timeout=300)
    lines = done.stdout.splitlines()
    assert [line for line in lines if not line.startswith("2 ")] == []
    assert len(lines) == len(COMMANDS), done.stderr
