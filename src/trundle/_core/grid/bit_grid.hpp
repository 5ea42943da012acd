// A grid of blocked and free cells as bits, and the scans along its lines that jump point search is made of.
//
// Cells have a border of one blocked cell, so that no scan needs a bound: (row, col) here is (row - 1, col - 1) of the
// map. A word holds 64 columns of a row, and the words of eight rows lie together in the 64 bytes of a cache line: a
// scan looks at three rows at once, and a diagonal one goes from row to row.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace trundle {

// Where a scan ends.
struct Stop {
  std::int32_t at;
  bool blocked;
};

class BitGrid {
 public:
  // All cells blocked; rows and cols count the border.
  BitGrid(std::int64_t rows, std::int64_t cols)
      : rows_(rows),
        cols_(cols),
        words_(static_cast<std::size_t>(cols + 63) / 64),
        storage_((static_cast<std::size_t>(rows + 7) / 8 * words_ + 1) * kLine, ~std::uint64_t{0}) {
    const auto address = reinterpret_cast<std::uintptr_t>(storage_.data());
    bits_ = storage_.data() + (64 - address % 64) % 64 / sizeof(std::uint64_t);
  }
  BitGrid(const BitGrid &) = delete;
  BitGrid &operator=(const BitGrid &) = delete;

  std::int64_t rows() const { return rows_; }
  std::int64_t cols() const { return cols_; }
  std::size_t words() const { return words_; }
  std::size_t bytes() const { return storage_.size() * sizeof(std::uint64_t); }

  std::uint64_t &word(std::int64_t row, std::size_t index) { return bits_[word_index(row) + index * kLine]; }
  std::uint64_t word(std::int64_t row, std::size_t index) const { return bits_[word_index(row) + index * kLine]; }

  bool blocked(std::int32_t row, std::int32_t col) const {
    return word(row, static_cast<std::size_t>(col) >> 6) >> (col & 63) & 1;
  }

  // Prefetches the cells around one, which may lie outside.
  void prefetch(std::int32_t row, std::int32_t col) const {
    const auto line = static_cast<std::uintptr_t>(row >> 3) * words_ + static_cast<std::uintptr_t>(col >> 6);
    __builtin_prefetch(reinterpret_cast<const void *>(reinterpret_cast<std::uintptr_t>(bits_) + line * 64));
  }

  void set(std::int64_t row, std::int64_t col, bool blocked) {
    const std::uint64_t bit = std::uint64_t{1} << (col & 63);
    std::uint64_t &bits = word(row, static_cast<std::size_t>(col) >> 6);
    bits = blocked ? bits | bit : bits & ~bit;
  }

  // A row inside the border, and the two beside it.
  struct Rows {
    const std::uint64_t *low, *own, *high;
    bool blocked(std::int32_t col) const { return own[(static_cast<std::size_t>(col) >> 6) * kLine] >> (col & 63) & 1; }
  };
  Rows around(std::int32_t row) const { return {bits_ + word_index(row - 1), bits_ + word_index(row), bits_ + word_index(row + 1)}; }
  // Those around `row`, from those around the row before it or, with step -1, after it.
  template <int Step>
  Rows onward(const Rows &last, std::int32_t row) const {
    if constexpr (Step > 0) return {last.own, last.high, bits_ + word_index(row + 1)};
    return {bits_ + word_index(row - 1), last.low, last.own};
  }

  // The first cell after a column, with growing columns, that is blocked or has a forced neighbour: one beside it is
  // free, and the one beside the cell before is blocked.
  static Stop scan_up(const Rows &rows, std::int32_t col) {
    const auto [low, own, high] = rows;
    std::size_t at = (static_cast<std::size_t>(col) >> 6) * kLine;
    std::uint64_t l = low[at], m = own[at], h = high[at];
    std::uint64_t stops = (m | ((l << 1) & ~l) | ((h << 1) & ~h)) & (~std::uint64_t{1} << (col & 63));
    while (stops == 0) {
      const std::uint64_t carry_l = l >> 63, carry_h = h >> 63;
      at += kLine;
      l = low[at], m = own[at], h = high[at];
      stops = m | ((l << 1 | carry_l) & ~l) | ((h << 1 | carry_h) & ~h);
    }
    const int bit = __builtin_ctzll(stops);
    return {static_cast<std::int32_t>(at * (64 / kLine)) + bit, (m >> bit & 1) != 0};
  }

  // The same with falling columns.
  static Stop scan_down(const Rows &rows, std::int32_t col) {
    const auto [low, own, high] = rows;
    std::size_t at = (static_cast<std::size_t>(col) >> 6) * kLine;
    std::uint64_t l = low[at], m = own[at], h = high[at];
    std::uint64_t stops =
        (m | ((l >> 1) & ~l) | ((h >> 1) & ~h)) & ((std::uint64_t{1} << (col & 63)) - 1);
    while (stops == 0) {
      const std::uint64_t carry_l = l << 63, carry_h = h << 63;
      at -= kLine;
      l = low[at], m = own[at], h = high[at];
      stops = m | ((l >> 1 | carry_l) & ~l) | ((h >> 1 | carry_h) & ~h);
    }
    const int bit = 63 - __builtin_clzll(stops);
    return {static_cast<std::int32_t>(at * (64 / kLine)) + bit, (m >> bit & 1) != 0};
  }

  // The first blocked cell of a row from a column on.
  std::int32_t run_end(std::int64_t row, std::int32_t col) const {
    std::size_t w = static_cast<std::size_t>(col) >> 6;
    std::uint64_t stops = word(row, w) & (~std::uint64_t{0} << (col & 63));
    while (stops == 0) stops = word(row, ++w);
    return static_cast<std::int32_t>(w * 64) + __builtin_ctzll(stops);
  }

  // Adds up the free cells of rows and words [first, end), and four times the Euler number of the free space (its parts
  // less the obstacles within) as far as squares of 2 x 2 cells count whose lower left cell is one of them, and the
  // corners of obstacles there. S. Gray, "Local Properties of Binary Images in Two Dimensions" (1971), for 4-connected
  // free space.
  void count(std::int64_t row_first, std::int64_t row_end, std::size_t word_first, std::size_t word_end,
             std::int64_t &free, std::int64_t &euler, std::int64_t &corners) const {
    for (std::int64_t row = std::max<std::int64_t>(row_first, 0); row < std::min(row_end, rows_ - 1); ++row) {
      for (std::size_t w = word_first; w < std::min(word_end, words_); ++w) {
        const bool last = w + 1 == words_;
        const std::uint64_t a = ~word(row, w), c = ~word(row + 1, w);
        const std::uint64_t b = a >> 1 | (last ? 0 : ~word(row, w + 1) << 63);
        const std::uint64_t d = c >> 1 | (last ? 0 : ~word(row + 1, w + 1) << 63);
        const std::uint64_t odd = a ^ b ^ c ^ d, two = (a & b) | (c & d) | ((a | b) & (c | d));
        const std::uint64_t crossed = (a & d & ~b & ~c) | (b & c & ~a & ~d);
        free += __builtin_popcountll(a);
        const std::int64_t three = __builtin_popcountll(odd & two);
        euler += __builtin_popcountll(odd & ~two) - three + 2 * __builtin_popcountll(crossed);
        corners += three;
      }
    }
  }

  // Becomes the other grid with rows and columns exchanged.
  void transpose(const BitGrid &other) {
    std::uint64_t block[64];
    for (std::int64_t row = 0; row < other.rows_; row += 64) {
      for (std::size_t w = 0; w < other.words_; ++w) {
        for (std::int64_t i = 0; i < 64; ++i) block[i] = row + i < other.rows_ ? other.word(row + i, w) : ~std::uint64_t{0};
        transpose_block(block);
        const std::int64_t first = static_cast<std::int64_t>(w) * 64, count = std::min<std::int64_t>(64, rows_ - first);
        for (std::int64_t i = 0; i < count; ++i) word(first + i, static_cast<std::size_t>(row) / 64) = block[i];
      }
    }
  }

 private:
  static constexpr std::size_t kLine = 8;

  std::size_t word_index(std::int64_t row) const {
    return (static_cast<std::size_t>(row) >> 3) * words_ * kLine + (static_cast<std::size_t>(row) & 7);
  }

  // Exchanges ever smaller squares of bits across the diagonal.
  static void transpose_block(std::uint64_t (&block)[64]) {
    std::uint64_t mask = 0x00000000ffffffffULL;
    for (int size = 32; size > 0; size >>= 1, mask ^= mask << size) {
      for (int i = 0; i < 64; i = ((i | size) + 1) & ~size) {
        const std::uint64_t change = ((block[i] >> size) ^ block[i | size]) & mask;
        block[i] ^= change << size;
        block[i | size] ^= change;
      }
    }
  }

  std::int64_t rows_, cols_;
  std::size_t words_;
  std::vector<std::uint64_t> storage_;
  std::uint64_t *bits_;
};

}  // namespace trundle
