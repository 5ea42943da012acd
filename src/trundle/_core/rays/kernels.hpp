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

// What an earlier scan from (x, y) says about points: 1 where it saw farther than to the point and `margin`, else 2 where
// it met something there, else 0. `bearings` of its beams are ascending from 0, `zero` is that of the first, `spacing`
// the angle between two; `through` is how far each saw, `ends` where it met something (infinity: nowhere). A point is
// compared with the nearest beam, and with the ends of `aside` beams on both sides of it.
nb::ndarray<nb::numpy, std::uint8_t> compare_scan(In<double, 1> bearings, In<double, 1> through, In<double, 2> ends,
                                                  double x, double y, double zero, double spacing,
                                                  In<double, 2> points, double margin, int aside);

}  // namespace trundle
