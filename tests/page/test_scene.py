import base64
import io
import json

import numpy as np
import pytest
from PIL import Image

from trundle.errors import WorldError
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.maps import OccupancyGrid
from trundle.page import costmap_png, grid_png, scene_of
from trundle.page.encoding import unpack_array
from trundle.page.scene import boxes_of, solid_instances
from trundle.robots import Robot, robot_names
from trundle.worlds import World
from trundle.worlds.movers import Crowd, Mover, Waypoints
from trundle.worlds.movers.mover import person_body

TETRAHEDRON = Mesh(
    np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]),
    np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]),
)
TURNED = Pose3D.planar(1.0, 2.0, 0.5, yaw=0.7)


def pixels(picture):
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(picture["png"]))))


def instance(scene, shape):
    return next(one for one in scene["instances"] if one["shape"] == shape)


def test_every_kind_of_solid_is_in_the_scene(carter):
    cells = OccupancyCells(np.array([[True, True], [False, True]]), 0.5, 1.2)
    world = World(
        "all",
        (
            Solid("box", Box((1.0, 2.0, 3.0)), TURNED, (1.0, 0.0, 0.0, 1.0), "wall"),
            Solid("cylinder", Cylinder(0.4, 1.5), TURNED, (0.0, 1.0, 0.0, 0.5)),
            Solid("sphere", Sphere(0.3), TURNED),
            Solid("mesh", TETRAHEDRON, TURNED, (0.0, 0.0, 1.0, 1.0)),
            Solid("cells", cells, Pose3D.planar(5.0, 5.0)),
        ),
    )
    scene = json.loads(json.dumps(scene_of(world, carter), allow_nan=False))
    assert scene["name"] == "all"
    assert scene["map"] is None
    boxes = instance(scene, "box")
    pose, size = unpack_array(boxes["pose"]), unpack_array(boxes["size"])
    assert len(pose) == 3  # and the cells as two boxes
    np.testing.assert_allclose(pose[0], [*TURNED.position, *TURNED.quaternion], rtol=1e-6)
    np.testing.assert_allclose(size[0], (1.0, 2.0, 3.0))
    assert unpack_array(boxes["color"])[0].tolist() == [255, 0, 0, 255]
    assert unpack_array(boxes["wall"]).tolist() == [1, 1, 1]
    assert unpack_array(instance(scene, "cylinder")["size"]).tolist() == [pytest.approx([0.4, 0.4, 1.5])]
    assert unpack_array(instance(scene, "cylinder")["color"]).tolist() == [[0, 255, 0, 128]]
    assert unpack_array(instance(scene, "sphere")["size"]).tolist() == [pytest.approx([0.3, 0.3, 0.3])]
    (mesh,) = scene["meshes"]
    assert mesh["color"] == [0, 0, 255, 255]
    np.testing.assert_allclose(
        unpack_array(mesh["vertices"]), TURNED.transform_points(TETRAHEDRON.vertices), rtol=1e-6, atol=1e-6
    )
    assert unpack_array(mesh["triangles"]).tolist() == TETRAHEDRON.faces.tolist()
    low, high = world.bounds
    assert scene["bounds"] == pytest.approx([*low, *high], abs=1e-3)


def test_meshes_of_one_colour_are_one(carter):
    solids = [Solid(f"{n}", TETRAHEDRON, Pose3D.planar(float(n), 0.0), (0.5, 0.5, 0.5, 1.0)) for n in range(3)]
    (mesh,) = scene_of(World("meshes", tuple(solids)), carter)["meshes"]
    triangles = unpack_array(mesh["triangles"])
    assert triangles.shape == (12, 3)
    assert triangles.max() == 11


def test_many_colours_take_few_draw_calls(carter):
    solids = tuple(
        Solid(f"{n}", TETRAHEDRON, Pose3D.planar(float(n), 0.0), (n % 7 / 7, n % 11 / 11, n % 13 / 13, 1.0))
        for n in range(900)
    )
    assert 1 < len(scene_of(World("colours", solids), carter)["meshes"]) <= 40


def test_the_largest_meshes_become_boxes_where_they_do_not_fit(carter):
    fine = Mesh(np.tile(TETRAHEDRON.vertices, (500, 1)), np.tile(TETRAHEDRON.faces, (500, 1)))
    world = World("large", (Solid("fine", fine, TURNED), Solid("coarse", TETRAHEDRON, Pose3D.planar(9.0, 0.0))))
    scene = scene_of(world, carter, most_bytes=20_000)
    assert len(unpack_array(scene["meshes"][0]["triangles"])) == 4
    low, high = world.solids[0].bounds()
    np.testing.assert_allclose(unpack_array(instance(scene, "box")["size"])[0], high - low, rtol=1e-6)
    assert scene["note"] == "1 of 2 solids are drawn as boxes: their meshes are too large to send"
    assert scene_of(world, carter)["note"] == ""


def test_a_scene_too_large_to_send_says_so(carter):
    world = World("huge", tuple(Solid(f"{n}", Sphere(0.1)) for n in range(1000)))
    with pytest.raises(WorldError, match=r"world 'huge' is too large to send: 1000 solids take 0 MB, and the most"):
        scene_of(world, carter, most_bytes=10_000)


@pytest.mark.parametrize("seed", range(3))
def test_boxes_cover_exactly_the_blocked_cells(seed):
    blocked = np.random.default_rng(seed).random((17, 23)) < 0.4
    covered = np.zeros(blocked.shape, dtype=int)
    for x, y, width, depth in boxes_of(OccupancyCells(blocked, 1.0, 1.0)):
        covered[round(y - depth / 2) : round(y + depth / 2), round(x - width / 2) : round(x + width / 2)] += 1
    np.testing.assert_array_equal(covered, blocked)


def test_a_map_of_many_pieces_gets_larger_cells(monkeypatch):
    monkeypatch.setattr("trundle.page.scene.MOST_BOXES", 20)
    blocked = np.zeros((21, 21), dtype=bool)
    blocked[::2, ::2] = True
    boxes = boxes_of(OccupancyCells(blocked, 0.1, 1.0))
    assert len(boxes) <= 20
    assert boxes[:, 0].max() + boxes[0, 2] / 2 >= 2.1 - 1e-9


@pytest.mark.parametrize("name", robot_names())
def test_robots_have_turning_wheels(name):
    robot = Robot.load(name)
    look = scene_of(None, robot)["robot"]
    sides = [part["wheel"] for part in look["parts"]]
    assert {"left", "right", None} == set(sides)
    for part in look["parts"]:
        if part["wheel"] is not None:  # each turns about its own middle, which is on the axle
            assert part["pose"][2] == pytest.approx(robot.drive.wheel_radius, abs=1e-4)
            assert (part["pose"][1] > 0) == (part["wheel"] == "left")
            assert part["axis"] == [0, 1, 0]
        if part["shape"] == "mesh":
            assert unpack_array(part["triangles"]).max() < len(unpack_array(part["vertices"]))
    top = max(part["pose"][2] for part in look["parts"])
    assert 0.0 < top <= robot.body.height + 0.05
    assert look["limits"]["v_min"] <= 0.0 < look["limits"]["v"]
    assert [lidar["name"] for lidar in look["lidars"]] == list(robot.lidars)


def test_movers_and_crowds_are_in_the_scene(carter):
    mover = Mover("cart", person_body(), Waypoints(((0.0, 0.0, 0.0), (2.0, 1.0, 0.0))), kind="person")
    scene = scene_of(World("busy", (), movers=(mover, Crowd("people", 3))), carter)
    assert [one["name"] for one in scene["movers"]] == ["cart", "people_1", "people_2", "people_3"]
    assert {part["shape"] for part in scene["movers"][0]["instances"]} == {"cylinder", "sphere"}


def test_a_solid_that_is_dropped_is_one_instance():
    (boxes,) = solid_instances([Solid("dropped", Box((0.4, 0.5, 0.6)), TURNED)])
    np.testing.assert_allclose(unpack_array(boxes["size"]), [(0.4, 0.5, 0.6)], rtol=1e-6)


def test_twenty_thousand_solids_are_few_draw_calls(carter):
    shapes = (Box((0.1, 0.2, 0.3)), Cylinder(0.1, 0.3), Sphere(0.2))
    solids = tuple(Solid(f"{n}", shapes[n % 3], Pose3D.planar(n / 100.0, 0.0)) for n in range(20_000))
    scene = scene_of(World("many", solids), carter)
    assert len(scene["instances"]) + len(scene["meshes"]) == 3
    assert len(json.dumps(scene)) < 2_000_000


def test_a_map_is_a_grey_picture_with_its_first_row_at_the_bottom():
    grid = OccupancyGrid(np.array([[0, 100], [-1, 50], [0, 0]]), 0.1, Pose2D(1.0, 2.0, 0.3))
    picture = grid_png(grid)
    assert pixels(picture).tolist() == [[254, 254], [205, 127], [254, 0]]
    assert (picture["width"], picture["height"], picture["resolution"]) == (2, 3, 0.1)
    assert picture["origin"] == [1.0, 2.0, 0.3]


def test_a_large_map_keeps_what_is_occupied(monkeypatch):
    monkeypatch.setattr("trundle.page.encoding._MOST_CELLS", 4)
    cells = np.zeros((5, 4), dtype=np.int8)
    cells[4, 3] = 100
    picture = grid_png(OccupancyGrid(cells, 0.1))
    assert (picture["width"], picture["height"]) == (2, 2)
    assert picture["resolution"] == pytest.approx(0.3)
    assert pixels(picture).tolist() == [[254, 0], [254, 254]]


def test_a_costmap_is_a_picture_of_its_costs(carter, hall):
    from trundle.costmap import Costmap

    costmap = Costmap.from_grid(OccupancyGrid.from_world(hall), carter)
    np.testing.assert_array_equal(pixels(costmap_png(costmap)), costmap.data[::-1])


def test_unknown_cells_of_a_costmap_are_unknown_even_where_the_robot_may_drive(carter):
    from trundle.costmap import Costmap

    cells = np.full((40, 40), -1, dtype=np.int8)
    cells[:, :20] = 0
    cells[20, 30] = 100
    costmap = Costmap.from_grid(OccupancyGrid(cells, 0.05), carter, unknown="costly")
    shown = pixels(costmap_png(costmap))[::-1]
    assert shown[20, 30] == 254
    assert shown[39, 39] == 255
    np.testing.assert_array_equal(shown[:, :20], costmap.data[:, :20])


def test_walls_of_a_map_are_sent_with_tops_and_unknown_cells_as_a_plate(carter):
    data = np.zeros((40, 60), dtype=np.int8)
    data[0], data[20:24, 20:24], data[:, 50:] = 100, 100, -1
    world = World.from_map(OccupancyGrid(data, 0.1))
    scene = scene_of(world, carter)
    boxes = instance(scene, "box")
    rows = dict(zip([solid.name for solid in world.solids], unpack_array(boxes["size"])[:, 2].tolist(), strict=True))
    walls = dict(zip(rows, unpack_array(boxes["wall"]).tolist(), strict=True))
    assert (rows["map[0:1,0:50]"], walls["map[0:1,0:50]"]) == (pytest.approx(1.2), 2)
    assert (rows["map[20:24,20:24]"], walls["map[20:24,20:24]"]) == (pytest.approx(1.0), 1)
    assert rows["map[0:40,50:60]"] < 0.1
    assert scene["bounds"][3] == pytest.approx(5.0)
