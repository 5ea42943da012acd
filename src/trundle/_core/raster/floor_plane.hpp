// How the floor of a cell is told to the rasters that stand on it.
#pragma once

#include <cstddef>

namespace trundle {

// Of each cell: height at its centre [m], rise along x and y [m a cell], least and most of floor - plane [m], steepest rise.
constexpr std::size_t kPlane = 6;

}  // namespace trundle
