"""A world whose floor is the top of a slab at 0.034 m, in every format and verb."""

import numpy as np
import pytest

import trundle
from trundle.errors import ScenarioError, WorldError
from trundle.mission import Scenario

TOP = 0.034

SDF = """<sdf version="1.9"><world name="hall"><model name="hall"><static>true</static><link name="link">
  <collision name="slab"><pose>0 0 -0.066 0 0 0</pose><geometry><box><size>8 6 0.2</size></box></geometry></collision>
  <collision name="wall"><pose>4 0 0.5 0 0 0</pose><geometry><box><size>0.2 6 2</size></box></geometry></collision>
  <collision name="crate"><pose>0 2.5 0.284 0 0 0</pose><geometry><box><size>1 1 0.5</size></box></geometry></collision>
  <collision name="rail"><pose>0 -2.8 0.109 0 0 0</pose>
    <geometry><box><size>8 0.1 0.15</size></box></geometry></collision>
</link></model></world></sdf>"""

MJCF = """<mujoco model="hall"><worldbody>
  <geom name="slab" type="box" pos="0 0 -0.066" size="4 3 0.1"/>
  <geom name="wall" type="box" pos="4 0 0.5" size="0.1 3 1"/>
  <geom name="crate" type="box" pos="0 2.5 0.284" size="0.5 0.5 0.25"/>
  <geom name="rail" type="box" pos="0 -2.8 0.109" size="4 0.05 0.075"/>
</worldbody></mujoco>"""

BOXES = {
    "slab": ((0.0, 0.0, -0.066), (8.0, 6.0, 0.2)),
    "wall": ((4.0, 0.0, 0.5), (0.2, 6.0, 2.0)),
    "crate": ((0.0, 2.5, 0.284), (1.0, 1.0, 0.5)),
    "rail": ((0.0, -2.8, 0.109), (8.0, 0.1, 0.15)),
}


def obj_text():
    """The same boxes as a mesh file."""
    lines, first = [], 1
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    for name, (middle, size) in BOXES.items():
        lines.append(f"o {name}")
        for z in (-0.5, 0.5):
            for y in (-0.5, 0.5):
                for x in (-0.5, 0.5):
                    corner = [m + s * u for m, s, u in zip(middle, size, (x, y, z), strict=True)]
                    lines += ["v " + " ".join(map(str, corner))]
        lines += ["f " + " ".join(str(first + corner) for corner in quad) for quad in quads]
        first += 8
    return "\n".join(lines) + "\n"


def usd_text():
    cubes = [
        f'    def Cube "{name}" (prepend apiSchemas = ["PhysicsCollisionAPI"])\n    {{\n        double size = 1\n'
        f"        double3 xformOp:translate = {middle}\n        float3 xformOp:scale = {size}\n"
        '        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]\n    }\n'
        for name, (middle, size) in BOXES.items()
    ]
    return '#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = "Z"\n)\ndef Xform "hall"\n{\n' + "".join(cubes) + "}\n"


@pytest.fixture(params=["sdf", "xml", "obj", "usda"])
def hall(request, tmp_path):
    if request.param == "usda":
        pytest.importorskip("pxr")
    if request.param == "obj":
        pytest.importorskip("trimesh")
    path = tmp_path / f"hall.{request.param}"
    path.write_text({"sdf": SDF, "xml": MJCF, "obj": obj_text(), "usda": usd_text()}[request.param])
    return path


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["mujoco", "kinematic"])
def test_a_robot_drives_on_a_slab(hall, backend):
    scenario = Scenario.make(world=str(hall), start=(-2.5, 0.0, 0.0), goal=(2.0, 0.5), backend=backend)
    with scenario.build() as mission:
        assert mission.scenario.floor_z == pytest.approx(TOP)
        episode = mission.run()
    assert episode.outcome == "arrived"


@pytest.mark.slow
def test_the_map_is_measured_from_the_floor(hall):
    setting = Scenario.make(world=str(hall), start=(-2.5, 0.0), goal=(2.0, 0.5)).prepare()
    # Over the floor the rail ends at 0.15 m: within Nova Carter's band from 0.10 m. The slab is under all of it.
    row, col = setting.grid.world_to_cell(0.0, -2.8)
    assert setting.grid.data[row, col] == 100
    row, col = setting.grid.world_to_cell(0.0, 0.0)
    assert setting.grid.data[row, col] == 0


@pytest.mark.slow
def test_a_world_is_loaded_with_its_floor_at_zero(hall):
    world = trundle.World.load(hall, floor_z=TOP)
    assert max(solid.bounds()[1][2] for solid in world.solids if "slab" in solid.name) == pytest.approx(0.0, abs=1e-6)
    with trundle.simulate(world, "nova_carter") as sim:
        assert sim.reset(trundle.Pose2D(-2.5, 0.0)).contacts == ()
    grid = trundle.OccupancyGrid.from_world(trundle.World.load(hall), floor_z=TOP)
    assert np.array_equal(grid.data, trundle.OccupancyGrid.from_world(world).data)


def test_a_wrong_floor_is_a_contact_whose_hint_names_the_option(tmp_path):
    (tmp_path / "hall.sdf").write_text(SDF)
    scenario = Scenario.make(world=str(tmp_path / "hall.sdf"), floor_z=0.0, start=(-2.5, 0.0), goal=(2.0, 0.5))
    with scenario.build() as mission:
        episode = mission.run()
    assert episode.outcome == "collided"
    assert "hall/slab" in episode.message or "slab" in episode.message
    assert "--floor-z" in episode.message


def test_a_scenario_keeps_the_floor_that_was_found(tmp_path):
    (tmp_path / "hall.sdf").write_text(SDF)
    exact = Scenario.make(world=str(tmp_path / "hall.sdf"), start=(-2.5, 0.0), goal=(2.0, 0.5)).prepare().scenario
    exact.save(tmp_path / "exact.yaml")
    assert Scenario.load(tmp_path / "exact.yaml").floor_z == pytest.approx(TOP)


def test_without_a_start_the_floor_under_most_of_the_world_counts(tmp_path):
    (tmp_path / "hall.sdf").write_text(SDF)
    setting = Scenario.make(world=str(tmp_path / "hall.sdf"), seed=3, robot="turtlebot3_burger").prepare()
    assert setting.scenario.floor_z == pytest.approx(TOP)


def test_two_floors_are_asked_for(tmp_path):
    upper = SDF.replace(
        "</link>",
        '<collision name="upper"><pose>0 0 1.2 0 0 0</pose><geometry><box><size>8 6 0.1</size>'
        "</box></geometry></collision></link>",
    )
    (tmp_path / "hall.sdf").write_text(upper)
    settings = {"world": str(tmp_path / "hall.sdf"), "start": (-2.5, 0.0), "goal": (2.0, 0.5)}
    with pytest.raises(WorldError, match=r"0\.034, 1\.250 m.*--floor-z"):
        Scenario.make(**settings).prepare()
    assert Scenario.make(**settings, floor_z=TOP).prepare().scenario.floor_z == TOP


def test_a_floor_needs_a_world():
    with pytest.raises(ScenarioError, match="floor_z"):
        Scenario.make(map="map.yaml", floor_z=0.1)
