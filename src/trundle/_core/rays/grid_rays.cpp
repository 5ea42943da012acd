// Rays through a grid of blocked cells, for planar lidars: from cell to cell, or by jumps through a field of distances,
// with the same answer.
#include "rays/kernels.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "rays/cell_walk.hpp"
#include "rays/jumping_ray.hpp"
#include "shared/registers.hpp"

namespace trundle {

namespace {

constexpr std::size_t kTogether = 16;  // sums that are added up side by side, as one waits for its own last one
constexpr int kFarthest = 255;         // distance that a byte holds

void check_rays(double x, double y, double reach) {
  if (!std::isfinite(x) || !std::isfinite(y)) throw std::invalid_argument("the rays' origin must be finite");
  if (!(reach >= 0.0) || !std::isfinite(reach)) throw std::invalid_argument("reach must be a finite distance");
}

CellBytes cells_of(const In<std::uint8_t, 2> &array) {
  return {array.data(), static_cast<std::ptrdiff_t>(array.shape(0)), static_cast<std::ptrdiff_t>(array.shape(1))};
}

// Sums of hits that wait until there are enough of them.
struct Sums {
  std::array<double, kTogether> sum{}, spacing{}, more{};
  std::array<std::size_t, kTogether> ray{};
  std::size_t count = 0;
  double most = 0.0;

  void push(std::size_t index, const Landing &landing) {
    sum[count] = landing.first, spacing[count] = landing.spacing, ray[count] = index;
    more[count] = static_cast<double>(landing.more);
    most = std::max(most, more[count]);
    ++count;
  }

  // As `Landing::distance`.
  TRUNDLE_INLINE void add() {
    for (double step = 0.0; step < most; step += 1.0) {
      for (std::size_t i = 0; i < kTogether; ++i) {
        const double next = sum[i] + spacing[i];
        sum[i] = step < more[i] ? next : sum[i];
      }
    }
  }

  TRUNDLE_INLINE void flush(double reach, double *out) {
    add();
    for (std::size_t i = 0; i < count; ++i) out[ray[i]] = sum[i] <= reach ? sum[i] : kNoHit;
    count = 0, most = 0.0;
    more.fill(0.0);
  }
};

TRUNDLE_INLINE void cast_all(const CellBytes &field, double x, double y, const double *angles, double reach,
                             std::vector<double> &out) {
  const double rounding = rounding_of_walk(field, reach);
  Sums sums;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!std::isfinite(angles[i])) continue;
    const double dx = std::cos(angles[i]), dy = std::sin(angles[i]);
    const Landing landing = land_ray(field, x, y, dx, dy, reach, rounding);
    if (landing.kind == Arrival::kUnsure) {
      out[i] = walk_ray(field, x, y, dx, dy, reach, [](std::uint8_t distance) { return distance == 0; });
    } else if (landing.kind == Arrival::kHit) {
      sums.push(i, landing);
      if (sums.count == kTogether) sums.flush(reach, out.data());
    }
  }
  sums.flush(reach, out.data());
}

#ifdef TRUNDLE_AVX2
TRUNDLE_TARGET("avx2") void cast_all_avx2(const CellBytes &field, double x, double y, const double *angles, double reach,
                                          std::vector<double> &out) {
  cast_all(field, x, y, angles, reach, out);
}
#endif

}  // namespace

nb::ndarray<nb::numpy, double> cast_grid_rays(In<std::uint8_t, 2> blocked, double x, double y, In<double, 1> angles,
                                              double reach) {
  check_rays(x, y, reach);
  const CellBytes grid = cells_of(blocked);
  std::vector<double> out(angles.size(), kNoHit);
  {
    nb::gil_scoped_release release;
    if (grid.rows > 0 && grid.cols > 0) {
      for (std::size_t i = 0; i < out.size(); ++i) {
        const double angle = angles.data()[i];
        if (!std::isfinite(angle)) continue;
        out[i] = walk_ray(grid, x, y, std::cos(angle), std::sin(angle), reach, [](std::uint8_t cell) { return cell != 0; });
      }
    }
  }
  const std::size_t count = out.size();
  return to_numpy(std::move(out), {count});
}

nb::ndarray<nb::numpy, double> cast_jumping_rays(In<std::uint8_t, 2> field, double x, double y, In<double, 1> angles,
                                                 double reach) {
  check_rays(x, y, reach);
  const CellBytes grid = cells_of(field);
  std::vector<double> out(angles.size(), kNoHit);
  {
    nb::gil_scoped_release release;
    if (grid.rows > 0 && grid.cols > 0) {
#ifdef TRUNDLE_AVX2
      if (__builtin_cpu_supports("avx2")) {
        cast_all_avx2(grid, x, y, angles.data(), reach, out);
      } else
#endif
        cast_all(grid, x, y, angles.data(), reach, out);
    }
  }
  const std::size_t count = out.size();
  return to_numpy(std::move(out), {count});
}

// Chessboard distance by two passes over the eight neighbours: Rosenfeld and Pfaltz, Distance Functions on Digital
// Pictures (1968).
nb::ndarray<nb::numpy, std::uint8_t> chebyshev_field(In<std::uint8_t, 2> blocked) {
  const std::size_t rows = blocked.shape(0), cols = blocked.shape(1);
  std::vector<std::uint8_t> out(rows * cols);
  {
    nb::gil_scoped_release release;
    // Beside the grid is nothing: a ray that leaves it meets no cell any more.
    const auto pass = [&](std::size_t row, std::size_t from, bool first) {
      std::uint8_t *here = out.data() + row * cols;
      const std::uint8_t *other = out.data() + from * cols;
      const bool has_other = from != row;
      int last = kFarthest;
      if (has_other) {
        for (std::size_t col = 0; col < cols; ++col) {
          int least = other[col];
          if (col > 0) least = std::min<int>(least, other[col - 1]);
          if (col + 1 < cols) least = std::min<int>(least, other[col + 1]);
          here[col] = static_cast<std::uint8_t>(std::min<int>(here[col], least + 1));
        }
      }
      for (std::size_t k = 0; k < cols; ++k) {
        std::uint8_t &cell = here[first ? k : cols - 1 - k];
        last = std::min<int>(cell, last + 1);
        cell = static_cast<std::uint8_t>(last);
      }
    };
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = blocked.data()[i] ? 0 : kFarthest;
    for (std::size_t row = 0; row < rows; ++row) pass(row, row > 0 ? row - 1 : row, true);
    for (std::size_t row = rows; row-- > 0;) pass(row, row + 1 < rows ? row + 1 : row, false);
  }
  return to_numpy(std::move(out), {rows, cols});
}

}  // namespace trundle
