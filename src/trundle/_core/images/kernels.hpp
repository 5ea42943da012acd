// Kernels of pictures: reading PNG, and drawing triangles.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

// Bytes of rows whose first byte names their filter; `step` is the distance in bytes to the left neighbour.
nb::ndarray<nb::numpy, std::uint8_t> png_unfilter(In<std::uint8_t, 2> lines, std::size_t step);

// The triangle that each pixel shows, -1 for none, and its depth, infinity for none.
nb::tuple draw_triangles(In<double, 3> triangles, std::int64_t width, std::int64_t height, double scale, double near,
                         bool perspective);

}  // namespace trundle
