"""Pictures of plans and runs: the map, its inflation, the path, and the driven trajectory."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Goal, Pose2D, arc_lengths
from trundle.maps.masks import SpeedMask
from trundle.mission import Episode, Outcome, Trajectory
from trundle.mission.metrics import CLEARANCE_CAP
from trundle.path import Path
from trundle.pictures.colors import (
    BAD,
    GOAL,
    GOOD,
    INFLATED,
    OCCUPIED,
    PAGE,
    PLANNED,
    ROBOT,
    SEVERAL,
    START,
    UNKNOWN,
    WARNING,
    Rgb,
    speed_color,
)
from trundle.record.map_view import MapView, draw_doubts, draw_estimated, speed_zones, view_run, zone_marks
from trundle.record.page import Mark, compose_page, draw_tag
from trundle.robots import Robot
from trundle.sim.mover_history import MoverHistory

_SPEED_LEVELS = 24
_OUTLINES = 14  # approximate number of footprints along a path
_LEAST_GAP_M = 1.2
_FAINT, _FILL = 200, 70  # opacity of the outlines of movers and of their insides
_DASH = 18.0
"""Length of a stripe [px]."""

_LEGEND = (
    Mark("line", PLANNED, "planned"),
    Mark("square", OCCUPIED, "occupied"),
    Mark("square", UNKNOWN, "unknown"),
    Mark("square", INFLATED, "inflation"),
)
_STATUS: dict[Outcome, Rgb] = {Outcome.ARRIVED: GOOD, Outcome.FINISHED: GOOD, Outcome.COLLIDED: BAD}


def draw_plan(
    costmap: Costmap,
    path: Path,
    robot: Robot,
    *,
    title: str = "",
    lines: Sequence[str] = (),
    speed_mask: SpeedMask | None = None,
    before: Path | None = None,
) -> Image.Image:
    """Draw a planned path on its map, with the robot's footprint at both ends.

    Args:
        costmap: The costmap of the plan.
        path: The path.
        robot: The robot, for its footprint.
        title: Headline. By default, it is the robot's and the planner's names.
        lines: Smaller lines below it. By default, they tell length and cost.
        speed_mask: The speed limits, or None.
        before: The path before smoothing, drawn thin on top, or None.
    """
    view = MapView(costmap, path.poses[:, :2], zones=speed_zones(speed_mask, robot))
    view.line(path.poses[:, :2], PLANNED, 7)
    marks = list(_LEGEND)
    if before is not None:
        view.line(before.poses[:, :2], BAD, 2.5)
        marks[0:1] = [Mark("line", PLANNED, "smoothed"), Mark("line", BAD, "planned")]
    _draw_outlines(view, robot, path.poses, arc_lengths(path.poses))
    for pose, color in ((path.start, START), (path.goal, GOAL)):
        _draw_robot(view, robot, pose, color)
    picture = view.finish()
    ends = [(path.start.as_tuple(), "start", START), (path.goal.as_tuple(), "goal", GOAL)]
    _draw_tags(view, robot, picture, ends)
    cost = "" if math.isnan(path.cost) else f" · cost {path.cost:.1f}"
    return compose_page(
        picture,
        title=title or f"{robot.name} · {path.planner}",
        status=None,
        lines=lines or [f"{path.length:.2f} m{cost}"],
        legend=[*marks, *zone_marks(view.costmap, view.zones)],
        pixels_per_metre=view.pixels_per_metre,
    )


def draw_paths(
    costmap: Costmap, robot: Robot, paths: Mapping[str, Path], *, title: str = "", speed_mask: SpeedMask | None = None
) -> Image.Image:
    """Draw several paths between the same ends on their map, each in its own colour.

    Args:
        costmap: The costmap of the plans.
        robot: The robot, whose footprint is drawn at both ends.
        paths: At least one, by name; overlapping parts are striped.
        title: Headline. By default, it is the robot's name.
        speed_mask: The speed limits, or None.
    """
    seen = np.concatenate([path.poses[:, :2] for path in paths.values()])
    view = MapView(costmap, seen, zones=speed_zones(speed_mask, robot))
    colors = [SEVERAL[index % len(SEVERAL)] for index in range(len(paths))]
    draw_striped(view, [(path.poses[:, :2], color) for path, color in zip(paths.values(), colors, strict=True)])
    legend = [Mark("line", color, name) for name, color in zip(paths, colors, strict=True)]
    first = next(iter(paths.values()))
    for pose, color in ((first.start, START), (first.goal, GOAL)):
        _draw_robot(view, robot, pose, color)
    picture = view.finish()
    ends = [(first.start.as_tuple(), "start", START), (first.goal.as_tuple(), "goal", GOAL)]
    _draw_tags(view, robot, picture, ends)
    return compose_page(
        picture,
        title=title or robot.name,
        status=None,
        lines=[" · ".join(f"{name} {path.length:.2f} m" for name, path in paths.items())],
        legend=[*legend, *zone_marks(view.costmap, view.zones)],
        pixels_per_metre=view.pixels_per_metre,
    )


def draw_run(
    costmap: Costmap | None,
    robot: Robot,
    episode: Episode,
    *,
    speed_mask: SpeedMask | None = None,
    movers: MoverTrails | None = None,
) -> Image.Image:
    """Draw a run on its map: planned paths, the driven trajectory coloured by speed, and the outcome.

    The path that was followed last to each goal is wide, those that it replaced are thin. Of a run with a localizer the
    estimated trajectory is drawn, too, and where the localizer said that it is not sure.

    Args:
        costmap: The costmap of the run. If None, the run is drawn on an empty floor.
        robot: The robot, for its footprint.
        episode: The run.
        speed_mask: The speed limits, or None.
        movers: Where the movers were, or None; they are drawn as they are at the end, with trails of eight seconds.
    """
    trajectory = episode.trajectory
    view = view_run(costmap, robot, episode, speed_mask)
    kept = _kept_paths(trajectory)
    for index, path in enumerate(episode.paths):
        view.line(path.poses[:, :2], PLANNED, 11 if index in kept else 2)
    poses = trajectory.poses
    _draw_outlines(view, robot, poses, arc_lengths(poses))
    top_speed = robot.limits.linear_speed
    if movers is not None:
        movers.draw(view)
    doubts = draw_doubts(view, trajectory)
    believed = [*draw_estimated(view, trajectory), *doubts]
    draw_driven(view, trajectory, top_speed)
    _draw_robot(view, robot, episode.start, START)
    end = Pose2D(*poses[-1].tolist())
    view.outline(end, robot.outline, ROBOT, 1.5, fill=60)
    for goal in episode.goals:
        _draw_goal(view, robot, goal)
    if episode.outcome not in (Outcome.ARRIVED, Outcome.FINISHED):
        view.arrow(end, 14, ROBOT)
        view.cross((end.x, end.y), 13, _STATUS.get(episode.outcome, WARNING), 5)
    picture = view.finish()
    names = ["goal"] if len(episode.goals) == 1 else [f"goal {number + 1}" for number in range(len(episode.goals))]
    tags = [(episode.start.as_tuple(), "start", START)]
    tags += [(goal, name, GOAL) for goal, name in zip(episode.goals, names, strict=True)]
    _draw_tags(view, robot, picture, tags)
    moving = [Mark("line", WARNING, "moving")] if movers else []
    return compose_page(
        picture,
        title=episode.name,
        status=(episode.outcome.value.replace("_", " "), _STATUS.get(episode.outcome, WARNING)),
        lines=describe(episode),
        legend=[*_LEGEND, *believed, *moving, *zone_marks(view.costmap, view.zones)],
        pixels_per_metre=view.pixels_per_metre,
        top_speed=top_speed,
    )


def describe(episode: Episode) -> list[str]:
    """Return the metrics of a run as lines of text, without wall times, so that equal runs give equal pictures."""
    metrics = episode.metrics
    figures = [
        f"{metrics.time_s:.1f} s",
        f"{metrics.distance_m:.2f} m driven",
        f"{metrics.path_length_m:.2f} m planned",
    ]
    if metrics.min_clearance_m is not None:
        capped = metrics.min_clearance_m >= CLEARANCE_CAP
        figures.append(f"smallest clearance {metrics.min_clearance_m:.2f} m" + (" or more" if capped else ""))
    if metrics.max_cross_track_error_m is not None:
        figures.append(f"off path at most {metrics.max_cross_track_error_m:.2f} m")
    figures.append(f"SPL {metrics.spl:.2f}")
    settings = [
        episode.planner,
        episode.controller,
        episode.robot,
        f"seed {episode.seed}",
    ]
    lines = [" · ".join(figures), " · ".join(settings)]
    return lines if episode.arrived or episode.outcome is Outcome.FINISHED else [episode.message, *lines]


def draw_driven(view: MapView, trajectory: Trajectory, top_speed: float, *, width: float = 4.0) -> None:
    """Draw the driven trajectory, coloured by speed."""
    points = trajectory.poses[:, :2]
    kept = thin(view.to_pixels(points), 1.5)
    if len(kept) < 2:
        return
    levels = np.minimum(np.abs(trajectory.v[kept]) / top_speed * _SPEED_LEVELS, _SPEED_LEVELS).round().astype(int)
    edges = [0, *(np.flatnonzero(np.diff(levels[1:])) + 1).tolist(), len(kept) - 1]
    for first, last in itertools.pairwise(edges):
        if last > first:
            color = speed_color(levels[first + 1] / _SPEED_LEVELS)
            view.line(points[kept[first : last + 1]], color, width)


def thin(pixels: FloatArray, gap: float) -> list[int]:
    """Return indices of points, shape (N, 2), that are `gap` apart along the line, including the first and the last."""
    driven = arc_lengths(pixels)
    marks = np.searchsorted(driven, np.arange(0.0, driven[-1], gap))
    return sorted({*marks.tolist(), len(pixels) - 1})


def _kept_paths(trajectory: Trajectory) -> set[int]:
    """Return indices of the paths that were followed last to each goal; the others were replaced on the way."""
    return {int(trajectory.path[trajectory.goal == goal][-1]) for goal in set(trajectory.goal.tolist())}


def _draw_outlines(view: MapView, robot: Robot, poses: FloatArray, along: FloatArray) -> None:
    """Draw faint footprints at equal distances between the ends."""
    gap = max(_LEAST_GAP_M, along[-1] / _OUTLINES)
    for mark in np.arange(gap, along[-1] - 0.5 * gap, gap):
        after = min(int(np.searchsorted(along, mark)), len(poses) - 1)
        before = max(0, after - 1)
        share = (mark - along[before]) / max(1e-9, along[after] - along[before])
        x, y = poses[before, :2] + share * (poses[after, :2] - poses[before, :2])
        yaw = _heading(poses, before, after)
        view.outline(Pose2D(float(x), float(y), yaw), robot.outline, ROBOT, 1.5, alpha=80)


def _heading(poses: FloatArray, before: int, after: int) -> float:
    """Return the yaw between consecutive poses: a planned path turns at its corners, a driven one in between."""
    step = poses[after, :2] - poses[before, :2]
    if np.hypot(*step) < 0.2:
        return float(poses[after, 2])
    forward = float(np.arctan2(step[1], step[0]))
    backward = math.cos(forward - float(poses[before, 2])) < -0.5
    return forward + math.pi if backward else forward


def _draw_robot(view: MapView, robot: Robot, pose: Pose2D, color: Rgb) -> None:
    view.outline(pose, robot.outline, color, 2.5, fill=50)
    view.disc((pose.x, pose.y), 10, PAGE)
    view.disc((pose.x, pose.y), 8.5, color)
    view.arrow(pose, 12, PAGE)


def _draw_goal(view: MapView, robot: Robot, goal: Goal) -> None:
    """Draw a goal: as the footprint at the goal if it has a yaw, else as a target."""
    if not goal.yaw_free:
        _draw_robot(view, robot, goal.pose, GOAL)
        return
    view.disc(goal, 10, PAGE)
    view.ring(goal, 10, GOAL, 3)
    view.disc(goal, 4, GOAL)


def _draw_tags(
    view: MapView, robot: Robot, picture: Image.Image, tags: Sequence[tuple[tuple[float, ...], str, Rgb]]
) -> None:
    draw = ImageDraw.Draw(picture)
    apart = min(60.0, 8.0 + 0.7 * robot.circumscribed_radius * view.pixels_per_metre)
    for point, text, color in tags:
        x, y = view.to_pixels([point[:2]])[0]
        draw_tag(draw, (float(x), float(y)), text, color, apart=apart, size=picture.size)


class MoverTrails(MoverHistory):
    """Collects the movers of a run, one entry for each step, and draws them."""

    def draw(self, view: MapView) -> None:
        """Draw the outlines of the movers at the end of the run, each with its trail."""
        if not self._times:
            return
        shown = self.at(self._times[-1])
        for trail, state in zip(shown.trails, shown.states, strict=True):
            view.line(trail, WARNING, 2)
            view.outline(state.pose, np.array(state.outline), WARNING, 2.0, alpha=_FAINT, fill=_FILL)


# Stripes --------------------------------------------------------------------------------------------------------------


def draw_striped(view: MapView, lines: Sequence[tuple[FloatArray, Rgb]], *, width: float = 5.0) -> None:
    """Draw lines so that each stays visible along its whole length.

    Overlapping lines alternate in stripes of their colours; the stripes follow the first of them.

    Args:
        view: The map to draw on.
        lines: Points [m] in the map frame, shape (N, 2), and a colour, for each line.
        width: Width of the lines [px].
    """
    sampled = [_resample(view.to_pixels(points)) for points, _ in lines]
    stripes = np.stack([_stripe_numbers(samples, view.size, width) for samples in sampled])
    colors = [color for _, color in lines]
    for index, samples in enumerate(sampled):
        cols, rows = np.floor(samples).astype(int).T
        inside = (cols >= 0) & (cols < view.size[0]) & (rows >= 0) & (rows < view.size[1])
        here = np.where(inside, stripes[:, rows.clip(0, view.size[1] - 1), cols.clip(0, view.size[0] - 1)], 0)
        here[index] = np.maximum(here[index], 1)  # a line covers its own ends, too
        shown = _choose(here)
        changes = np.flatnonzero(np.diff(shown)) + 1
        for first, last in itertools.pairwise([0, *changes.tolist(), len(samples) - 1]):
            view.line_pixels(samples[first : last + 1], colors[shown[first]], width)


def _choose(here: npt.NDArray[np.int32]) -> npt.NDArray[np.int64]:
    """Return the line that is visible at each sample, from the stripe numbers of all lines, shape (lines, samples)."""
    on = here > 0
    first = on.argmax(axis=0)
    turn = here[first, np.arange(here.shape[1])] % on.sum(axis=0)
    return (np.cumsum(on, axis=0) > turn).argmax(axis=0)


def _resample(pixels: FloatArray) -> FloatArray:
    """Return points about a pixel apart along a line, shape (N, 2) with N ≥ 2."""
    along = arc_lengths(pixels)
    marks = np.linspace(0.0, along[-1], max(2, int(along[-1]) + 1))
    return np.column_stack([np.interp(marks, along, pixels[:, axis]) for axis in (0, 1)])


def _stripe_numbers(samples: FloatArray, size: tuple[int, int], width: float) -> npt.NDArray[np.int32]:
    """Return the stripe's number, from 1, at each pixel that a line of this width covers, else 0; (height, width)."""
    image = Image.new("I", size, 0)
    draw = ImageDraw.Draw(image)
    along = arc_lengths(samples)
    numbers = (along / _DASH).astype(int) + 1
    changes = np.flatnonzero(np.diff(numbers)) + 1
    for first, last in itertools.pairwise([0, *changes.tolist(), len(samples) - 1]):
        part = [(float(x), float(y)) for x, y in samples[first : last + 1]]
        if len(part) > 1:
            draw.line(part, fill=int(numbers[first]), width=max(1, round(width)), joint="curve")
    return np.asarray(image, dtype=np.int32)
