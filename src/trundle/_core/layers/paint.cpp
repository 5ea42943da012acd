// The evidence in the cells of a map that may lie at any angle to it. Free space is looked up at the centre of each of
// the map's cells, so that it has no holes; marks are put where they were hit.
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "layers/evidence.hpp"
#include "shared/registers.hpp"

namespace trundle {

namespace {

constexpr double kOne = 4294967296.0;
constexpr double kMostScale = 1e4;
constexpr std::ptrdiff_t kBlock = 64, kWord = 8;  // cells
constexpr double kOnCell = 1e-4;
constexpr double kWidest = 1e8;  // cells; differences fit into 31 bits

std::int64_t to_fixed(double value) { return static_cast<std::int64_t>(std::floor(value * kOne + 0.5)); }

constexpr std::int8_t kUnknown = -1, kFree = 0, kOccupied = 100;

// The evidence of a part's cells: cell (r, c) of the part has its centre in cell (v >> 32, u >> 32) of the evidence.
struct Lookup {
  std::int64_t u, v, u_per_col, v_per_col, u_per_row, v_per_row;
};

// Cells of a map: a row starts `stride` cells after the one before.
template <typename Cell>
struct CellRows {
  Cell *first;
  std::ptrdiff_t stride;

  Cell *operator[](std::ptrdiff_t row) const { return first + row * stride; }
};

// Evidence, and where a part of a map of so many cells lies in it.
struct Painted {
  const std::uint8_t *evidence, *points;
  std::ptrdiff_t rows, cols, height, width;
  double u0, v0, cos, sin, scale;  // in cells of the evidence
  bool clear_occupied;

  // Whether its cells lie on those of the evidence, but for rounding: hits are at least half a 256th within theirs.
  bool lies_on() const {
    return cos == 1.0 && sin == 0.0 && scale == 1.0 && std::abs(u0 - std::round(u0)) < kOnCell &&
           std::abs(v0 - std::round(v0)) < kOnCell;
  }
};

// Whether any of some bytes, of a whole number of words, has one of the bits of a mask.
TRUNDLE_INLINE bool has_bits(const std::uint8_t *bytes, std::ptrdiff_t count, std::uint8_t mask) {
  std::uint64_t any = 0;
  for (std::ptrdiff_t i = 0; i < count; i += kWord) {
    std::uint64_t word;
    std::memcpy(&word, bytes + i, kWord);
    any |= word;
  }
  return (any & (std::uint64_t{mask} * 0x0101010101010101U)) != 0;
}

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

// The same for a long row, block by block: most have no cell that may become free.
TRUNDLE_INLINE void free_row(const std::uint8_t *evidence, std::int8_t *out, std::int64_t count, bool clear_occupied) {
  const std::int8_t clearable = clear_occupied ? kOccupied : kUnknown;
  std::int64_t c = 0;
  for (; c + kBlock <= count; c += kBlock) {
    std::int8_t any = 0;
    for (std::ptrdiff_t i = 0; i < kBlock; ++i) {
      any |= static_cast<std::int8_t>((out[c + i] == kUnknown ? -1 : 0) | (out[c + i] == clearable ? -1 : 0));
    }
    if (any) free_cells(evidence + c, out + c, kBlock, clear_occupied);
  }
  free_cells(evidence + c, out + c, count - c, clear_occupied);
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

// Put the evidence into a part of a map.
TRUNDLE_INLINE void paint_part(const Painted &p, CellRows<std::int8_t> cells, CellRows<const std::uint8_t> kept) {
  const double rows = static_cast<double>(p.rows), cols = static_cast<double>(p.cols);
  const double height = static_cast<double>(p.height), width = static_cast<double>(p.width);
  // Rows and columns of the evidence under the part.
  double low[2] = {p.u0, p.v0}, high[2] = {p.u0, p.v0};
  for (int corner = 1; corner < 4; ++corner) {
    const double c = corner & 1 ? width : 0.0, r = corner & 2 ? height : 0.0;
    const double at[2] = {p.u0 + c * p.cos - r * p.sin, p.v0 + c * p.sin + r * p.cos};
    for (int axis = 0; axis < 2; ++axis) {
      low[axis] = std::min(low[axis], at[axis]);
      high[axis] = std::max(high[axis], at[axis]);
    }
  }
  if (high[0] < 0.0 || high[1] < 0.0 || low[0] > cols || low[1] > rows) return;

  const Lookup lookup{to_fixed(p.u0 + 0.5 * p.cos - 0.5 * p.sin), to_fixed(p.v0 + 0.5 * p.sin + 0.5 * p.cos),
                      to_fixed(p.cos), to_fixed(p.sin), to_fixed(-p.sin), to_fixed(p.cos)};
  const bool is_aligned = lookup.u_per_col == std::int64_t{1} << 32 && lookup.v_per_col == 0;
  for (std::ptrdiff_t r = 0; r < p.height; ++r) {
    const std::int64_t u = lookup.u + r * lookup.u_per_row, v = lookup.v + r * lookup.v_per_row;
    if (is_aligned) {
      const std::int64_t er = v >> 32, ec = u >> 32;
      const std::int64_t first = std::max<std::int64_t>(0, -ec), end = std::min<std::int64_t>(p.width, p.cols - ec);
      if (er < 0 || er >= p.rows || first >= end) continue;
      free_row(p.evidence + er * p.cols + ec + first, cells[r] + first, end - first, p.clear_occupied);
    } else {
      free_slanted_row(p.evidence, p.rows, p.cols, lookup, u, v, cells[r], p.width, p.clear_occupied);
    }
  }

  const auto first_row = static_cast<std::ptrdiff_t>(std::clamp(std::floor(low[1]) - 1.0, 0.0, rows));
  const auto first_col = static_cast<std::ptrdiff_t>(std::clamp(std::floor(low[0]) - 1.0, 0.0, cols));
  const auto row_end = static_cast<std::ptrdiff_t>(std::clamp(std::floor(high[1]) + 2.0, 0.0, rows));
  const auto col_end = static_cast<std::ptrdiff_t>(std::clamp(std::floor(high[0]) + 2.0, 0.0, cols));
  const double across = 1.0 / (p.scale * p.scale);
  const auto put = TRUNDLE_LAMBDA(std::ptrdiff_t r, std::ptrdiff_t c) {
    const std::uint8_t *point = p.points + 2 * (r * p.cols + c);
    const double u = static_cast<double>(c) + (point[0] + 0.5) / 256.0 - p.u0;
    const double v = static_cast<double>(r) + (point[1] + 0.5) / 256.0 - p.v0;
    const double to_col = std::floor((p.cos * u + p.sin * v) * across), to_row = std::floor((p.cos * v - p.sin * u) * across);
    if (to_col < 0.0 || to_row < 0.0 || to_col >= width || to_row >= height) return;
    const auto at_row = static_cast<std::ptrdiff_t>(to_row), at_col = static_cast<std::ptrdiff_t>(to_col);
    if (kept[at_row][at_col] == 0) cells[at_row][at_col] = kOccupied;
  };
  for (std::ptrdiff_t r = first_row; r < row_end; ++r) {
    const std::uint8_t *bytes = p.evidence + r * p.cols;
    for (std::ptrdiff_t c = first_col; c < col_end;) {  // most blocks hold no mark, and most words of the others
      const std::ptrdiff_t left = col_end - c;
      if (left >= kBlock && !has_bits(bytes + c, kBlock, kMarked)) {
        c += kBlock;
        continue;
      }
      for (const std::ptrdiff_t end = c + std::min(left, kBlock); c < end;) {
        if (end - c >= kWord && !has_bits(bytes + c, kWord, kMarked)) {
          c += kWord;
          continue;
        }
        for (const std::ptrdiff_t last = std::min(c + kWord, end); c < last; ++c) {
          if (bytes[c] & kMarked) put(r, c);
        }
      }
    }
  }
}

// Cells that lie on those of the evidence, as `free_cells` and then the marks leave them.
TRUNDLE_INLINE void paint_cells(const std::uint8_t *__restrict evidence, const std::uint8_t *__restrict kept,
                                std::int8_t *__restrict out, std::ptrdiff_t count, bool clear_occupied) {
  free_cells(evidence, out, count, clear_occupied);
  for (std::ptrdiff_t c = 0; c < count; ++c) {
    const std::int8_t open = kept[c] == 0 ? -1 : 0, marked = evidence[c] >= kMarked ? -1 : 0;
    const std::int8_t occupied = open & marked;
    out[c] = static_cast<std::int8_t>((out[c] & ~occupied) | (kOccupied & occupied));
  }
}

// The same for row `r` of a part that lies on the evidence, block by block: each stays in the nearest memory.
TRUNDLE_INLINE void paint_row(const Painted &p, std::ptrdiff_t r, const std::uint8_t *kept, std::int8_t *out) {
  const std::ptrdiff_t row = r + std::lround(p.v0), col = std::lround(p.u0);
  if (row < 0 || row >= p.rows) return;
  const std::ptrdiff_t end = std::min(p.width, p.cols - col);
  const std::uint8_t *evidence = p.evidence + row * p.cols + col;
  std::ptrdiff_t c = std::max<std::ptrdiff_t>(0, -col);
  for (; c + kBlock <= end; c += kBlock) paint_cells(evidence + c, kept + c, out + c, kBlock, p.clear_occupied);
  if (c < end) paint_cells(evidence + c, kept + c, out + c, end - c, p.clear_occupied);
}

TRUNDLE_INLINE void paint_all(const Painted &p, CellRows<std::int8_t> cells, CellRows<const std::uint8_t> kept) {
  if (!p.lies_on()) return paint_part(p, cells, kept);
  for (std::ptrdiff_t r = 0; r < p.height; ++r) paint_row(p, r, kept[r], cells[r]);
}

// Take over what was painted in a row; `box` grows by where that differs from before.
TRUNDLE_INLINE void take_over(const std::int8_t *from, std::int8_t *to, std::ptrdiff_t r, std::ptrdiff_t width, CellBox &box) {
  if (std::memcmp(from, to, static_cast<std::size_t>(width)) == 0) return;
  std::ptrdiff_t first = 0, end = width;
  while (from[first] == to[first]) ++first;
  while (from[end - 1] == to[end - 1]) --end;
  box.add(r, first, end);
  std::memcpy(to + first, from + first, static_cast<std::size_t>(end - first));
}

// Paint a part again from what it is without the evidence, and return where it differs from before.
TRUNDLE_INLINE CellBox repaint_all(const Painted &p, CellRows<std::int8_t> cells, CellRows<const std::int8_t> base,
                                   CellRows<const std::uint8_t> kept) {
  CellBox box;
  const auto width = static_cast<std::size_t>(p.width);
  if (p.lies_on()) {
    std::vector<std::int8_t> row(width);
    for (std::ptrdiff_t r = 0; r < p.height; ++r) {
      std::memcpy(row.data(), base[r], width);
      paint_row(p, r, kept[r], row.data());
      take_over(row.data(), cells[r], r, p.width, box);
    }
    return box;
  }
  // Not initialised, as all of it is copied from the map.
  const std::unique_ptr<std::int8_t[]> memory(new std::int8_t[static_cast<std::size_t>(p.height) * width]);
  const CellRows<std::int8_t> painted{memory.get(), p.width};
  for (std::ptrdiff_t r = 0; r < p.height; ++r) std::memcpy(painted[r], base[r], width);
  paint_part(p, painted, kept);
  for (std::ptrdiff_t r = 0; r < p.height; ++r) take_over(painted[r], cells[r], r, p.width, box);
  return box;
}

#ifdef TRUNDLE_AVX2
TRUNDLE_TARGET("avx2") void paint_avx2(const Painted &part, CellRows<std::int8_t> cells, CellRows<const std::uint8_t> kept) {
  paint_all(part, cells, kept);
}
TRUNDLE_TARGET("avx2") CellBox repaint_avx2(const Painted &part, CellRows<std::int8_t> cells,
                                            CellRows<const std::int8_t> base, CellRows<const std::uint8_t> kept) {
  return repaint_all(part, cells, base, kept);
}
#endif

void paint(const Painted &part, CellRows<std::int8_t> cells, CellRows<const std::uint8_t> kept) {
#ifdef TRUNDLE_AVX2
  if (__builtin_cpu_supports("avx2")) return paint_avx2(part, cells, kept);
#endif
  paint_all(part, cells, kept);
}

CellBox repaint(const Painted &part, CellRows<std::int8_t> cells, CellRows<const std::int8_t> base,
                CellRows<const std::uint8_t> kept) {
#ifdef TRUNDLE_AVX2
  if (__builtin_cpu_supports("avx2")) return repaint_avx2(part, cells, base, kept);
#endif
  return repaint_all(part, cells, base, kept);
}

// What is painted into a part of a map with so many rows and columns; (x, y, yaw) is the pose of its lower left corner.
Painted painted_of(const Evidence &evidence, const HitPoints &points, std::int64_t row, std::int64_t col, double resolution,
                   std::size_t height, std::size_t width, double x, double y, double yaw, double cell_size,
                   bool clear_occupied) {
  check_shapes(evidence, points);
  check_place(row, col, resolution);
  check_place(0, 0, cell_size);
  const double scale = cell_size / resolution;
  if (!(scale <= kMostScale) || !(scale * kMostScale >= 1.0)) throw std::invalid_argument("the cells are of too different sizes");
  if (!std::isfinite(yaw) || !(std::abs(x) / resolution <= kFarthest) || !(std::abs(y) / resolution <= kFarthest)) {
    throw std::invalid_argument("a part of a map is too far away");
  }
  const std::size_t rows = evidence.shape(0), cols = evidence.shape(1);
  if (!(scale * static_cast<double>(std::max(height, width)) <= kWidest) || static_cast<double>(std::max(rows, cols)) > kWidest) {
    throw std::invalid_argument("a map or its part is too large");
  }
  return {evidence.data(), points.data(), static_cast<std::ptrdiff_t>(rows), static_cast<std::ptrdiff_t>(cols),
          static_cast<std::ptrdiff_t>(height), static_cast<std::ptrdiff_t>(width), x / resolution - static_cast<double>(col),
          y / resolution - static_cast<double>(row), std::cos(yaw) * scale, std::sin(yaw) * scale, scale, clear_occupied};
}

template <typename One, typename Other>
bool has_shape_of(const One &one, const Other &other) {
  return one.shape(0) == other.shape(0) && one.shape(1) == other.shape(1);
}

}  // namespace

void paint_marks(Evidence evidence, HitPoints points, std::int64_t row, std::int64_t col, double resolution, Cells cells,
                 In<std::uint8_t, 2> kept, double x, double y, double yaw, double cell_size, bool clear_occupied) {
  if (!has_shape_of(kept, cells)) throw std::invalid_argument("what is kept needs the shape of the cells");
  const Painted part = painted_of(evidence, points, row, col, resolution, cells.shape(0), cells.shape(1), x, y, yaw,
                                  cell_size, clear_occupied);
  nb::gil_scoped_release release;
  paint(part, {cells.data(), part.width}, {kept.data(), part.width});
}

Rectangle repaint_marks(Evidence evidence, HitPoints points, std::int64_t row, std::int64_t col, double resolution,
                        Cells cells, In<std::int8_t, 2> base, In<std::uint8_t, 2> kept, const Rectangle &window, double x,
                        double y, double yaw, double cell_size, bool clear_occupied) {
  if (!has_shape_of(kept, cells) || !has_shape_of(base, cells)) {
    throw std::invalid_argument("the map and what is kept need the shape of the cells");
  }
  const auto [first_row, row_end, first_col, col_end] = window;
  const auto stride = static_cast<std::ptrdiff_t>(cells.shape(1));
  if (first_row < 0 || first_row > row_end || row_end > static_cast<std::int64_t>(cells.shape(0)) || first_col < 0 ||
      first_col > col_end || col_end > stride) {
    throw std::invalid_argument("the window must lie within the cells");
  }
  const Painted part = painted_of(evidence, points, row, col, resolution, static_cast<std::size_t>(row_end - first_row),
                                  static_cast<std::size_t>(col_end - first_col), x, y, yaw, cell_size, clear_occupied);
  nb::gil_scoped_release release;
  const std::ptrdiff_t corner = first_row * stride + first_col;
  CellBox box = repaint(part, {cells.data() + corner, stride}, {base.data() + corner, stride}, {kept.data() + corner, stride});
  if (box.row < box.row_end) box = {box.row + first_row, box.row_end + first_row, box.col + first_col, box.col_end + first_col};
  return box.as_rectangle();
}

}  // namespace trundle
