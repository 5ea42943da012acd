// Mapping: surfaces seen by scans as a field that grows, pose graphs, and drawing maps from beams.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

using Floats = nb::ndarray<nb::numpy, double>;
// Counts of cells that a kernel changes in place.
using Counts = nb::ndarray<std::int32_t, nb::ndim<3>, nb::c_contig, nb::device::cpu>;

// Normals of the surfaces at points (N, 2) in the order of their beams, towards where the beams began, shape (N, 2); zero
// where the points beside it make no line. `gap` is the most distance of two points on one surface, as a share of the
// range, and `least` in any case [m].
Floats find_normals(In<double, 2> points, In<double, 2> sensors, double gap, double least);

// Poses (N, 3) that fit edges best: Levenberg-Marquardt with a sparse Cholesky decomposition. `edges` (E, 2) are nodes,
// `transforms` (E, 3) the second seen from the first, `information` (E, 3, 3), `widths` (E,) from which error (in standard
// deviations) on an edge counts less, 0 for never. Fixed nodes stay. Returns the poses, the squared error of each edge
// (E,), and (iterations, cost before, cost after).
nb::tuple solve_graph(In<double, 2> poses, In<std::int32_t, 2> edges, In<double, 2> transforms,
                      In<double, 3> information, In<double, 1> widths, In<std::uint8_t, 1> fixed,
                      std::int64_t iterations);

// Count beams from sensors (N, 2) to points (N, 2) in cells: `counts` (rows, cols, 4) are beams that end in a cell, that
// pass through it, and the sums of where in it those ended (x, y, in thousandths of a cell). Beams with `hits` 0 end
// nowhere: they only pass. Passing ends `short_by` [m] before the end. `sign` -1 takes away what 1 added. The lower-left
// corner of the cells is `corner`.
void count_beams(Counts counts, In<double, 2> sensors, In<double, 2> points, In<std::uint8_t, 1> hits,
                 In<double, 1> corner, double resolution, double short_by, int sign);

// Probabilities 0 to 100 of occupied from counts, and -1 where no beam was, shape (rows, cols): what is occupied is the
// line on which the ends of beams lie on average, one cell thick. `settings`: least ends for a wall, least share of ends
// of the beams in a cell, least beams for free.
nb::ndarray<nb::numpy, std::int8_t> draw_cells(In<std::int32_t, 3> counts, In<double, 1> settings);

}  // namespace trundle
