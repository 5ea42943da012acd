import math

import mujoco
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from support.beams_oracle import cast_cells, cast_slowly
from trundle._core import cast_grid_rays, cast_outline_rays
from trundle.errors import UnknownNameError
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.robots import Lidar, Robot
from trundle.sim import simulate
from trundle.sim.beams import WorldOutline
from trundle.sim.footprint import CellField
from trundle.sim.lidar import beam_angles
from trundle.sim.mujoco.model import build_spec
from trundle.worlds import World

BACKENDS = ["kinematic", "mujoco"]
ROOM = World(
    "room",
    (
        Solid("north", Box((8.0, 0.1, 1.0)), Pose3D((0.0, 3.0, 0.5))),
        Solid("east", Box((0.1, 6.0, 1.0)), Pose3D((4.0, 0.0, 0.5))),
        Solid("turned", Box((0.6, 0.3, 1.0)), Pose3D.planar(1.5, 1.5, 0.5, 0.7)),
        Solid("post", Cylinder(0.2, 1.0), Pose3D((2.0, -1.0, 0.5))),
        Solid("ball", Sphere(0.5), Pose3D((-2.0, 1.0, 0.3))),
        Solid("leaning", Box((0.2, 0.2, 3.0)), Pose3D((-1.0, -2.0, 0.5), (0.9, 0.3, 0.1, 0.2))),
        Solid("roll", Cylinder(0.5, 2.0), Pose3D((-3.0, -1.0, 0.5), (0.6, 0.8, 0.1, 0.0))),
        Solid(
            "pyramid",
            Mesh(
                np.array([[0.5, 0.5, 0], [-0.5, 0.5, 0], [-0.5, -0.5, 0], [0.5, -0.5, 0], [0, 0, 1.0]]),
                np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [0, 2, 1], [0, 3, 2]]),
            ),
            Pose3D.planar(0.0, -2.5, 0.0, 0.4),
        ),
        Solid("cells", OccupancyCells(np.eye(12, dtype=bool), 0.1, 1.0), Pose3D.planar(2.5, 1.0, 0.0, -0.3)),
    ),
)


def robot_with(**changes):
    robot = Robot.load("nova_carter")
    lidar = robot.lidars["front"].model_copy(update=changes)
    return robot.model_copy(update={"lidars": {"front": lidar}})


def scan(backend, world, pose=Pose2D(0.0, 0.0), *, seed=0, **changes):
    with simulate(world, robot_with(**changes), backend=backend, lidar=True) as simulator:
        (result,) = simulator.reset(pose, seed=seed).scans
        return result


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_wall_ahead_is_the_distance_over_the_cosine(backend):
    world = World("wall", (Solid("wall", Box((0.2, 100.0, 2.0)), Pose3D((5.1, 0.0, 1.0))),))
    result = scan(backend, world, x=0.0, yaw=0.0, range_max=8.0)
    expected = 5.0 / np.cos(result.angles)
    expected[(np.cos(result.angles) <= 0.0) | (expected > 8.0)] = np.inf
    assert np.isfinite(expected).any()
    np.testing.assert_allclose(result.ranges, expected, atol=1e-9)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_post_is_met_at_its_skin(backend):
    world = World("post", (Solid("post", Cylinder(0.5, 2.0), Pose3D((0.0, 4.0, 1.0))),))
    result = scan(backend, world, x=0.0, yaw=math.pi / 2.0)
    assert result.ranges[360] == pytest.approx(3.5)
    seen = np.count_nonzero(np.isfinite(result.ranges)) * 2.0 * math.pi / 720
    assert seen == pytest.approx(2.0 * math.asin(0.5 / 4.0), abs=0.01)


@pytest.mark.parametrize("height", [0.1, 0.418, 0.6])
def test_both_simulators_read_the_same(height):
    poses = [Pose2D(0.0, 0.0, 0.3), Pose2D(1.0, 0.2, -2.0), Pose2D(-1.2, -0.5, 1.5)]
    for pose in poses:
        exact, engine = (scan(backend, ROOM, pose, z=height).ranges for backend in BACKENDS)
        both = np.isfinite(exact) & np.isfinite(engine)
        assert np.count_nonzero(both) > 200
        # A beam that grazes a corner may meet it in one and pass it in the other.
        apart = np.abs(exact[both] - engine[both]) > 0.002
        assert np.count_nonzero(apart) + np.count_nonzero(np.isfinite(exact) != np.isfinite(engine)) <= 3


@pytest.mark.parametrize("backend", BACKENDS)
def test_noise_is_the_seeds(backend):
    quiet = scan(backend, ROOM).ranges
    first, again, other = (scan(backend, ROOM, seed=seed, noise=0.02).ranges for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
    hit = np.isfinite(quiet)
    assert np.array_equal(hit, np.isfinite(first))
    assert (first[hit] - quiet[hit]).std() == pytest.approx(0.02, rel=0.2)


@pytest.mark.parametrize("backend", BACKENDS)
def test_ranges_stay_between_the_sensors_bounds(backend):
    result = scan(backend, ROOM, range_min=1.2, range_max=3.0, noise=0.5)
    finite = result.ranges[np.isfinite(result.ranges)]
    assert finite.min() == 1.2
    assert finite.max() <= 3.0
    assert np.isinf(result.ranges).any()


@pytest.mark.parametrize("backend", BACKENDS)
def test_scans_come_at_their_rate_with_the_time_of_their_moment(backend):
    with simulate(ROOM, robot_with(rate=10.0), backend=backend, lidar="front") as simulator:
        simulator.reset(Pose2D(0.0, 0.0))
        counts = []
        for _ in range(20):
            state = simulator.step(Twist2D(0.2, 0.1), 0.05)
            counts.append(len(state.scans))
            for each in state.scans:
                mount = simulator.robot.lidars["front"]
                assert (each.time, each.height) == (state.time, mount.z)
                assert each.mount == Pose2D(mount.x, mount.y, mount.yaw)
        assert counts == [0, 1] * 10


def test_beams_cover_the_field_of_view_once():
    partial = beam_angles(Lidar(x=0, y=0, z=0.3, beams=5, fov=2.0))
    assert partial == pytest.approx([-1.0, -0.5, 0.0, 0.5, 1.0])
    full = beam_angles(Lidar(x=0, y=0, z=0.3, beams=4))
    assert full == pytest.approx([-math.pi, -math.pi / 2.0, 0.0, math.pi / 2.0])


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_unknown_lidar_offers_the_nearest(backend):
    with pytest.raises(UnknownNameError, match="Did you mean 'front'"):
        simulate(ROOM, "nova_carter", backend=backend, lidar="frnt")


@pytest.mark.parametrize("backend", BACKENDS)
def test_lidars_are_off_unless_asked_for(backend):
    with simulate(ROOM, "nova_carter", backend=backend) as simulator:
        assert simulator.step(Twist2D(), 0.05).scans == ()


def test_a_beam_from_inside_meets_the_skin():
    world = World("w", (Solid("post", Cylinder(1.0, 1.0)), Solid("box", Box((6.0, 6.0, 1.0)))))
    distances = WorldOutline(world, 0.1).cast(0.0, 0.0, np.array([0.0, math.pi / 4.0]), 10.0)
    assert distances == pytest.approx([1.0, 1.0])


cells = st.integers(0, 2**25 - 1).map(lambda bits: np.array([bits >> i & 1 for i in range(25)], bool).reshape(5, 5))


@given(
    blocked=cells, x=st.floats(-2.0, 7.0), y=st.floats(-2.0, 7.0), turn=st.floats(-4.0, 4.0), reach=st.floats(0.0, 9.0)
)
@example(blocked=np.ones((5, 5), bool), x=-0.5, y=0.0, turn=-5e-324, reach=1.0)
def test_the_kernel_casts_through_cells_as_numpy_does(blocked, x, y, turn, reach):
    angles = turn + np.linspace(-3.0, 3.0, 11)
    field = CellField("map", Pose2D(0.0, 0.0), blocked, 1.0)
    kernel = cast_grid_rays(blocked.view(np.uint8), x, y, angles, reach)
    # On a grid line, or within rounding of one, a start belongs to either cell.
    on_line = min(abs(x - round(x)), abs(y - round(y))) < 1e-12
    for angle, distance in zip(angles, kernel, strict=True):
        along = np.arange(0.0, reach, 0.01)
        col, row = np.floor(x + along * np.cos(angle)).astype(int), np.floor(y + along * np.sin(angle)).astype(int)
        inside = (row >= 0) & (row < 5) & (col >= 0) & (col < 5)
        hit = inside.copy()
        hit[inside] = blocked[row[inside], col[inside]]
        if hit.any():
            assert distance <= along[np.argmax(hit)] + 1e-9 or on_line
    reference = cast_cells(field, x, y, angles, reach)
    same = np.isclose(kernel, reference, atol=1e-9) | (np.isinf(kernel) & np.isinf(reference))
    assert same.all() or on_line


@pytest.mark.parametrize("values", [(math.nan, 0.0, 1.0), (0.0, math.inf, 1.0), (0.0, 0.0, -1.0), (0.0, 0.0, math.inf)])
def test_the_kernel_refuses_what_is_not_finite(values):
    x, y, reach = values
    with pytest.raises(ValueError, match="finite"):
        cast_grid_rays(np.zeros((2, 2), np.uint8), x, y, np.zeros(1), reach)


def test_the_engines_own_rays_agree():
    model = build_spec(ROOM, Robot.load("nova_carter")).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    angles = np.linspace(-3.0, 3.0, 400)
    beams = np.c_[np.cos(angles), np.sin(angles), np.zeros(400)].ravel()
    groups, geoms, theirs = np.array([1, 0, 0, 0, 0, 0], np.uint8), np.empty(400, np.int32), np.empty(400)
    origin = np.array([0.3, -0.2, 0.4])
    mujoco.mj_multiRay(model, data, origin, beams, groups, True, -1, geoms, theirs, None, 400, 12.0)
    world = World("geoms", tuple(solid for solid in ROOM.solids if solid.name != "cells"))
    ours = WorldOutline(world, 0.4).cast(0.3, -0.2, angles, 12.0)
    theirs = np.where(geoms >= 0, theirs, np.inf)
    agree = np.isclose(ours, theirs, atol=0.001) | (np.isinf(ours) & np.isinf(theirs))
    assert np.count_nonzero(~agree) <= 2
    assert len({*geoms.tolist()}) >= 7


@given(
    seed=st.integers(0, 2**32 - 1),
    x=st.floats(-3.0, 3.0),
    y=st.floats(-3.0, 3.0),
    first=st.floats(-10.0, 10.0),
    fov=st.floats(0.1, 2.0 * math.pi - 0.02),
    reach=st.floats(0.5, 9.0),
)
def test_the_kernels_cast_as_numpy_does(seed, x, y, first, fov, reach):
    rng = np.random.default_rng(seed)
    boxes = [
        Solid(
            f"b{i}",
            Box((*rng.uniform(0.05, 1.5, 2), 1.0)),
            Pose3D.planar(*rng.uniform(-4, 4, 2), 0.5, rng.uniform(-3, 3)),
        )
        for i in range(8)
    ]
    posts = [
        Solid(f"c{i}", Cylinder(rng.uniform(0.05, 1.0), 1.0), Pose3D((*rng.uniform(-4, 4, 2), 0.5))) for i in range(4)
    ]
    outline = WorldOutline(World("w", (*boxes, *posts)), 0.4)
    angles = first + np.linspace(0.0, fov, 90)
    slow, quick = cast_slowly(outline, x, y, angles, reach), outline.cast(x, y, angles, reach)
    agree = np.isclose(slow, quick, atol=1e-6) | (np.isinf(slow) & np.isinf(quick))
    assert np.count_nonzero(~agree) <= 1


def test_one_beam_is_enough():
    outline = WorldOutline(World("w", (Solid("b", Box((1.0, 1.0, 1.0)), Pose3D((2.0, 0.0, 0.5))),)), 0.4)
    assert outline.cast(0.0, 0.0, np.zeros(1), 5.0) == pytest.approx([1.5])


@pytest.mark.parametrize(
    "changes",
    [
        {"x": math.nan},
        {"first": math.inf},
        {"step": 0.0},
        {"step": 1.0},
        {"count": 0},
        {"reach": -1.0},
        {"segments": np.zeros((2, 3))},
        {"discs": np.zeros((2, 4))},
    ],
)
def test_the_outline_kernel_refuses_bad_arguments(changes):
    good = {"segments": np.zeros((1, 4)), "discs": np.zeros((1, 3)), "x": 0.0, "y": 0.0}
    good |= {"first": 0.0, "step": 0.1, "count": 10, "reach": 5.0}
    assert np.isfinite(cast_outline_rays(**good)).all()
    with pytest.raises(ValueError, match=r"need shape|must be"):
        cast_outline_rays(**{**good, **changes})
