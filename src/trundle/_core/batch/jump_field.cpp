// The field that rays jump by; and rays of one lidar by it.
#include "batch/kernels.hpp"

#include "batch/jump_rays.hpp"

#include <algorithm>
#include <cmath>

namespace trundle {

nb::ndarray<nb::numpy, std::uint8_t> chebyshev_field(In<std::uint8_t, 2> blocked) {
  const auto rows = static_cast<std::ptrdiff_t>(blocked.shape(0)), cols = static_cast<std::ptrdiff_t>(blocked.shape(1));
  std::vector<std::uint8_t> out(static_cast<std::size_t>(rows * cols));
  {
    nb::gil_scoped_release release;
    const std::uint8_t *given = blocked.data();
    // Two passes, each with the four neighbours that come before: exact for this distance (Rosenfeld and Pfaltz 1968).
    const auto lower = [&](std::ptrdiff_t row, std::ptrdiff_t col, std::ptrdiff_t back) {
      std::uint8_t &cell = out[row * cols + col];
      std::uint8_t nearest = 254;
      const auto see = [&](std::ptrdiff_t r, std::ptrdiff_t c) {
        if (r >= 0 && r < rows && c >= 0 && c < cols) nearest = std::min(nearest, out[r * cols + c]);
      };
      see(row, col + back);
      for (std::ptrdiff_t beside = -1; beside <= 1; ++beside) see(row + back, col + beside);
      cell = std::min(cell, static_cast<std::uint8_t>(nearest + 1));
    };
    for (std::ptrdiff_t row = 0; row < rows; ++row) {
      for (std::ptrdiff_t col = 0; col < cols; ++col) {
        out[row * cols + col] = given[row * cols + col] ? 0 : 255;
        lower(row, col, -1);
      }
    }
    for (std::ptrdiff_t row = rows - 1; row >= 0; --row) {
      for (std::ptrdiff_t col = cols - 1; col >= 0; --col) lower(row, col, 1);
    }
  }
  return to_numpy(std::move(out), {static_cast<std::size_t>(rows), static_cast<std::size_t>(cols)});
}

nb::ndarray<nb::numpy, double> cast_jumping_rays(In<std::uint8_t, 2> field, double x, double y, In<double, 1> angles,
                                                 double reach) {
  if (!std::isfinite(x) || !std::isfinite(y)) throw nb::value_error("the rays' origin must be finite");
  if (!(reach >= 0.0) || !std::isfinite(reach)) throw nb::value_error("reach must be a finite distance");
  const batch::JumpField cells{field.data(), static_cast<std::ptrdiff_t>(field.shape(0)),
                               static_cast<std::ptrdiff_t>(field.shape(1))};
  std::vector<double> out(angles.size(), std::numeric_limits<double>::infinity());
  {
    nb::gil_scoped_release release;
    if (cells.rows > 0 && cells.cols > 0) {
      for (std::size_t i = 0; i < out.size(); ++i) {
        const double angle = angles.data()[i];
        if (std::isfinite(angle)) {
          out[i] = batch::cast_jumping_ray(cells, x, y, std::cos(angle), std::sin(angle), reach);
        }
      }
    }
  }
  const std::size_t count = out.size();
  return to_numpy(std::move(out), {count});
}

}  // namespace trundle
