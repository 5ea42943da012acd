"""The raster of all kinds of solids against an oracle on random scenes: cells missed, extra and left out.

    python -m benchmarks.mapping.exactness [--scenes 200] [--seed 0]

manifold3d makes the bodies and cuts them to the band of heights; shapely says which cells, made smaller by 1 µm, what
is left meets from above. Cells that change if that 1 µm is 10 nm more or less are left out and counted. A round body
is held between a prism inside of it and one outside, so cells between these are left out as well; a ball's part in the
band is a disc, seen from above. A sheet has no thickness and counts where it touches. Ends with 1 if a cell is wrong.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import shapely
from benchmarks.timing import describe_machine, print_table
from manifold3d import Manifold
from tests.support.mesh_oracle import (
    BAND,
    CLOSE,
    ORIGIN,
    RESOLUTION,
    SHAPE,
    Comparison,
    compare,
    flipped,
    joined,
    mesh_of,
    random_body,
    random_pose,
    reached,
    seen_from_above,
)

from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.maps.rasterise import DEPTH, SolidRaster

AROUND = 3_000  # Sides of the prisms that a cylinder is held between.
BODIES = 3  # In a scene.


@dataclass(frozen=True)
class Seen:
    """A solid and what it looks like from above: surely, and at most."""

    solid: Solid
    inner: np.ndarray
    outer: np.ndarray


def exactly(name: str, shape: Box | Mesh | OccupancyCells, pose: Pose3D, *bodies: Manifold) -> Seen:
    parts = np.concatenate([seen_from_above(body, pose) for body in bodies])
    return Seen(Solid(name, shape, pose), parts, parts)


def box(name: str, rng: np.random.Generator) -> Seen:
    x, y, z = np.exp(rng.uniform(math.log(0.002), math.log(1.5), 3)).tolist()
    return exactly(name, Box((x, y, z)), random_pose(rng), Manifold.cube((x, y, z), center=True))


def upright_pose(rng: np.random.Generator) -> Pose3D:
    return Pose3D.planar(*rng.uniform(-1.0, 1.0, 2), rng.uniform(-0.3, 1.0), rng.uniform(-3.0, 3.0))


def cylinder(name: str, rng: np.random.Generator, pose: Pose3D) -> Seen:
    radius, length = np.exp(rng.uniform(math.log(0.01), math.log(1.0), 2)).tolist()
    inner, outer = (
        Manifold.cylinder(length, r, r, AROUND, center=True) for r in (radius, radius / math.cos(math.pi / AROUND))
    )
    return Seen(Solid(name, Cylinder(radius, length), pose), seen_from_above(inner, pose), seen_from_above(outer, pose))


def ball(name: str, rng: np.random.Generator) -> Seen:
    radius, pose = float(rng.uniform(0.01, 0.8)), random_pose(rng)
    x, y, z = pose.position
    off = max(BAND.inner_low - z, z - BAND.inner_high, 0.0)
    disc = math.sqrt(max(0.0, radius**2 - off**2))
    sides = 1_000
    inner, outer = (
        np.array([shapely.Point(x, y).buffer(r, quad_segs=sides)] if disc > 0.0 else [])
        for r in (disc, disc / math.cos(math.pi / (4 * sides)))
    )
    return Seen(Solid(name, Sphere(radius), pose), inner, outer)


def concave_mesh(name: str, rng: np.random.Generator) -> Seen:
    body = random_body(rng)
    return exactly(name, mesh_of(body), random_pose(rng), body)


def overlapping_shells(name: str, rng: np.random.Generator) -> Seen:
    bodies = [random_body(rng).translate(rng.uniform(-0.4, 0.4, 3)) for _ in range(3)]
    return exactly(name, mesh_of(*bodies), random_pose(rng), *bodies)


def hollow_mesh(name: str, rng: np.random.Generator) -> Seen:
    outer = Manifold.cube(rng.uniform(0.6, 2.0, 3), center=True)
    inner = Manifold.cube(np.array(outer.bounding_box()[3:]) * 2 - rng.uniform(0.02, 0.3, 3), center=True)
    mesh = joined(mesh_of(outer), flipped(mesh_of(inner)))
    return exactly(name, mesh, random_pose(rng), outer - inner)


def map_cells(name: str, rng: np.random.Generator) -> Seen:
    edge, height = float(rng.uniform(0.02, 0.2)), float(rng.uniform(0.05, 1.0))
    blocked = rng.random((8, 10)) < 0.4
    blocked[0, 0] = True
    bodies = [
        Manifold.cube((edge, edge, height)).translate((col * edge, row * edge, 0.0))
        for row, col in np.argwhere(blocked)
    ]
    return exactly(name, OccupancyCells(blocked, edge, height), random_pose(rng), *bodies)


def sheet(name: str, rng: np.random.Generator) -> Seen:
    """Triangles of no thickness; what of them lies in the band, grown by 1 nm, is what they may touch."""
    vertices = rng.uniform((-1.2, -1.2, -0.3), (1.2, 1.2, 1.0), (9, 3))
    vertices[3:6, 2] = 0.3  # A flat one.
    vertices[6:9, 0] = 0.5 * vertices[6:9, 1]  # An upright one.
    mesh = Mesh(vertices, np.arange(9).reshape(-1, 3))
    pose = upright_pose(rng)
    pieces = [cut_triangle(pose.transform_points(vertices[face])) for face in mesh.faces]
    parts = np.array([piece for piece in pieces if not piece.is_empty])
    return Seen(Solid(name, mesh, pose), parts, parts)


def cut_triangle(corners: np.ndarray) -> shapely.Geometry:
    low, high = BAND.inner_low, BAND.inner_high
    points = [corner[:2] for corner in corners if low <= corner[2] <= high]
    for a, b in ((0, 1), (1, 2), (2, 0)):
        for height in (low, high):
            if (corners[a, 2] - height) * (corners[b, 2] - height) < 0.0:
                share = (height - corners[a, 2]) / (corners[b, 2] - corners[a, 2])
                points.append((corners[a] + share * (corners[b] - corners[a]))[:2])
    return shapely.MultiPoint(np.array(points)).convex_hull if points else shapely.Polygon()


KINDS: dict[str, Callable[[str, np.random.Generator], Seen]] = {
    "box, any orientation": box,
    "cylinder, upright": lambda name, rng: cylinder(name, rng, upright_pose(rng)),
    "cylinder, tilted": lambda name, rng: cylinder(name, rng, random_pose(rng)),
    "sphere": ball,
    "cells of a map": map_cells,
    "mesh, concave": concave_mesh,
    "mesh, overlapping shells": overlapping_shells,
    "mesh, hollow": hollow_mesh,
}


def rasterise(solids: list[Solid]) -> np.ndarray:
    cells = np.full(SHAPE, -1, dtype=np.int8)
    SolidRaster(cells, RESOLUTION, ORIGIN, BAND).add(solids)
    return cells == 100


def compare_scene(seen: list[Seen]) -> tuple[Comparison, int]:
    """The comparison, and how many cells are occupied."""
    cells = rasterise([part.solid for part in seen])
    inner, outer = (np.concatenate([getattr(part, side) for part in seen]) for side in ("inner", "outer"))
    return compare(cells, inner, outer), int(cells.sum())


def compare_sheets(seen: list[Seen]) -> tuple[Comparison, int]:
    cells = rasterise([part.solid for part in seen])
    parts = np.concatenate([part.inner for part in seen])
    surely, maybe = reached(parts, CLOSE), reached(parts, -CLOSE)
    counts = (int(found.sum()) for found in (surely & ~cells, cells & ~maybe, maybe & ~surely))
    return Comparison(*counts), int(cells.sum())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=200, help="of each kind")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    print(f"{options.scenes} scenes a kind, {BODIES} solids each, {SHAPE[1]} x {SHAPE[0]} cells of {RESOLUTION} m")
    print(f"{describe_machine()}; a cell counts deeper than {DEPTH * 1e6:g} µm\n")
    rows: list[tuple[str, ...]] = []
    wrong = 0
    kinds = list(KINDS.values())
    for name in (*KINDS, "all of these at once", "sheets"):
        totals, occupied = np.zeros(3, dtype=int), 0
        for scene in range(options.scenes):
            rng = np.random.default_rng([options.seed, len(rows), scene])
            if name == "sheets":
                found, marked = compare_sheets([sheet(str(index), rng) for index in range(BODIES)])
            else:
                makers = kinds if name not in KINDS else [KINDS[name]] * BODIES
                found, marked = compare_scene([make(str(index), rng) for index, make in enumerate(makers)])
            totals += found
            occupied += marked
            if found.missed or found.extra:
                print(f"{name}, scene {scene}: {found.missed} missed, {found.extra} extra")
        wrong += int(totals[0] + totals[1])
        cells = options.scenes * SHAPE[0] * SHAPE[1]
        rows.append((name, f"{cells:,}", f"{occupied:,}", *(f"{number:,}" for number in totals)))
    print_table(("kind", "cells", "occupied", "missed", "extra", "left out"), rows)
    raise SystemExit(1 if wrong else 0)


if __name__ == "__main__":
    main()
