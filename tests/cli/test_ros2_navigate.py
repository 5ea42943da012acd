"""`trundle ros2 navigate`: what is refused before anything moves."""

from __future__ import annotations

import pytest

from support.command_line import Trundle

pytest.importorskip("rosbags", reason="rosbags is not installed")
pytest.importorskip("cyclonedds", reason="cyclonedds is not installed, or has no wheel here")

NAVIGATE = ("ros2", "navigate", "warehouse", "--transport", "dds", "--domain", "98")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (("--localizer", "odometry"), "--localizer odometry needs --start X,Y,YAW"),
        (("--start", "900,0,0"), "the start (900, 0) lies outside of the map"),
        (("--start", "0,0,0", "--goal", "900,0"), "the goal (900, 0) lies outside of the map"),
        (("--backend", "kinematic"), "--backend is for simulated robots"),
        (("--odometry", "scale=0.1"), "--odometry is for simulated robots"),
        (("--localizer", "amlc"), "amcl"),
        (("--robot", "nova"), "nova_carter"),
    ],
)
def test_what_cannot_be_used_is_refused(trundle: Trundle, given: tuple[str, ...], message: str) -> None:
    ended = trundle(*NAVIGATE, *given)
    assert ended.code == 2
    assert message in ended.err
