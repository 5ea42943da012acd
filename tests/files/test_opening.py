"""What a parser raises becomes one typed error; what our own code raises does not."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from trundle.errors import RobotError, TrundleError, WorldError
from trundle.files.mesh import read_mesh
from trundle.files.model_spec import compile_spec, read_spec
from trundle.files.opening import parser_errors, parser_reason
from trundle.sim.mujoco.joints import read_joints

ANYTHING = [
    RuntimeError("Caught an unknown exception!"),
    KeyError("mesh"),
    OverflowError(),
    RecursionError("maximum recursion depth exceeded"),
    ZeroDivisionError("division by zero"),
    UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid start byte"),
    mujoco.FatalError("no memory"),
]


@pytest.fixture(params=ANYTHING, ids=lambda problem: type(problem).__name__)
def fail(request):
    def call(*_args, **_kwargs):
        raise request.param

    call.problem = request.param
    return call


def model(folder: Path) -> Path:
    (folder / "m.xml").write_text("<mujoco><worldbody><geom size='.1'/></worldbody></mujoco>")
    return folder / "m.xml"


@pytest.mark.parametrize("read", [lambda path: read_spec(path, folders=(), error=RobotError), read_joints])
def test_whatever_mujoco_raises_while_it_reads(fail, tmp_path, monkeypatch, read):
    monkeypatch.setattr(mujoco, "MjSpec", type("MjSpec", (), {"from_file": staticmethod(fail)}))
    with pytest.raises(RobotError, match=r"m\.xml: MuJoCo cannot read it: \S") as raised:
        read(model(tmp_path))
    assert raised.value.__cause__ is fail.problem


def test_whatever_mujoco_raises_while_it_builds(fail, tmp_path):
    spec = type("MjSpec", (), {"compile": fail})()
    with pytest.raises(WorldError, match=r"m\.xml: MuJoCo cannot build it: \S"):
        compile_spec(tmp_path / "m.xml", spec, error=WorldError)


def test_whatever_trimesh_raises_after_it_has_read(fail, tmp_path, monkeypatch):
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.box().export(tmp_path / "a.stl")
    monkeypatch.setattr(trimesh.Trimesh, "faces", property(fail))
    with pytest.raises(WorldError, match=r"a\.stl: (its meshes cannot be read|cannot be read as a \.stl file): \S"):
        read_mesh(tmp_path / "a.stl")


def test_whatever_usd_raises_of_its_own(tmp_path):
    pytest.importorskip("pxr")
    from trundle.worlds.usd.stage import opened

    (tmp_path / "a.usda").write_text("#usda 1.0\n")
    for problem in (RuntimeError("Accessed invalid null prim"), OverflowError("bad numeric conversion")):
        with pytest.raises(WorldError, match=rf"a\.usda: .*{problem}"), opened(str(tmp_path / "a.usda")):
            raise problem
    with pytest.raises(IndexError), opened(str(tmp_path / "a.usda")):
        raise IndexError("a fault of ours")


def test_a_fault_outside_the_parser_stays_what_it_is(tmp_path, monkeypatch):
    pytest.importorskip("trimesh").creation.box().export(tmp_path / "a.stl")
    monkeypatch.setattr(np, "unique", lambda *_, **__: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        read_mesh(tmp_path / "a.stl")


def test_an_error_that_is_typed_already_stays():
    with pytest.raises(RobotError, match=r"^as it was$"), parser_errors("a file", WorldError):
        raise RobotError("as it was")
    with (
        pytest.raises(TrundleError, match=r"^a file: its reader gives no reason \(OverflowError\); "),
        parser_errors("a file", WorldError),
    ):
        raise OverflowError


@pytest.mark.parametrize(
    "problem",
    [
        AssertionError(),
        KeyError("y"),
        IndexError("list index out of range"),
        TypeError("'NoneType' …"),
        RuntimeError(""),
        RuntimeError("Caught an unknown exception!"),
        AttributeError("mesh"),
        StopIteration(),
        OverflowError(),
        ValueError("cannot reshape array of size 24 into shape (8,4)"),
        ValueError("Maximum allowed dimension exceeded"),
    ],
    ids=repr,
)
def test_messages_that_say_nothing_come_with_what_to_do(problem):
    reason = parser_reason(problem)
    assert reason.startswith(f"its reader gives no reason ({type(problem).__name__}")
    assert reason.endswith("write it again, or in another format")


def test_messages_that_say_something_stay(tmp_path):
    assert parser_reason(ValueError("chunk was not\nexpected length!")) == "chunk was not expected length!"


def test_a_ply_without_a_column_says_what_to_do(tmp_path):
    pytest.importorskip("trimesh")
    file = tmp_path / "a.ply"
    file.write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n0 0\n1 0\n0 1\n3 0 1 2\n"
    )
    with pytest.raises(
        WorldError, match=r"a\.ply: cannot be read as a \.ply file: its reader gives no reason \(KeyError: 'y'"
    ):
        read_mesh(file)
