"""The C++ kernels: plain functions on arrays. They release the GIL and check their bounds at this edge."""

from trundle._core._kernels import (
    cast_grid_rays,
    cast_outline_rays,
    draw_triangles,
    flood_free,
    flood_largest,
    footprint_clearance,
    footprint_collides,
    grid_search,
    inflate,
    line_costs,
    png_unfilter,
    raster_discs,
    raster_hexahedra,
    raster_hulls,
    raster_triangles,
    shortcut,
)

__all__ = [
    "cast_grid_rays",
    "cast_outline_rays",
    "draw_triangles",
    "flood_free",
    "flood_largest",
    "footprint_clearance",
    "footprint_collides",
    "grid_search",
    "inflate",
    "line_costs",
    "png_unfilter",
    "raster_discs",
    "raster_hexahedra",
    "raster_hulls",
    "raster_triangles",
    "shortcut",
]
