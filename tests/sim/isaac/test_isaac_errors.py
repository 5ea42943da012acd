"""What can be wrong with Isaac Sim or with what it is given: one clear error each, and it is always closed."""

import sys

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdPhysics

import trundle
from trundle.errors import (
    InputError,
    MissingExtraError,
    RobotError,
    RobotWarning,
    SimulationError,
    UnknownNameError,
    WorldError,
)
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.mission import Outcome
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.sim.isaac import IsaacSimulator, application
from trundle.worlds import World

EMPTY = World("empty", ())


def make(**options):
    return simulate(EMPTY, "nova_carter", backend="isaac", **{"headless": True, **options})


def test_no_isaac_sim(monkeypatch):
    monkeypatch.delenv("ISAAC_PATH", raising=False)
    monkeypatch.setitem(sys.modules, "isaacsim", None)
    monkeypatch.setattr(application.importlib.util, "find_spec", lambda _: None)
    with pytest.raises(InputError, match=r"needs Isaac Sim 5.1 or 6.x.*python.sh -m trundle.*--backend mujoco"):
        make()


def test_isaac_sim_that_is_elsewhere_is_pointed_at(monkeypatch):
    monkeypatch.setenv("ISAAC_PATH", "/opt/isaac-sim")
    monkeypatch.setattr(application.importlib.util, "find_spec", lambda _: None)
    with pytest.raises(InputError, match=r"/opt/isaac-sim/python.sh -m trundle"):
        make()


@pytest.mark.parametrize(("installed", "needs"), [("5.1.0.0", "3.11"), ("6.2.0.0", "3.12")])
def test_the_wrong_python(make_fake, monkeypatch, installed, needs):
    make_fake(5)
    monkeypatch.setattr(application, "PYTHONS", {5: (3, 11), 6: (3, 12)})
    monkeypatch.setattr(application, "installed_version", lambda: installed)
    monkeypatch.setattr(application.sys, "version_info", (3, 13, 1))
    with pytest.raises(InputError, match=rf"Isaac Sim {installed} needs Python {needs}, and .* is Python 3.13"):
        make()


def test_an_isaac_sim_that_is_too_old(make_fake, monkeypatch):
    make_fake(5)
    monkeypatch.setattr(application, "installed_version", lambda: "4.5.0")
    with pytest.raises(InputError, match=r"Isaac Sim 4.5.0 is too old"):
        make()


def test_an_isaac_sim_that_does_not_start(fake, monkeypatch):
    def fail(*_, **__):
        raise RuntimeError("no suitable GPU")

    monkeypatch.setattr(fake.modules["isaacsim"]["SimulationApp"], "__init__", fail)
    with pytest.raises(SimulationError, match=r"does not start: no suitable GPU. It needs an NVIDIA RTX GPU"):
        make()


def test_an_api_that_nobody_knows(make_fake):
    fake = make_fake(5)
    for name in [name for name in fake.modules if "wheeled_robots" in name]:
        del fake.modules[name]
    with pytest.raises(SimulationError, match=r"has neither the API of 5.1 .* nor that of 6.x"):
        make()
    assert fake.app_closes == 1


def test_a_changed_api_is_reported_by_what_is_missing(make_fake):
    fake = make_fake(6)
    del fake.modules["isaacsim.core.simulation_manager"]["SimulationManager"].setup_simulation
    with pytest.raises(SimulationError, match=r"SimulationManager.setup_simulation is missing"):
        make()
    assert fake.app_closes == 1


def test_a_second_application_in_the_process(fake):
    with application.Application(headless=True):  # noqa: SIM117
        with pytest.raises(SimulationError, match="already running in this process"):
            application.Application(headless=True)


def test_assets_that_cannot_be_reached(make_fake):
    fake = make_fake(5, assets=None)
    with pytest.raises(InputError, match=r"cannot be reached: .*assets.example.*--assets-root or TRUNDLE_ISAAC_ASSETS"):
        make()
    assert fake.app_closes == 1


def test_a_folder_without_assets_is_refused_before_isaac_sim_starts(fake, tmp_path):
    with pytest.raises(InputError, match=r"--assets-root .*: it has no subfolder Isaac"):
        make(assets_root=str(tmp_path))
    with pytest.raises(InputError, match="there is no such folder"):
        make(assets_root=str(tmp_path / "nothing"))
    assert fake.app_starts == 0


def test_assets_may_be_named_by_the_environment_variable(make_fake, assets, monkeypatch):
    make_fake(6, assets=None)
    monkeypatch.setenv("TRUNDLE_ISAAC_ASSETS", str(assets))
    with make(environment="warehouse") as sim:
        assert sim.step(Twist2D(), 0.05).time == 0.05


def test_an_unknown_environment_offers_the_nearest(fake):
    with pytest.raises(UnknownNameError, match=r"unknown environment 'warehose'. Did you mean 'warehouse'"):
        make(environment="warehose")
    assert fake.app_starts == 0


def test_an_environment_file_that_is_not_there(fake):
    with pytest.raises(InputError, match=r"environment nowhere.usd: no such file"):
        make(environment="nowhere.usd")


def test_an_environment_that_is_missing_in_the_assets(fake):
    with pytest.raises(WorldError, match=r"hospital.usd: Isaac Sim cannot open it"):
        make(environment="hospital")
    assert fake.app_closes == 1


def test_a_robot_that_isaac_sim_does_not_have(fake):
    with pytest.raises(
        InputError, match=r"no robot 'jackal' .*nova_carter.*--robot-usd.*trundle export jackal --to usd"
    ):
        simulate(EMPTY, "jackal", backend="isaac", headless=True)
    assert fake.app_starts == 0


@pytest.mark.parametrize(
    ("path", "says"), [("robot.urdf", "give a file that ends in .usd"), ("no.usd", "no such file")]
)
def test_a_robots_usd_that_cannot_be_used(fake, path, says):
    with pytest.raises(InputError, match=f"--robot-usd {path}: .*{says}"):
        make(robot_usd=path)


def test_a_robots_usd_without_the_wheels_joints_lists_what_it_has(fake, assets):
    carter = assets / "Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd"
    with pytest.raises(
        RobotError, match=r"has no joint wheel_left_joint and no joint wheel_right_joint; it has .*joint_wheel_l"
    ):
        simulate(EMPTY, "turtlebot3_burger", backend="isaac", headless=True, robot_usd=str(carter))
    assert fake.app_closes == 1


@pytest.mark.parametrize(
    ("meters", "up", "says"),
    [
        (0.01, "Z", r"is in centimetres, but robots and maps are in metres: everything would be 100 times too large"),
        (0.001, "Z", "is in millimetres"),
        (0.0254, "Z", "is in units of 0.0254 m"),
        (1.0, "Y", "the up axis is Y, it must be Z"),
    ],
)
def test_a_stage_in_other_units(fake, tmp_path, meters, up, says):
    stage = Usd.Stage.CreateNew(str(tmp_path / "hall.usda"))
    UsdGeom.SetStageMetersPerUnit(stage, meters)
    UsdGeom.SetStageUpAxis(stage, up)
    UsdGeom.Cube.Define(stage, "/Box")
    stage.Save()
    with pytest.raises(WorldError, match=says):
        make(environment=str(tmp_path / "hall.usda"))
    assert fake.app_closes == 1


def test_a_start_inside_a_collider_ends_the_run_with_what_it_stands_in(fake, assets):
    hall = World.load(assets / "Isaac/Environments/Simple_Warehouse/warehouse.usd")
    empty = World("nothing to plan around", hall.solids[:4])
    grid = trundle.OccupancyGrid.from_world(empty, resolution=0.05, z_range=(0.1, 0.62), bounds=((-4, -3), (4, 3)))
    with simulate(hall, "nova_carter", backend="isaac", environment="warehouse", headless=True) as sim:
        episode = trundle.run(sim, trundle.Navigator(grid, "nova_carter"), start=(0.2, 0.0, 0.0), goal=(2.5, 1.5))
    assert episode.outcome is Outcome.COLLIDED
    assert "in contact at the start" in episode.message
    assert "crate" in episode.message


def test_a_stage_without_a_floor(make_fake):
    fake = make_fake(6, floor=False)
    with pytest.raises(SimulationError, match=r"fell .* m in 0.5 s: there is no collider under it.*--ground-offset"):
        make()
    assert fake.app_closes == 1


def test_physics_that_broke_down(fake):
    with make() as sim:
        fake.body.world_pose = lambda: (np.full(3, np.nan), np.array([1.0, 0.0, 0.0, 0.0]))
        with pytest.raises(SimulationError, match=r"diverged.*smaller --physics-dt than 0.005 s"):
            sim.step(Twist2D(), 0.05)


def test_a_step_after_close(fake):
    sim = make()
    sim.close()
    sim.close()
    for call in (lambda: sim.step(Twist2D(), 0.05), lambda: sim.reset(Pose2D(0.0, 0.0)), sim.joint_names):
        with pytest.raises(SimulationError, match=r"was closed; make a new one with trundle.simulate"):
            call()
    assert fake.app_closes == 1


@pytest.mark.parametrize("options", [{"physics_dt": 0.0}, {"physics_dt": 0.5}, {"ground_offset": -0.1}])
def test_options_out_of_range(fake, options):
    with pytest.raises(InputError, match="out of range"):
        make(**options)
    assert fake.app_starts == 0


def test_a_fault_in_the_middle_of_loading_closes_the_application(fake, monkeypatch):
    def fail(*_):
        raise KeyboardInterrupt

    fake.on_draw = fail
    with pytest.raises(KeyboardInterrupt):
        IsaacSimulator(EMPTY, Robot.load("nova_carter"))
    assert fake.app_closes == 1


def test_an_option_that_it_does_not_have(fake):
    with pytest.raises(InputError, match="backend 'isaac'"):
        make(warp=True)


def test_lidars_are_refused_before_it_starts(fake):
    with pytest.raises(InputError, match="simulates no lidars"):
        make(lidar=True)
    assert fake.app_starts == 0


def test_a_wheel_whose_drive_does_not_follow_a_speed_is_warned_of(fake, assets, tmp_path):
    # A copy: the layer that a path names is shared by all who open it.
    layer = Sdf.Layer.OpenAsAnonymous(str(assets / "Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd"))
    stage = Usd.Stage.Open(layer)
    for prim in stage.Traverse():
        if prim.GetName() == "joint_wheel_left":
            UsdPhysics.DriveAPI(prim, "angular").GetDampingAttr().Set(0.0)
    stage.Export(str(tmp_path / "carter.usda"))
    with pytest.warns(RobotWarning, match="drive of joint_wheel_left has a damping of 0 and a stiffness of 0"):
        make(robot_usd=str(tmp_path / "carter.usda")).close()


def test_nobody_is_advised_to_install_usd_core_beside_isaac_sims_own(fake, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "pxr.Usd", None)
    (tmp_path / "hall.usd").touch()
    with pytest.raises(MissingExtraError, match=r"in another Python than Isaac Sim's"):
        World.load(tmp_path / "hall.usd", trusted=True)


def test_a_world_is_written_without_scipy(fake, monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.spatial", None)
    walls = World("walls", (Solid("wall", Box((0.2, 4.0, 1.0)), Pose3D((3.0, 0.0, 0.5))),))
    with simulate(walls, "nova_carter", backend="isaac", headless=True) as sim:
        assert sim.step(Twist2D(), 0.05).time == 0.05
