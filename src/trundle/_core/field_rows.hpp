// What a cost field reads and writes, in the widest registers that the processor has: a tile's costs before it is settled,
// and the rows of the result; and memory for a whole map.
#pragma once

#include "field_tile.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define TRUNDLE_AVX2 1
#endif

namespace trundle {

struct Freed {
  void operator()(void *memory) const noexcept { std::free(memory); }
};

// Memory for a whole map. In large pages, where the system has them to give: the small ones of a map of 2000 x 2000 cells
// take it as long to find as a third of the field.
template <typename Number>
std::unique_ptr<Number[], Freed> allocate(std::size_t count) {
  constexpr std::size_t kLargePage = std::size_t{1} << 21;
  const std::size_t bytes = (std::max<std::size_t>(count, 1) * sizeof(Number) + kLargePage - 1) / kLargePage * kLargePage;
  void *memory = bytes > 2 * kLargePage ? std::aligned_alloc(kLargePage, bytes) : std::malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
#if defined(__linux__)
  if (bytes > 2 * kLargePage) madvise(memory, bytes, MADV_HUGEPAGE);
#endif
  return std::unique_ptr<Number[], Freed>(static_cast<Number *>(memory));
}

template <typename Cost>
struct Grid {
  const Cost *costs;
  std::int64_t rows, cols;
  bool diagonals;
};

// What a cell's half of a straight and of a diagonal step costs, for the cells of a tile and its frame.
template <typename Cost, typename Number>
TRUNDLE_INLINE void load_costs(const Grid<Cost> &grid, std::int64_t y, std::int64_t x, Tile<Number> &tile) {
  constexpr Number kFar = Scale<Number>::kFar;
  for (int r = -1; r <= kTile; ++r) {
    Number *straight = tile.upright.straight[1 + r] + Tile<Number>::kFirst;
    Number *diagonal = tile.upright.diagonal[1 + r] + Tile<Number>::kFirst;
    std::fill(straight - 1, straight + kTile + 1, kFar);
    std::fill(diagonal - 1, diagonal + kTile + 1, kFar);
    if (y + r < 0 || y + r >= grid.rows) continue;
    const Cost *costs = grid.costs + (y + r) * grid.cols + x;
    const int first = x > 0 ? -1 : 0, last = static_cast<int>(std::min<std::int64_t>(kTile + 1, grid.cols - x));
    for (int c = first; c < last; ++c) {
      straight[c] = is_wall(costs[c]) ? kFar : static_cast<Number>(costs[c]) * Scale<Number>::kStraight;
    }
    if (!grid.diagonals) continue;
    for (int c = first; c < last; ++c) {
      diagonal[c] = is_wall(costs[c]) ? kFar : static_cast<Number>(costs[c]) * Scale<Number>::kDiagonal;
    }
  }
}

template <int kBytes, typename Cost, typename Number>
TRUNDLE_INLINE void settle_any(const Grid<Cost> &grid, std::int64_t y, std::int64_t x, Tile<Number> &tile,
                               bool everywhere) {
  load_costs(grid, y, x, tile);
  tile.template settle<kBytes>(everywhere);
}

template <typename Cost, typename Number>
void settle_portable(const Grid<Cost> &grid, std::int64_t y, std::int64_t x, Tile<Number> &tile, bool everywhere) {
  settle_any<16>(grid, y, x, tile, everywhere);
}

#ifdef TRUNDLE_AVX2
template <typename Cost, typename Number>
__attribute__((target("avx2"))) void settle_avx2(const Grid<Cost> &grid, std::int64_t y, std::int64_t x,
                                                 Tile<Number> &tile, bool everywhere) {
  settle_any<32>(grid, y, x, tile, everywhere);
}
#endif

template <typename Cost, typename Number>
auto choose_settle() {
#ifdef TRUNDLE_AVX2
  if (__builtin_cpu_supports("avx2")) return settle_avx2<Cost, Number>;
#endif
  return settle_portable<Cost, Number>;
}

// The costs of a row as the caller counts them, infinity where there is no way, and the largest number among them. By way
// of blocks of our own, so that the two rows may be one.
template <typename Number>
TRUNDLE_INLINE Number write_any(const Number *values, std::int64_t count, float *out) {
  constexpr std::int64_t kBlock = 64;
  constexpr Number kFar = Scale<Number>::kFar;
  constexpr float kNone = std::numeric_limits<float>::infinity();
  using Signed = std::conditional_t<sizeof(Number) == 4, std::int32_t, double>;
  Number largest = 0;
  for (std::int64_t col = 0; col < count; col += kBlock) {
    const std::int64_t some = std::min(kBlock, count - col);
    Number costs[kBlock] = {};
    float written[kBlock];
    std::memcpy(costs, values + col, sizeof(Number) * static_cast<std::size_t>(some));
    for (int k = 0; k < kBlock; ++k) {
      const Number reached = costs[k] < kFar ? costs[k] : Number{0};
      const auto cost = static_cast<float>(static_cast<Signed>(reached) * (1.0 / Scale<Number>::kUnit));
      written[k] = costs[k] < kFar ? cost : kNone;
      largest = std::max(largest, reached);
    }
    std::memcpy(out + col, written, sizeof(float) * static_cast<std::size_t>(some));
  }
  return largest;
}

template <typename Number>
Number write_portable(const Number *values, std::int64_t count, float *out) {
  return write_any(values, count, out);
}

#ifdef TRUNDLE_AVX2
template <typename Number>
__attribute__((target("avx2"))) Number write_avx2(const Number *values, std::int64_t count, float *out) {
  return write_any(values, count, out);
}
#endif

template <typename Number>
auto choose_write() {
#ifdef TRUNDLE_AVX2
  if (__builtin_cpu_supports("avx2")) return write_avx2<Number>;
#endif
  return write_portable<Number>;
}

}  // namespace trundle
