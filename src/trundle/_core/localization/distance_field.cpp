// Signed distances of cells' centres from the squares of occupied cells (outside) or of the others (inside).
//
// The distance from a centre to a square is max(|dx| - 1/2, 0) and likewise in y, so the square of the whole one is a
// sum that can be minimised along rows first and along columns after (Felzenszwalb and Huttenlocher 2012, section 2).
// Distances are truncated, so the second pass looks at a band of rows only, nearest first, until none can be nearer.
#include "localization/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "localization/checks.hpp"
#include "localization/field_view.hpp"

namespace trundle {

using namespace localization;

namespace {

float gap(std::ptrdiff_t cells) { return cells == 0 ? 0.0f : static_cast<float>(cells) - 0.5f; }

// Squares of the distances [cells²] to the nearest cell of the kind `wanted`, at most `reach`².
std::vector<float> squares_to(const std::uint8_t *cells, std::ptrdiff_t rows, std::ptrdiff_t cols, bool wanted,
                              std::ptrdiff_t reach) {
  const float most = static_cast<float>(reach) * static_cast<float>(reach);
  std::vector<float> along(static_cast<std::size_t>(rows * cols), most);
  std::vector<std::uint8_t> any(static_cast<std::size_t>(rows), 0);
  for (std::ptrdiff_t row = 0; row < rows; ++row) {
    const std::uint8_t *line = cells + row * cols;
    float *out = along.data() + row * cols;
    std::ptrdiff_t last = -reach - 1;
    for (std::ptrdiff_t col = 0; col < cols; ++col) {
      if ((line[col] != 0) == wanted) last = col, any[row] = 1;
      if (col - last <= reach) out[col] = std::min(most, gap(col - last) * gap(col - last));
    }
    last = cols + reach + 1;
    for (std::ptrdiff_t col = cols; col-- > 0;) {
      if ((line[col] != 0) == wanted) last = col;
      if (last - col <= reach) out[col] = std::min(out[col], gap(last - col) * gap(last - col));
    }
  }
  std::vector<float> nearest(along);
  for (std::ptrdiff_t row = 0; row < rows; ++row) {
    float *out = nearest.data() + row * cols;
    for (std::ptrdiff_t step = 1; step <= reach; ++step) {
      const float across = gap(step) * gap(step);
      if (step % 4 == 1 && *std::max_element(out, out + cols) <= across) break;
      for (const std::ptrdiff_t other : {row - step, row + step}) {
        if (other < 0 || other >= rows || !any[other]) continue;
        const float *from = along.data() + other * cols;
        for (std::ptrdiff_t col = 0; col < cols; ++col) out[col] = std::min(out[col], from[col] + across);
      }
    }
  }
  return nearest;
}

}  // namespace

Field distance_field(In<std::uint8_t, 2> occupied, double resolution, double shift, double limit) {
  check_resolution(resolution);
  refuse_unless(std::isfinite(shift) && std::abs(shift) <= resolution, "the shift must be at most a cell");
  refuse_unless(limit >= resolution && limit <= 1000.0 * resolution, "the limit must be from 1 to 1000 cells");
  const auto rows = static_cast<std::ptrdiff_t>(occupied.shape(0)), cols = static_cast<std::ptrdiff_t>(occupied.shape(1));
  refuse_unless(rows > 0 && cols > 0, "a field needs cells");
  std::vector<float> out;
  {
    nb::gil_scoped_release release;
    // One cell more than the limit, so that a shift towards zero does not show.
    const auto reach = static_cast<std::ptrdiff_t>(std::ceil(limit / resolution)) + 2;
    out = squares_to(occupied.data(), rows, cols, true, reach);
    const std::vector<float> inside = squares_to(occupied.data(), rows, cols, false, reach);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double cells = occupied.data()[i] ? -std::sqrt(inside[i]) : std::sqrt(out[i]);
      out[i] = static_cast<float>(std::clamp(cells * resolution + shift, -limit, limit));
    }
  }
  return to_numpy(std::move(out), {static_cast<std::size_t>(rows), static_cast<std::size_t>(cols)});
}

Floats field_at(In<float, 2> field, double resolution, double limit, In<double, 2> points) {
  check_resolution(resolution);
  check_points(points);
  const std::size_t count = points.shape(0);
  std::vector<double> out(3 * count);
  {
    nb::gil_scoped_release release;
    const FieldView view{field.data(), static_cast<std::ptrdiff_t>(field.shape(0)),
                         static_cast<std::ptrdiff_t>(field.shape(1)), 1.0 / resolution, limit};
    for (std::size_t i = 0; i < count; ++i) {
      const Slope slope = view.at(points.data()[2 * i], points.data()[2 * i + 1]);
      out[3 * i] = slope.value, out[3 * i + 1] = slope.x, out[3 * i + 2] = slope.y;
    }
  }
  return to_numpy(std::move(out), {count, 3});
}

}  // namespace trundle
