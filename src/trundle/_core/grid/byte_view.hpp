// A caller's bytes with any strides, and how they are packed to bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "grid/bit_grid.hpp"

namespace trundle {

// A rectangle of bytes, not 0 where a cell is blocked, with any strides.
struct ByteView {
  const std::uint8_t *data;
  std::int64_t rows, cols, row_stride, col_stride;
  std::uint8_t at(std::int64_t row, std::int64_t col) const { return data[row * row_stride + col * col_stride]; }
  ByteView transposed() const { return {data, cols, rows, col_stride, row_stride}; }
};

// Into a grid of the same cells with a border.
inline void pack(const ByteView &blocked, BitGrid &grid) {
  std::vector<std::uint8_t> line(grid.words() * 64, 1);
  for (std::int64_t row = 0; row < blocked.rows; ++row) {
    const std::uint8_t *source = blocked.data + row * blocked.row_stride;
    if (blocked.col_stride == 1) {
      std::memcpy(line.data() + 1, source, static_cast<std::size_t>(blocked.cols));
    } else {
      for (std::int64_t col = 0; col < blocked.cols; ++col) line[col + 1] = source[col * blocked.col_stride];
    }
    for (std::size_t w = 0; w < grid.words(); ++w) {
      std::uint64_t bits = 0;
      for (std::size_t group = 0; group < 8; ++group) {
        constexpr std::uint64_t kLow = 0x7f7f7f7f7f7f7f7fULL;
        std::uint64_t eight = 0;
        for (std::size_t i = 0; i < 8; ++i) eight |= std::uint64_t{line[w * 64 + group * 8 + i]} << (8 * i);
        const std::uint64_t set = (((eight & kLow) + kLow) | eight) & ~kLow;  // the top bit of bytes that are not 0
        bits |= ((set >> 7) * 0x0102040810204080ULL >> 56) << (8 * group);
      }
      grid.word(row + 1, w) = bits;
    }
  }
}

}  // namespace trundle
