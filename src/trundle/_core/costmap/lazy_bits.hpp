// The blocked cells of a costmap as bits, packed when they are first asked for.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "shared/zeroed_table.hpp"

namespace trundle {

class LazyBits {
 public:
  // Forgets what was packed before. Cells of 254 and 255 are blocked.
  void begin(const std::uint8_t *costs, std::int64_t rows, std::int64_t cols) {
    costs_ = costs, rows_ = rows, cols_ = cols, block_cols_ = (cols + 63) / 64;
    const auto blocks = static_cast<std::size_t>((rows + kRows - 1) / kRows * block_cols_);
    packed_.fit(blocks);
    words_.fit(blocks * kRows);
    if (++stamp_ == 0) packed_.clear(), stamp_ = 1;  // after 2^32 queries
  }

  // Packs all cells of a rectangle inside the map.
  void pack(std::int64_t first_row, std::int64_t last_row, std::int64_t first_col, std::int64_t last_col) {
    for (std::int64_t row = first_row / kRows; row <= last_row / kRows; ++row) {
      for (std::int64_t col = first_col / 64; col <= last_col / 64; ++col) {
        std::uint32_t &packed = packed_[static_cast<std::size_t>(row * block_cols_ + col)];
        if (packed != stamp_) pack_block(row, col), packed = stamp_;
      }
    }
  }

  // Whether one is blocked of `count` cells of a row from a column on, 1 to 64 cells that are packed.
  bool any(std::int64_t row, std::int64_t col, int count) const {
    const std::uint64_t *word = words_.data() + word_index(row, col);
    const int shift = static_cast<int>(col & 63);
    std::uint64_t bits = *word >> shift;
    if (shift + count > 64) bits |= word[kRows] << (64 - shift);  // the block to the right comes next
    return (bits & (~std::uint64_t{0} >> (64 - count))) != 0;
  }

  // The same of a rectangle of any size inside the map.
  bool any_in(std::int64_t first_row, std::int64_t last_row, std::int64_t first_col, std::int64_t last_col) {
    pack(first_row, last_row, first_col, last_col);
    for (std::int64_t row = first_row; row <= last_row; ++row) {
      for (std::int64_t col = first_col; col <= last_col; col += 64) {
        if (any(row, col, static_cast<int>(std::min<std::int64_t>(64, last_col - col + 1)))) return true;
      }
    }
    return false;
  }

  std::size_t bytes() const { return packed_.bytes() + words_.bytes(); }

 private:
  static constexpr std::int64_t kRows = 16;  // of a block, which is a word wide

  std::size_t word_index(std::int64_t row, std::int64_t col) const {
    return static_cast<std::size_t>((row / kRows * block_cols_ + (col >> 6)) * kRows + row % kRows);
  }

  void pack_block(std::int64_t block_row, std::int64_t block_col) {
    const std::int64_t first = block_row * kRows, left = block_col * 64;
    const std::int64_t last = std::min(first + kRows, rows_), count = std::min<std::int64_t>(64, cols_ - left);
    std::uint64_t *word = words_.data() + word_index(first, left);
    for (std::int64_t row = first; row < last; ++row) {
      const std::uint8_t *cells = costs_ + row * cols_ + left;
      std::uint64_t bits = 0;
      std::int64_t col = 0;
      for (; col + 8 <= count; col += 8) bits |= eight(cells + col) << col;
      for (; col < count; ++col) bits |= std::uint64_t{cells[col] >= kLethal} << col;
      *word++ = bits;
    }
  }

  static std::uint64_t eight(const std::uint8_t *cells) {
    constexpr std::uint64_t kLow = 0x7f7f7f7f7f7f7f7f, kTwo = 0x0202020202020202;
    std::uint64_t bytes;
    std::memcpy(&bytes, cells, 8);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    bytes = __builtin_bswap64(bytes);  // the first cell goes to the lowest bit
#endif
    // The top bit of bytes that have it and whose other bits reach 126.
    const std::uint64_t tops = ((bytes & kLow) + kTwo) & bytes & ~kLow;
    return (tops >> 7) * 0x0102040810204080 >> 56;
  }

  static constexpr std::uint8_t kLethal = 254;

  const std::uint8_t *costs_ = nullptr;
  std::int64_t rows_ = 0, cols_ = 0, block_cols_ = 0;
  std::uint32_t stamp_ = 0;
  ZeroedTable<std::uint32_t> packed_;
  ZeroedTable<std::uint64_t> words_;
};

}  // namespace trundle
