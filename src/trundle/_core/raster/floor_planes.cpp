// A floor of sampled heights as planes, one for each cell of a grid, and how far the floor differs from them.
//
// Between four samples the floor is bilinear. Over a rectangle such a surface, its difference from a plane and its
// steepest slope have their extremes in the corners, so each cell is asked at its corners and where lines of samples
// cross it.
#include "raster/floor_plane.hpp"
#include "raster/kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace trundle {

namespace {

constexpr double kSnap = 1e-6;  // Edges this near to a sample, in samples or cells, lie on it.

// The samples between which a cell's edges [low, high] lie.
struct Span {
  double low, high;
  std::int64_t first, end;

  Span(double from, double to) {
    const double near = kSnap * std::min(1.0, to - from);
    low = snapped(from, near);
    high = snapped(to, near);
    first = whole(std::floor(low));
    end = whole(std::ceil(high));
  }
  // Far from the samples' origin a cell may have no width in doubles.
  bool within(std::size_t samples) const { return low >= 0.0 && high <= static_cast<double>(samples) - 1.0 && low < high; }
  double from(std::int64_t index) const { return std::max(low - static_cast<double>(index), 0.0); }
  double to(std::int64_t index) const { return std::min(high - static_cast<double>(index), 1.0); }

 private:
  static double snapped(double value, double near) {
    return std::abs(value - std::round(value)) < near ? std::round(value) : value;
  }
  static std::int64_t whole(double value) { return static_cast<std::int64_t>(std::clamp(value, -1.0, 1e15)); }
};

// Four samples and the bilinear surface between them.
struct Patch {
  double h00, h10, h01, h11;

  double height(double s, double t) const {
    return (1.0 - t) * ((1.0 - s) * h00 + s * h10) + t * ((1.0 - s) * h01 + s * h11);
  }
  double squared_rise(double s, double t) const {  // Convex in s and t, so steepest in a corner of a part.
    const double x = (1.0 - t) * (h10 - h00) + t * (h11 - h01), y = (1.0 - s) * (h01 - h00) + s * (h11 - h10);
    return x * x + y * y;
  }
  bool known() const { return std::isfinite(h00) && std::isfinite(h10) && std::isfinite(h01) && std::isfinite(h11); }
};

class Field {
 public:
  explicit Field(const In<double, 2> &heights) : heights_(heights.data()), rows_(heights.shape(0)), cols_(heights.shape(1)) {}

  bool covers(const Span &x, const Span &y) const { return x.within(cols_) && y.within(rows_); }
  Patch patch(std::int64_t row, std::int64_t col) const {
    const double *at = heights_ + static_cast<std::size_t>(row) * cols_ + static_cast<std::size_t>(col);
    return {at[0], at[1], at[cols_], at[cols_ + 1]};
  }

 private:
  const double *heights_;
  std::size_t rows_, cols_;
};

using Plane = std::array<double, kPlane>;

const Plane kNoFloor = [] {
  Plane plane;
  plane.fill(std::numeric_limits<double>::quiet_NaN());
  return plane;
}();

Plane fit_plane(const Field &field, const Span &x, const Span &y) {
  if (!field.covers(x, y)) return kNoFloor;
  const std::int64_t left = x.first, right = x.end - 1, bottom = y.first, top = y.end - 1;
  const Patch first = field.patch(bottom, left), last = field.patch(top, right);
  if (!first.known() || !last.known()) return kNoFloor;
  const bool single = left == right && bottom == top;
  const double h00 = first.height(x.from(left), y.from(bottom)), h11 = last.height(x.to(right), y.to(top));
  const double h10 = (single ? first : field.patch(bottom, right)).height(x.to(right), y.from(bottom));
  const double h01 = (single ? first : field.patch(top, left)).height(x.from(left), y.to(top));
  const double middle = 0.25 * (h00 + h10 + h01 + h11);
  const double along_x = 0.5 * (h10 + h11 - h00 - h01), along_y = 0.5 * (h01 + h11 - h00 - h10);
  double least = std::numeric_limits<double>::infinity(), most = -least, steepest = 0.0;
  for (std::int64_t row = bottom; row <= top; ++row)
    for (std::int64_t col = left; col <= right; ++col) {
      const Patch patch = single ? first : field.patch(row, col);
      if (!patch.known()) return kNoFloor;
      for (const double s : {x.from(col), x.to(col)})
        for (const double t : {y.from(row), y.to(row)}) {
          steepest = std::max(steepest, patch.squared_rise(s, t));
          if (single) continue;
          const double at_x = (static_cast<double>(col) + s - x.low) / (x.high - x.low) - 0.5;
          const double at_y = (static_cast<double>(row) + t - y.low) / (y.high - y.low) - 0.5;
          const double off = patch.height(s, t) - middle - along_x * at_x - along_y * at_y;
          least = std::min(least, off);
          most = std::max(most, off);
        }
    }
  if (single) {  // The plane runs above two corners as far as below the others.
    most = 0.25 * std::abs(h00 - h10 - h01 + h11);
    least = -most;
  }
  return {middle, along_x, along_y, least, most, std::sqrt(steepest)};
}

}  // namespace

nb::ndarray<nb::numpy, double> floor_planes(In<double, 2> heights, double spacing, double x, double y,
                                            double resolution, std::int64_t rows, std::int64_t cols) {
  if (heights.shape(0) < 2 || heights.shape(1) < 2) throw std::invalid_argument("heights need at least 2 x 2 samples");
  if (!(spacing > 0.0 && std::isfinite(x) && std::isfinite(y) && rows > 0 && cols > 0))
    throw std::invalid_argument("a floor needs a spacing above 0, a finite place and some cells");
  if (rows > (std::int64_t{1} << 40) / cols) throw std::invalid_argument("a floor has at most 2^40 cells");
  std::vector<double> planes(static_cast<std::size_t>(rows * cols) * kPlane);
  {
    nb::gil_scoped_release released;
    const Field field(heights);
    const auto spans = [&](std::int64_t count, double start) {
      std::vector<Span> found;
      found.reserve(static_cast<std::size_t>(count));
      for (std::int64_t i = 0; i < count; ++i)
        found.emplace_back((static_cast<double>(i) - start) / spacing, (static_cast<double>(i) + 1.0 - start) / spacing);
      return found;
    };
    const std::vector<Span> across = spans(cols, x), up = spans(rows, y);
    for (std::int64_t row = 0; row < rows; ++row)
      for (std::int64_t col = 0; col < cols; ++col) {
        double *plane = planes.data() + static_cast<std::size_t>(row * cols + col) * kPlane;
        const Plane fitted = fit_plane(field, across[static_cast<std::size_t>(col)], up[static_cast<std::size_t>(row)]);
        std::copy(fitted.begin(), fitted.end(), plane);
        plane[5] /= spacing * resolution;
      }
  }
  return to_numpy(std::move(planes), {static_cast<std::size_t>(rows), static_cast<std::size_t>(cols), kPlane});
}

}  // namespace trundle
