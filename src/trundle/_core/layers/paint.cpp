// The evidence in the cells of a map that may lie at any angle to it. Free space is looked up at the centre of each of
// the map's cells, so that it has no holes; marks are put where they were hit.
#include <cmath>

#include "layers/evidence.hpp"
#include "shared/registers.hpp"

namespace trundle {

namespace {

constexpr double kOne = 4294967296.0;
constexpr double kMostScale = 1e4;
constexpr std::ptrdiff_t kBlock = 32;  // cells
constexpr double kWidest = 1e8;  // cells; differences fit into 31 bits

std::int64_t to_fixed(double value) { return static_cast<std::int64_t>(std::floor(value * kOne + 0.5)); }

constexpr std::int8_t kUnknown = -1, kFree = 0, kOccupied = 100;

// The evidence of a part's cells: cell (r, c) of the part has its centre in cell (v >> 32, u >> 32) of the evidence.
struct Lookup {
  std::int64_t u, v, u_per_col, v_per_col, u_per_row, v_per_row;
};

// Cells of a row of the map, each under one cell of the evidence. Masks of whole bytes, as compilers vectorise these.
TRUNDLE_INLINE void free_cells(const std::uint8_t *__restrict evidence, std::int8_t *__restrict out, std::int64_t count,
                               bool clear_occupied) {
  static_assert(kFree == 0);
  const std::int8_t clearable = clear_occupied ? kOccupied : kUnknown;
  for (std::int64_t c = 0; c < count; ++c) {
    const std::uint8_t level = evidence[c] & kLevel;
    const std::int8_t unseen = level == 0 ? -1 : 0, unsure = level == 1 ? 0 : -1;
    const std::int8_t known = out[c] == kUnknown ? 0 : -1, fixed = out[c] == clearable ? 0 : -1;
    out[c] = static_cast<std::int8_t>(out[c] & (unseen | known) & (unsure | fixed));
  }
}

#ifdef TRUNDLE_AVX2
TRUNDLE_TARGET("avx2") void free_row_avx2(const std::uint8_t *evidence, std::int8_t *out, std::int64_t count,
                                          bool clear_occupied) {
  free_cells(evidence, out, count, clear_occupied);
}
#endif

void free_row(const std::uint8_t *evidence, std::int8_t *out, std::int64_t count, bool clear_occupied) {
#ifdef TRUNDLE_AVX2
  if (__builtin_cpu_supports("avx2")) return free_row_avx2(evidence, out, count, clear_occupied);
#endif
  free_cells(evidence, out, count, clear_occupied);
}

// Cells of a row that lies across the evidence; the first has its centre at (u, v).
void free_slanted_row(const std::uint8_t *evidence, std::ptrdiff_t rows, std::ptrdiff_t cols, const Lookup &lookup,
                      std::int64_t u, std::int64_t v, std::int8_t *out, std::ptrdiff_t width, bool clear_occupied) {
  for (std::ptrdiff_t c = 0; c < width; ++c, u += lookup.u_per_col, v += lookup.v_per_col) {
    const bool is_unknown = out[c] == kUnknown;
    if (!is_unknown && !(clear_occupied && out[c] == kOccupied)) continue;
    const std::int64_t er = v >> 32, ec = u >> 32;
    if (er < 0 || ec < 0 || er >= rows || ec >= cols) continue;
    const std::uint8_t level = evidence[er * cols + ec] & kLevel;
    if (is_unknown ? level != 0 : level == 1) out[c] = kFree;
  }
}

}  // namespace

void paint_marks(Evidence evidence, HitPoints points, std::int64_t row, std::int64_t col, double resolution, Cells cells,
                 In<std::uint8_t, 2> kept, double x, double y, double yaw, double cell_size, bool clear_occupied) {
  check_shapes(evidence, points);
  check_place(row, col, resolution);
  check_place(0, 0, cell_size);
  if (kept.shape(0) != cells.shape(0) || kept.shape(1) != cells.shape(1)) {
    throw std::invalid_argument("what is kept needs the shape of the cells");
  }
  const double scale = cell_size / resolution;
  if (!(scale <= kMostScale) || !(scale * kMostScale >= 1.0)) throw std::invalid_argument("the cells are of too different sizes");
  if (!std::isfinite(yaw) || !(std::abs(x) / resolution <= kFarthest) || !(std::abs(y) / resolution <= kFarthest)) {
    throw std::invalid_argument("a part of a map is too far away");
  }
  const auto rows = static_cast<std::ptrdiff_t>(evidence.shape(0)), cols = static_cast<std::ptrdiff_t>(evidence.shape(1));
  const auto height = static_cast<std::ptrdiff_t>(cells.shape(0)), width = static_cast<std::ptrdiff_t>(cells.shape(1));
  if (!(scale * static_cast<double>(std::max(height, width)) <= kWidest) || std::max(rows, cols) > kWidest) {
    throw std::invalid_argument("a map or its part is too large");
  }
  nb::gil_scoped_release release;
  const double cos = std::cos(yaw) * scale, sin = std::sin(yaw) * scale;  // cells of the evidence per cell of the map
  const double u0 = x / resolution - static_cast<double>(col), v0 = y / resolution - static_cast<double>(row);
  // Rows and columns of the evidence under the part.
  double low[2] = {u0, v0}, high[2] = {u0, v0};
  for (int corner = 1; corner < 4; ++corner) {
    const double c = corner & 1 ? static_cast<double>(width) : 0.0, r = corner & 2 ? static_cast<double>(height) : 0.0;
    const double at[2] = {u0 + c * cos - r * sin, v0 + c * sin + r * cos};
    for (int axis = 0; axis < 2; ++axis) {
      low[axis] = std::min(low[axis], at[axis]);
      high[axis] = std::max(high[axis], at[axis]);
    }
  }
  if (high[0] < 0.0 || high[1] < 0.0 || low[0] > static_cast<double>(cols) || low[1] > static_cast<double>(rows)) return;

  const Lookup lookup{to_fixed(u0 + 0.5 * cos - 0.5 * sin), to_fixed(v0 + 0.5 * sin + 0.5 * cos),
                      to_fixed(cos), to_fixed(sin), to_fixed(-sin), to_fixed(cos)};
  const bool is_aligned = lookup.u_per_col == std::int64_t{1} << 32 && lookup.v_per_col == 0;
  for (std::ptrdiff_t r = 0; r < height; ++r) {
    std::int8_t *out = cells.data() + r * width;
    const std::int64_t u = lookup.u + r * lookup.u_per_row, v = lookup.v + r * lookup.v_per_row;
    if (is_aligned) {
      const std::int64_t er = v >> 32, ec = u >> 32;
      const std::int64_t first = std::max<std::int64_t>(0, -ec), end = std::min<std::int64_t>(width, cols - ec);
      if (er < 0 || er >= rows || first >= end) continue;
      free_row(evidence.data() + er * cols + ec + first, out + first, end - first, clear_occupied);
    } else {
      free_slanted_row(evidence.data(), rows, cols, lookup, u, v, out, width, clear_occupied);
    }
  }

  const auto first_row = static_cast<std::ptrdiff_t>(std::clamp(std::floor(low[1]) - 1.0, 0.0, static_cast<double>(rows)));
  const auto first_col = static_cast<std::ptrdiff_t>(std::clamp(std::floor(low[0]) - 1.0, 0.0, static_cast<double>(cols)));
  const auto row_end = static_cast<std::ptrdiff_t>(std::clamp(std::floor(high[1]) + 2.0, 0.0, static_cast<double>(rows)));
  const auto col_end = static_cast<std::ptrdiff_t>(std::clamp(std::floor(high[0]) + 2.0, 0.0, static_cast<double>(cols)));
  const double across = 1.0 / (scale * scale);
  for (std::ptrdiff_t r = first_row; r < row_end; ++r) {
    const std::uint8_t *bytes = evidence.data() + r * cols;
    for (std::ptrdiff_t c = first_col; c < col_end;) {
      if (c + kBlock <= col_end) {  // most hold no mark
        std::uint8_t any = 0;
        for (std::ptrdiff_t i = 0; i < kBlock; ++i) any |= bytes[c + i];
        if (!(any & kMarked)) {
          c += kBlock;
          continue;
        }
      }
      const std::ptrdiff_t end = std::min(c + kBlock, col_end);
      for (; c < end; ++c) {
        if (!(bytes[c] & kMarked)) continue;
        const std::uint8_t *point = points.data() + 2 * (r * cols + c);
        const double u = static_cast<double>(c) + (point[0] + 0.5) / 256.0 - u0;
        const double v = static_cast<double>(r) + (point[1] + 0.5) / 256.0 - v0;
        const double to_col = std::floor((cos * u + sin * v) * across), to_row = std::floor((cos * v - sin * u) * across);
        if (to_col < 0.0 || to_row < 0.0 || to_col >= static_cast<double>(width) || to_row >= static_cast<double>(height)) continue;
        const std::ptrdiff_t cell = static_cast<std::ptrdiff_t>(to_row) * width + static_cast<std::ptrdiff_t>(to_col);
        if (kept.data()[cell] == 0) cells.data()[cell] = kOccupied;
      }
    }
  }
}

}  // namespace trundle
