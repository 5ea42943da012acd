"""The fuzz targets by name, and the kernels that each of them calls."""

from __future__ import annotations

from dataclasses import dataclass

from fuzz import (
    fuzz_any_angle,
    fuzz_batch,
    fuzz_components,
    fuzz_cost_field,
    fuzz_crowds,
    fuzz_curves,
    fuzz_eikonal,
    fuzz_footprint,
    fuzz_grid_search,
    fuzz_hybrid_astar,
    fuzz_inflation,
    fuzz_layers,
    fuzz_least_cost,
    fuzz_localization,
    fuzz_map_reader,
    fuzz_mapping,
    fuzz_missions,
    fuzz_mppi,
    fuzz_png_filter,
    fuzz_raster,
    fuzz_rays,
    fuzz_smoothing,
    fuzz_tracking,
    fuzz_weighted_grid,
    fuzz_zbuffer,
)
from fuzz.loop import Round


@dataclass(frozen=True, slots=True)
class Target:
    """A target.

    Attributes:
        one_round: Plays a round.
        kernels: What it calls of `trundle._core`, itself or through the public functions.
        quick: How many rounds the tests play.
    """

    one_round: Round
    kernels: tuple[str, ...]
    quick: int


TARGETS = {
    "grid_search": Target(fuzz_grid_search.one_round, ("BinaryGrid", "walk_corners"), 300),
    "any_angle": Target(fuzz_any_angle.one_round, ("BinaryGrid",), 100),
    "weighted_grid": Target(fuzz_weighted_grid.one_round, ("grid_search", "line_costs", "shortcut"), 600),
    "least_cost": Target(fuzz_least_cost.one_round, ("LeastCost", "line_costs"), 400),
    "cost_field": Target(fuzz_cost_field.one_round, ("cost_field",), 400),
    "eikonal": Target(fuzz_eikonal.one_round, ("eikonal_field",), 150),
    "hybrid_astar": Target(fuzz_hybrid_astar.one_round, ("HybridAStar", "flood_poses"), 700),
    "smoothing": Target(fuzz_smoothing.one_round, ("PathSmoother",), 250),
    "crowds": Target(fuzz_crowds.one_round, ("CrowdFloor", "CrowdModel", "CrowdRun", "BatchCrowds"), 60),
    "curves": Target(fuzz_curves.one_round, ("shortest_curves",), 500),
    "mppi": Target(
        fuzz_mppi.one_round,
        ("Mppi", "MppiState", "MppiLimits", "MppiNoise", "MppiWindow", "MppiAim", "MppiCritics"),
        150,
    ),
    "inflation": Target(fuzz_inflation.one_round, ("inflate",), 150),
    "footprint": Target(
        fuzz_footprint.one_round, ("footprint_collides", "footprint_clearance", "footprint_sweep"), 400
    ),
    "components": Target(
        fuzz_components.one_round, ("label_components", "mark_gaps", "flood_free", "flood_largest"), 500
    ),
    "rays": Target(
        fuzz_rays.one_round,
        (
            *("cast_grid_rays", "cast_jumping_rays", "chebyshev_field"),
            *("cast_outline_rays", "find_moved", "find_lone_hits", "place_scan", "points_around", "outline_clearances"),
            "measure_ranges",
        ),
        1000,
    ),
    "missions": Target(
        fuzz_missions.one_round,
        ("MissionDriver", "MissionRun", "outline_distances", "polyline_distances", "stopping_poses", "drive_period"),
        60,
    ),
    "batch": Target(fuzz_batch.one_round, ("Batch",), 300),
    "localization": Target(
        fuzz_localization.one_round,
        (
            *("distance_field", "field_at", "move_particles", "weigh_particles", "resample_particles"),
            *("match_scan", "judge_beams", "search_poses", "pick_beams", "peak_particle"),
            *("expect_surfaces", "learn_surfaces"),
        ),
        200,
    ),
    "mapping": Target(
        fuzz_mapping.one_round, ("SurfaceMap", "find_normals", "solve_graph", "count_beams", "draw_cells"), 100
    ),
    "tracking": Target(fuzz_tracking.one_round, ("ScanTracker",), 60),
    "layers": Target(
        fuzz_layers.one_round, ("mark_scan", "paint_marks", "repaint_marks", "unmark_before", "unmark_within"), 150
    ),
    "raster": Target(
        fuzz_raster.one_round,
        (
            "raster_hexahedra",
            "raster_cylinders",
            "raster_discs",
            "raster_mesh",
            "raster_thin_faces",
            "raster_mesh_over_floor",
            "raster_thin_faces_over_floor",
            "floor_planes",
        ),
        100,
    ),
    "zbuffer": Target(fuzz_zbuffer.one_round, ("draw_triangles",), 400),
    "png_filter": Target(fuzz_png_filter.one_round, ("png_unfilter",), 1000),
    "map_reader": Target(fuzz_map_reader.one_round, ("png_unfilter",), 100),
}
