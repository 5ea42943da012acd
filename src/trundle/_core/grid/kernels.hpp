// The kernel of grids whose cells have a weight each.
#pragma once

#include <nanobind/stl/pair.h>

#include <optional>
#include <utility>

#include "shared/arrays.hpp"
#include "shared/call_limits.hpp"

namespace trundle {

// Shortest path over cells that have a weight each: its cells (row, col), shape (N, 2), and its cost. No cells and 0
// where there is no path; no cells and NaN where the search was stopped.
nb::tuple grid_search(In<std::uint8_t, 2> costs, In<std::uint16_t, 1> weights, std::pair<int, int> start,
                      std::pair<int, int> goal, int connectivity, std::optional<double> seconds, const Flag &cancel);

}  // namespace trundle
