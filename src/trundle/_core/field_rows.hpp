// What a cost field reads and writes, in the widest registers that the processor has: a tile's costs before it is
// settled, and the tile's part of the result after.
#pragma once

#include "field_tile.hpp"

#include <vector>

#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define TRUNDLE_AVX2 1
#endif

namespace trundle {

// The largest cost of a type is a wall.
template <typename Cost>
constexpr Cost kWall = std::numeric_limits<Cost>::has_infinity ? std::numeric_limits<Cost>::infinity()
                                                               : std::numeric_limits<Cost>::max();

template <typename Cost>
struct Grid {
  const Cost *costs;
  std::int64_t rows, cols;
  bool diagonals;
};

// The costs of a tile's cells and of those beyond two of its sides, row by row, and of its columns; walls outside the
// grid.
template <typename Cost>
struct TileCosts {
  alignas(64) Cost upright[kTile + 2][kTile], turned[kTile + 2][kTile];
  Cost corner[4];

  TRUNDLE_INLINE void load(const Grid<Cost> &grid, std::int64_t y, std::int64_t x) {
    const auto at = [&](std::int64_t r, std::int64_t c) {
      return r >= 0 && r < grid.rows && c >= 0 && c < grid.cols ? grid.costs[r * grid.cols + c] : kWall<Cost>;
    };
    for (int r = 0; r < kTile + 2; ++r) {
      const std::int64_t row = y + r - 1;
      if (row < 0 || row >= grid.rows) {
        std::fill_n(upright[r], kTile, kWall<Cost>);
      } else if (x + kTile <= grid.cols) {
        std::memcpy(upright[r], grid.costs + row * grid.cols + x, sizeof upright[r]);
      } else {
        const Cost *from = grid.costs + row * grid.cols + x;
        std::fill(std::copy(from, grid.costs + (row + 1) * grid.cols, upright[r]), upright[r] + kTile, kWall<Cost>);
      }
    }
    transpose<kTile, 1>(upright[1], turned[1]);
    load_column(grid, y, x - 1, turned[0]);
    load_column(grid, y, x + kTile, turned[kTile + 1]);
    corner[0] = at(y - 1, x - 1);
    corner[1] = at(y - 1, x + kTile);
    corner[2] = at(y + kTile, x - 1);
    corner[3] = at(y + kTile, x + kTile);
  }

 private:
  static TRUNDLE_INLINE void load_column(const Grid<Cost> &grid, std::int64_t y, std::int64_t x, Cost (&to)[kTile]) {
    const bool inside = x >= 0 && x < grid.cols;
    const auto high = inside ? static_cast<int>(std::min<std::int64_t>(kTile, grid.rows - y)) : 0;
    const Cost *from = grid.costs + y * grid.cols + x;
    for (int r = 0; r < high; ++r) to[r] = from[r * grid.cols];
    std::fill(to + high, to + kTile, kWall<Cost>);
  }
};

// Half steps in the cells of a row, straight and diagonal, kFar or more in a wall; and kFar in a wall, 0 elsewhere.
template <int kBytes, typename Number>
struct HalfSteps {
  static constexpr int kLanes = kBytes / static_cast<int>(sizeof(Number)), kParts = kTile / kLanes;
  using Vector = typename Register<Number, kBytes>::Vector;
  Vector straight[kParts], diagonal[kParts], wall[kParts];

  template <typename Cost>
  TRUNDLE_INLINE void load(const Cost (&costs)[kTile]) {
    constexpr Number kFar = Scale<Number>::kFar, kNumberOfWall = static_cast<Number>(kWall<Cost>);
    alignas(64) Number numbers[kTile];
    for (int c = 0; c < kTile; ++c) numbers[c] = static_cast<Number>(costs[c]);
    Vector row[kParts];
    each<kParts>(TRUNDLE_LAMBDA(auto k) { std::memcpy(&row[k], numbers + k * kLanes, kBytes); });
    deal(row);
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      const Vector cost = row[k];
      wall[k] = cost == kNumberOfWall ? Vector{} + kFar : Vector{};
      if constexpr (std::is_integral_v<Number>) {
        straight[k] = cost * Scale<Number>::kStraight + wall[k];
        diagonal[k] = cost * Scale<Number>::kDiagonal + wall[k];
      } else {
        const Vector counted = cost > 0 ? cost : Vector{};  // of costs below 0 and of NaN there would be no end
        straight[k] = cost == kNumberOfWall ? wall[k] : counted * Scale<Number>::kStraight;
        diagonal[k] = cost == kNumberOfWall ? wall[k] : counted * Scale<Number>::kDiagonal;
      }
    });
  }
};

// What the steps between the rows of a plane cost. A diagonal one needs both cells beside it free.
template <int kBytes, typename Number, typename Cost>
TRUNDLE_INLINE void load_steps(const Cost (&costs)[kTile + 2][kTile], bool diagonals,
                               typename Tile<Number>::Plane &plane) {
  using Half = HalfSteps<kBytes, Number>;
  using Vector = typename Half::Vector;
  constexpr int kParts = Half::kParts, kLanes = Half::kLanes;
  Half rows[2];
  rows[0].load(costs[0]);
  for (int row = 0; row <= kTile; ++row) {
    const Half &low = rows[row % 2];
    Half &high = rows[1 - row % 2];
    high.load(costs[row + 1]);
    Vector off[kParts], on[kParts];
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      off[k] = low.diagonal[k] + high.wall[k];
      on[k] = high.diagonal[k] + low.wall[k];
      const Vector straight = low.straight[k] + high.straight[k];
      std::memcpy(plane.straight[row] + k * kLanes, &straight, kBytes);
    });
    const Vector below_first = turned_up(off[kParts - 1]), beyond_last = turned_down(off[0]);
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      const Vector left = on[k] + (k > 0 ? off[(k + kParts - 1) % kParts] : below_first);
      const Vector right = on[k] + (k + 1 < kParts ? off[(k + 1) % kParts] : beyond_last);
      std::memcpy(plane.left[row] + k * kLanes, &left, kBytes);
      std::memcpy(plane.right[row] + k * kLanes, &right, kBytes);
    });
    plane.left[row][0] = plane.right[row][kTile - 1] = Scale<Number>::kFar;
  }
  if (diagonals) return;
  std::fill_n(&plane.left[0][0], (kTile + 1) * kTile, Scale<Number>::kFar);
  std::fill_n(&plane.right[0][0], (kTile + 1) * kTile, Scale<Number>::kFar);
}

template <typename Number, typename Cost>
TRUNDLE_INLINE void load_corners(const TileCosts<Cost> &costs, bool diagonals, Tile<Number> &tile) {
  for (int corner = 0; corner < 4; ++corner) {
    const int row = corner < 2 ? 1 : kTile, col = corner % 2 == 0 ? 0 : kTile - 1;
    const Cost own = costs.upright[row][col], across = costs.corner[corner];
    const Cost beside = costs.upright[corner < 2 ? 0 : kTile + 1][col];
    const Cost other = costs.turned[corner % 2 == 0 ? 0 : kTile + 1][row - 1];
    const bool open = diagonals && std::max({own, across, beside, other}) < kWall<Cost>;
    const Number both = static_cast<Number>(own) + static_cast<Number>(across);
    tile.corner_step[corner] = open ? both * Scale<Number>::kDiagonal : Scale<Number>::kFar;
  }
}

// The costs of so many cells of a row as the caller counts them, infinity where there is no way, and the largest
// number.
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
  float written[kTile];
  each<kTile / kLanes>(TRUNDLE_LAMBDA(auto k) {
    Numbers own;
    std::memcpy(&own, reinterpret_cast<const char *>(row) + k * sizeof own, sizeof own);
    const Floats costs = __builtin_convertvector(
        __builtin_convertvector(reinterpret_cast<Whole>(own), Doubles) * (1.0 / Scale<Number>::kUnit), Floats);
    const Mask far = __builtin_convertvector(own >= kFar, Mask);
    const Floats shown = far ? Floats{} + std::numeric_limits<float>::infinity() : costs;
    std::memcpy(written + k * kLanes, &shown, sizeof shown);
  });
  if (count == kTile) {
    std::memcpy(out, written, sizeof written);
  } else {
    std::memcpy(out, written, sizeof(float) * static_cast<std::size_t>(count));
  }
  return largest;
}

// The same of the rows of a tile that changed.
template <int kBytes, typename Number>
TRUNDLE_INLINE Number write(const Number (&values)[kTile + 2][kTile], std::uint64_t changed, int cols, float *out,
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

// Which tile to settle, by its first cell, and where the result goes.
template <typename Cost>
struct Place {
  const Grid<Cost> &grid;
  std::int64_t y, x;
  float *out;
};

// What a thread works with. The tile's frame and its own goals are given, and so may be what its cells cost when it
// was settled last.
template <typename Cost, typename Number>
struct Work {
  TileCosts<Cost> costs;
  Tile<Number> tile;
  std::vector<std::int32_t> goals;  // cells, counted row by row
  Number *kept;                     // where to keep the cells' numbers for the next time, or null
  bool known;                       // whether those of the last time are there
  typename Tile<Number>::Gains gains;
  Number largest;
};

template <int kBytes, typename Cost, typename Number>
TRUNDLE_INLINE void settle_any(const Place<Cost> &place, Work<Cost, Number> &work) {
  const Grid<Cost> &grid = place.grid;
  Tile<Number> &tile = work.tile;
  work.costs.load(grid, place.y, place.x);
  load_steps<kBytes, Number>(work.costs.upright, grid.diagonals, tile.upright);
  load_steps<kBytes, Number>(work.costs.turned, grid.diagonals, tile.turned);
  load_corners(work.costs, grid.diagonals, tile);
  tile.template begin<kBytes>(work.known ? work.kept : nullptr);
  for (const std::int32_t cell : work.goals) tile.template improve<kBytes>(cell / kTile, cell % kTile, 0);
  tile.template settle<kBytes>();
  work.gains = tile.template gains<kBytes>();
  if (work.kept != nullptr) std::memcpy(work.kept, tile.upright.value[1], sizeof(Number) * kTile * kTile);
  const auto wide = static_cast<int>(std::min<std::int64_t>(kTile, grid.cols - place.x));
  const auto high = static_cast<int>(std::min<std::int64_t>(kTile, grid.rows - place.y));
  std::uint64_t rows = (std::uint64_t{2} << high) - 2;
  if (work.known) rows &= tile.rows.ever;
  work.largest = write<kBytes>(tile.upright.value, rows, wide, place.out + place.y * grid.cols + place.x, grid.cols);
}

template <typename Cost, typename Number>
void settle_portable(const Place<Cost> &place, Work<Cost, Number> &work) {
  settle_any<16>(place, work);
}

#ifdef TRUNDLE_AVX2
template <typename Cost, typename Number>
__attribute__((target("avx2"))) void settle_avx2(const Place<Cost> &place, Work<Cost, Number> &work) {
  settle_any<32>(place, work);
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
