"""trundle's IsaacSimulator and both of its adapters on NVIDIA's own classes and PhysX."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

pytestmark = pytest.mark.isaac


@pytest.fixture(scope="module")
def reports(program: Callable[..., Any]) -> dict[int, Any]:
    return {generation: program("simulator", "--api", generation) for generation in (5, 6)}


@pytest.fixture(params=[5, 6], ids=["5.1", "6.x"])
def report(request: pytest.FixtureRequest, reports: dict[int, Any]) -> Any:
    return reports[request.param]


def test_each_generation_has_its_own_adapter(reports: dict[int, Any]) -> None:
    assert {asked: report["generation"] for asked, report in reports.items()} == {5: 5, 6: 6}


def test_both_adapters_do_the_same_bit_for_bit(reports: dict[int, Any]) -> None:
    assert {**reports[5], "generation": 6} == reports[6]


@pytest.mark.parametrize(
    ("command", "metres", "radians"), [("straight", 0.005, 0.002), ("turn", 0.006, 0.03), ("curve", 0.015, 0.02)]
)
def test_it_drives_as_the_kinematic_model_does(report: Any, command: str, metres: float, radians: float) -> None:
    found, expected = report["found"][command], report["expected"][command]
    assert math.dist(found["pose"][:2], expected["pose"][:2]) < metres
    assert abs(math.remainder(found["pose"][2] - expected["pose"][2], math.tau)) < radians
    assert found["twist"] == pytest.approx(expected["twist"], abs=0.02)
    assert found["odometry"] == pytest.approx(found["pose"], abs=0.01)
    assert found["time"] == pytest.approx(expected["time"])
    assert found["contacts"] == []


def test_a_reset_starts_the_same_run_again_bit_for_bit(report: Any) -> None:
    assert report["again"] == report["found"]["curve"]


def test_it_stands_where_it_was_put(report: Any) -> None:
    assert report["still"]["pose"] == pytest.approx((-1.0, 0.5, 0.3), abs=2e-3)
    assert report["still"]["twist"] == pytest.approx((0.0, 0.0), abs=5e-3)


def test_it_touches_the_wall_where_its_front_gets_there(report: Any) -> None:
    time, names, x = report["touched"]
    assert names == ["wall"]
    assert x == pytest.approx(2.9, abs=0.01)
    # 0.77 m to go, and up to 0.5 m/s.
    assert 1.0 < time < 2.5


def test_a_start_inside_the_wall_names_it_and_throws_nothing(report: Any) -> None:
    names, pose = report["inside"]
    assert names == ["wall"]
    assert pose == pytest.approx((2.8, 0.0, 0.0), abs=1e-6)


def test_the_joints_are_those_of_the_robot(report: Any) -> None:
    assert {"joint_wheel_left", "joint_wheel_right", "joint_caster_base"} <= {*report["joints"]}
    assert len(report["joints"]) == 7
