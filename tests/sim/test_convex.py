from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
import shapely
import trimesh

from trundle.errors import WorldWarning
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Mesh, Solid
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.sim.convex import FLOOR_TOP, MOST_PLATES, THICKNESS, take_apart
from trundle.sim.mujoco.model import build_spec
from trundle.worlds import World

BACKENDS = ("mujoco", "kinematic")


def solid(shape: trimesh.Trimesh, name: str = "m", pose: Pose3D = Pose3D()) -> Solid:
    return Solid(name, Mesh(shape.vertices, shape.faces), pose)


def pieces(shape: trimesh.Trimesh, pose: Pose3D = Pose3D(), ceiling: float = math.inf):
    return take_apart([solid(shape, pose=pose)], ceiling=ceiling)["m"]


def box(size, x=0.0, y=0.0, z=0.0) -> trimesh.Trimesh:
    return trimesh.creation.box(size, transform=trimesh.transformations.translation_matrix((x, y, z)))


def room() -> trimesh.Trimesh:
    """8 x 6 x 3 m on the floor, seen from inside."""
    made = box((8, 6, 3), z=1.5)
    made.invert()
    return made


def u_shape() -> trimesh.Trimesh:
    """One concave body: a bay that opens towards -x, of walls 0.2 m thick, 1 m wide inside."""
    outer = [(0, -0.7), (1.5, -0.7), (1.5, 0.7), (0, 0.7), (0, 0.5), (1.3, 0.5), (1.3, -0.5), (0, -0.5)]
    count = len(outer)
    vertices = [(x, y, z) for z in (0.0, 1.0) for x, y in outer]
    faces = []
    for i in range(count):
        j = (i + 1) % count
        faces += [(i, j, count + j), (i, count + j, count + i)]
    cap = [(0, 1, 6), (0, 6, 7), (1, 2, 5), (1, 5, 6), (2, 3, 4), (2, 4, 5)]
    faces += [(a + count, b + count, c + count) for a, b, c in cap] + [(c, b, a) for a, b, c in cap]
    return trimesh.Trimesh(vertices, faces, process=False)


@pytest.mark.parametrize("shape", [box((1, 2, 3)), trimesh.creation.icosphere(3), trimesh.creation.cylinder(1, 2)])
def test_a_convex_mesh_is_one_piece(shape):
    found = pieces(shape, Pose3D.from_rpy((1, 2, 3), (0.1, 0.2, 0.3)))
    assert found.whole
    (piece,) = found.hulls
    assert len(piece.corners) == len(shape.vertices)


def test_corners_that_are_there_twice_are_joined():
    soup = box((1, 1, 1))
    soup.unmerge_vertices()
    assert len(soup.vertices) == 36
    assert pieces(soup).whole


def test_parts_that_do_not_touch_are_hulls_of_their_own():
    found = pieces(trimesh.util.concatenate([box((1, 1, 1)), box((1, 1, 1), x=3), trimesh.creation.icosphere(2)]))
    assert not found.whole
    assert sorted(len(piece.corners) for piece in found.hulls) == [8, 8, 162]


def test_a_concave_part_becomes_plates_behind_its_faces():
    shape = u_shape()
    found = pieces(shape)
    # Its bottom is floor.
    assert len(found.hulls) == len(shape.faces) - 6
    corners = np.array([piece.corners for piece in found.hulls])
    depth = np.linalg.norm(corners[:, 3:] - corners[:, :3], axis=2)
    np.testing.assert_allclose(depth, THICKNESS, rtol=1e-9)
    # Half a millimetre behind a face is inside of the body: in one of its three arms.
    arms = [shapely.box(0, -0.7, 1.5, -0.5), shapely.box(0, 0.5, 1.5, 0.7), shapely.box(1.3, -0.7, 1.5, 0.7)]
    body = shapely.union_all(arms)
    assert all(body.contains(shapely.Point(x, y)) for x, y, _ in corners.mean(axis=1))
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    np.testing.assert_allclose((low[:2], high[:2]), ((0, -0.7), (1.5, 0.7)), atol=1e-12)


def test_a_box_that_looks_inward_is_a_room_and_not_a_hull():
    found = pieces(room())
    assert not found.whole
    # Four walls and the ceiling; the floor is floor.
    assert len(found.hulls) == 10
    assert len(pieces(room(), ceiling=2.0).hulls) == 8


def test_an_open_sheet_is_plates():
    sheet = trimesh.Trimesh([(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)], [(0, 1, 2), (0, 2, 3)])
    assert len(pieces(sheet).hulls) == 2


def test_what_ends_at_the_floor_is_left_out():
    assert pieces(box((5, 5, 0.1), z=-0.05)).hulls == []
    assert len(pieces(box((5, 5, 0.1), z=-0.05 + 2 * FLOOR_TOP)).hulls) == 1


def test_a_concave_mesh_of_many_triangles_becomes_boxes_that_hold_it_with_a_word():
    ring = trimesh.creation.torus(2.0, 0.5, major_sections=64, minor_sections=32)
    ring.apply_translation((0, 0, 0.5))
    assert len(ring.faces) > MOST_PLATES
    with pytest.warns(
        WorldWarning, match=r"the mesh 'm' is not convex and has 4096 triangles: .* m³; its faces enclose 9\.\d* m³"
    ):
        found = pieces(ring)
    assert found.boxes == len(found.hulls) > 0
    lows = np.array([piece.corners.min(axis=0) for piece in found.hulls])
    highs = np.array([piece.corners.max(axis=0) for piece in found.hulls])
    for point in ring.sample(200, seed=1):
        assert ((lows <= point + 1e-9) & (point - 1e-9 <= highs)).all(axis=1).any()
    # The hole stays open, but for a cell.
    assert (np.hypot(*((lows + highs) / 2.0)[:, :2].T) > 1.3).all()
    assert np.prod(highs - lows, axis=1).sum() < 1.5 * ring.volume


def test_the_plates_of_a_world_are_limited_together(monkeypatch):
    monkeypatch.setattr("trundle.sim.convex.MOST_TOGETHER", 60)
    solids = [solid(u_shape(), f"bay{i}", Pose3D((4.0 * i, 0.0, 0.0))) for i in range(3)] + [solid(room(), "room")]
    with pytest.warns(WorldWarning) as caught:
        found = take_apart(solids, ceiling=2.0)
    assert {str(one.message).split("'")[1] for one in caught} == {"bay2"}
    assert (found["room"].boxes, found["bay0"].boxes) == (0, 0)
    assert found["bay2"].boxes > 0


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_robot_drives_inside_a_room_and_meets_its_wall(backend):
    world = World("room", (solid(room(), "hall"),))
    with simulate(world, "nova_carter", backend=backend) as sim:
        state = sim.reset(Pose2D(0.0, 0.0))
        assert state.contacts == ()
        front = float(Robot.load("nova_carter").outline[:, 0].max())
        while not state.contacts and state.time < 8.0:
            state = sim.step(Twist2D(0.8, 0.0), 0.05)
        assert state.contacts[0].other == "hall"
        assert len({(contact.part, contact.other) for contact in state.contacts}) == len(state.contacts)
        assert state.pose.x + front == pytest.approx(4.0, abs=0.05)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_robot_drives_into_the_bay_of_a_concave_mesh(backend):
    world = World("bay", (solid(u_shape(), "bay"),))
    with simulate(world, "turtlebot3_burger", backend=backend) as sim:
        state = sim.reset(Pose2D(-0.5, 0.0))
        for _ in range(140):
            state = sim.step(Twist2D(0.22, 0.0), 0.05)
            assert state.contacts == ()
        assert 0.7 < state.pose.x < 1.2
        while not state.contacts and state.time < 12.0:
            state = sim.step(Twist2D(0.22, 0.0), 0.05)
        assert state.contacts[0].other == "bay"


def test_a_slab_whose_top_is_the_floor_is_no_obstacle():
    slab = Solid("slab", Box((9.0, 9.0, 0.2)), Pose3D((0.0, 0.0, -0.1)))
    tiles = solid(trimesh.util.concatenate([box((9, 9, 0.2), y=5, z=-0.1), box((1, 1, 1), x=7)]), "tiles")
    with simulate(World("w", (slab, tiles)), "nova_carter") as sim:
        state = sim.reset(Pose2D(0.0, 0.0))
        for _ in range(20):
            state = sim.step(Twist2D(0.5, 0.5), 0.05)
        assert state.contacts == ()


def test_pictures_show_the_mesh_and_not_its_pieces():
    model = build_spec(World("room", (solid(room(), "hall"),)), Robot.load("nova_carter")).compile()
    groups = {model.geom(i).name: int(model.geom_group[i]) for i in range(model.ngeom)}
    assert groups["hall"] == 0
    assert {group for name, group in groups.items() if name.startswith("hall / piece")} == {3}
    assert model.geom_conaffinity[model.geom("hall").id] == 0
    assert model.geom_type[model.geom("hall").id] == mujoco.mjtGeom.mjGEOM_MESH
