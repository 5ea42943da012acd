// The cost to go in any direction, over a small window.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

// From each cell to the seeds, which start with `values`; `costs` of a cell's length by class, infinite for walls. Cells
// that cost more than a cell (row, col) by `beyond` are left out: they are infinite.
nb::ndarray<nb::numpy, float> eikonal_field(In<std::uint8_t, 2> classes, In<float, 1> costs, In<std::int64_t, 2> seeds,
                                            In<double, 1> values, std::int64_t row, std::int64_t col, double beyond);

}  // namespace trundle
