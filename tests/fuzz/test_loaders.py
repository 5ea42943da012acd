"""A few mutated files of every format, and what the fuzz of the loaders found."""

from __future__ import annotations

import time

import pytest

from fuzz.fuzz_loaders import LOADERS, play
from trundle.errors import RobotError
from trundle.sim.mujoco.joints import list_joints


@pytest.mark.parametrize("form", LOADERS)
def test_mutated_files_are_read_or_refused(form):
    ends, findings = play(form, range(12), 0, time.monotonic() + 300.0, None)
    assert findings == []
    assert sum(ends.values()) == 12


def test_a_joint_about_no_axis_is_refused(tmp_path):
    file = tmp_path / "r.usda"
    file.write_text('#usda 1.0\ndef PhysicsRevoluteJoint "J" {\n    uniform token physics:axis = ""\n}\n')
    with pytest.raises(RobotError, match=r"r\.usda: /J: its axis must be X, Y or Z, got ''"):
        list_joints(file, trusted=True)


@pytest.mark.parametrize("number", [242, 338])
def test_values_of_another_type_or_out_of_range_are_refused(number):
    """A limit that is no number, and a transform of numbers too large to multiply."""
    assert play("usd", range(number, number + 1), 2, time.monotonic() + 60.0, None)[1] == []
