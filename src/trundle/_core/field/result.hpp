// A tile's part of the result, in the widest registers that the processor has.
#pragma once

#include "field/tile.hpp"

#include <cmath>

namespace trundle {

// Writes the costs of `count` cells of a row in the caller's unit, infinity where they are not reached. Returns the
// largest number.
template <int kBytes, typename Number>
TRUNDLE_INLINE auto write_row(const Number (&values)[kTile], int count, float *out) {
  constexpr int kLanes = kBytes / static_cast<int>(sizeof(double));
  constexpr Number kFar = Scale<Number>::kFar;
  using Dealt = typename Register<Number, kBytes>::Vector;
  using Signed = std::conditional_t<sizeof(Number) == 4, std::int32_t, Number>;
  using Numbers = typename Register<Number, kLanes * sizeof(Number)>::Vector;
  using Whole = typename Register<Signed, kLanes * sizeof(Number)>::Vector;
  using Doubles = typename Register<double, kBytes>::Vector;
  using Floats = typename Register<float, kBytes / 2>::Vector;
  using Mask = typename Register<std::int32_t, kBytes / 2>::Vector;
  constexpr int kDealtLanes = kLaneCount<Dealt>, kParts = kTile / kDealtLanes;
  Dealt row[kParts], largest = {};
  each<kParts>(TRUNDLE_LAMBDA(auto k) {
    std::memcpy(&row[k], values + k * kDealtLanes, kBytes);
    const Dealt reached = row[k] < kFar ? row[k] : Dealt{};
    largest = largest > reached ? largest : reached;
  });
  gather(row);
  float buffer[kTile], *to = count == kTile ? out : buffer;
  each<kTile / kLanes>(TRUNDLE_LAMBDA(auto k) {
    Numbers own;
    std::memcpy(&own, reinterpret_cast<const char *>(row) + k * sizeof own, sizeof own);
    const Floats costs = __builtin_convertvector(
        __builtin_convertvector(reinterpret_cast<Whole>(own), Doubles) * (1.0 / Scale<Number>::kUnit), Floats);
    const Mask far = __builtin_convertvector(own >= kFar, Mask);
    const Floats shown = far ? Floats{} + std::numeric_limits<float>::infinity() : costs;
    std::memcpy(to + k * kLanes, &shown, sizeof shown);
  });
  if (count < kTile) std::copy_n(buffer, count, out);
  return largest;
}

// The same for the rows of a tile that changed.
template <int kBytes, typename Number>
TRUNDLE_INLINE Number write(const Number (*values)[kTile], std::uint64_t changed, int cols, float *out,
                            std::int64_t stride) {
  decltype(write_row<kBytes>(values[0], cols, out)) largest = {};
  for (; changed != 0; changed &= changed - 1) {
    const int row = __builtin_ctzll(changed);
    const auto own = write_row<kBytes>(values[row], cols, out + (row - 1) * stride);
    largest = largest > own ? largest : own;
  }
  const auto more = TRUNDLE_LAMBDA(auto a, auto b) { return a > b ? a : b; };
  return joined<kLaneCount<decltype(largest)> / 2>(largest, more)[0];
}

// A thread's memory: a tile, and its numbers where they are not kept.
template <typename Cost, typename Number>
struct Workspace {
  Tile<Cost, Number> tile;
  alignas(64) Number value[kTile + 2][kTile];  // for tiles whose numbers are not to be kept
  Number largest;
};

template <int kBytes, typename Cost, typename Number>
TRUNDLE_INLINE void settle_any(const TileView<Cost> &view, float *out, Workspace<Cost, Number> &work) {
  const Grid<Cost> &grid = view.grid;
  Tile<Cost, Number> &tile = work.tile;
  tile.template settle<kBytes>(view);
  const auto wide = static_cast<int>(std::min<std::int64_t>(kTile, grid.cols - view.x));
  const auto high = static_cast<int>(std::min<std::int64_t>(kTile, grid.rows - view.y));
  std::uint64_t rows = (std::uint64_t{2} << high) - 2;
  if (tile.is_kept) rows &= tile.changed;
  work.largest = write<kBytes>(tile.value, rows, wide, out + view.y * grid.cols + view.x, grid.cols);
}

template <typename Cost, typename Number>
void settle_portable(const TileView<Cost> &view, float *out, Workspace<Cost, Number> &work) {
  settle_any<16>(view, out, work);
}

#ifdef TRUNDLE_AVX2
template <typename Cost, typename Number>
TRUNDLE_TARGET("avx2") void settle_avx2(const TileView<Cost> &view, float *out, Workspace<Cost, Number> &work) {
  settle_any<32>(view, out, work);
}
#endif

template <typename Cost, typename Number>
auto choose_settle() {
#ifdef TRUNDLE_AVX2
  if (__builtin_cpu_supports("avx2")) return settle_avx2<Cost, Number>;
#endif
  return settle_portable<Cost, Number>;
}

}  // namespace trundle
