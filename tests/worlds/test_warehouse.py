import itertools
import math

import numpy as np
import pytest

from trundle.errors import InputError, WorldError
from trundle.geometry.solids import Solid
from trundle.worlds import World
from trundle.worlds.generators.warehouse import CROSS_AISLE, FORKLIFT_ROOM, FREE_BESIDE, LANE, generate_warehouse

BAND = (0.10, 0.62)
VARIANTS = [
    {"seed": 0},
    {"seed": 1, "aisle_width": 1.1},
    {"seed": 2, "aisle_width": 1.8, "size": (24.0, 16.0)},
    {"seed": 3, "aisle_width": 2.5, "size": (14.0, 11.0)},
    {"seed": 4, "aisle_width": 1.3, "size": (45.0, 30.0), "levels": 2},
    {"seed": 5, "forklifts": 2},
    {"seed": 6, "forklifts": 2, "aisle_width": 1.3, "size": (24.0, 16.0)},
]


def in_band(solid: Solid) -> bool:
    low, high = solid.bounds()
    return low[2] < BAND[1] and high[2] > BAND[0]


def loose_things(world: World) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Bounds of every loose thing, by the first two words of its solids' names."""
    things: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    for solid in world.solids:
        if solid.name.startswith(("forklift", "pallet", "barrels", "boxes")):
            name = "_".join(solid.name.split("_")[:2])
            low, high = solid.bounds()
            if name in things:
                low, high = np.minimum(low, things[name][0]), np.maximum(high, things[name][1])
            things[name] = (low, high)
    return things


def field(world: World) -> tuple[np.ndarray, np.ndarray]:
    bounds = [solid.bounds() for solid in world.solids if solid.name.startswith(("rack", "row"))]
    return np.min([low for low, _ in bounds], axis=0), np.max([high for _, high in bounds], axis=0)


def rows(world: World) -> list[tuple[float, float]]:
    """South and north faces of each row of racks, from what stands in the height band."""
    spans = sorted(
        (float(solid.bounds()[0][1]), float(solid.bounds()[1][1]))
        for solid in world.solids
        if solid.name.startswith(("rack", "row")) and in_band(solid)
    )
    merged: list[tuple[float, float]] = []
    for low, high in spans:
        if merged and low <= merged[-1][1] + 0.2:  # two racks back to back are one row
            merged[-1] = (merged[-1][0], max(merged[-1][1], high))
        else:
            merged.append((low, high))
    return merged


def room_of(options):
    """What is free everywhere for forklifts [m]."""
    return FORKLIFT_ROOM if options.get("forklifts") else 0.0


def test_the_same_seed_makes_the_same_warehouse_and_another_seed_another():
    assert generate_warehouse(seed=5) == generate_warehouse(seed=5)
    assert generate_warehouse(seed=5) != generate_warehouse(seed=6)
    assert World.generate("warehouse", seed=5) == generate_warehouse(seed=5)


@pytest.mark.parametrize("options", VARIANTS)
def test_aisles_are_exactly_as_wide_as_asked(options):
    world = generate_warehouse(**options)
    faces = rows(world)
    assert len(faces) >= 2
    for (_, north), (south, _) in itertools.pairwise(faces):
        assert south - north == pytest.approx(options.get("aisle_width", max(1.6, room_of(options))), abs=1e-9)


@pytest.mark.parametrize("options", VARIANTS)
def test_there_is_room_to_turn_around_the_racks(options):
    world = generate_warehouse(**options)
    length, width = options.get("size", (30.0, 20.0))
    low, high = field(world)
    cross_aisle, lane = max(CROSS_AISLE, room_of(options)), max(LANE, room_of(options))
    assert low[0] + length / 2.0 >= cross_aisle - 1e-9
    assert length / 2.0 - high[0] >= cross_aisle - 1e-9
    assert low[1] + width / 2.0 >= lane - 1e-9
    assert width / 2.0 - high[1] >= lane - 1e-9


@pytest.mark.parametrize("options", VARIANTS)
def test_loose_things_leave_the_aisles_free_and_room_beside_them(options):
    world = generate_warehouse(**options)
    length, width = options.get("size", (30.0, 20.0))
    low, high = field(world)
    things = loose_things(world)
    cross_aisle, beside = max(CROSS_AISLE, room_of(options)), max(FREE_BESIDE, room_of(options))
    for name, (thing_low, thing_high) in things.items():
        gap = np.maximum(0.0, np.maximum(low - thing_high, thing_low - high))[:2]
        assert gap[0] >= cross_aisle or gap[1] >= beside, name
        half = np.array([length, width]) / 2.0
        edges = [*(thing_low[:2] + half), *(half - thing_high[:2])]
        assert all(0.04 < edge < 0.11 or edge >= beside for edge in edges), name
    for (first, a), (second, b) in itertools.combinations(things.items(), 2):
        gap = np.maximum(0.0, np.maximum(a[0] - b[1], b[0] - a[1]))[:2]
        assert math.hypot(*gap) >= beside, (first, second)


def test_the_default_has_what_a_warehouse_has_within_the_walls():
    world = generate_warehouse()
    kinds = {solid.kind for solid in world.solids}
    assert kinds == {"wall", "rack", "goods", "pallet", "box", "barrel", "forklift"}
    names = {solid.name for solid in world.solids}
    assert {"rack_2_shelf_1", "forklift_1_body", "forklift_2_body"} <= names
    assert 300 <= len(world.solids) <= 800
    low, high = world.bounds
    assert np.allclose(low, (-15.2, -10.2, 0.0))
    assert np.allclose(high, (15.2, 10.2, 4.0))
    for solid in world.solids:
        assert solid.bounds()[0][2] >= -1e-9, solid.name


def test_what_a_low_robot_could_touch_is_seen_in_its_height_band():
    for solid in generate_warehouse(seed=3).solids:
        low, high = solid.bounds()
        assert low[2] >= BAND[1] or in_band(solid) or "lid" in solid.name or "block" in solid.name, solid.name
        assert high[2] > BAND[0], solid.name


@pytest.mark.parametrize("options", VARIANTS)
def test_the_seed_point_is_free(options):
    world = generate_warehouse(**options)
    ((x, y),) = world.seeds
    for solid in world.solids:
        low, high = solid.bounds()
        gap = np.maximum(0.0, np.maximum(low[:2] - (x, y), (x, y) - high[:2]))
        assert math.hypot(*gap) >= 1.0, solid.name


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"size": (6.0, 20.0)}, "at least"),
        ({"size": (30.0, 5.0)}, "at least"),
        ({"size": (math.nan, 20.0)}, "size along x"),
        ({"size": (30.0, 1e6)}, "size along y"),
        ({"size": 30.0}, "two lengths"),
        ({"size": (30.0, "wide")}, "size along y"),
        ({"aisle_width": 0.5}, "aisle_width"),
        ({"aisle_width": math.inf}, "aisle_width"),
        ({"seed": -1}, "seed"),
        ({"seed": 1.5}, "seed"),
        ({"levels": 0}, "levels"),
        ({"fill": 1.1}, "fill"),
        ({"clutter": math.nan}, "clutter"),
        ({"wall_height": 0.1}, "wall_height"),
    ],
)
def test_values_out_of_range_are_refused_by_name(options, message):
    with pytest.raises(WorldError, match=message):
        generate_warehouse(**options)


def test_an_unknown_option_is_an_input_error():
    with pytest.raises(InputError, match="aisles"):
        World.generate("warehouse", aisles=3)


def test_clutter_and_fill_can_be_turned_off():
    bare = generate_warehouse(fill=0.0, clutter=0.0)
    assert {solid.kind for solid in bare.solids} == {"wall", "rack"}
