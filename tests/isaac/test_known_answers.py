"""DifferentialController: NVIDIA's published answers, by its own classes, and trundle's drive beside them."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest

from trundle.geometry import Twist2D
from trundle.robots import DifferentialDrive

pytestmark = pytest.mark.isaac
CASES: list[tuple[dict[str, float], tuple[float, float]]] = [
    ({}, (0.3, 1.0)),
    ({"max_wheel_speed": 9.0}, (0.3, 1.0)),
    ({"max_linear_speed": 0.3}, (5.0, 1.0)),
    ({"max_angular_speed": 1.0}, (0.3, 50.0)),
    ({"max_linear_speed": 0.3, "max_angular_speed": 1.0, "max_wheel_speed": 9.0}, (-7.0, 7.0)),
]


def test_both_classes_of_nvidia_and_trundles_drive_agree(program: Callable[..., Any]) -> None:
    answers = program("known_answers", json.dumps(CASES))
    assert answers[0][0] == pytest.approx([8.125, 11.875])
    assert answers[1][0] == pytest.approx([8.125, 9.0])
    for (limits, command), (old, new) in zip(CASES, answers, strict=True):
        most = limits.get("max_wheel_speed")
        drive = DifferentialDrive(
            wheel_radius=0.03, track_width=0.1125, left_joint="l", right_joint="r", max_wheel_speed=most
        )
        bounds = {name: limit for name, limit in limits.items() if name != "max_wheel_speed"}
        assert old == pytest.approx(new)
        assert tuple(drive.wheel_command(Twist2D(*command), **bounds)) == pytest.approx(tuple(old))
