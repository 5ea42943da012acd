// Kernels of straight lines: what they cost, and the cheapest shortcut of a path.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

// The cost of each straight line from a start to an end, infinity where it is blocked.
nb::ndarray<nb::numpy, double> line_costs(In<std::uint8_t, 2> costs, In<double, 1> weights, In<double, 2> starts,
                                          In<double, 2> ends);

// The points of a path that its cheapest shortcut keeps, by index, and the cost of that; no points where it is blocked.
nb::tuple shortcut(In<std::uint8_t, 2> costs, In<double, 1> weights, In<double, 2> points);

}  // namespace trundle
