import itertools
import math

import numpy as np
import pytest
import scipy

from trundle._core import label_components
from trundle.errors import InputError, WorldError
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.worlds import World, world_names
from trundle.worlds.generators.cylinders import RADIUS, RUN_IN

BAND = (0.10, 0.62)
GENERATED = ["corridors", "cylinders", "lot", "maze", "office"]
SMALL = {"lot": {"size": (20.0, 16.0)}, "office": {"size": (14.0, 10.0)}, "maze": {"rows": 3, "columns": 4}}


def free_areas(world: World, radius: float, *, resolution: float = 0.05) -> tuple[OccupancyGrid, np.ndarray]:
    """The world's map, and the numbers of its areas that a disc can go about in."""
    grid = OccupancyGrid.from_world(world, resolution=resolution, z_range=BAND)
    distance = scipy.ndimage.distance_transform_edt(grid.data == 0) * resolution
    return grid, label_components((distance > radius).view(np.uint8), diagonal=False)[0]


def area_at(grid: OccupancyGrid, areas: np.ndarray, x: float, y: float) -> int:
    row, col = grid.world_to_cell(x, y)
    return int(areas[row, col])


def test_every_generated_world_is_listed():
    assert set(GENERATED) <= set(world_names())


@pytest.mark.parametrize("name", GENERATED)
def test_the_same_seed_makes_the_same_world_and_another_seed_another(name):
    options = {"corridors": {"stagger": 1.0}}.get(name, {})
    assert World.generate(name, seed=5, **options) == World.generate(name, seed=5, **options)
    assert World.generate(name, seed=5, **options) != World.generate(name, seed=6, **options)


@pytest.mark.parametrize("name", GENERATED)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_what_a_low_robot_could_touch_is_seen_in_its_height_band(name, seed):
    for solid in World.generate(name, seed=seed).solids:
        low, high = solid.bounds()
        assert low[2] >= -1e-9, solid.name
        assert high[2] > BAND[0], solid.name


@pytest.mark.parametrize("name", GENERATED)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_robot_can_turn_at_the_seed_point(name, seed):
    world = World.generate(name, seed=seed, **SMALL.get(name, {}))
    swing = Robot.load("nova_carter").circumscribed_radius
    for x, y in world.seeds:
        for solid in world.solids:
            low, high = solid.bounds()
            gap = np.maximum(0.0, np.maximum(low[:2] - (x, y), (x, y) - high[:2]))
            assert low[2] > BAND[1] or math.hypot(*gap) > swing, solid.name


@pytest.mark.parametrize("name", GENERATED)
def test_the_walls_shut_the_world_in(name):
    world = World.generate(name, **SMALL.get(name, {}))
    grid = OccupancyGrid.from_world(world, resolution=0.05, z_range=BAND, margin=0.5)
    edge = np.concatenate([grid.data[0], grid.data[-1], grid.data[:, 0], grid.data[:, -1]])
    assert (edge == -1).all()


@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_a_perfect_maze_has_one_path_between_any_two_cells(seed):
    rows, columns, cell = 5, 7, 1.0
    world = World.generate("maze", seed=seed, rows=rows, columns=columns, cell=cell)
    grid = OccupancyGrid.from_world(world, resolution=0.05, z_range=BAND)
    x, y = [
        (index - (count - 1) / 2.0) * cell for index, count in ((np.arange(columns), columns), (np.arange(rows), rows))
    ]

    def is_open(x, y):
        row, col = grid.world_to_cell(x, y)
        return grid.data[row, col] == 0

    assert all(is_open(a, b) for a, b in itertools.product(x, y))  # the flood came everywhere: all are joined
    doors = sum(is_open(a + cell / 2.0, b) for a, b in itertools.product(x[:-1], y))
    doors += sum(is_open(a, b + cell / 2.0) for a, b in itertools.product(x, y[:-1]))
    assert doors == rows * columns - 1  # a tree


def test_loops_take_walls_out_of_a_maze_and_no_two_walls_overlap():
    lengths = []
    for loops in (0.0, 0.3, 1.0):
        world = World.generate("maze", seed=3, loops=loops, rows=5, columns=6)
        rects = [solid.bounds() for solid in world.solids if not solid.name.endswith("_cap")]
        for (a, b), (c, d) in itertools.combinations(rects, 2):
            assert (np.minimum(b, d) - np.maximum(a, c)).min() < 1e-9
        lengths.append(sum(float((high - low)[:2].max()) for low, high in rects))
    assert lengths[0] > lengths[1] > lengths[2]


def test_doors_of_the_corridors_are_exactly_as_wide_as_asked():
    widths = (1.5, 0.9, 0.62)
    world = World.generate("corridors", door_widths=widths, stagger=0.5, seed=2)
    solids = {solid.name: solid for solid in world.solids}
    for number, width in enumerate(widths, start=1):
        left, right = (solids[f"door_{number}_post_{side}"].bounds() for side in ("left", "right"))
        assert left[0][1] - right[1][1] == pytest.approx(width, abs=1e-9)
    assert World.generate("corridors", door_widths="1.5,0.9,0.62", stagger=0.5, seed=2) == world


def test_a_wide_robot_comes_as_far_as_its_door():
    world = World.generate("corridors", door_widths=(1.6, 1.2, 0.8), spacing=3.0, door_depth=0.2)
    grid, areas = free_areas(world, 0.5)
    halls = [area_at(grid, areas, index * 3.2, 0.0) for index in range(4)]
    assert halls[0] == halls[1] == halls[2] > 0
    assert halls[3] > 0
    assert halls[3] != halls[2]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("density", [0.2, 0.35])
@pytest.mark.parametrize("radius", [0.25, 0.6])
def test_a_disc_passes_the_lane_of_cylinders(seed, density, radius):
    world = World.generate("cylinders", seed=seed, density=density, passable_radius=radius)
    posts = [solid for solid in world.solids if solid.kind == "post"]
    assert len(posts) > 20
    grid, areas = free_areas(world, radius - 0.05, resolution=0.025)  # cells are occupied where they are touched
    west, east = (area_at(grid, areas, x, 0.0) for x in (-RUN_IN / 2.0, 10.0 + RUN_IN / 2.0))
    assert west == east > 0


def test_without_a_promised_path_no_post_is_left_out_and_denser_lanes_have_more():
    counts = []
    for density in (0.0, 0.1, 0.2, 0.3):
        free, opened = (World.generate("cylinders", seed=1, density=density, passable_radius=r) for r in (0.0, 0.5))
        assert {solid.pose for solid in opened.solids} <= {solid.pose for solid in free.solids}
        counts.append(sum(solid.kind == "post" for solid in free.solids))
    assert counts[0] == 0
    assert counts == sorted(set(counts))


def test_posts_are_barns():
    world = World.generate("cylinders")
    posts = [solid for solid in world.solids if solid.kind == "post"]
    assert {solid.shape.radius for solid in posts} == {RADIUS} == {0.075}
    places = np.array([solid.pose.position[:2] for solid in posts])
    assert (places[:, 0] > 0.0).all()
    assert (places[:, 0] < 10.0).all()
    assert (np.abs(places[:, 1]) < 4.5 / 2.0).all()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("size", [(24.0, 14.0), (30.0, 26.0), (14.0, 10.0)])
def test_every_room_of_an_office_can_be_entered(seed, size):
    world = World.generate("office", seed=seed, size=size)
    grid, areas = free_areas(world, 0.4)
    doors: dict[str, list] = {}
    for solid in world.solids:
        if "_door_post_" in solid.name:
            doors.setdefault(solid.name.split("_door_")[0], []).append(solid.bounds())
    assert len(doors) >= 4
    start = area_at(grid, areas, *world.seeds[0])
    assert start > 0
    for name, (west, east) in doors.items():
        assert east[0][0] - west[1][0] == pytest.approx(1.2, abs=1e-9), name
        x, y = (west[1][0] + east[0][0]) / 2.0, (west[0][1] + west[1][1]) / 2.0
        for side in (-1.2, 1.2):
            assert area_at(grid, areas, x, y + side) == start, name


def test_an_office_has_what_an_office_has():
    kinds = {solid.kind for seed in range(3) for solid in World.generate("office", seed=seed).solids}
    assert {"wall", "door", "desk", "chair", "cabinet", "plant", "table"} <= kinds
    bare = World.generate("office", furnishing=0.0, open_doors=False)
    assert {solid.kind for solid in bare.solids} <= {"wall", "door", "board", "table", "chair", "sofa"}
    assert not any(solid.name.endswith("_leaf") for solid in bare.solids)


@pytest.mark.parametrize("seed", range(3))
def test_a_lot_has_what_a_lot_has_and_its_corners_are_joined(seed):
    world = World.generate("lot", seed=seed)
    assert {"kerb", "vehicle", "container", "lamp", "cone", "hedge", "tree", "grass"} == {
        solid.kind for solid in world.solids
    }
    grid, areas = free_areas(world, 0.7, resolution=0.1)
    corners = [area_at(grid, areas, x, y) for x in (-16.5, 16.5) for y in (-12.5, 12.5)]
    start = area_at(grid, areas, *world.seeds[0])
    assert start > 0
    # A container may stand in a northern corner; the southern ones are free.
    assert corners[0] == corners[2] == start
    assert World.generate("lot", fill=0.0, containers=0.0, cones=0, hedges=False)


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("maze", {"rows": 0}, "rows"),
        ("maze", {"rows": 1, "columns": 1}, "at least two cells"),
        ("maze", {"cell": 0.4, "wall_thickness": 0.3}, "passages of 0.10 m"),
        ("maze", {"loops": 1.5}, "loops"),
        ("maze", {"columns": 2.5}, "columns"),
        ("corridors", {"door_widths": ()}, "door_widths must be 1 to 40 numbers"),
        ("corridors", {"door_widths": (1.0, math.nan)}, "door_widths"),
        ("corridors", {"door_widths": "1.0,wide"}, "door_widths"),
        ("corridors", {"door_widths": 5.0}, "does not fit"),
        ("corridors", {"spacing": True}, "spacing"),
        ("cylinders", {"density": 0.9}, "density"),
        ("cylinders", {"smoothing": -1}, "smoothing"),
        ("cylinders", {"width": 1.2, "passable_radius": 0.6}, "too narrow"),
        ("cylinders", {"length": math.inf}, "length"),
        ("office", {"size": (5.0, 20.0)}, "at least"),
        ("office", {"size": "12"}, "two lengths"),
        ("office", {"door_width": 0.1}, "door_width"),
        ("office", {"open_doors": 1}, "open_doors"),
        ("lot", {"size": (3.0, 20.0)}, "size along x"),
        ("lot", {"cones": -1}, "cones"),
        ("lot", {"hedges": "yes"}, "hedges"),
        *((name, {"seed": -1}, "seed") for name in GENERATED),
    ],
)
def test_values_out_of_range_are_refused_by_name(name, options, message):
    with pytest.raises(WorldError, match=message) as caught:
        World.generate(name, **options)
    assert str(caught.value).startswith(f"{name}: ")


@pytest.mark.parametrize("name", GENERATED)
def test_an_unknown_option_is_an_input_error(name):
    with pytest.raises(InputError, match=rf"world '{name}': 'colour' is not an option of this world.*: .*exclude"):
        World.generate(name, colour=3)


def test_the_nearest_option_is_offered():
    with pytest.raises(InputError, match=r"'hegdes' is not an option of this world \(did you mean 'hedges'\?\)"):
        World.generate("lot", hegdes=False)
