"""The C++ kernels: plain functions on arrays. They release the GIL and check their bounds at this edge."""

from trundle._core._kernels import (
    flood_free,
    flood_largest,
    inflate,
    png_unfilter,
    raster_discs,
    raster_hexahedra,
    raster_hulls,
    raster_triangles,
)

__all__ = [
    "flood_free",
    "flood_largest",
    "inflate",
    "png_unfilter",
    "raster_discs",
    "raster_hexahedra",
    "raster_hulls",
    "raster_triangles",
]
