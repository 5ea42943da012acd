// Which free cells of a window of a grid are joined within it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "grid/bit_grid.hpp"

namespace trundle {

// Rows and columns [first, end) of a grid.
struct Window {
  std::int64_t row, row_end, col, col_end;
  Window grown() const { return {row - 1, row_end + 1, col - 1, col_end + 1}; }
  std::int64_t cols() const { return col_end - col; }
  std::size_t area() const { return static_cast<std::size_t>((row_end - row) * cols()); }
  std::size_t index(std::int64_t r, std::int64_t c) const { return static_cast<std::size_t>((r - row) * cols() + c - col); }
  bool contains(std::int64_t r, std::int64_t c) const { return r >= row && r < row_end && c >= col && c < col_end; }
};

constexpr std::uint32_t kNoPart = ~std::uint32_t{0};

// The part that each cell of a window belongs to, row by row: the index of the part's first cell, or `kNoPart` where
// the cell is blocked. Union-find over the cells; the smaller index wins.
inline std::vector<std::uint32_t> parts_of(const BitGrid &grid, const Window &window) {
  std::vector<std::uint32_t> parts(window.area(), kNoPart);
  const auto root = [&](std::uint32_t cell) {
    while (parts[cell] != cell) cell = parts[cell] = parts[parts[cell]];
    return cell;
  };
  const auto cols = static_cast<std::uint32_t>(window.cols());
  std::uint32_t cell = 0;
  for (std::int64_t row = window.row; row < window.row_end; ++row) {
    for (std::int64_t col = window.col; col < window.col_end; ++col, ++cell) {
      if (grid.blocked(static_cast<std::int32_t>(row), static_cast<std::int32_t>(col))) continue;
      parts[cell] = cell;
      if (col > window.col && parts[cell - 1] != kNoPart) parts[cell] = root(cell - 1);
      if (row == window.row || parts[cell - cols] == kNoPart) continue;
      const std::uint32_t a = root(cell), b = root(cell - cols);
      parts[std::max(a, b)] = std::min(a, b);
    }
  }
  for (cell = 0; cell < parts.size(); ++cell) {
    if (parts[cell] != kNoPart) parts[cell] = parts[parts[cell]];
  }
  return parts;
}

}  // namespace trundle
