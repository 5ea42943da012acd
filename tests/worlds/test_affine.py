import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, Solid, Sphere
from trundle.worlds.affine import FlattenedError, place, pose_of, split
from trundle.worlds.tessellate import (
    as_mesh,
    box_mesh,
    capsule_mesh,
    cone_mesh,
    cylinder_mesh,
    frustum_mesh,
    sphere_mesh,
)

TURN = Pose3D(quaternion=(0.3, -0.5, 0.7, 0.2)).rotation()
SHEAR = np.array([[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


def affine(linear: np.ndarray, position=(1.0, 2.0, 3.0)) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, position
    return matrix


def volume(mesh: Mesh) -> float:
    """Positive where faces look outwards."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return float((np.cross(a, b) * c).sum() / 6.0)


def is_closed(mesh: Mesh) -> bool:
    edges = {(int(a), int(b)) for face in mesh.faces for a, b in zip(face, np.roll(face, -1), strict=True)}
    return len(edges) == 3 * len(mesh.faces) and all((b, a) in edges for a, b in edges)


@given(st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: sum(n * n for n in q) > 1e-3))
def test_a_rotation_becomes_its_quaternion(quaternion):
    rotation = Pose3D(quaternion=quaternion).rotation()
    np.testing.assert_allclose(pose_of(np.zeros(3), rotation).rotation(), rotation, atol=1e-12)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1)])
def test_half_turns_have_their_quaternion(axis):
    rotation = Pose3D(quaternion=(0.0, *axis)).rotation()
    np.testing.assert_allclose(pose_of(np.zeros(3), rotation).rotation(), rotation, atol=1e-15)


def test_a_scaled_rotation_splits_and_a_mirror_is_in_the_last_scale():
    rotation, scales = split(TURN @ np.diag([2.0, 3.0, 4.0]))
    np.testing.assert_allclose(rotation, TURN)
    np.testing.assert_allclose(scales, [2.0, 3.0, 4.0])
    rotation, scales = split(TURN @ np.diag([-2.0, 3.0, 4.0]))
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    np.testing.assert_allclose(rotation @ np.diag(scales), TURN @ np.diag([-2.0, 3.0, 4.0]), atol=1e-12)


def test_shear_and_flattening_do_not_split():
    assert split(SHEAR) is None
    assert split(np.diag([1.0, 1.0, 0.0])) is None


def test_a_box_stays_one_under_any_scale_of_its_axes():
    shape, pose = place(Box((1.0, 2.0, 3.0)), affine(TURN @ np.diag([2.0, -3.0, 4.0])))
    assert isinstance(shape, Box)
    assert shape.size == pytest.approx((2.0, 6.0, 12.0))
    assert pose.position == (1.0, 2.0, 3.0)


@pytest.mark.parametrize("shape", [Sphere(0.5), Cylinder(0.5, 2.0)])
def test_a_round_shape_stays_one_under_one_scale(shape):
    scaled, _ = place(shape, affine(TURN * 2.0))
    assert type(scaled) is type(shape)
    assert scaled.radius == pytest.approx(1.0)


def test_a_cylinder_stays_one_under_a_scale_of_its_length_alone():
    shape, _ = place(Cylinder(0.5, 2.0), affine(np.diag([1.0, 1.0, 3.0])))
    assert shape == Cylinder(0.5, 6.0)


@pytest.mark.parametrize(
    ("shape", "linear"),
    [
        (Sphere(0.5), np.diag([1.0, 2.0, 1.0])),
        (Cylinder(0.5, 2.0), np.diag([1.0, 2.0, 1.0])),
        (Box((1.0, 1.0, 1.0)), SHEAR),
        (Sphere(0.5), SHEAR),
        (Cylinder(0.5, 2.0), -SHEAR),
    ],
)
def test_what_is_no_longer_its_shape_becomes_a_mesh_of_the_same_extent(shape, linear):
    mesh, pose = place(shape, affine(linear))
    assert isinstance(mesh, Mesh)
    assert is_closed(mesh)
    assert volume(mesh) == pytest.approx(volume(as_mesh(shape)) * abs(np.linalg.det(linear)))
    reach = np.linalg.norm(linear * 0.5, axis=1) if isinstance(shape, Sphere) else None
    if reach is not None:
        low, high = Solid("it", mesh, pose).bounds()
        np.testing.assert_allclose((high - low) / 2.0, reach, rtol=5e-3)
        np.testing.assert_allclose((high + low) / 2.0, (1.0, 2.0, 3.0), atol=1e-12)


@pytest.mark.parametrize("linear", [np.diag([-1.0, 1.0, 1.0]), -np.eye(3), SHEAR @ np.diag([1.0, -1.0, 1.0])])
def test_a_mirrored_mesh_keeps_its_faces_outwards(linear):
    wedge = frustum_mesh(1.0, 0.3, 2.0)
    mesh, pose = place(wedge, affine(linear))
    assert volume(mesh) == pytest.approx(volume(wedge))
    placed, expected = pose.transform_points(mesh.vertices), wedge.vertices @ linear.T + (1.0, 2.0, 3.0)
    np.testing.assert_allclose(np.sort(placed, axis=0), np.sort(expected, axis=0), atol=1e-12)


def test_a_flattened_box_keeps_its_area_and_a_line_is_refused():
    mesh, _ = place(Box((1.0, 1.0, 1.0)), affine(np.diag([2.0, 3.0, 0.0])))
    assert np.ptp(mesh.vertices, axis=0) == pytest.approx((2.0, 3.0, 0.0))
    with pytest.raises(FlattenedError, match="scale of 0"):
        place(Box((1.0, 1.0, 1.0)), affine(np.diag([2.0, 0.0, 0.0])))


@pytest.mark.parametrize(
    ("mesh", "expected"),
    [
        (box_mesh((1.0, 2.0, 3.0)), 6.0),
        (cylinder_mesh(0.5, 2.0), np.pi * 0.5),
        (cone_mesh(0.5, 2.0), np.pi * 0.5 / 3.0),
        (frustum_mesh(1.0, 0.5, 3.0), np.pi * (1.0 + 0.5 + 0.25)),
        (sphere_mesh(0.5), np.pi / 6.0),
        (capsule_mesh(0.5, 2.0), np.pi * (0.5 + 1.0 / 6.0)),
    ],
)
def test_tessellations_are_closed_and_hardly_larger_than_their_shape(mesh, expected):
    assert is_closed(mesh)
    assert expected * (1.0 - 1e-12) <= volume(mesh) <= expected * 1.005


def test_the_tessellated_ball_holds_the_ball():
    a, b, c = np.moveaxis(sphere_mesh(1.0).vertices[sphere_mesh(1.0).faces], 1, 0)
    normals = np.cross(b - a, c - a)
    distances = (normals * a).sum(axis=1) / np.linalg.norm(normals, axis=1)
    assert distances.min() >= 1.0 - 1e-12
