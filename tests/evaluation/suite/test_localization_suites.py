"""The suites of benchmarks/localization hold the conditions that their figures are named after."""

import math
from pathlib import Path

import pytest

from trundle.evaluation.suite import Suite
from trundle.mission.fields import StartError
from trundle.mission.obstacles import MapErrors

SUITES = Path(__file__).parents[3] / "benchmarks" / "localization" / "suites"


def first(name):
    suite = Suite.load(SUITES / f"{name}.yaml")
    return suite, suite.spec(0).scenario


@pytest.mark.parametrize(
    ("name", "odometry", "start", "map_errors"),
    [
        ("a", (0.01, 1.0), None, None),
        ("b", (0.05, 5.0), (1.0, 20.0), None),
        ("d", (0.05, 5.0), (1.0, 20.0), MapErrors(missing=0.25, ghosts=12)),
        ("closed_loop", (0.01, 1.0), None, None),
        ("closed_loop_d", (0.05, 5.0), (0.5, 10.0), MapErrors(missing=0.25, ghosts=12)),
        ("closed_loop_people", (0.01, 1.0), None, None),
    ],
)
def test_a_suite_has_the_errors_of_its_condition(name, odometry, start, map_errors):
    suite, scenario = first(name)
    closed = name.startswith("closed")
    assert len(suite) == (500 if closed else 200)
    assert scenario.backend.name == ("mujoco" if closed else "kinematic")
    assert (scenario.lidar, scenario.localizer.name) == (True, "amcl")
    assert (scenario.odometry.scale, math.degrees(scenario.odometry.heading)) == pytest.approx(odometry)
    told = None if start is None else StartError(distance=start[0], heading=math.radians(start[1]))
    assert scenario.start_error == told
    assert scenario.map_errors == map_errors
    slips = scenario.odometry.slips
    if map_errors is None:
        assert slips is None
    else:
        assert (slips.distance, math.degrees(slips.heading)) == pytest.approx((0.3, 10.0))
        assert slips.count == (None if closed else 6)
    assert (scenario.unmapped is None) != closed
    low = [world.options.get("low_objects") for world in suite.worlds if world.name in ("warehouse", "office", "lot")]
    assert set(low) == {False}


def test_the_conditions_drive_the_same_missions_and_can_be_prepared():
    suites = [first(name)[0] for name in "abd"]
    content = [[suite.spec(25 * world).content for world in range(8)] for suite in suites]
    assert content[0] == content[1] == content[2]
    settings = [suite.spec(60).scenario.model_copy(update={"localizer": None}).prepare() for suite in suites]
    assert settings[0].start == settings[1].start == settings[2].start
    assert (settings[0].grid.data == settings[1].grid.data).all()
    assert (settings[0].grid.data != settings[2].grid.data).any()
