// Costs of the steps between a tile's cells, and to those around it: made from the grid's costs where they are
// needed, a row at a time.
#pragma once

#include "field/row.hpp"

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

  Cost at(std::int64_t row, std::int64_t col) const {
    return row >= 0 && row < rows && col >= 0 && col < cols ? costs[row * cols + col] : kWall<Cost>;
  }
};

// The costs of a tile's cells, where they are in the grid; the tile is that from (y, x) on.
template <typename Cost>
struct TileView {
  const Grid<Cost> &grid;
  std::int64_t y, x;

  // The costs of a row of its cells, in the grid, or copied to `buffer` where some lie outside it; −1 and kTile are the
  // rows beyond the tile.
  TRUNDLE_INLINE const Cost *row(int r, Cost (&buffer)[kTile]) const {
    const bool inside = y + r >= 0 && y + r < grid.rows;
    if (inside && x + kTile <= grid.cols) return grid.costs + (y + r) * grid.cols + x;
    const auto wide = inside ? static_cast<int>(std::min<std::int64_t>(kTile, grid.cols - x)) : 0;
    for (int c = 0; c < wide; ++c) buffer[c] = grid.costs[(y + r) * grid.cols + x + c];
    std::fill(buffer + wide, buffer + kTile, kWall<Cost>);
    return buffer;
  }

  TRUNDLE_INLINE const Cost *col(int c, Cost (&buffer)[kTile]) const {
    const bool inside = x + c >= 0 && x + c < grid.cols;
    const auto high = inside ? static_cast<int>(std::min<std::int64_t>(kTile, grid.rows - y)) : 0;
    for (int r = 0; r < high; ++r) buffer[r] = grid.costs[(y + r) * grid.cols + x + c];
    std::fill(buffer + high, buffer + kTile, kWall<Cost>);
    return buffer;
  }

  // Reads a cost of each cache line that the rows lie in: all at once arrive in the time of a few one after the other.
  // A prefetch does not do that: where the system has the map in small pages, it is often dropped.
  TRUNDLE_INLINE Cost touch() const {
    constexpr std::int64_t kApart = 64 / sizeof(Cost);
    const std::int64_t first = std::max<std::int64_t>(x - 1, 0), last = std::min(x + kTile, grid.cols - 1);
    Cost all = 0;
    for (std::int64_t r = std::max<std::int64_t>(y - 1, 0); r < std::min(y + kTile + 1, grid.rows); ++r) {
      for (std::int64_t c = first; c < last; c += kApart) all += grid.costs[r * grid.cols + c];
      all += grid.costs[r * grid.cols + last];
    }
    return all;
  }
};

// Half steps in the cells of a row, straight and diagonal, kFar or more in a wall; and kFar in a wall, 0 elsewhere.
template <int kBytes, typename Number>
struct HalfSteps {
  using R = Row<Number, kBytes>;
  using Vector = typename R::Vector;
  static constexpr int kParts = R::kParts;
  Vector straight[kParts], diagonal[kParts], wall[kParts];

  template <typename Cost>
  TRUNDLE_INLINE void load(const Cost *costs) {
    constexpr Number kFar = Scale<Number>::kFar, kNumberOfWall = static_cast<Number>(kWall<Cost>);
    Vector row[kParts];
    load_dealt(costs, row);
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      const Vector cost = row[k];
      wall[k] = cost == kNumberOfWall ? Vector{} + kFar : Vector{};
      if constexpr (std::is_integral_v<Number>) {
        straight[k] = cost * Scale<Number>::kStraight + wall[k];
        diagonal[k] = cost * Scale<Number>::kDiagonal + wall[k];
      } else {
        const Vector counted = cost > 0 ? cost : Vector{};  // costs below 0, and NaN, would fall for ever
        straight[k] = cost == kNumberOfWall ? wall[k] : counted * Scale<Number>::kStraight;
        diagonal[k] = cost == kNumberOfWall ? wall[k] : counted * Scale<Number>::kDiagonal;
      }
    });
  }

 private:
  template <typename Cost>
  static TRUNDLE_INLINE void load_dealt(const Cost *costs, Vector (&row)[kParts]) {
    constexpr bool kLowFirst = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
    if constexpr (kLowFirst && std::is_integral_v<Number> && sizeof(Cost) * kParts == sizeof(Number)) {
      Vector packed;  // in each lane the costs of its cells
      std::memcpy(&packed, costs, kBytes);
      each<kParts>(TRUNDLE_LAMBDA(auto k) {
        row[k] = packed >> static_cast<Number>(8 * sizeof(Cost) * k) & Number{std::numeric_limits<Cost>::max()};
      });
    } else {
      alignas(64) Number numbers[kTile];
      for (int c = 0; c < kTile; ++c) numbers[c] = static_cast<Number>(costs[c]);
      each<kParts>(TRUNDLE_LAMBDA(auto k) { std::memcpy(&row[k], numbers + k * R::kLanes, kBytes); });
      deal(row);
    }
  }
};

// Steps between two rows. A diagonal step needs both cells beside it free.
template <int kBytes, typename Number>
TRUNDLE_INLINE void make_steps(const HalfSteps<kBytes, Number> &low, const HalfSteps<kBytes, Number> &high,
                               bool diagonals, Steps<Number> &steps) {
  using R = Row<Number, kBytes>;
  using Vector = typename R::Vector;
  constexpr int kParts = R::kParts, kLast = kParts - 1;
  R straight, left, right;
  Vector off[kParts], on[kParts];
  each<kParts>(TRUNDLE_LAMBDA(auto k) {
    off[k] = low.diagonal[k] + high.wall[k];
    on[k] = high.diagonal[k] + low.wall[k];
    straight.part[k] = low.straight[k] + high.straight[k];
  });
  const Vector below_first = rotated_up(off[kLast]), beyond_last = rotated_down(off[0]);
  each<kParts>(TRUNDLE_LAMBDA(auto k) {
    left.part[k] = on[k] + (k > 0 ? off[(k + kLast) % kParts] : below_first);
    right.part[k] = on[k] + (k < kLast ? off[(k + 1) % kParts] : beyond_last);
  });
  if (diagonals) {
    left.part[0][0] = right.part[kLast][R::kLanes - 1] = R::kFar;
  } else {
    each<kParts>(TRUNDLE_LAMBDA(auto k) { left.part[k] = right.part[k] = Vector{} + R::kFar; });
  }
  straight.store(steps.straight);
  left.store(steps.left);
  right.store(steps.right);
}

// Along a row, to each cell from the one before it.
template <int kBytes, typename Number>
TRUNDLE_INLINE void make_steps_along(const HalfSteps<kBytes, Number> &half, Number (&steps)[kTile]) {
  using R = Row<Number, kBytes>;
  constexpr int kParts = R::kParts, kLast = kParts - 1;
  const auto below_first = rotated_up(half.straight[kLast]);
  R step;
  each<kParts>(TRUNDLE_LAMBDA(auto k) {
    const auto both = half.straight[k] + (k > 0 ? half.straight[(k + kLast) % kParts] : below_first);
    step.part[k] = least(both, typename R::Vector{} + R::kFar);
  });
  step.part[0][0] = R::kFar;
  step.store(steps);
}

// The steps of a tile.
template <typename Cost, typename Number>
class TileSteps {
 public:
  // Those from a row to the next higher one, and along both of them; the row below the tile is 0, its own are 1 to
  // kTile.
  Steps<Number> up[kTile + 1];
  alignas(64) Number along[kTile + 2][kTile];

  void begin() { ready_ = 0; }

  // Make steps where they are not made yet: all of them, or those of a row.
  template <int kBytes>
  TRUNDLE_INLINE void make_all(const TileView<Cost> &view) {
    alignas(64) Cost buffer[kTile];
    touched_ = view.touch();
    HalfSteps<kBytes, Number> halves[2];
    halves[0].load(view.row(-1, buffer));
    for (int row = 0; row <= kTile; ++row) {
      HalfSteps<kBytes, Number> &low = halves[row % 2], &high = halves[1 - row % 2];
      high.load(view.row(row, buffer));
      make_steps(low, high, view.grid.diagonals, up[row]);
      make_steps_along(high, along[row + 1]);
    }
    ready_ |= kUp;
  }

  template <int kBytes>
  TRUNDLE_INLINE void make(const TileView<Cost> &view, int row) {
    if (ready_ >> row & 1) return;
    ready_ |= std::uint64_t{1} << row;
    alignas(64) Cost buffer[kTile];
    HalfSteps<kBytes, Number> low, high;
    low.load(view.row(row - 1, buffer));
    high.load(view.row(row, buffer));
    make_steps(low, high, view.grid.diagonals, up[row]);
    make_steps_along(low, along[row]);
    make_steps_along(high, along[row + 1]);
  }

  // Those between the column beyond the tile and its own next to it, as if they were rows: on the left, or the right.
  template <int kBytes, bool kRightSide>
  TRUNDLE_INLINE const Steps<Number> &between_columns(const TileView<Cost> &view) {
    constexpr std::uint64_t kBit = (kUp + 1) << kRightSide;
    if (!(ready_ & kBit)) {
      ready_ |= kBit;
      constexpr int kFirst = kRightSide ? kTile - 1 : -1;
      alignas(64) Cost buffer[kTile];
      HalfSteps<kBytes, Number> low, high;
      low.load(view.col(kFirst, buffer));
      high.load(view.col(kFirst + 1, buffer));
      make_steps(low, high, view.grid.diagonals, sides_[kRightSide]);
    }
    return sides_[kRightSide];
  }

  // The step across a corner of the tile, to the row and the column beyond it: by the directions of both.
  static TRUNDLE_INLINE Number across(const TileView<Cost> &view, int rows, int cols) {
    const Grid<Cost> &grid = view.grid;
    const std::int64_t row = view.y + (rows < 0 ? 0 : kTile - 1), col = view.x + (cols < 0 ? 0 : kTile - 1);
    const Cost own = grid.at(row, col), other = grid.at(row + rows, col + cols);
    const Cost beside[2] = {grid.at(row + rows, col), grid.at(row, col + cols)};
    if (!grid.diagonals || std::max({own, other, beside[0], beside[1]}) == kWall<Cost>) return Scale<Number>::kFar;
    const auto counted = [](Cost cost) { return static_cast<Number>(cost > 0 ? cost : Cost{0}); };
    return (counted(own) + counted(other)) * Scale<Number>::kDiagonal;
  }

 private:
  static constexpr std::uint64_t kUp = (std::uint64_t{2} << kTile) - 1;

  Steps<Number> sides_[2];
  std::uint64_t ready_ = 0;  // a bit for each of the rows, and for the sides above them
  Cost touched_;
};

}  // namespace trundle
