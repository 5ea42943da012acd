// Many robots on many maps at once.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

// Chebyshev distance in cells from each cell to the nearest blocked one: 0 in it, 255 at most and where there is none.
nb::ndarray<nb::numpy, std::uint8_t> chebyshev_field(In<std::uint8_t, 2> blocked);

// Distances in cells from (x, y), in cell units, to the first blocked cell along each angle, or infinity, by that field.
nb::ndarray<nb::numpy, double> cast_jumping_rays(In<std::uint8_t, 2> field, double x, double y, In<double, 1> angles,
                                                 double reach);

}  // namespace trundle
