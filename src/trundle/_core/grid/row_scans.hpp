// Where runs of free cells end in the rows of a `BitGrid`, 64 cells at a time. Its border stops every scan.
#pragma once

#include <cstddef>
#include <cstdint>

#include "grid/bit_grid.hpp"

namespace trundle {

// The first column from `col` on that is blocked.
inline std::int32_t next_blocked(const BitGrid &grid, std::int32_t row, std::int32_t col) {
  std::size_t w = static_cast<std::size_t>(col) >> 6;
  std::uint64_t bits = grid.word(row, w) & (~std::uint64_t{0} << (col & 63));
  while (bits == 0) bits = grid.word(row, ++w);
  return static_cast<std::int32_t>(w * 64) + __builtin_ctzll(bits);
}

// The last column up to `col` that is blocked.
inline std::int32_t last_blocked(const BitGrid &grid, std::int32_t row, std::int32_t col) {
  std::size_t w = static_cast<std::size_t>(col) >> 6;
  std::uint64_t bits = grid.word(row, w) & (~std::uint64_t{0} >> (63 - (col & 63)));
  while (bits == 0) bits = grid.word(row, --w);
  return static_cast<std::int32_t>(w * 64) + 63 - __builtin_clzll(bits);
}

// The first column from `col` on that is free, or `limit` if that comes first.
inline std::int32_t next_free(const BitGrid &grid, std::int32_t row, std::int32_t col, std::int32_t limit) {
  std::size_t w = static_cast<std::size_t>(col) >> 6;
  std::uint64_t bits = ~grid.word(row, w) & (~std::uint64_t{0} << (col & 63));
  while (bits == 0) {
    if (static_cast<std::int32_t>(++w * 64) >= limit) return limit;
    bits = ~grid.word(row, w);
  }
  const std::int32_t at = static_cast<std::int32_t>(w * 64) + __builtin_ctzll(bits);
  return at < limit ? at : limit;
}

// A line between two rows can be followed where one of them is free. The first column beyond `col`, to one side, where
// both are blocked or where one of them, blocked until there, is free.
inline std::int32_t next_turn(const BitGrid &grid, std::int32_t row, std::int32_t col, int side) {
  std::size_t w = static_cast<std::size_t>(col) >> 6;
  std::uint64_t a = grid.word(row, w), b = grid.word(row - 1, w);
  if (side > 0) {
    std::uint64_t stops = ((a & b) | (a << 1 & ~a) | (b << 1 & ~b)) & (~std::uint64_t{1} << (col & 63));
    while (stops == 0) {
      const std::uint64_t carry_a = a >> 63, carry_b = b >> 63;
      a = grid.word(row, ++w), b = grid.word(row - 1, w);
      stops = (a & b) | ((a << 1 | carry_a) & ~a) | ((b << 1 | carry_b) & ~b);
    }
    return static_cast<std::int32_t>(w * 64) + __builtin_ctzll(stops);
  }
  std::uint64_t stops = ((a & b) | (a >> 1 & ~a) | (b >> 1 & ~b)) & ((std::uint64_t{1} << (col & 63)) - 1);
  while (stops == 0) {
    const std::uint64_t carry_a = a << 63, carry_b = b << 63;
    a = grid.word(row, --w), b = grid.word(row - 1, w);
    stops = (a & b) | ((a >> 1 | carry_a) & ~a) | ((b >> 1 | carry_b) & ~b);
  }
  return static_cast<std::int32_t>(w * 64) + 63 - __builtin_clzll(stops);
}

}  // namespace trundle
