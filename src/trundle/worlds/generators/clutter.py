"""Loose objects of a warehouse, pallets, boxes, barrels and forklifts, and where they are scattered."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Color, Cylinder, Solid
from trundle.worlds.generators.props import CHARCOAL, DARK_WOOD, RUBBER, SEEN_TO, STEEL, WOOD, Part, box, place

CARTONS: tuple[Color, ...] = (
    (0.76, 0.60, 0.42, 1.0),
    (0.70, 0.53, 0.35, 1.0),
    (0.80, 0.66, 0.48, 1.0),
    (0.63, 0.47, 0.31, 1.0),
    (0.73, 0.58, 0.44, 1.0),
)
TOTES: tuple[Color, ...] = (
    (0.13, 0.33, 0.62, 1.0),
    (0.18, 0.47, 0.36, 1.0),
    (0.62, 0.64, 0.66, 1.0),
    (0.72, 0.22, 0.18, 1.0),
)
BARRELS: tuple[Color, ...] = (
    (0.12, 0.32, 0.58, 1.0),
    (0.70, 0.20, 0.16, 1.0),
    (0.16, 0.42, 0.30, 1.0),
    (0.30, 0.32, 0.35, 1.0),
)
SAFETY_YELLOW: Color = (0.95, 0.74, 0.10, 1.0)

PALLET_SIZE = (1.2, 0.8, 0.144)  # EN 13698-1, the EUR pallet [m]
BARREL_RADIUS, BARREL_HEIGHT = 0.29, 0.88  # a 200-litre drum [m]

_ALONG_Y = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Rect:
    """An axis-aligned rectangle on the floor [m]."""

    x0: float
    y0: float
    x1: float
    y1: float


def pallet(rng: np.random.Generator, *, low_objects: bool = True) -> list[Part]:
    """Return a wooden pallet, usually with a stack of cartons on it; without low objects with a collar round them."""
    length, width, height = PALLET_SIZE
    deck = 0.022
    parts = [box("deck", (length, width, deck), (0.0, 0.0, height - deck / 2.0), WOOD, "pallet")]
    block = height - deck
    for index, y in enumerate((-0.35, 0.0, 0.35)):
        parts.append(box(f"block_{index + 1}", (length, 0.1, block), (0.0, y, block / 2.0), DARK_WOOD, "pallet"))
    if not low_objects:
        collar = SEEN_TO - height
        parts.append(box("collar", (length, width, collar), (0.0, 0.0, height + collar / 2.0), WOOD, "pallet"))
    if rng.random() < 0.85:
        parts += _carton_stack(rng, height)
    return parts


def _carton_stack(rng: np.random.Generator, base: float) -> list[Part]:
    """Return cartons in layers of two by one or two by two, slightly fewer towards the top."""
    parts: list[Part] = []
    columns, rows = 2, int(rng.integers(1, 3))
    color = np.asarray(CARTONS[rng.integers(len(CARTONS))])
    edge_x, edge_y = 1.12 / columns, 0.74 / rows
    for column in range(columns):
        for row in range(rows):
            z = base
            for layer in range(int(rng.integers(1, 4))):
                height = 0.36
                red, green, blue = (float(channel) for channel in color[:3] * rng.uniform(0.92, 1.06, size=()))
                centre = ((column + 0.5) * edge_x - 0.56, (row + 0.5) * edge_y - 0.37, z + height / 2.0)
                size = (edge_x - 0.015, edge_y - 0.015, height - 0.006)
                name = f"carton_{column + 1}{row + 1}{layer + 1}"
                parts.append(
                    box(name, size, centre, (red, green, blue, 1.0), "goods", yaw=float(rng.uniform(-0.02, 0.02)))
                )
                z += height
    return parts


def boxes(rng: np.random.Generator, *, low_objects: bool = True) -> list[Part]:
    """Return one to three loose cartons on the floor, the third on top; without low objects they are taller."""
    parts = []
    first = float(rng.uniform(0.45, 0.6))
    second = float(rng.uniform(0.35, 0.5))
    count = int(rng.integers(1, 4))
    least = 0.0 if low_objects else SEEN_TO
    specs = [
        (first, (0.0, 0.0), 0.0),
        (second, ((first + second) / 2.0 + 0.06, float(rng.uniform(-0.08, 0.08))), 0.0),
        (0.36, (0.0, 0.0), max(first * 0.8, least)),
    ]
    for index, (edge, at, bottom) in enumerate(specs[:count]):
        color = CARTONS[rng.integers(len(CARTONS))]
        height = edge * 0.8 if bottom else max(edge * 0.8, least)
        size, centre = (edge, edge * 0.85, height), (*at, bottom + height / 2.0)
        parts.append(box(str(index + 1), size, centre, color, "box", yaw=float(rng.uniform(-0.12, 0.12))))
    return parts


def barrels(rng: np.random.Generator) -> list[Part]:
    """Return one to four drums standing close together."""
    color = BARRELS[rng.integers(len(BARRELS))]
    pitch = 2.0 * BARREL_RADIUS + 0.03
    spots = [(0.0, 0.0), (pitch, 0.0), (pitch / 2.0, pitch * math.sqrt(0.75)), (1.5 * pitch, pitch * math.sqrt(0.75))]
    parts = []
    for index, (x, y) in enumerate(spots[: int(rng.integers(1, 5))]):
        body = Cylinder(BARREL_RADIUS, BARREL_HEIGHT)
        lid = Cylinder(BARREL_RADIUS * 0.93, 0.02)
        parts.append(Part(f"{index + 1}", body, Pose3D((x, y, BARREL_HEIGHT / 2.0)), color, "barrel"))
        parts.append(Part(f"{index + 1}_lid", lid, Pose3D((x, y, BARREL_HEIGHT + 0.01)), STEEL, "barrel"))
    return parts


def forklift(*, fork_height: float = 0.14, low_objects: bool = True) -> list[Part]:
    """Return a counterbalance forklift, 2.9 m long with its forks; every part is at least 0.1 m high somewhere.

    Args:
        fork_height: Underside of the forks above the floor [m]; above 0.10, so that a map for low robots shows them.
        low_objects: Whether its forks and wheels are open; else a skirt is round the wheels, and the forks carry a
            crate.
    """
    fork, kind = fork_height + 0.03, "forklift"
    parts = [
        box("body", (1.35, 1.05, 0.50), (-0.15, 0.0, 0.45), SAFETY_YELLOW, kind),
        box("counterweight", (0.50, 1.08, 0.78), (-1.00, 0.0, 0.57), CHARCOAL, kind),
        box("hood", (0.62, 0.80, 0.24), (-0.44, 0.0, 0.82), SAFETY_YELLOW, kind),
        box("seat", (0.46, 0.50, 0.12), (-0.38, 0.0, 1.00), CHARCOAL, kind),
        box("seat_back", (0.10, 0.48, 0.46), (-0.64, 0.0, 1.22), CHARCOAL, kind),
        box("dashboard", (0.14, 0.84, 0.42), (0.42, 0.0, 0.90), CHARCOAL, kind),
        box("carriage", (0.07, 0.94, 0.42), (0.78, 0.0, fork + 0.24), CHARCOAL, kind),
        box("mast_crossbar", (0.10, 0.52, 0.10), (0.68, 0.0, 2.02), STEEL, kind),
        box("roof", (1.22, 0.98, 0.06), (-0.16, 0.0, 2.08), CHARCOAL, kind),
    ]
    for side, y in (("left", 1.0), ("right", -1.0)):
        parts += [
            box(f"mast_{side}", (0.12, 0.10, 2.10), (0.68, y * 0.30, 1.13), STEEL, kind),
            box(f"fork_{side}", (1.05, 0.12, 0.06), (1.33, y * 0.28, fork), STEEL, kind),
            box(f"guard_front_{side}", (0.06, 0.06, 1.38), (0.42, y * 0.46, 1.38), CHARCOAL, kind),
            box(f"guard_rear_{side}", (0.06, 0.06, 1.14), (-0.74, y * 0.46, 1.50), CHARCOAL, kind),
        ]
        for axle, x, radius in (("front", 0.42, 0.30), ("rear", -0.92, 0.24)):
            tyre = Pose3D((x, y * 0.50, radius), _ALONG_Y)
            hub = Pose3D((x, y * 0.605, radius), _ALONG_Y)
            parts.append(Part(f"wheel_{axle}_{side}", Cylinder(radius, 0.20), tyre, RUBBER, kind))
            parts.append(Part(f"hub_{axle}_{side}", Cylinder(radius * 0.5, 0.02), hub, STEEL, kind))
    if not low_objects:
        parts.append(box("skirt", (2.06, 1.24, SEEN_TO - 0.05), (-0.22, 0.0, (SEEN_TO + 0.05) / 2.0), CHARCOAL, kind))
        parts.append(box("crate", (1.06, 0.94, 0.80), (1.33, 0.0, 0.47), CARTONS[0], kind))
    parts.append(Part("steering_wheel", Cylinder(0.17, 0.03), Pose3D((0.27, 0.0, 1.17)), RUBBER, kind))
    parts.append(Part("beacon", Cylinder(0.06, 0.12), Pose3D((-0.55, 0.0, 2.17)), (0.98, 0.45, 0.05, 1.0), kind))
    return parts


@dataclass(slots=True)
class Clutter:
    """Scatters loose objects over the loading area and the lanes, never in an aisle or a cross aisle.

    Attributes:
        rng: Random numbers; the same ones make the same objects in the same places.
        floor: The floor between the walls.
        racks: Bounds of all rows of racks, with the aisles between them.
        cross_aisle: Width of the cross aisles [m], which stay free.
        beside: Least free width beside an object [m].
        low_objects: Whether there are objects that a planar lidar does not see.
    """

    rng: np.random.Generator
    floor: Rect
    racks: Rect
    cross_aisle: float
    beside: float
    low_objects: bool
    _taken: list[Rect] = field(default_factory=list[Rect])

    def scatter(self, amount: float) -> list[Solid]:
        """Place forklifts first, then smaller objects in proportion to the floor area."""
        if amount == 0.0:
            return []
        area = (self.floor.x1 - self.floor.x0) * (self.floor.y1 - self.floor.y0)
        solids: list[Solid] = []
        low = self.low_objects
        kinds: tuple[tuple[str, Callable[[], list[Part]], int], ...] = (
            ("forklift", lambda: forklift(low_objects=low), 2),
            ("pallet", lambda: pallet(self.rng, low_objects=low), round(amount * area / 60.0)),
            ("barrels", lambda: barrels(self.rng), round(amount * area / 150.0)),
            ("boxes", lambda: boxes(self.rng, low_objects=low), round(amount * area / 120.0)),
        )
        for kind, make, count in kinds:
            placed = 0
            for _ in range(count):
                things = self._try_place(make(), f"{kind}_{placed + 1}", tries=60)
                placed += bool(things)
                solids += things
        return solids

    def _try_place(self, parts: list[Part], prefix: str, *, tries: int) -> list[Solid]:
        """Place an object at a random spot where it fits; empty if all tries failed."""
        for _ in range(tries):
            turn = float(self.rng.integers(4)) * math.pi / 2.0 + float(self.rng.uniform(-0.06, 0.06))
            extent = _floor_bounds(place(parts, prefix, 0.0, 0.0, turn))
            x, y = self._draw(extent)
            rect = Rect(extent.x0 + x, extent.y0 + y, extent.x1 + x, extent.y1 + y)
            if self._fits(rect):
                self._taken.append(rect)
                return place(parts, prefix, x, y, turn)
        return []

    def _draw(self, extent: Rect) -> tuple[float, float]:
        """Draw a spot, two times of three against a wall."""
        floor, racks, rng = self.floor, self.racks, self.rng
        east = racks.x0 if rng.random() < 0.6 else floor.x1
        x = float(rng.uniform(floor.x0 - extent.x0, east - extent.x1))
        y = float(rng.uniform(floor.y0 - extent.y0, floor.y1 - extent.y1))
        wall, gap = int(rng.integers(6)), 0.08
        if wall == 0:
            x = floor.x0 + gap - extent.x0
        elif wall in (1, 2):
            y = floor.y0 + gap - extent.y0
        elif wall in (3, 4):
            y = floor.y1 - gap - extent.y1
        return x, y

    def _fits(self, rect: Rect) -> bool:
        floor, racks, beside = self.floor, self.racks, self.beside
        gaps = (rect.x0 - floor.x0, rect.y0 - floor.y0, floor.x1 - rect.x1, floor.y1 - rect.y1)
        if any(gap < 0.05 or 0.1 < gap < beside for gap in gaps):
            return False
        along, across = _gap(rect.x0, rect.x1, racks.x0, racks.x1), _gap(rect.y0, rect.y1, racks.y0, racks.y1)
        if along < self.cross_aisle and across < beside:
            return False
        return all(
            math.hypot(_gap(rect.x0, rect.x1, other.x0, other.x1), _gap(rect.y0, rect.y1, other.y0, other.y1)) >= beside
            for other in self._taken
        )


def _gap(low: float, high: float, other_low: float, other_high: float) -> float:
    """Return the distance between two intervals; 0 where they overlap."""
    return max(0.0, other_low - high, low - other_high)


def _floor_bounds(solids: Sequence[Solid]) -> Rect:
    bounds: list[tuple[FloatArray, FloatArray]] = [solid.bounds() for solid in solids]
    low = np.min([low for low, _ in bounds], axis=0)
    high = np.max([high for _, high in bounds], axis=0)
    return Rect(float(low[0]), float(low[1]), float(high[0]), float(high[1]))
