// What is known of a cell, in one byte, and how hits and misses change it.
//
// Bit 7 is set while the cell is marked. The lower bits are its level: 0 for a cell that no beam has met or passed, else
// from 1 (surely free) over `neutral` to `top`. A hit adds `hit` from neutral on, and marks the cell at the top; a miss
// takes away `miss`, and unmarks it at neutral. As top - neutral = neutral - 1 = hit · miss, `miss` hits in a row mark a
// cell and `hit` misses in a row unmark it; between the two it stays as it was.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "layers/kernels.hpp"

namespace trundle {

constexpr std::uint8_t kMarked = 128, kLevel = 127;
constexpr std::int64_t kMostSteps = 63;
constexpr double kSubcells = 256.0;  // per edge of a cell, in which the points of hits are kept
constexpr double kFarthest = 1e11;  // cells from the origin; there, a double still resolves 1e-5 cells

struct EvidenceRule {
  std::uint8_t hit, miss, neutral, top;

  EvidenceRule(std::int64_t hits, std::int64_t misses) {
    if (hits < 1 || misses < 1 || hits > kMostSteps || misses > kMostSteps || hits * misses > kMostSteps) {
      throw std::invalid_argument("hit and miss must be 1 or more, and their product 63 or less");
    }
    hit = static_cast<std::uint8_t>(hits);
    miss = static_cast<std::uint8_t>(misses);
    neutral = static_cast<std::uint8_t>(1 + hits * misses);
    top = static_cast<std::uint8_t>(neutral + hits * misses);
  }
};

// Rows and columns [row, row_end) x [col, col_end) that hold all cells added.
struct CellBox {
  std::ptrdiff_t row = 0, row_end = 0, col = 0, col_end = 0;

  void add(std::ptrdiff_t r, std::ptrdiff_t first, std::ptrdiff_t end) {
    if (row == row_end) {
      *this = {r, r + 1, first, end};
      return;
    }
    row = std::min(row, r);
    row_end = std::max(row_end, r + 1);
    col = std::min(col, first);
    col_end = std::max(col_end, end);
  }

  Rectangle as_rectangle() const { return {row, row_end, col, col_end}; }
};

// Whether a point lies in a convex outline, counter-clockwise, of so many corners x, y; in none if it has no corners.
inline bool is_inside(const double *corners, std::size_t count, double x, double y) {
  for (std::size_t i = 0; i < count; ++i) {
    const double *a = corners + 2 * i, *b = corners + 2 * ((i + 1) % count);
    if ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) < 0.0) return false;
  }
  return count > 0;
}

inline void check_shapes(const Evidence &evidence, const HitPoints &points) {
  if (points.shape(0) != evidence.shape(0) || points.shape(1) != evidence.shape(1) || points.shape(2) != 2) {
    throw std::invalid_argument("the points of the evidence need its shape and 2");
  }
}

inline void check_times(const Evidence &evidence, const HitTimes &times) {
  if (times.shape(0) != evidence.shape(0) || times.shape(1) != evidence.shape(1)) {
    throw std::invalid_argument("the times of the evidence need its shape");
  }
}

inline void check_place(std::int64_t row, std::int64_t col, double resolution) {
  if (!(resolution > 0.0) || !(resolution < 1e6)) throw std::invalid_argument("the resolution must be positive");
  const auto far = static_cast<std::int64_t>(kFarthest);
  if (row > far || row < -far || col > far || col < -far) throw std::invalid_argument("the grid is too far away");
}

}  // namespace trundle
