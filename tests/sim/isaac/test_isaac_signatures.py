"""The one file of signatures, what is made of it, and the known answers of DifferentialController."""

import sys
from pathlib import Path

import numpy as np
import pytest

from support.fake_isaac.refused import Refused
from trundle.geometry import Twist2D
from trundle.robots import DifferentialDrive
from trundle.sim.isaac.application import Application
from trundle.sim.isaac.signatures import differences, read_signatures

ROOT = Path(__file__).parents[3]


def test_every_module_names_its_source():
    for module in read_signatures():
        assert module.generations
        assert len(module.source) > 20, module.name


def test_the_stubs_are_made_of_the_file(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "scripts")
    from isaac_stubs import make_stubs

    for path, text in make_stubs().items():
        assert (ROOT / "typings" / path).read_text(encoding="utf-8") == text, "run scripts/isaac_stubs.py"


def test_a_running_isaac_sim_that_is_as_expected_has_no_differences(fake):
    with Application(headless=True) as app:
        assert differences(app.generation) == []


def test_differences_name_what_is_missing_or_new(make_fake):
    fake = make_fake(5)
    with Application(headless=True) as app:
        world = fake.modules["isaacsim.core.api"]["World"]
        del world.render
        world.step = lambda self, render, always: None
        fake.modules["isaacsim.core.utils.stage"].pop("open_stage")
        assert set(differences(app.generation)) == {
            "isaacsim.core.api.World.render is missing",
            "isaacsim.core.api.World.step has no parameter step_sim",
            "isaacsim.core.api.World.step has no parameter update_fabric",
            "isaacsim.core.api.World.step requires always, which trundle does not pass",
            "isaacsim.core.utils.stage.open_stage is missing",
        }


@pytest.mark.parametrize(
    ("limits", "command", "answer"),
    [
        # NVIDIA's own, from the tests of DifferentialController in isaac-sim/IsaacSim, v5.1.0 and v6.0.1.
        ({}, (0.3, 1.0), (8.125, 11.875)),
        ({"max_wheel_speed": 9.0}, (0.3, 1.0), (8.125, 9.0)),
        # v and w are clipped first, each on its own, and the wheels after that.
        ({"max_linear_speed": 0.3}, (5.0, 1.0), (8.125, 11.875)),
        ({"max_angular_speed": 1.0}, (0.3, 50.0), (8.125, 11.875)),
        ({"max_linear_speed": 0.3, "max_angular_speed": 1.0, "max_wheel_speed": 9.0}, (7.0, 7.0), (8.125, 9.0)),
    ],
)
def test_known_answers_of_differential_controller_hold_in_ours(limits, command, answer):
    drive = DifferentialDrive(
        wheel_radius=0.03,
        track_width=0.1125,
        left_joint="l",
        right_joint="r",
        max_wheel_speed=limits.get("max_wheel_speed"),
    )
    of_robot = {name: limit for name, limit in limits.items() if name != "max_wheel_speed"}
    assert tuple(drive.wheel_command(Twist2D(*command), **of_robot)) == pytest.approx(answer)


def test_the_stand_in_refuses_what_isaac_sim_would_not_take(make_fake):
    make_fake(5)
    with pytest.raises(ImportError, match="before SimulationApp runs"):
        import isaacsim.core.api  # noqa: F401
    with Application(headless=True) as app:
        from isaacsim.core.api import World
        from isaacsim.robot.wheeled_robots.controllers.differential_controller import DifferentialController
        from isaacsim.robot.wheeled_robots.robots import WheeledRobot

        with pytest.raises(Refused, match="without a stage"):
            World(physics_dt=0.005, rendering_dt=0.005)
        with pytest.raises(TypeError):
            World(dt=0.005)
        with pytest.raises(TypeError):
            DifferentialController(wheel_radius=0.1, wheel_base=0.2)  # 5.1 wants a name
        with pytest.raises(Refused, match=r"command has the shape \(3,\)"):
            DifferentialController("d", 0.1, 0.2).forward(np.zeros(3))
        with pytest.raises(Refused, match="no prim"):
            WheeledRobot("/robot", wheel_dof_names=["l", "r"])
        assert app.is_running
    with pytest.raises(Refused, match="does not run"):
        DifferentialController("d", 0.1, 0.2)


def test_the_stand_in_of_6_takes_keywords_alone_and_arrays_of_robots(make_fake):
    fake = make_fake(6)
    with Application(headless=True):
        from isaacsim.core.simulation_manager import SimulationManager
        from isaacsim.robot.experimental.wheeled_robots.controllers import DifferentialController
        from isaacsim.robot.experimental.wheeled_robots.robots import WheeledRobot

        with pytest.raises(TypeError):
            DifferentialController(0.1, 0.2)
        with pytest.raises(ValueError, match="limits"):
            DifferentialController(wheel_radius=0.1, wheel_base=0.2, max_wheel_speed=-1.0)
        with pytest.raises(TypeError):
            SimulationManager.step(5)
        with pytest.raises(Refused, match="timeline does not play"):
            SimulationManager.step(steps=1)
        with pytest.raises(Refused, match=r"positions has the shape \(3,\), not \(1, 3\)"):
            WheeledRobot("/robot", wheel_dof_names=["l"], positions=[0.0, 0.0, 0.0])
    assert "isaacsim.core.api" not in fake.modules
    assert "isaacsim.core.api" not in sys.modules
