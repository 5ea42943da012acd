// Rays of planar lidars.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

// Distances in cells from (x, y), in cell units, to the first blocked cell along each angle, or infinity.
nb::ndarray<nb::numpy, double> cast_grid_rays(In<std::uint8_t, 2> blocked, double x, double y, In<double, 1> angles,
                                              double reach);

// Distances from (x, y) along `count` rays at `first + i * step` to the nearest segment (x0, y0, x1, y1) or disc
// (x, y, radius), infinity where there is none within `reach`. From inside a disc the rays meet its rim.
nb::ndarray<nb::numpy, double> cast_outline_rays(In<double, 2> segments, In<double, 2> discs, double x, double y,
                                                 double first, double step, std::int64_t count, double reach);

}  // namespace trundle
