"""A few mutated files of every format, and what the fuzz of the loaders found."""

from __future__ import annotations

import collections
import os
import re
import shutil
import time
from pathlib import Path

import pytest

from fuzz import loader_seeds, loaders, world_seeds
from fuzz.fuzz_loaders import play, play_apart, report
from fuzz.loaders import LOADERS, command_line
from trundle.errors import RobotError, TrundleError
from trundle.guard import Child
from trundle.sim.mujoco.joints import list_joints


@pytest.mark.slow
@pytest.mark.parametrize("form", LOADERS)
def test_mutated_files_are_read_or_refused(form, monkeypatch):
    monkeypatch.setattr(loaders, "MOST_SECONDS", 120.0)  # three reads may each take all of their time, on any machine
    ends, findings = play(form, range(12), 0, time.monotonic() + 300.0)
    assert findings == []
    assert sum(ends.values()) == 12


def test_a_joint_about_no_axis_is_refused(tmp_path):
    file = tmp_path / "r.usda"
    file.write_text('#usda 1.0\ndef PhysicsRevoluteJoint "J" {\n    uniform token physics:axis = ""\n}\n')
    with pytest.raises(RobotError, match=r"r\.usda: /J: its axis must be X, Y or Z, got ''"):
        list_joints(file, trusted=True)


def test_wheels_too_heavy_for_a_drive_are_listed_by_name(tmp_path):
    (file,) = world_seeds.urdf(tmp_path)
    file.write_text(file.read_text().replace("<mass value='.1'/>", "<mass value='2e4'/>"))
    assert [joint.name for joint in list_joints(file, trusted=True) if joint.drives] == ["left_wheel", "right_wheel"]


STAGE = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 0.01
)
def Xform "World" {
    def Cube "Box" (prepend apiSchemas = ["PhysicsCollisionAPI"]) {
        double size = 100
        double3 xformOp:translate = (1, 2, 3)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def Cylinder "Post" { double height = 200
        double radius = 20
    }
    def PointInstancer "Racks" {
        point3f[] positions = [(0, 0, 0), (300, 0, 0)]
        int[] protoIndices = [0, 0]
        rel prototypes = </World/Racks/Rack>
        def Sphere "Rack" {
            double radius = 30
        }
    }
    def PhysicsRevoluteJoint "Joint" { rel physics:body0 = </World/Box>
        rel physics:body1 = </World/Post>
        float physics:lowerLimit = -90
    }
}
"""


@pytest.mark.filterwarnings("ignore::trundle.errors.WorldWarning", "ignore::RuntimeWarning")
@pytest.mark.parametrize(
    ("old", "new"), [("float physics", "floaoat physics"), ("metersPerUnit = 0.01", "metersPerUnit = 1e300")]
)
def test_values_of_another_type_or_out_of_range_are_refused(tmp_path, old, new):
    file = tmp_path / "scene.usda"
    with Child() as child:
        file.write_text(STAGE)
        LOADERS["usd"](child, file)
        file.write_text(STAGE.replace(old, new))
        with pytest.raises(TrundleError, match=r"scene\.usda"):
            LOADERS["usd"](child, file)


def test_findings_of_one_kind_are_reported_together_and_do_not_end_the_fuzz(monkeypatch, tmp_path):
    def read(_, file):
        if len(file.read_bytes()) % 2:
            raise ZeroDivisionError("odd")
        raise KeyError("even")

    monkeypatch.setitem(LOADERS, "scenario", read)
    ends, findings = play("scenario", range(20), 0, time.monotonic() + 300.0, str(tmp_path))
    assert ends == {"found": 20}
    assert len(list(tmp_path.iterdir())) == 20
    kinds = report(findings, 0)
    assert sorted(kind.splitlines()[-1] for kind in kinds) == ["KeyError: 'even'", "ZeroDivisionError: odd"]
    assert all("scenario --seed 0, " in kind for kind in kinds)


def end_at_2(form, numbers, seed, until, keep, progress):
    """In the place of `play`."""
    for number in numbers:
        Path(progress).write_text(str(number))
        if number == 2:
            os._exit(1)
    return collections.Counter({"read": len(numbers)}), []


def test_a_file_that_ends_the_process_is_a_finding_and_the_rest_are_read():
    ends, findings = play_apart("map", range(0, 8, 2), 0, time.monotonic() + 300.0, None, read=end_at_2)
    assert ends == {"found": 1, "read": 2}
    assert [finding.number for finding in findings] == [2]


def test_a_file_that_takes_too_much_time_or_memory_is_a_finding(monkeypatch):
    monkeypatch.setattr(loaders, "MOST_SECONDS", 0.0)
    _, findings = play("scenario", range(2), 0, time.monotonic() + 300.0)
    assert all(re.match(r"it took \d+ s and \d+ kB: (read|refused)", finding.text) for finding in findings)
    assert len(findings) == 2
    monkeypatch.setattr(loaders, "MOST_SECONDS", 60.0)
    monkeypatch.setattr(loaders, "MOST_KILOBYTES", 1000)
    assert len(play("scenario", range(2), 0, time.monotonic() + 300.0)[1]) == 2


@pytest.mark.slow
@pytest.mark.parametrize("form", ["barn", "directives", "dynabarn", "evaluation", "mcap", "nav2", "run", "suite"])
def test_the_command_line_reads_the_files_that_are_mutated(form, tmp_path):
    for source in loader_seeds.SEEDS[form](tmp_path):
        file = tmp_path / f"{loaders.PREFIX}{source.name}"
        shutil.copy(source, file)
        if source.suffix in {".json", ".yaml", ".npy", ".mcap", ".jsonl"}:
            assert command_line(form, file) == "read"
            break
