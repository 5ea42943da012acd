// Kernels of a costmap: inflation, and a footprint against its blocked cells.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

// Costs of an occupancy map; `table` holds the cost by squared distance in cells to the nearest blocked cell.
nb::ndarray<nb::numpy, std::uint8_t> inflate(In<std::int8_t, 2> occupancy, In<std::uint8_t, 1> table);

// Whether the footprint touches a blocked cell, or leaves the map, at each pose (x, y, yaw).
nb::ndarray<nb::numpy, bool> footprint_collides(In<std::uint8_t, 2> cells, double resolution, double origin_x,
                                                double origin_y, double origin_yaw, In<double, 2> outline,
                                                In<double, 2> poses);

// Which share of each motion from a first to a last pose is free, from its start on.
nb::ndarray<nb::numpy, double> footprint_sweep(In<std::uint8_t, 2> cells, double resolution, double origin_x,
                                               double origin_y, double origin_yaw, In<double, 2> outline,
                                               In<double, 2> first, In<double, 2> last);

// Distance [m] from the footprint at each pose to the nearest blocked cell or the map's edge, at most `cap`.
nb::ndarray<nb::numpy, double> footprint_clearance(In<std::uint8_t, 2> cells, double resolution, double origin_x,
                                                   double origin_y, double origin_yaw, In<double, 2> outline,
                                                   In<double, 2> poses, double cap);

}  // namespace trundle
