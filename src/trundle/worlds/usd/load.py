"""From a USD stage to a `World`: which prims are read, and warnings about those that are not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Tf, UsdGeom, UsdPhysics

from trundle.errors import WorldError
from trundle.geometry import FloatArray
from trundle.geometry.solids import Solid, solids_bounds
from trundle.worlds.affine import FlattenedError
from trundle.worlds.leave_out import Filter, warn_of_unmet
from trundle.worlds.shapes import find_ground, is_ground
from trundle.worlds.usd.options import NAME, SEEDS, Options
from trundle.worlds.usd.shapes import Colors, Shapes, level_plane
from trundle.worlds.usd.stage import opened, report_missing, select_variants, to_metres, warn
from trundle.worlds.usd.walk import SHAPES, TIME, Place, walk
from trundle.worlds.world import World

MAX_SOLIDS = 1_000_000
"""A stage with more shapes than this is refused, before memory runs out."""

LOW, HIGH = 0.01, 2.0
"""Shapes that end below or start above these heights over the ground [m] are floor or ceiling, and ignored."""

_NEAR = 0.01  # a collider whose bounds are this close [m] belongs to the shape
_AT_ONCE = 1 << 22  # pairs of bounds compared at once, which bounds the memory


def load(path: str, options: Options) -> World:
    """Load a world; see `trundle.worlds.usd.load_usd`."""
    leave_out = Filter.of(options.exclude)
    with opened(path) as stage:
        select_variants(path, stage, options.variants)
        report_missing(path, stage, refuse=options.missing == "error", is_excluded=leave_out.takes_name)
        root = to_metres(path, stage, options.meters_per_unit, options.up_axis)
        places = []
        for place in walk(path, stage, root, leave_out):
            places.append(place)
            if len(places) > MAX_SOLIDS:
                raise WorldError(f"{path}: it has more than {MAX_SOLIDS} prims with a shape; exclude some")
        colliders = _takes_colliders(places, options.geometry)
        chosen = _choose(path, places, options, colliders)
        _warn_of_robots(path, stage, leave_out)
        planes = [(place, plane) for place in chosen if (plane := level_plane(place)) is not None]
        chosen = [place for place in chosen if level_plane(place) is None]
        solids = list(_solids(path, chosen, leave_out, colliders))
        ground = find_ground([plane for _, plane in planes], solids)
        decks = [place for place, plane in planes if not is_ground(plane, ground)]
        solids += _solids(path, decks, leave_out, colliders)
        if colliders and options.geometry == "auto":
            _warn_of_unmatched(path, places, options, solids, ground)
        world = World(Path(path).stem, tuple(solids), _seeds(stage), ground)
    _warn_of_emptiness(path, places, chosen + decks, options)
    warn_of_unmet(leave_out, path)
    return world


def _takes_colliders(places: Sequence[Place], geometry: str) -> bool:
    if geometry != "auto":
        return geometry == "collision"
    return any(place.approximation is not None and place.prim.GetTypeName() != "Plane" for place in places)


def _choose(path: str, places: Sequence[Place], options: Options, colliders: bool) -> list[Place]:
    """Return the places to load, without prims of types that have no solid shape."""
    if colliders:
        chosen = [place for place in places if place.approximation is not None]
    else:
        chosen = [place for place in places if _is_seen(place, options)]
    unknown = [place for place in chosen if place.prim.GetTypeName() not in SHAPES]
    for kind, count in Counter(str(place.prim.GetTypeName()) for place in unknown).items():
        first = next(place.name for place in unknown if place.prim.GetTypeName() == kind)
        warn(f"{path}: prims of type {kind} have no solid shape and are left out: {count}, the first is {first}")
    return [place for place in chosen if place.prim.GetTypeName() in SHAPES]


def _solids(path: str, places: Sequence[Place], leave_out: Filter, colliders: bool) -> Iterator[Solid]:
    shapes, colors = Shapes(path, colliders), Colors()
    taken = {place.name for place in places}
    for place in places:
        try:
            shape, pose = shapes.shape(place)
        except FlattenedError as error:
            warn(f"{path}: {place.name}: {error}. It is left out")
            continue
        given = place.prim.GetCustomDataByKey(NAME)
        name = place.name
        if isinstance(given, str) and given and given not in taken:
            taken.add(given)
            name = given
        solid = Solid(name, shape, pose, color=colors.of(place.prim), kind=place.label)
        if not leave_out.takes_solid(solid):
            yield solid


def _seeds(stage: Any) -> tuple[tuple[float, float], ...]:
    """Return the seeds [m] that trundle's exporter stores."""
    prim = stage.GetDefaultPrim()
    values = prim.GetAttribute(SEEDS).Get() if prim else None
    return tuple((float(x), float(y)) for x, y in values or ())


def _warn_of_robots(path: str, stage: Any, leave_out: Filter) -> None:
    for prim in stage.Traverse():
        if prim.HasAPI(UsdPhysics.ArticulationRootAPI) and not leave_out.takes_name(str(prim.GetPath())):
            warn(
                f"{path}: {prim.GetPath()} is an articulation, probably a robot, and becomes a fixed obstacle; "
                "exclude its path if that is not intended"
            )


def _warn_of_unmatched(
    path: str, places: Sequence[Place], options: Options, solids: Sequence[Solid], ground: float | None
) -> None:
    seen = [place for place in places if place.approximation is None and _is_seen(place, options)]
    shapes = [place for place in seen if place.prim.GetTypeName() in SHAPES]
    alone = seen_without_collider(shapes, solids, ground or 0.0)
    if alone:
        warn(
            f"{path}: only colliders are read; {len(alone)} visible shapes without a collider nearby are left "
            f'out; the first is {alone[0].name}. Use geometry="visual" to read visible shapes'
        )


def _is_seen(place: Place, options: Options) -> bool:
    return place.visible and place.purpose in options.purposes


def _warn_of_emptiness(path: str, places: Sequence[Place], chosen: Sequence[Place], options: Options) -> None:
    if chosen or all(level_plane(place) is not None for place in places):
        return
    if options.geometry == "collision":
        reason = f'none of its {len(places)} shapes except the floor is a collider; use geometry="visual"'
    else:
        purposes = ", ".join(sorted(set(options.purposes)))
        reason = f"none of its {len(places)} shapes except the floor is visible and has one of the purposes {purposes}"
    warn(f"{path}: the world is empty: {reason}")


def seen_without_collider(places: Sequence[Place], solids: Sequence[Solid], ground: float) -> list[Place]:
    """Return the shapes between floor and ceiling whose bounds overlap no solid above the floor.

    Args:
        places: Visible shapes that do not collide.
        solids: Solids made from colliders.
        ground: Height of the ground [m].
    """
    bounds = [(place, _bounds(place)) for place in places]
    found = [
        (place, box)
        for place, box in bounds
        if box is not None and box[1][2] - ground > LOW and box[0][2] - ground < HIGH
    ]
    if not found:
        return []
    lows, highs = solids_bounds(solids)
    standing = highs[:, 2] - ground > LOW
    lows, highs = lows[standing] - _NEAR, highs[standing] + _NEAR
    step = max(1, _AT_ONCE // max(1, len(lows)))
    alone: list[Place] = []
    for start in range(0, len(found), step):
        boxes = np.array([box for _, box in found[start : start + step]])
        meets = ((boxes[:, None, 0] <= highs) & (boxes[:, None, 1] >= lows)).all(axis=-1).any(axis=-1)
        alone += [found[start + int(index)][0] for index in np.flatnonzero(~meets)]
    return alone


def _bounds(place: Place) -> FloatArray | None:
    """Return the lowest and highest corner [m] of a prim in the map frame, shape (2, 3); None if it has no extent."""
    try:
        extent = UsdGeom.Boundable(place.prim).ComputeExtent(TIME)
    except Tf.ErrorException:
        return None
    box = np.array(extent or (), dtype=np.float64)
    if box.shape != (2, 3) or not np.isfinite(box).all() or (box[0] > box[1]).any():
        return None
    corners = np.array(np.meshgrid(*box.T)).reshape(3, -1)
    placed = (place.matrix[:3, :3] @ corners).T + place.matrix[:3, 3]
    return np.array([placed.min(axis=0), placed.max(axis=0)])
