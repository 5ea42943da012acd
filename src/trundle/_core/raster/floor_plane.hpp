// The floor of a cell, as `floor_planes` describes it to the rasters above it.
#pragma once

#include <cstddef>

namespace trundle {

// Of each cell: height at its centre [m], rise along x and y [m a cell], least and most of floor - plane [m], steepest
// rise.
constexpr std::size_t kPlane = 6;

}  // namespace trundle
