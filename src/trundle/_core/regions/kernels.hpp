// Kernels on the connected regions of a map.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

// Labels of the connected components, numbered from 1 in the order of their first cells, and a row of a table for each:
// cells, first row, end row, first column, end column.
nb::tuple label_components(In<std::uint8_t, 2> mask, bool diagonal);

// Marks runs of open cells along rows, columns and both diagonals that are shorter than `limit` cells, with a blocked
// cell or the edge of the grid at both ends.
nb::ndarray<nb::numpy, std::uint8_t> mark_gaps(In<std::uint8_t, 2> blocked, double limit);

// Unknown cells that are joined to a seed become free; returns how many.
std::int64_t flood_free(Cells cells, In<std::int64_t, 2> seeds);

// The largest area of unknown cells becomes free, the first of those that are as large; returns how many, 0 where there
// is none.
std::int64_t flood_largest(Cells cells);

}  // namespace trundle
