"""A world whose only floor is a level plane that is not at z = 0, in every format and verb."""

import pytest

from trundle.mission import Scenario
from trundle.worlds import World

HEIGHTS = [-0.5, 0.3]

BOXES = {"wall": ((4.0, 0.0, 1.0), (0.2, 6.0, 2.0)), "rail": ((0.0, -2.8, 0.075), (8.0, 0.1, 0.15))}
"""Over the floor: middles and sizes [m]. The rail is in Nova Carter's band of heights, and ends where it does."""


def sdf_text(height, ground):
    shapes = "".join(
        f"<collision name='{name}'><pose>{x} {y} {z + height} 0 0 0</pose>"
        f"<geometry><box><size>{a} {b} {c}</size></box></geometry></collision>"
        for name, ((x, y, z), (a, b, c)) in BOXES.items()
    )
    return (
        f"<sdf version='1.9'><world name='hall'>{ground}"
        f"<model name='hall'><static>1</static><link name='l'>{shapes}</link></model></world></sdf>"
    )


def sdf_plane(height):
    return sdf_text(
        height,
        f"<model name='g'><static>1</static><pose>0 0 {height} 0 0 0</pose><link name='l'><collision name='c'>"
        "<geometry><plane><normal>0 0 1</normal><size>20 20</size></plane></geometry></collision></link></model>",
    )


def sdf_include(height):
    return sdf_text(height, f"<include><uri>model://ground_plane</uri><pose>0 0 {height} 0 0 0</pose></include>")


def mjcf(height, size="0 0 1"):
    geoms = "".join(
        f"<geom name='{name}' type='box' pos='{x} {y} {z + height}' size='{a / 2} {b / 2} {c / 2}'/>"
        for name, ((x, y, z), (a, b, c)) in BOXES.items()
    )
    plane = f"<geom name='floor' type='plane' size='{size}' pos='0 0 {height}'/>"
    return f"<mujoco model='hall'><worldbody>{plane}{geoms}</worldbody></mujoco>"


def usd(height):
    cubes = "".join(
        f'    def Cube "{name}" (prepend apiSchemas = ["PhysicsCollisionAPI"])\n    {{\n        double size = 1\n'
        f"        double3 xformOp:translate = {(x, y, z + height)}\n        float3 xformOp:scale = {size}\n"
        '        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]\n    }\n'
        for name, ((x, y, z), size) in BOXES.items()
    )
    plane = (
        '    def Plane "ground" (prepend apiSchemas = ["PhysicsCollisionAPI"])\n    {\n'
        '        uniform token axis = "Z"\n        double width = 20\n        double length = 20\n'
        f"        double3 xformOp:translate = (0, 0, {height})\n"
        '        uniform token[] xformOpOrder = ["xformOp:translate"]\n    }\n'
    )
    return f'#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = "Z"\n)\ndef Xform "hall"\n{{\n{plane}{cubes}}}\n'


FILES = {
    "plane": ("hall.sdf", sdf_plane),
    "include": ("hall.world", sdf_include),
    "endless": ("hall.xml", mjcf),
    "sized": ("sized.xml", lambda height: mjcf(height, "10 10 1")),
    "usd": ("hall.usda", usd),
}


@pytest.fixture(params=list(FILES))
def write(request, tmp_path):
    """Write a world with its floor at a height."""
    if request.param == "usd":
        pytest.importorskip("pxr")
    name, text = FILES[request.param]

    def make(height):
        (tmp_path / name).write_text(text(height))
        return tmp_path / name

    return make


@pytest.fixture
def hall(tmp_path):
    """Write an SDF world with its floor at a height."""

    def make(height):
        (tmp_path / "hall.sdf").write_text(sdf_plane(height))
        return tmp_path / "hall.sdf"

    return make


@pytest.mark.parametrize("height", HEIGHTS)
def test_the_plane_is_the_ground_and_no_solid(write, height):
    world = World.load(write(height))
    assert world.ground_z == pytest.approx(height)
    assert len(world.solids) == len(BOXES)


@pytest.mark.slow
@pytest.mark.parametrize("height", HEIGHTS)
def test_a_robot_drives_on_the_plane(write, height):
    scenario = Scenario.make(world=str(write(height)), start=(-2.5, 0.0, 0.0), goal=(1.0, 0.5), backend="kinematic")
    setting = scenario.prepare()
    assert setting.scenario.floor_z == pytest.approx(height)
    assert setting.world.bounds[0][2] == pytest.approx(0.0, abs=1e-6)
    row, col = setting.grid.world_to_cell(0.0, -2.8)
    assert setting.grid.data[row, col] == 100
    # The map is as large as the solids and not as the plane.
    assert setting.grid.data.shape == (120, 162)
    with scenario.build() as mission:
        assert mission.run().outcome == "arrived"


@pytest.mark.parametrize("height", HEIGHTS)
def test_a_robot_drives_in_mujoco_as_over_zero(hall, height):
    ends = {"start": (-2.5, 0.0, 0.0), "goal": (1.0, 0.5)}
    with Scenario.make(world=str(hall(height)), **ends).build() as mission:
        episode = mission.run()
    with Scenario.make(world=str(hall(0.0)), **ends).build() as mission:
        level = mission.run()
    assert mission.scenario.floor_z is None
    assert episode.outcome == level.outcome == "arrived"
    assert episode.metrics.time_s == level.metrics.time_s
