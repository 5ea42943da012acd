import math
import signal

import numpy as np
import pytest

import trundle
from trundle.errors import SimulationError
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, OccupancyCells, Solid
from trundle.mission import Outcome
from trundle.sim import Simulator, simulate
from trundle.sim.isaac import IsaacSimulator
from trundle.sim.isaac.adapter import BodyState, base_motion
from trundle.sim.isaac.application import Application
from trundle.testing import check_simulator
from trundle.worlds import World

EMPTY = World("empty", ())
PERIOD = 0.05


def test_it_keeps_the_promises_of_a_simulator_and_agrees_with_the_kinematic_one(fake):
    with Application(headless=True):
        check_simulator(lambda world, robot: IsaacSimulator(world, robot))
    assert fake.app_closes == 1


def robot_with_depenetration(assets, folder, speed):
    """Write a copy of the robot's USD with another depenetration speed [m/s], or with none."""
    from pxr import Sdf, Usd, UsdPhysics

    (usd,) = assets.rglob("nova_carter.usd")
    stage = Usd.Stage.Open(Sdf.Layer.OpenAsAnonymous(str(usd)))
    for prim in stage.Traverse():
        if prim.HasAPI(UsdPhysics.RigidBodyAPI) and speed is not None:
            name = "physxRigidBody:maxDepenetrationVelocity"
            prim.CreateAttribute(name, Sdf.ValueTypeNames.Float, False).Set(speed)
    stage.Export(str(folder / "robot.usda"))
    return str(folder / "robot.usda")


@pytest.fixture
def hall(assets):
    return World.load(assets / "Isaac/Environments/Simple_Warehouse/warehouse.usd")


def test_a_mission_arrives_in_an_environment_of_isaac_sim(fake, hall):
    grid = trundle.OccupancyGrid.from_world(hall, resolution=0.05, z_range=(0.1, 0.62))
    navigator = trundle.Navigator(grid, "nova_carter")
    with simulate(hall, "nova_carter", backend="isaac", environment="warehouse", headless=True) as sim:
        assert isinstance(sim, Simulator)
        episode = trundle.run(sim, navigator, start=(-2.5, -1.0, 0.0), goal=(2.0, 1.5))
    assert episode.outcome is Outcome.ARRIVED
    assert fake.stage_path.endswith("Isaac/Environments/Simple_Warehouse/warehouse.usd")
    assert fake.app_closes == 1


def test_a_mission_arrives_on_a_map_that_is_written_as_usd(fake):
    cells = np.zeros((80, 120), dtype=np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[30:50, 55:60] = 100
    grid = trundle.OccupancyGrid(cells, 0.05)
    world = World.from_map(grid)
    with simulate(world, "nova_carter", backend="isaac", headless=True) as sim:
        episode = trundle.run(sim, trundle.Navigator(grid, "nova_carter"), start=(1.0, 2.0, 0.0), goal=(4.8, 2.0))
        walls = sim.reset(Pose2D(2.8, 2.0)).contacts
    assert episode.outcome is Outcome.ARRIVED
    assert {contact.other for contact in walls} == {"map[30:50,55:60]"}


def test_contacts_with_blocked_cells_name_the_cell(fake):
    blocked = np.zeros((40, 40), dtype=bool)
    blocked[18:22, 30:32] = True
    world = World("cells", (Solid("map", OccupancyCells(blocked, 0.05, 1.0), Pose3D((0.0, 0.0, 0.0))),))
    with IsaacSimulator(world, trundle.Robot.load("nova_carter"), headless=True) as sim:
        touched = {contact.other for contact in sim.reset(Pose2D(1.6, 1.0)).contacts}
    assert touched
    assert touched <= {f"map[{row},{col}]" for row in range(18, 22) for col in (30, 31)}


def test_every_contact_of_a_control_period_is_reported(fake):
    behind = Solid("behind", Box((0.4, 0.2, 0.4)), Pose3D((-0.805, 0.0, 0.2)))
    ahead = [Solid(f"ahead_{side}", Box((0.2, 0.2, 0.4)), Pose3D((0.74, 0.15 * side, 0.2))) for side in (-1, 1)]
    with IsaacSimulator(World("room", (behind, *ahead)), trundle.Robot.load("nova_carter"), headless=True) as sim:
        sim.reset(Pose2D(0.0, 0.0))
        state = sim.step(Twist2D(0.5, 0.0), 2.0)
    assert [contact.other for contact in state.contacts] == ["behind", "ahead_-1", "ahead_1"]


def test_the_start_pose_is_written_on_the_robots_prim_above_the_ground(fake):
    placed = []
    with IsaacSimulator(EMPTY, trundle.Robot.load("nova_carter"), headless=True, ground_offset=0.05) as sim:
        body = fake.body
        place = body.place
        body.place = lambda position, orientation: (
            placed.append((fake.timeline, tuple(position), tuple(orientation))),
            place(position, orientation),
        )
        sim.reset(Pose2D(1.0, -2.0, math.pi / 2.0))
    timeline, position, orientation = placed[0]
    assert timeline == "stopped"
    assert position == pytest.approx((1.0, -2.0, 0.05))
    assert orientation == pytest.approx((math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))


@pytest.mark.slow
@pytest.mark.parametrize("generation", [5, 6])
def test_an_articulation_whose_root_is_not_base_link_is_placed_and_read_at_base_link(make_fake, generation):
    make_fake(generation, root=Pose2D(-0.2, 0.05, 0.3))
    with Application(headless=True):
        check_simulator(lambda world, robot: IsaacSimulator(world, robot))


@pytest.mark.parametrize("generation", [5, 6])
def test_the_twist_is_that_of_base_link_and_not_of_a_root_beside_it(make_fake, generation):
    make_fake(generation, root=Pose2D(-0.2, 0.1, 0.3))
    with IsaacSimulator(EMPTY, trundle.Robot.load("nova_carter"), headless=True) as sim:
        for _ in range(20):
            state = sim.step(Twist2D(0.3, 0.5), PERIOD)
    assert (state.twist.v, state.twist.w) == pytest.approx((0.3, 0.5), abs=1e-5)


@pytest.mark.parametrize("generation", [5, 6])
def test_the_twist_is_that_of_base_link_though_physx_gives_that_of_the_centre_of_mass(make_fake, generation):
    make_fake(generation, center=(-0.4, 0.3, 0.5))
    with IsaacSimulator(EMPTY, trundle.Robot.load("nova_carter"), headless=True) as sim:
        sim.reset(Pose2D(1.0, 2.0, 2.5))
        for _ in range(20):
            state = sim.step(Twist2D(0.0, 0.6), PERIOD)
    assert (state.twist.v, state.twist.w) == pytest.approx((0.0, 0.6), abs=1e-5)


@pytest.mark.parametrize("tilt", [0.0, 0.2])
def test_base_motion_turns_the_centre_of_mass_with_the_root(tilt):
    turn = Pose3D.planar(0.0, 0.0, 0.0, 0.7).quaternion if not tilt else (math.cos(tilt / 2), math.sin(tilt / 2), 0, 0)
    center, angular = np.array([0.1, -0.2, 0.5]), np.array([0.3, 0.2, 0.6])
    at_center = Pose3D(quaternion=turn).rotation() @ center
    origin = np.array([0.4, 0.1, 0.0])
    body = BodyState(np.zeros(3), np.array(turn), origin + np.cross(angular, at_center), angular, center)
    pose, twist = base_motion(body, Pose2D(0.0, 0.0))
    assert twist.v == pytest.approx(0.4 * math.cos(pose.yaw) + 0.1 * math.sin(pose.yaw))
    assert twist.w == pytest.approx(0.6)


@pytest.mark.parametrize("depth", [0.005, 0.4])
@pytest.mark.parametrize("speed", [None, 5.0])
def test_a_robot_that_starts_in_a_solid_stays_there_and_names_it(fake, assets, tmp_path, depth, speed):
    # PhysX pushes it out while it settles, or its pose becomes NaN: the contact is in the first step only.
    usd = robot_with_depenetration(assets, tmp_path, speed)
    wall = World("wall", (Solid("wall", Box((1.0, 4.0, 1.0)), Pose3D((0.64, 0.0, 0.5))),))
    with IsaacSimulator(wall, trundle.Robot.load("nova_carter"), robot_usd=usd, headless=True) as sim:
        state = sim.reset(Pose2D(depth, 0.3, 0.0))
        assert {contact.other for contact in state.contacts} == {"wall"}
        assert state.pose.distance_to(Pose2D(depth, 0.3)) < 1e-6
        assert state.odometry == Pose2D(depth, 0.3)
        assert not sim.reset(Pose2D(-1.0, 0.0)).contacts


def test_a_mission_that_starts_in_a_solid_ends_as_collided_with_its_name(fake):
    grid = trundle.OccupancyGrid(np.zeros((80, 80), dtype=np.int8), 0.05)
    box = World("box", (Solid("forgotten box", Box((0.5, 0.5, 0.5)), Pose3D((1.2, 2.0, 0.25))),))
    with simulate(box, "nova_carter", backend="isaac", headless=True) as sim:
        episode = trundle.run(sim, trundle.Navigator(grid, "nova_carter"), start=(1.0, 2.0, 0.0), goal=(3.0, 2.0))
    assert episode.outcome is Outcome.COLLIDED
    assert "forgotten box" in episode.message


def test_what_only_the_raised_robot_touches_at_its_start_is_no_contact(fake):
    shelf = World("shelf", (Solid("shelf", Box((0.2, 0.2, 0.2)), Pose3D((3.0, 0.0, 0.73))),))
    with IsaacSimulator(shelf, trundle.Robot.load("nova_carter"), headless=True) as sim:
        for z, names in ((0.631, set()), (0.6, {"shelf"})):
            touched = {}
            pair = ("/trundle_robot/base_link", "/World/Solids/shelf", [(3.0, 0.0, z)])
            sim._contacts.add([type(sim._contacts.touching()[0])(*pair)], touched, height=sim.robot.body.height)
            assert {contact.other for contact in touched.values()} == names


def test_a_robot_that_is_not_where_it_was_put_is_an_error(make_fake):
    fake = make_fake(6, root=Pose2D(3.0, 0.0))
    with pytest.raises(SimulationError, match=r"its root is 3.00 m away"):
        IsaacSimulator(EMPTY, trundle.Robot.load("nova_carter"), headless=True)
    assert fake.app_closes == 1


@pytest.mark.parametrize("physics_dt", [0.0025, 0.005, 0.01])
def test_a_control_period_has_as_many_physics_steps_as_fit(fake, physics_dt):
    with IsaacSimulator(EMPTY, trundle.Robot.load("nova_carter"), headless=True, physics_dt=physics_dt) as sim:
        before = fake.steps
        state = sim.step(Twist2D(0.2, 0.0), PERIOD)
        assert fake.steps - before == round(PERIOD / physics_dt)
        assert state.time == pytest.approx(PERIOD)
        assert fake.dt == physics_dt


def test_isaac_sims_own_controller_turns_the_wheels(fake):
    robot = trundle.Robot.load("nova_carter")
    with IsaacSimulator(EMPTY, robot, headless=True) as sim:
        for _ in range(40):
            state = sim.step(Twist2D(0.5, 0.4), PERIOD)
        assert fake.body.targets == pytest.approx(tuple(robot.wheel_speeds(Twist2D(0.5, 0.4))))
        assert tuple(state.wheel_speeds) == pytest.approx(fake.body.targets, abs=1e-5)
    assert "DifferentialController.forward" in fake.calls


def test_wheel_angles_go_on_where_physics_wraps_them(fake):
    robot = trundle.Robot.load("nova_carter")
    with IsaacSimulator(EMPTY, robot, headless=True) as sim:
        for _ in range(200):
            state = sim.step(Twist2D(0.7, 0.0), PERIOD)
        assert abs(fake.body.angles[0]) < 4.0 * math.pi
        assert state.wheel_positions.left > 8.0 * math.pi
        assert state.odometry.x == pytest.approx(state.pose.x, abs=1e-3)
        assert state.wheel_positions.left * robot.drive.wheel_radius == pytest.approx(state.pose.x, abs=1e-3)


def test_contacts_of_a_stage_that_trundle_did_not_write_are_named_by_prims(fake, tmp_path):
    from pxr import Usd, UsdGeom, UsdPhysics

    stage = Usd.Stage.CreateNew(str(tmp_path / "mine.usda"))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    box = UsdGeom.Cube.Define(stage, "/Hall/Shelf")
    box.AddTranslateOp().Set((2.0, 0.0, 1.0))
    UsdPhysics.CollisionAPI.Apply(box.GetPrim())
    stage.Save()
    world = World.load(tmp_path / "mine.usda")
    with IsaacSimulator(
        world, trundle.Robot.load("nova_carter"), environment=str(tmp_path / "mine.usda"), headless=True
    ) as sim:
        assert not sim.reset(Pose2D(0.0, 0.0)).contacts
        assert {contact.other for contact in sim.reset(Pose2D(1.5, 0.0)).contacts} == {"/Hall/Shelf"}


def test_a_picture_comes_from_isaac_sims_renderer(fake):
    with IsaacSimulator(EMPTY, trundle.Robot.load("nova_carter"), headless=True) as sim:
        picture = sim.picture((3.0, 0.0, 2.0), (0.0, 0.0, 0.3), (64, 48))
    assert picture.shape == (48, 64, 3)
    assert picture.dtype == np.uint8
    assert picture.any()
    assert fake.cameras["/OmniverseKit_Persp"] == ((3.0, 0.0, 2.0), (0.0, 0.0, 0.3))


def test_without_a_window_nothing_is_drawn_while_it_drives(fake):
    with IsaacSimulator(EMPTY, trundle.Robot.load("nova_carter"), headless=True) as sim:
        before = fake.draws
        sim.step(Twist2D(0.1, 0.0), PERIOD)
        assert fake.draws == before
    config, experience = fake.launch
    assert config["headless"] is True
    assert experience == ""


def test_with_a_window_it_draws_once_every_control_period(fake):
    with IsaacSimulator(EMPTY, trundle.Robot.load("nova_carter")) as sim:
        before = fake.draws
        sim.step(Twist2D(0.1, 0.0), PERIOD)
        assert fake.draws == before + 1
    assert fake.launch[0]["headless"] is False


def test_a_livestream_runs_the_streaming_experience_without_a_window(fake, monkeypatch):
    monkeypatch.setenv("EXP_PATH", "/opt/isaac-sim/apps")
    with IsaacSimulator(EMPTY, trundle.Robot.load("nova_carter"), livestream=True) as sim:
        assert sim.application.draws
    config, experience = fake.launch
    assert config["headless"] is True
    assert config["hide_ui"] is False
    assert experience == "/opt/isaac-sim/apps/isaacsim.exp.full.streaming.kit"


def drive(sim, hall, fake, **hooks):
    grid = trundle.OccupancyGrid.from_world(hall, resolution=0.05, z_range=(0.1, 0.62))
    for name, hook in hooks.items():
        setattr(fake, name, hook)
    return trundle.run(sim, trundle.Navigator(grid, "nova_carter"), start=(-2.5, -1.0, 0.0), goal=(2.0, 1.5))


def test_ctrl_c_ends_a_run_as_aborted_and_closes_the_application(fake, hall):
    def interrupt(step):
        if step == 500:
            signal.raise_signal(signal.SIGINT)

    with simulate(hall, "nova_carter", backend="isaac", environment="warehouse", headless=True) as sim:
        episode = drive(sim, hall, fake, on_step=interrupt)
    assert episode.outcome is Outcome.ABORTED
    assert "Ctrl-C" in episode.message
    assert fake.app_closes == 1


def test_closing_the_window_ends_a_run_as_aborted(fake, hall):
    def close_window(drawing):
        fake.window_open = drawing < 60

    with simulate(hall, "nova_carter", backend="isaac", environment="warehouse") as sim:
        episode = drive(sim, hall, fake, on_draw=close_window)
    assert episode.outcome is Outcome.ABORTED
    assert "Isaac Sim was closed" in episode.message
    assert fake.app_closes == 1


def test_a_pause_in_the_window_is_waited_for(fake, monkeypatch):
    monkeypatch.setattr("time.sleep", lambda _: None)
    with IsaacSimulator(EMPTY, trundle.Robot.load("nova_carter")) as sim:
        fake.timeline = "paused"
        paused_at = fake.draws

        def play_on(drawing):
            if drawing == paused_at + 10:
                fake.timeline = "playing"

        fake.on_draw = play_on
        steps = fake.steps
        assert sim.step(Twist2D(0.1, 0.0), PERIOD).time == pytest.approx(PERIOD)
        assert fake.steps - steps == 10


def test_a_timeline_that_was_stopped_ends_the_run(fake):
    with IsaacSimulator(EMPTY, trundle.Robot.load("nova_carter")) as sim:
        fake._stop()
        with pytest.raises(SimulationError, match="timeline of Isaac Sim was stopped"):
            sim.step(Twist2D(0.1, 0.0), PERIOD)


def test_an_application_that_runs_already_is_used_and_left_open(fake):
    from isaacsim import SimulationApp

    app = SimulationApp({"headless": True})
    with IsaacSimulator(EMPTY, trundle.Robot.load("nova_carter"), headless=True, application=app) as sim:
        sim.step(Twist2D(0.1, 0.0), PERIOD)
    assert fake.runs
    app.close()


def test_several_simulators_share_one_application(fake):
    with Application(headless=True):
        for _ in range(2):
            with simulate(EMPTY, "nova_carter", backend="isaac") as sim:
                sim.step(Twist2D(0.1, 0.0), PERIOD)
    assert fake.app_starts == 1
