import math
from pathlib import Path

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import AngleWarning, BlockedPoseError, InputError, OutputError, ScenarioError, UnknownNameError
from trundle.files.choice import Choice
from trundle.geometry import Pose2D, Twist2D
from trundle.localization.odometry import OdometryLocalizer
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, Scenario, Trajectory, run
from trundle.mission.simulation import session_options
from trundle.robots import Robot


def write(folder, text, name="scenario.yaml"):
    path = folder / name
    path.write_text(text)
    return path


def test_names_alone_stand_for_choices_without_options(tmp_path):
    scenario = Scenario.load(write(tmp_path, "world: warehouse\nplanner: manhattan_astar\nbackend: kinematic\n"))
    assert scenario.world.name == "warehouse"
    assert scenario.planner.name == "manhattan_astar"
    assert scenario.backend.options == {}
    assert scenario.controller.name == "regulated_pure_pursuit"


def test_options_and_numbers_are_read(tmp_path):
    text = """
world: {name: warehouse, seed: 7, options: {aisle_width: 1.4, size: [20, 12.5]}}
robot: turtlebot3_burger
start: [0, 1.5]
goals: [[3, 4], [5, 6, 1.57]]
controller: {name: regulated_pure_pursuit, options: {lookahead: 6e-1}}
time_limit_s: 90
"""
    scenario = Scenario.load(write(tmp_path, text))
    assert scenario.world.seed == 7
    assert scenario.world.options == {"aisle_width": 1.4, "size": [20, 12.5]}
    assert scenario.goals == ((3.0, 4.0), (5.0, 6.0, 1.57))
    assert scenario.controller.options == {"lookahead": 0.6}


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("world: warehouse\nspeed: 3\n", ":2:1: speed: unknown key"),
        ("world: warehouse\nstart: [1]\n", ":2:8: start:"),
        ("world: warehouse\nstart: [1, 2, 3, 4]\n", ":2:8: start:"),
        ("world: warehouse\nstart: [1, .nan]\n", ":2:12: start.1:"),
        ("world: warehouse\ngoals: []\n", ":2:8: goals:"),
        ("world: warehouse\nseed: -1\n", ":2:7: seed:"),
        ("world: warehouse\nresolution: 0\n", ":2:13: resolution:"),
        ("world: {name: warehouse, sede: 1}\n", ":1:26: world.sede: unknown key. Did you mean 'seed'"),
        ("world: {seed: 1}\n", ":1:8: world.name:"),
        ("planner: 3\nworld: warehouse\n", ":1:10: planner:"),
        ("world: warehouse\nplanner: jps\n", ":2:10: planner: 'jps' was removed; use astar with method='jps'"),
        ("controller: blog\nmap: m.yaml\n", ":1:13: controller: 'blog' was renamed; use lookahead"),
        ("planner: {name: theta_star}\nmap: m.yaml\n", ":1:10: planner: 'theta_star' was removed; use any_angle"),
        ("robot: nova_carter\n", "either world or map"),
        ("world: warehouse\nmap: m.yaml\n", "either world or map"),
        ("world: warehouse\ngoal: [1, 2]\ngoals: [[1, 2]]\n", "either goal or goals"),
        ("world: warehouse\ncompat: humble\n", "needs map"),
    ],
)
def test_every_mistake_is_reported_with_its_place(tmp_path, text, where):
    path = write(tmp_path, text)
    with pytest.raises(ScenarioError) as caught:
        Scenario.load(path)
    assert where in str(caught.value)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\n", "a map"),
        ("name: mine\ndrive: {wheel_radius: 0.1}\nfootprint: []\n", "a robot"),
    ],
)
def test_a_file_of_another_kind_is_called_what_it_is(tmp_path, text, kind):
    path = write(tmp_path, text)
    with pytest.raises(ScenarioError) as caught:
        Scenario.load(path)
    assert str(caught.value) == f"{path}: this is {kind}, not a scenario"


def test_an_option_of_no_kind_that_is_known_is_one_mistake(tmp_path):
    path = write(tmp_path, "world: {name: warehouse, options: {size: {x: 1}}}\n")
    with pytest.raises(ScenarioError) as caught:
        Scenario.load(path)
    assert str(caught.value) == f"{path}:1:42: world.options.size: must be a single value, or a list of them"


def test_a_yaw_may_be_in_degrees(tmp_path):
    path = write(tmp_path, "world: warehouse\nstart: [1, 2, 90deg]\ngoals: [[1, 2], [3, 4, -45deg]]\n")
    scenario = Scenario.load(path)
    assert scenario.start == pytest.approx((1.0, 2.0, math.pi / 2.0))
    assert scenario.goals[1] == pytest.approx((3.0, 4.0, -math.pi / 4.0))
    assert Scenario.make(world="warehouse", goal=(1, 2, "90 deg")).goal[2] == pytest.approx(math.pi / 2.0)


def test_a_yaw_beyond_a_whole_turn_is_warned_of_with_its_place(tmp_path):
    path = write(tmp_path, "world: warehouse\nstart: [1, 2, 90]\n")
    with pytest.warns(AngleWarning, match=r"scenario.yaml:2:8: start: 90 is more than one turn, .* write 90deg"):
        assert Scenario.load(path).start == (1.0, 2.0, math.remainder(90.0, math.tau))
    with pytest.warns(AngleWarning, match="^goal: 90 is more than one turn"):
        Scenario.make(world="warehouse", goal=(1, 2, 90))


def test_what_is_wrong_beside_such_a_yaw_is_an_error(tmp_path):
    path = write(tmp_path, "world: warehouse\nstart: [0.5, 1.1 1, 90]\n")
    with (
        pytest.warns(AngleWarning),
        pytest.raises(InputError, match=r"scenario\.yaml:2:14: start\.1: must be a number, got '1\.1 1'"),
    ):
        Scenario.load(path)


def test_a_missing_file_is_a_scenario_error(tmp_path):
    with pytest.raises(ScenarioError, match="cannot read"):
        Scenario.load(tmp_path / "none.yaml")


def test_mistakes_in_keywords_are_scenario_errors():
    with pytest.raises(ScenarioError, match="either world or map"):
        Scenario.make(robot="nova_carter")
    with pytest.raises(ScenarioError, match="speed: unknown key"):
        Scenario.make(world="warehouse", speed=3)


def test_paths_are_relative_to_the_file(tmp_path, monkeypatch):
    (tmp_path / "sub").mkdir()
    path = write(tmp_path / "sub", "map: maps/m.yaml\nrobot: ./mine.yaml\n")
    monkeypatch.chdir(tmp_path)
    scenario = Scenario.load("sub/scenario.yaml")
    assert Path(scenario.map) == Path("sub/maps/m.yaml")
    assert Path(scenario.robot) == Path("sub/mine.yaml")
    assert Scenario.load(path).map == str(path.parent / "maps" / "m.yaml")


def test_a_catalogue_robot_is_no_path(tmp_path):
    assert Scenario.load(write(tmp_path, "world: warehouse\nrobot: jackal\n")).robot == "jackal"


@pytest.mark.parametrize(
    "settings",
    [
        {"world": "warehouse"},
        {"world": {"name": "warehouse", "seed": 7, "options": {"aisle_width": 1.4}}, "seed": 3, "time_limit_s": 12.5},
        {"world": "warehouse", "start": (1.0, 2.0, 0.1), "goal": (0.1 + 0.2, 1e-7), "backend": "kinematic"},
        {"world": "warehouse", "goals": ((1.0, 2.0), (3.0, 4.0, -1.5)), "name": "two goals", "inflation_radius": 1.0},
    ],
)
def test_a_saved_scenario_comes_back_as_it_was(tmp_path, settings):
    scenario = Scenario.make(**settings)
    scenario.save(tmp_path / "s.yaml")
    assert Scenario.load(tmp_path / "s.yaml") == scenario


def test_saved_paths_still_lead_to_the_files(tmp_path, monkeypatch):
    (tmp_path / "maps").mkdir()
    (tmp_path / "runs" / "one").mkdir(parents=True)
    (tmp_path / "maps" / "m.yaml").write_text("")
    monkeypatch.chdir(tmp_path)
    Scenario.make(map="maps/m.yaml", robot="mine.yaml").save("runs/one/scenario.yaml")
    text = (tmp_path / "runs" / "one" / "scenario.yaml").read_text()
    assert "../../maps/m.yaml" in text
    again = Scenario.load("runs/one/scenario.yaml")
    assert Path(again.map).samefile("maps/m.yaml")
    assert Path(again.robot).resolve() == (tmp_path / "mine.yaml").resolve()


def test_a_map_from_elsewhere_is_named_in_full(tmp_path, monkeypatch):
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    Scenario.make(map="../m.yaml").save("s.yaml")
    assert Scenario.load("s.yaml").map == str(tmp_path / "m.yaml")


def test_saving_where_there_is_no_folder_is_an_output_error(tmp_path):
    with pytest.raises(OutputError):
        Scenario.make(world="warehouse").save(tmp_path / "none" / "s.yaml")


def test_the_title_names_robot_and_place():
    assert Scenario.make(world="warehouse").title == "nova_carter-warehouse"
    assert Scenario.make(map="maps/office.yaml", robot="robots/mine.yaml").title == "mine-office"
    assert Scenario.make(world="warehouse", name="night shift").title == "night shift"


# Built and run --------------------------------------------------------------------------------------------------------

SMALL = {"world": {"name": "warehouse", "options": {"size": [14, 11]}}, "seed": 5}


@pytest.fixture(scope="module")
def room_yaml(room, tmp_path_factory):
    path = tmp_path_factory.mktemp("maps") / "room.yaml"
    room.save(path)
    return path


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_the_same_scenario_gives_the_same_run_bit_for_bit(backend):
    runs = []
    for _ in range(2):
        with Scenario.make(**SMALL, backend=backend).build() as mission:
            runs.append(mission.run())
    assert runs[0].outcome is Outcome.ARRIVED
    for name in Trajectory.columns():
        assert getattr(runs[0].trajectory, name).tobytes() == getattr(runs[1].trajectory, name).tobytes()


def test_a_second_run_of_one_mission_repeats_the_first():
    with Scenario.make(**SMALL, backend="mujoco").build() as mission:
        first, second = mission.run(), mission.run()
    for name in Trajectory.columns():
        assert getattr(first.trajectory, name).tobytes() == getattr(second.trajectory, name).tobytes()


def test_a_map_is_extruded_and_driven_in(room_yaml):
    scenario = Scenario.make(map=str(room_yaml), start=(1.5, 1.5, 0.0), goal=(6.5, 1.5), backend="mujoco")
    with scenario.build() as mission:
        assert mission.world.solids
        assert mission.scenario == scenario
        assert mission.run().outcome is Outcome.ARRIVED


def test_what_is_picked_stands_in_the_exact_scenario():
    with Scenario.make(**SMALL, backend="kinematic").build() as mission:
        assert mission.scenario.start == mission.start.as_tuple()
        assert mission.scenario.goal == mission.goals[0]
    with Scenario.make(**SMALL, backend="kinematic", goals=[mission.goals[0], mission.goals[0][:2]]).build() as again:
        assert again.goals == (mission.goals[0], mission.goals[0][:2])
        assert again.scenario.goals == again.goals
        assert again.scenario.start is not None


def test_the_worlds_own_seed_comes_before_the_scenarios():
    def layout(seed, world_seed=None):
        world = {"name": "warehouse", "options": {"size": [14, 11]}, "seed": world_seed}
        with Scenario.make(world=world, seed=seed, backend="kinematic").build() as mission:
            return mission.world

    assert layout(5) != layout(6)
    assert layout(5, world_seed=1) == layout(6, world_seed=1)


def test_options_reach_planner_controller_backend_and_costmap(room_yaml):
    common = {"map": str(room_yaml), "backend": "kinematic"}
    with Scenario.make(
        **common, inflation_radius=1.5, cost_scaling_factor=4.0, control_frequency=10.0
    ).build() as built:
        assert built.navigator.costmap.inflation_radius == 1.5
        assert built.navigator.costmap.cost_scaling_factor == 4.0
        assert built.navigator.dt == 0.1
    common["smoother"] = "constrained"
    for choice in ("planner", "controller", "smoother", "backend"):
        bad = {"name": getattr(Scenario.make(**common), choice).name, "options": {"no_such_option": 1}}
        with pytest.raises(InputError, match="no_such_option"):
            Scenario.make(**{**common, choice: bad}).build()


@pytest.mark.parametrize("key", ["robot", "planner", "controller", "backend", "world"])
def test_an_unknown_name_offers_the_nearest(key):
    near = {
        "robot": "nova_cartr",
        "planner": "least_costs",
        "controller": "regulated_pure_persuit",
        "backend": "mujocco",
        "world": "warehose",
    }
    with pytest.raises(UnknownNameError, match="Did you mean"):
        Scenario.make(**{**SMALL, "backend": "kinematic", key: near[key]}).build()


def test_a_start_inside_a_rack_is_bad_input():
    with Scenario.make(**SMALL, backend="kinematic").build() as mission:
        low, high = next(solid for solid in mission.world.solids if solid.name.startswith("rack")).bounds()
        start = ((low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, 0.0)
        with pytest.raises(BlockedPoseError):
            run(mission.sim, mission.navigator, start, mission.goals)


def save_zone(path, value, x0, y0, x1, y1):
    """Write a mask of one zone [m] with cells of 0.2 m."""
    shape = round((y1 - y0) / 0.2), round((x1 - x0) / 0.2)
    OccupancyGrid(np.full(shape, value, dtype=np.int8), 0.2, Pose2D(x0, y0)).save(path, mode="raw")


def test_a_mission_stays_out_of_a_zone_and_within_the_limit_of_another(tmp_path):
    data = np.zeros((160, 240), dtype=np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    OccupancyGrid(data, 0.05).save(tmp_path / "hall.yaml")
    save_zone(tmp_path / "zones.yaml", 100, 3.0, 2.0, 5.0, 6.0)
    save_zone(tmp_path / "limits.yaml", 25, 7.0, 0.0, 9.0, 8.0)
    text = (
        "map: hall.yaml\nkeepout: zones.yaml\nspeed_mask: limits.yaml\nbackend: kinematic\n"
        "start: [1.2, 4, 0]\ngoal: [10.8, 4]\n"
    )
    scenario = Scenario.load(write(tmp_path, text))
    with scenario.build() as mission:
        episode = mission.run()
        limit = 0.25 * mission.robot.limits.linear_speed
    assert episode.outcome is Outcome.ARRIVED
    poses, speeds = episode.trajectory.poses, np.abs(episode.trajectory.v)
    # The zone and nothing else, on finer cells than the navigator's, for every pose of the whole robot.
    zone = np.zeros((800, 1200), dtype=np.int8)
    zone[200:600, 300:500] = 100
    assert not Costmap.from_grid(OccupancyGrid(zone, 0.01), mission.robot, 0.0).footprint_collides(poses).any()
    inside = (poses[:, 0] >= 7.0) & (poses[:, 0] < 9.0)
    assert inside.sum() > 100
    assert speeds[inside].max() <= limit + 1e-6
    assert speeds.max() > 0.7
    scenario.save(tmp_path / "again.yaml")
    assert Scenario.load(tmp_path / "again.yaml").prepare().navigator.speed_mask is not None


def test_a_mask_that_cannot_be_used_is_named(tmp_path):
    save_zone(tmp_path / "far.yaml", 100, 500.0, 0.0, 501.0, 1.0)
    scenario = Scenario.load(write(tmp_path, "world: warehouse\nkeepout: far.yaml\n"))
    with pytest.raises(InputError, match=r"far\.yaml: the mask does not overlap the map"):
        scenario.prepare()
    with pytest.raises(InputError, match=r"none\.yaml"):
        Scenario.make(world="warehouse", speed_mask="none.yaml").prepare()


def test_the_default_time_limit_allows_for_a_speed_mask(tmp_path):
    data = np.zeros((80, 240), dtype=np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    OccupancyGrid(data, 0.05).save(tmp_path / "hall.yaml")
    save_zone(tmp_path / "limits.yaml", 10, 2.0, 0.0, 11.0, 4.0)
    ends = {"start": (1.2, 2.0, 0.0), "goal": (10.8, 2.0), "backend": "kinematic"}
    scenario = Scenario.make(map=str(tmp_path / "hall.yaml"), speed_mask=str(tmp_path / "limits.yaml"), **ends)
    with scenario.build() as mission:
        episode = mission.run()
    # 8.8 m at 0.08 m/s take 110 s, which is more than 60 s and four times 12 s.
    assert episode.outcome is Outcome.ARRIVED
    assert episode.metrics.time_s > 109.0


def test_a_run_has_no_planning_deadline_unless_the_scenario_asks_for_one(tmp_path):
    assert Scenario.make(**SMALL).planning_deadline_s is None
    hasty = Scenario.make(**SMALL, backend="kinematic", planning_deadline_s=1e-9)
    hasty.save(tmp_path / "hasty.yaml")
    assert Scenario.load(tmp_path / "hasty.yaml").planning_deadline_s == 1e-9
    with hasty.build() as mission:
        assert mission.run().outcome is Outcome.PLANNING_TIMED_OUT


def test_a_scenario_has_errors_of_odometry_and_lidars(tmp_path):
    (tmp_path / "run.yaml").write_text(
        "world: maze\nbackend: kinematic\nodometry: {scale: 0.01, heading: 1deg}\nlidar: [front]\n"
    )
    scenario = Scenario.load(tmp_path / "run.yaml")
    assert scenario.odometry.heading == pytest.approx(math.radians(1.0))
    with scenario.build() as mission:
        mission.sim.reset(mission.start, seed=1)
        state = mission.sim.step(Twist2D(0.3, 0.0), 0.05)
    assert state.odometry_twist.v != state.twist.v
    assert [scan.lidar for scan in state.scans] == ["front"]
    scenario.save(tmp_path / "again.yaml")
    assert Scenario.load(tmp_path / "again.yaml") == scenario
    scenario.save_commented(tmp_path / "commented.yaml")
    assert Scenario.load(tmp_path / "commented.yaml") == scenario


def test_lidars_are_given_once():
    with pytest.raises(ScenarioError, match="lidar is given twice"):
        Scenario.make(world="maze", lidar=True, backend={"name": "mujoco", "options": {"lidar": True}})


def test_an_unknown_lidar_of_a_scenario_is_reported():
    with pytest.raises(UnknownNameError, match="unknown lidar of nova_carter 'frnt'"):
        Scenario.make(world="maze", lidar="frnt", backend="kinematic").build()


SENSING = """
world: {name: cylinders, options: {length: 3, density: 0.02}}
backend: kinematic
start: [-1, 0, 0]
goal: [4, 0]
lidar: true
known_map: false
localizer: odometry
odometry: {scale: 0.001}
layers: {obstacle: null}
latency: {scan_age_s: 0.05}
collision_monitor: {min_points: 4}
"""


def test_a_scenario_says_how_the_robot_senses(tmp_path):
    scenario = Scenario.load(write(tmp_path, SENSING))
    assert scenario.localizer == Choice(name="odometry")
    assert scenario.layers.obstacle is None
    assert scenario.latency.scan_age_s == 0.05
    assert scenario.collision_monitor.min_points == 4
    scenario.save(tmp_path / "again.yaml")
    assert Scenario.load(tmp_path / "again.yaml") == scenario
    scenario.save_commented(tmp_path / "commented.yaml")
    assert Scenario.load(tmp_path / "commented.yaml") == scenario


def test_a_robot_without_a_map_starts_with_unknown_space_and_the_same_mission():
    given = {"world": "maze", "backend": "kinematic", "seed": 4}
    known, blank = Scenario.make(**given).prepare(), Scenario.make(**given, lidar=True, known_map=False).prepare()
    assert blank.navigator.grid is None
    assert len(set(blank.navigator.costmap.data.ravel().tolist())) == 1
    assert (known.start, known.goals) == (blank.start, blank.goals)
    assert np.array_equal(blank.grid.data, known.grid.data)


def test_what_stands_between_simulator_and_navigator_is_made_of_the_scenario():
    robot = Robot.load("nova_carter")
    grid = OccupancyGrid(np.zeros((10, 10), np.int8), 0.05)
    given = {"world": "maze", "localizer": "odometry", "latency": {"command_delay_s": 0.1}}
    made = session_options(Scenario.make(**given, collision_monitor={"min_points": 5}), grid, robot)
    assert isinstance(made["localizer"], OdometryLocalizer)
    assert made["latency"].command_delay_s == 0.1
    assert made["monitor"].settings.min_points == 5
    for wanted in (None, True, False):
        assert session_options(Scenario.make(world="maze", collision_monitor=wanted), grid, robot)["monitor"] is wanted


def test_an_unknown_localizer_is_reported():
    grid = OccupancyGrid(np.zeros((10, 10), np.int8), 0.05)
    with pytest.raises(UnknownNameError, match="unknown localizer 'odometri'"):
        session_options(Scenario.make(world="maze", localizer="odometri"), grid, Robot.load("nova_carter"))


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"known_map": False}, "a robot that does not know the map needs lidars"),
        ({"known_map": False, "lidar": True, "keepout": "zones.yaml"}, "areas of a map"),
        ({"latency": {"scan_age_s": 3}}, "scan_age_s"),
        ({"layers": {"obstacl": None}}, "Did you mean 'obstacle'"),
    ],
)
def test_settings_of_sensing_that_cannot_be_used_are_refused(settings, words):
    with pytest.raises(ScenarioError, match=words):
        Scenario.make(world="maze", **settings)


class Recorder:
    """Keeps the steps of a run."""

    def __init__(self):
        self.steps = []

    def on_start(self, run):
        pass

    def on_step(self, step):
        self.steps.append(step)

    def on_end(self, episode):
        pass


def test_a_robot_drives_by_lidar_alone(tmp_path):
    scenario = Scenario.load(write(tmp_path, SENSING.replace("layers: {obstacle: null}\n", "")))
    recorder = Recorder()
    with scenario.build() as mission:
        episode = mission.run(observers=[recorder])
    assert episode.outcome is Outcome.ARRIVED
    assert any(step.scans for step in recorder.steps)
    assert recorder.steps[-1].estimate.pose != recorder.steps[-1].state.pose
    assert episode.metrics.contacts == ()
