"""A world from above as a picture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PIL import Image

from trundle._core import draw_triangles
from trundle.geometry import FloatArray, Pose2D
from trundle.geometry.solids import OccupancyCells, Solid, solids_bounds
from trundle.pictures.cells import merge_cells
from trundle.pictures.colors import START, WARNING
from trundle.pictures.figure import make_figure
from trundle.pictures.plan import Plan
from trundle.worlds.movers.crowd import Crowd
from trundle.worlds.movers.mover import Mover, outline_of
from trundle.worlds.movers.walk import CrowdWalk, RobotMotion
from trundle.worlds.tessellate import solid_triangles

_CEILING_M = 2.0
"""Solids that start above this height are left out: they would hide everything below."""

_LONG_SIDE = 800  # [pixels]
_STEP_M = 0.08  # a drop in height from one pixel to the next that gets an outline
_SUN = np.array([-0.45, 0.35, 0.82])  # from the upper left, as in maps: shadows then read as heights
_AHEAD_S, _AHEAD_STEPS = 8.0, 41  # how far movers' lines reach, in points every 0.2 s
_FILL = 110  # opacity of movers, 0 to 255
_NO_ROBOT = RobotMotion(1e6, 1e6, 0.0, 0.0, 0.0)
_SAME = np.arange(256, dtype=np.uint8)


def draw_world(
    solids: Sequence[Solid],
    seeds: Sequence[tuple[float, float]],
    title: str,
    lines: Sequence[str],
    *,
    movers: Sequence[Mover | Crowd] = (),
) -> Image.Image:
    """Draw solids from above, with the seed points, the movers where they start, and north up.

    Each mover has a line along its first eight seconds.
    """
    lows, highs = solids_bounds(solids)
    low_enough = lows[:, 2] < _CEILING_M
    shown = [solid for solid, keep in zip(solids, low_enough, strict=True) if keep]
    points = np.concatenate([np.array(seeds).reshape(-1, 2), lows[:, :2], highs[:, :2]])
    plan = Plan(points if len(points) else [(0.0, 0.0)], long_side=_LONG_SIDE)
    if shown:
        pixels, covered = _render(shown, plan, float(highs[low_enough, 2].max()))
        plan.paste(pixels, covered)
    for seed in seeds:
        plan.disc(seed, 4.0, START)
    _draw_movers(plan, movers, solids)
    return make_figure(plan.finish(), plan.pixels_per_metre, title, lines)


def _draw_movers(plan: Plan, movers: Sequence[Mover | Crowd], solids: Sequence[Solid]) -> None:
    scripted = [mover for mover in movers if isinstance(mover, Mover)]
    crowds = [crowd for crowd in movers if isinstance(crowd, Crowd)]
    times = np.linspace(0.0, _AHEAD_S, _AHEAD_STEPS)
    paths = [np.array([mover.motion.at(time)[:3] for time in times.tolist()]) for mover in scripted]
    outlines = [outline_of(mover.parts) for mover in scripted]
    if crowds:
        walk = CrowdWalk(crowds, scripted, solids)
        walk.reset(0, _NO_ROBOT)
        states = np.array([walk.at(time, _NO_ROBOT)[:, :3] for time in times.tolist()])
        paths += list(states.transpose(1, 0, 2))
        outlines += [outline_of(crowd.body) for crowd in crowds for _ in range(crowd.count)]
    for path, outline in zip(paths, outlines, strict=True):
        plan.line(path[:, :2], WARNING, 1.5)
        corners = Pose2D(*path[0].tolist()).transform_points(outline)
        plan.polygon(corners, WARNING, fill=_FILL)


def _render(solids: Sequence[Solid], plan: Plan, top: float) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.bool_]]:
    """Return colours seen from above, and a mask of pixels with a solid, over the plan's inner pixels."""
    meshes = [solid for solid in solids if not isinstance(solid.shape, OccupancyCells)]
    parts = [solid_triangles(solid) for solid in meshes]
    corners = np.concatenate([np.zeros((0, 3, 3)), *parts])
    colors = np.array([solid.color[:3] for solid in meshes]).reshape(-1, 3)
    colors = np.repeat(colors, [len(part) for part in parts], axis=0)
    x, y = plan.inner_points()
    middle = np.array([(x[0] + x[-1]) / 2.0, (y[0] + y[-1]) / 2.0, top + 1.0])
    seen = (corners - middle) * (1.0, 1.0, -1.0)
    faces, depths = draw_triangles(seen, len(x), len(y), plan.inner_scale, 1e-3, False)
    heights = top + 1.0 - depths
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    normals *= np.where(normals[:, 2:] < 0.0, -1.0, 1.0)  # thin sheets are also lit from above
    lit = colors * (0.62 + 0.38 * np.clip(normals @ _SUN, 0.0, 1.0))[:, None]
    picture = np.zeros((len(y), len(x), 3))
    picture[faces >= 0] = lit[faces[faces >= 0]]
    for solid in solids:
        if isinstance(solid.shape, OccupancyCells):
            _lay_cells(solid, solid.shape, (x, y), heights, picture)
    picture *= np.where(_outlines(heights), 0.55, 1.0)[..., None]
    return (picture.clip(0.0, 1.0) * 255.0).round().astype(np.uint8), np.isfinite(heights)


def _lay_cells(
    solid: Solid, cells: OccupancyCells, at: tuple[FloatArray, FloatArray], heights: FloatArray, picture: FloatArray
) -> None:
    """Draw the walls of blocked cells where they are the highest surface; changes both arrays."""
    x, y = (grid.ravel() for grid in np.meshgrid(*at))
    top = solid.pose.position[2] + cells.height
    merged = max(1, int((at[0][1] - at[0][0]) / cells.resolution)) if len(at[0]) > 1 else 1
    blocked = merge_cells(_SAME, cells.blocked.view(np.uint8), merged)
    local = (np.column_stack([x, y, np.full(len(x), top)]) - solid.pose.position) @ solid.pose.rotation()
    col, row = np.floor(local[:, :2].T / (cells.resolution * merged)).astype(int)
    inside = (row >= 0) & (row < blocked.shape[0]) & (col >= 0) & (col < blocked.shape[1])
    hit = np.zeros(len(x), dtype=np.bool_)
    hit[inside] = blocked[row[inside], col[inside]] > 0
    higher = hit.reshape(heights.shape) & (heights < top)
    heights[higher], picture[higher] = top, solid.color[:3]


def _outlines(heights: FloatArray) -> npt.NDArray[np.bool_]:
    """Return pixels of a solid next to a drop in height."""
    ground = np.where(np.isfinite(heights), heights, -1e9)
    edges = np.zeros(heights.shape, dtype=np.bool_)
    for axis in (0, 1):
        drop = np.diff(ground, axis=axis)
        before, after = (slice(None, -1), slice(1, None))
        low = (before, slice(None)) if axis == 0 else (slice(None), before)
        high = (after, slice(None)) if axis == 0 else (slice(None), after)
        edges[low] |= drop < -_STEP_M
        edges[high] |= drop > _STEP_M
    return edges
