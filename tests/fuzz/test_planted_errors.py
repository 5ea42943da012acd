"""Each target notices an answer that is a little wrong: what it looks at is really compared."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fuzz import (
    fuzz_batch,
    fuzz_components,
    fuzz_cost_field,
    fuzz_curves,
    fuzz_inflation,
    fuzz_layers,
    fuzz_localization,
    fuzz_mapping,
    fuzz_missions,
    fuzz_mppi,
    fuzz_png_filter,
    fuzz_rays,
    fuzz_tracking,
    fuzz_zbuffer,
)
from fuzz.loop import play
from fuzz.targets import TARGETS
from trundle import _core
from trundle.costmap import Costmap
from trundle.maps.images import pnm
from trundle.maps.rasterise import SolidRaster
from trundle.planning import GridSearch
from trundle.planning.constrained_smoother import ConstrainedSmoother
from trundle.planning.hybrid_astar import HybridAStarPlanner
from trundle.worlds.movers import walk

Function = Callable[..., Any]


def longer(find: Function) -> Function:
    def find_longer(search, start, goal, **options):
        path = find(search, start, goal, **options)
        return dataclasses.replace(path, length=path.length * (1.0 + 1e-9) + 1e-9)

    return find_longer


def far_off(find: Function) -> Function:
    def find_far_off(search, start, goal, **options):
        path = find(search, start, goal, **options)
        return dataclasses.replace(path, length=path.length + (2.0 if search.method == "astar" else 0.0))

    return find_far_off


def shifted(plan: Function) -> Function:
    def plan_shifted(planner, costmap, start, goal, **options):
        path = plan(planner, costmap, start, goal, **options)
        poses = path.poses.copy()
        poses[1:-1, :2] += 0.5 * costmap.resolution * max(costmap.shape)
        return dataclasses.replace(path, poses=poses)

    return plan_shifted


def off_course(explain: Function) -> Function:
    def explain_off_course(smoother, path, costmap):
        done = explain(smoother, path, costmap)
        poses = done.path.poses.copy()
        poses[1:-1, 0] += 0.02
        return dataclasses.replace(done, path=dataclasses.replace(done.path, poses=poses))

    return explain_off_course


def scaled(share: float) -> Callable[[Function], Function]:
    return lambda function: lambda *arguments, **options: function(*arguments, **options) * (1.0 + share)


def one_more(function: Function) -> Function:
    return lambda *arguments: function(*arguments) + 1


def last_cell_changed(function: Function) -> Function:
    def change(*arguments, **options):
        out = function(*arguments, **options).copy()
        out[-1:, -1:] ^= 1
        return out

    return change


def last_cost_changed(update: Function) -> Function:
    def change(costmap, *arguments):
        updated = update(costmap, *arguments)
        data = updated.data.copy()
        data[-1, -1] ^= 1
        return dataclasses.replace(updated, data=data)

    return change


def inverted(collides: Function) -> Function:
    return lambda *arguments, **options: ~collides(*arguments, **options)


def cell_left_out(add: Function) -> Function:
    def leave_out(raster, solids):
        add(raster, solids)
        marked = np.argwhere(raster.cells == 100)
        if len(marked):
            raster.cells[tuple(marked[len(marked) // 2])] = -1

    return leave_out


def first_cell_changed(mark: Function) -> Function:
    """One more bit of evidence in the first cell."""

    def change(evidence, *arguments):
        box = mark(evidence, *arguments)
        evidence[0, 0] ^= 4
        return box

    return change


class HeavyMppi(_core.Mppi):
    """Takes one sample's cost for a little more than it is."""

    def costs(self) -> Any:
        costs = super().costs()
        costs[-1] += 0.05 * (1.0 + costs[-1])
        return costs


class SlowBatch(_core.Batch):
    """Drives a little less far than it should."""

    def drive(self, poses: Any, *arguments: Any) -> None:
        before = poses.copy()
        super().drive(poses, *arguments)
        poses -= 1e-6 * (poses - before)


class ShortSightedBatch(_core.Batch):
    """Measures too little."""

    def scan(self, ranges: Any, *arguments: Any) -> None:
        super().scan(ranges, *arguments)
        ranges *= 1.0 - 1e-5


class LateCrowd(_core.CrowdRun):
    """Shows where its members were a moment ago."""

    def at(self, time: float) -> Any:
        return super().at(time - 1e-6)


class HastyDriver(_core.MissionDriver):
    """Commands a little more than the navigator."""

    def drive(self, *arguments: Any) -> Any:
        rows, ends, results = super().drive(*arguments)
        rows[1:, 5] *= 1.0 + 1e-6
        return rows, ends, results


class OverhastyDriver(_core.MissionDriver):
    """Sends a little more than it is given, where it is stepped."""

    def begin(self, *arguments: Any) -> Any:
        run = super().begin(*arguments)

        class Run:
            decide, look, take, result = run.decide, run.look, run.take, run.result

            def move(self, v: float, w: float) -> None:
                run.move(v * (1.0 + 1e-6), w)

        return Run()


class ImpatientDriver(_core.MissionDriver):
    """Takes a drive by others to be lost."""

    def begin(self, *arguments: Any) -> Any:
        run = super().begin(*arguments)

        class Run:
            decide, look, move, result = run.decide, run.look, run.move, run.result

            def take(self, v: float, w: float) -> int:
                return max(4, run.take(v, w) - 4)

        return Run()


class DriftingTracker(_core.ScanTracker):
    """Predicts too far."""

    def tracks(self, now: float) -> Any:
        return super().tracks(now + 1e-4)


class LossySurfaceMap(_core.SurfaceMap):
    """Does not take away what is taken from it."""

    def add(self, points: Any, normals: Any, pose: Any, sign: int) -> None:
        super().add(points, normals, pose, abs(sign))


class SkewedSurfaceMap(_core.SurfaceMap):
    """Matches a little beside the surfaces."""

    def match(self, *arguments: Any) -> Any:
        poses, *rest = super().match(*arguments)
        return poses + 1e-3, *rest


class ShiftedSurfaceMap(_core.SurfaceMap):
    """Finds scans a little beside where they fit."""

    def search(self, *arguments: Any) -> Any:
        pose, share = super().search(*arguments)
        return pose + 1e-3, share


def painted_beside(paint: Function) -> Function:
    def change(*arguments):
        box = paint(*arguments)
        cells = arguments[5]
        cells[:] = np.roll(cells, 1, axis=1)
        return box

    return change


def learned_twice(learn: Function) -> Function:
    return lambda *arguments: (learn(*arguments), learn(*arguments))


def part(index: int, change: Callable[[Any], Any]) -> Callable[[Function], Function]:
    def plant(function: Function) -> Function:
        def changed(*arguments):
            out = list(function(*arguments))
            out[index] = change(out[index])
            return tuple(out)

        return changed

    return plant


def fragile(decode: Function) -> Function:
    def decode_fragile(content: bytes, name: str) -> object:
        assert len(content) % 7, "planted"
        return decode(content, name)

    return decode_fragile


PLANTED: dict[str, tuple[str, Any, str, Callable[[Function], Function]]] = {
    "one method's path": ("grid_search", GridSearch, "shortest_path", far_off),
    "exact length": ("any_angle", GridSearch, "any_angle_path", longer),
    "weighted cost": ("weighted_grid", _core, "grid_search", part(1, lambda cost: cost + 1e-6)),
    "line cost": ("weighted_grid", _core, "line_costs", scaled(1e-6)),
    "shortcut": ("weighted_grid", _core, "shortcut", part(1, lambda cost: cost * (1.0 + 1e-6))),
    "least cost": ("least_cost", _core, "line_costs", scaled(1e-6)),
    "field": ("cost_field", fuzz_cost_field, "cost_field", scaled(1e-5)),
    "smooth field": ("eikonal", _core, "eikonal_field", scaled(1e-2)),
    "path in walls": ("hybrid_astar", HybridAStarPlanner, "plan", shifted),
    "smoothed course": ("smoothing", ConstrainedSmoother, "explain", off_course),
    "curve": ("curves", fuzz_curves, "shortest_curves", scaled(1e-5)),
    "cost of rollouts": ("mppi", fuzz_mppi, "Mppi", lambda _: HeavyMppi),
    "inflation": ("inflation", fuzz_inflation, "inflate", last_cell_changed),
    "local update": ("inflation", Costmap, "update", last_cost_changed),
    "touching": ("footprint", Costmap, "footprint_collides", inverted),
    "clearance": ("footprint", Costmap, "clearance", scaled(1e-4)),
    "labels": ("components", fuzz_components, "label_components", part(0, np.flipud)),
    "gaps": ("components", fuzz_components, "mark_gaps", last_cell_changed),
    "flood": ("components", fuzz_components, "flood_free", one_more),
    "largest area": ("components", fuzz_components, "flood_largest", one_more),
    "rays through cells": ("rays", fuzz_rays, "cast_grid_rays", scaled(1e-3)),
    "rays that jump": ("rays", fuzz_rays, "cast_jumping_rays", scaled(1e-15)),
    "free squares": ("rays", fuzz_rays, "chebyshev_field", one_more),
    "rays to outlines": ("rays", fuzz_rays, "cast_outline_rays", scaled(1e-2)),
    "whole missions": ("missions", fuzz_missions, "MissionDriver", lambda _: HastyDriver),
    "missions in steps": ("missions", fuzz_missions, "MissionDriver", lambda _: OverhastyDriver),
    "missions by others": ("missions", fuzz_missions, "MissionDriver", lambda _: ImpatientDriver),
    "outlines to polygons": ("missions", fuzz_missions, "outline_distances", scaled(1e-6)),
    "points to a polyline": ("missions", fuzz_missions, "polyline_distances", scaled(1e-6)),
    "stopping": ("missions", fuzz_missions, "stopping_poses", scaled(1e-6)),
    "control periods": ("missions", fuzz_missions, "drive_period", part(0, lambda rows: rows * (1.0 + 1e-6))),
    "motion of many": ("batch", fuzz_batch, "Batch", lambda _: SlowBatch),
    "scans of many": ("batch", fuzz_batch, "Batch", lambda _: ShortSightedBatch),
    "crowds": ("crowds", walk, "CrowdRun", lambda _: LateCrowd),
    "lone hits": ("rays", fuzz_rays, "find_lone_hits", one_more),
    "places of hits": ("rays", fuzz_rays, "place_scan", part(0, lambda places: places + 1e-6)),
    "ranges of a lidar": ("rays", fuzz_rays, "measure_ranges", scaled(1e-6)),
    "what has moved": ("rays", fuzz_rays, "find_moved", part(0, lambda velocities: velocities * 1.001)),
    "points round a robot": ("rays", fuzz_rays, "points_around", part(0, lambda places: places + 1e-6)),
    "clearances of an outline": ("rays", fuzz_rays, "outline_clearances", scaled(1e-6)),
    "tracks": ("tracking", fuzz_tracking, "ScanTracker", lambda _: DriftingTracker),
    "marks of a scan": ("layers", fuzz_layers, "mark_scan", first_cell_changed),
    "marks that are old": ("layers", fuzz_layers, "unmark_before", first_cell_changed),
    "marks under the robot": ("layers", fuzz_layers, "unmark_within", first_cell_changed),
    "marks in a map": ("layers", fuzz_layers, "paint_marks", painted_beside),
    "marks in a window": ("layers", fuzz_layers, "repaint_marks", painted_beside),
    "solids": ("raster", SolidRaster, "add", cell_left_out),
    "distances on a map": ("localization", fuzz_localization, "distance_field", scaled(0.01)),
    "beams of a scan": ("localization", fuzz_localization, "pick_beams", part(1, lambda sensors: sensors + 1e-3)),
    "surfaces that are expected": ("localization", fuzz_localization, "expect_surfaces", one_more),
    "surfaces that are learned": ("localization", fuzz_localization, "learn_surfaces", learned_twice),
    "places on a map": ("localization", fuzz_localization, "search_poses", part(1, lambda scores: scores + 1.0)),
    "peak of particles": ("localization", fuzz_localization, "peak_particle", scaled(1e-3)),
    "normals": ("mapping", fuzz_mapping, "find_normals", scaled(0.01)),
    "poses of a graph": ("mapping", fuzz_mapping, "solve_graph", part(0, lambda poses: poses + 1e-3)),
    "surfaces that stay": ("mapping", fuzz_mapping, "SurfaceMap", lambda _: LossySurfaceMap),
    "matches of surfaces": ("mapping", fuzz_mapping, "SurfaceMap", lambda _: SkewedSurfaceMap),
    "places on surfaces": ("mapping", fuzz_mapping, "SurfaceMap", lambda _: ShiftedSurfaceMap),
    "cells of beams": ("mapping", fuzz_mapping, "count_beams", first_cell_changed),
    "cells of a map": ("mapping", fuzz_mapping, "draw_cells", one_more),
    "pictures": ("zbuffer", fuzz_zbuffer, "draw_triangles", part(1, lambda depths: depths * 1.001)),
    "row filters": ("png_filter", fuzz_png_filter, "png_unfilter", last_cell_changed),
    "reader": ("map_reader", pnm, "decode_pnm", fragile),
}


@pytest.mark.parametrize("name", PLANTED)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_planted_error_is_noticed(name, monkeypatch):
    target, where, attribute, plant = PLANTED[name]
    monkeypatch.setattr(where, attribute, plant(getattr(where, attribute)))
    with pytest.raises(AssertionError):
        play(TARGETS[target].one_round, seed=1, count=400)


def test_every_target_has_a_planted_error():
    assert {target for target, *_ in PLANTED.values()} == set(TARGETS)
