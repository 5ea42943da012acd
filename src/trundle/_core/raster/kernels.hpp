// Kernels that mark the cells of a map which solids reach into, between two heights.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

using Vertices = In<double, 2>;
using Faces = In<std::int32_t, 2>;
using Planes = In<double, 3>;  // of a floor, by cell

// Boxes and other hexahedra, shape (N, 8, 3).
void raster_hexahedra(Cells cells, In<double, 3> corners, double low, double high, double resolution, double depth,
                      bool centre);

// Discs, shape (N, 3): x, y, radius.
void raster_discs(Cells cells, In<double, 2> discs, double resolution, double depth, bool centre);

// Cylinders that are not upright, shape (N, 8): middle, axis, radius, length.
void raster_cylinders(Cells cells, In<double, 2> cylinders, double low, double high, double resolution, double depth,
                      bool centre);

// A mesh: its surface and, with `fill`, what it encloses. Returns whether the mesh is closed, whether any of it lies in
// the band over the grid, and the faces of a closed mesh that lie between two cells somewhere, for `raster_thin_faces`.
nb::tuple raster_mesh(Cells cells, Vertices vertices, Faces faces, In<double, 2> transform, double low, double high,
                      double resolution, double depth, bool centre, bool fill);

// Faces of a closed mesh that lie between two cells with no solid behind them: walls without thickness. Both cells
// become 99 where the one behind is not occupied (100).
void raster_thin_faces(Cells cells, Vertices vertices, Faces faces, In<double, 2> transform, double low, double high,
                       double resolution, double depth);

// As `raster_mesh`, with the band above the floor.
nb::tuple raster_mesh_over_floor(Cells cells, Planes planes, Vertices vertices, Faces faces, In<double, 2> transform,
                                 double low, double high, double resolution, double depth, bool centre);

// As `raster_thin_faces`, with the band above the floor.
void raster_thin_faces_over_floor(Cells cells, Planes planes, Vertices vertices, Faces faces, In<double, 2> transform,
                                  double low, double high, double resolution, double depth);

// The floor of each cell of a grid, shape (rows, cols, 6), NaN where it is unknown; `heights` are samples `spacing`
// cells apart, the first of them at (x, y) cells from the grid's corner.
nb::ndarray<nb::numpy, double> floor_planes(In<double, 2> heights, double spacing, double x, double y,
                                            double resolution, std::int64_t rows, std::int64_t cols);

}  // namespace trundle
