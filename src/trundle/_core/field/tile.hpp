// One tile of a cost field: a square of cells with a frame of the neighbours' cells around it, settled by sweeps.
//
// A sweep (fast sweeping: Zhao 2005) takes the rows one after the other, upward or downward. Each is relaxed from the
// row before it, straight and along both diagonals, and then along itself, a register of cells at a time; it stays in
// registers for the next. Only rows next to one that changed are done again, until none changes: then each cell costs
// what its neighbours and the step from them say.
#pragma once

#include "field/step_costs.hpp"

#include <vector>

namespace trundle {

// The sides of a tile: below, above, on the left, on the right, and beyond the corners low left, low right, high
// left and high right.
enum Side { kLow, kHigh, kLeft, kRight, kCorner, kSides = 8 };
constexpr int kSideRow[kSides] = {-1, 1, 0, 0, -1, -1, 1, 1}, kSideCol[kSides] = {0, 0, -1, 1, -1, 1, -1, 1};

constexpr int opposite(int side) { return side < kCorner ? side ^ 1 : kCorner + kSides - 1 - side; }

// The cells along a tile's edges, as rows dealt to registers.
template <typename Number>
struct Edges {
  alignas(64) Number low[kTile], high[kTile], left[kTile], right[kTile];

  void clear() {
    for (Number *side : {low, high, left, right}) std::fill_n(side, kTile, Scale<Number>::kFar);
  }
};

template <typename Cost, typename Number>
class Tile {
 public:
  static constexpr Number kFar = Scale<Number>::kFar;

  // Given: the costs to go, of which the tile's own rows are 1 to kTile, and whether they are those that it was left
  // with; its edges and those of the tiles around it; the sides that offer something, a bit for each; and its goals,
  // counted row by row.
  Number (*value)[kTile];
  bool is_kept;
  Edges<Number> *edges;
  const Edges<Number> *neighbours[kSides];
  std::uint32_t offering;
  std::vector<std::int32_t> goals;

  // The result: the rows that changed, a bit for each; and the least cost that a cell beyond each side gets by a
  // step from here, where that is less than it has, else kFar.
  std::uint64_t changed;
  Number offers[kSides];

  template <int kBytes>
  TRUNDLE_INLINE void settle(const TileView<Cost> &view) {
    Number corners[4];
    for (int k = 0; k < 4; ++k) corners[k] = is_kept ? corner(kCorner + k) : kFar;
    take_offers<kBytes>(view);
    relax<kBytes>(view);
    find_offers<kBytes>(view, corners);
  }

 private:
  Number &corner(int side) { return value[kSideRow[side] < 0 ? 1 : kTile][kSideCol[side] < 0 ? 0 : kTile - 1]; }

  Number beyond_corner(int side) const {
    const Edges<Number> &there = *neighbours[side];
    return (kSideRow[side] < 0 ? there.high : there.low)[kSideCol[side] < 0 ? kTile - 1 : 0];
  }

  bool is_offering(int side, const Number (&edge)[kTile]) const {
    Number nearest = kFar;
    for (const Number cost : edge) nearest = std::min(nearest, cost);
    return offering >> side & 1 && nearest < kFar;
  }

  // Lowers the cells that the sides offer something, and the goals.
  template <int kBytes>
  TRUNDLE_INLINE void take_offers(const TileView<Cost> &view) {
    up_ = down_ = entered_ = changed = 0;
    steps_.begin();
    if (!is_kept) {
      std::fill_n(value[1], kTile * kTile, kFar);
      edges->clear();
      offering = (1 << kSides) - 1;
      steps_.template make_all<kBytes>(view);
    }
    if (is_offering(kLow, neighbours[kLow]->high)) {
      std::copy_n(neighbours[kLow]->high, kTile, value[0]);
      up_ = 1;
    }
    if (is_offering(kHigh, neighbours[kHigh]->low)) {
      std::copy_n(neighbours[kHigh]->low, kTile, value[kTile + 1]);
      down_ = std::uint64_t{1} << (kTile + 1);
    }
    if (is_offering(kLeft, neighbours[kLeft]->right)) {
      enter<kBytes, 1>(neighbours[kLeft]->right, steps_.template between_columns<kBytes, false>(view), 0);
    }
    if (is_offering(kRight, neighbours[kRight]->left)) {
      enter<kBytes, -1>(neighbours[kRight]->left, steps_.template between_columns<kBytes, true>(view), kTile - 1);
    }
    for (int side = kCorner; side < kSides; ++side) {
      if (!(offering >> side & 1) || beyond_corner(side) == kFar) continue;
      const Number cost = beyond_corner(side) + steps_.across(view, kSideRow[side], kSideCol[side]);
      improve(kSideRow[side] < 0 ? 1 : kTile, corner(side), cost);
    }
    for (const std::int32_t goal : goals) {
      const int row = goal / kTile + 1;
      improve(row, value[row][Row<Number, kBytes>::index_of(goal % kTile)], 0);
    }
  }

  TRUNDLE_INLINE void improve(int row, Number &own, Number cost) {
    entered_ |= std::uint64_t{cost < own} << row;
    own = std::min(own, cost);
  }

  // From a column beyond the tile to its own next to it.
  template <int kBytes, int kStep>
  TRUNDLE_INLINE void enter(const Number (&edge)[kTile], const Steps<Number> &between, int col) {
    using R = Row<Number, kBytes>;
    R beyond;
    beyond.load(edge);
    alignas(64) Number costs[kTile];
    step_from<kStep>(beyond, between).store(costs);
    for (int row = 1; row <= kTile; ++row) improve(row, value[row][col], costs[R::index_of(row - 1)]);
  }

  // Sweeps until nothing changes.
  template <int kBytes>
  TRUNDLE_INLINE void relax(const TileView<Cost> &view) {
    for (std::uint64_t rows = entered_; rows != 0; rows &= rows - 1) {
      const int row = __builtin_ctzll(rows);
      steps_.template make<kBytes>(view, row);
      Row<Number, kBytes> own;
      own.load(value[row]);
      relax_along(steps_.along[row], own);
      own.store(value[row]);
    }
    up_ |= entered_;
    down_ |= entered_;
    changed |= entered_;
    while (up_ || down_) {
      if (up_) sweep<kBytes, 1>(view);
      if (down_) sweep<kBytes, -1>(view);
    }
  }

  // Relaxes every row that follows a changed one; what changes is noted for the other direction. Most often the next
  // row changes as the last one did: where the processor guesses that it does not, it need not wait for this one.
  template <int kBytes, int kStep>
  TRUNDLE_INLINE void sweep(const TileView<Cost> &view) {
    using R = Row<Number, kBytes>;
    constexpr std::uint64_t kSources = ((std::uint64_t{1} << kTile) - 1) << (kStep > 0 ? 0 : 2);
    std::uint64_t open = (kStep > 0 ? up_ : down_) & kSources, lower = 0;
    (kStep > 0 ? up_ : down_) = 0;
    if (open == 0) return;
    int row = kStep > 0 ? __builtin_ctzll(open) : 63 - __builtin_clzll(open);
    R own, old;
    own.load(value[row]);
    // Rows between changed ones are relaxed too: to pass them by would take longer.
    do {
      const int low = kStep > 0 ? row : row - 1;
      steps_.template make<kBytes>(view, low);
      R next = step_from<kStep>(own, steps_.up[low]);
      row += kStep;
      old.load(value[row]);
      each<R::kParts>(TRUNDLE_LAMBDA(auto k) { next.part[k] = least(next.part[k], old.part[k]); });
      if (next != old) {
        relax_along(steps_.along[row], next);
        next.store(value[row]);
        own = next;
        lower |= std::uint64_t{1} << row;
        open |= std::uint64_t{1} << row & kSources;
      } else {
        own = old;
      }
    } while ((kStep > 0 ? open >> row : open << (63 - row)) != 0);
    (kStep > 0 ? down_ : up_) |= lower;
    changed |= lower;
  }

  // Brings the edges up to date; those that changed, and corners that cost less than they did, may offer something.
  template <int kBytes>
  TRUNDLE_INLINE void find_offers(const TileView<Cost> &view, const Number (&corners)[4]) {
    using R = Row<Number, kBytes>;
    std::fill_n(offers, int{kSides}, kFar);
    if (changed >> 1 & 1) {
      steps_.template make<kBytes>(view, 0);
      offers[kLow] = offer_of<kBytes, -1>(value[1], steps_.up[0], neighbours[kLow]->high, edges->low);
    }
    if (changed >> kTile & 1) {
      steps_.template make<kBytes>(view, kTile);
      offers[kHigh] = offer_of<kBytes, 1>(value[kTile], steps_.up[kTile], neighbours[kHigh]->low, edges->high);
    }
    alignas(64) Number left[kTile], right[kTile];
    for (int row = 0; row < kTile; ++row) {
      left[R::index_of(row)] = value[row + 1][0];
      right[R::index_of(row)] = value[row + 1][kTile - 1];
    }
    if (std::memcmp(left, edges->left, sizeof left) != 0) {
      const auto &between = steps_.template between_columns<kBytes, false>(view);
      offers[kLeft] = offer_of<kBytes, -1>(left, between, neighbours[kLeft]->right, edges->left);
    }
    if (std::memcmp(right, edges->right, sizeof right) != 0) {
      const auto &between = steps_.template between_columns<kBytes, true>(view);
      offers[kRight] = offer_of<kBytes, 1>(right, between, neighbours[kRight]->left, edges->right);
    }
    for (int side = kCorner; side < kSides; ++side) {
      if (corner(side) == corners[side - kCorner]) continue;
      const Number cost = corner(side) + steps_.across(view, kSideRow[side], kSideCol[side]);
      if (cost < beyond_corner(side)) offers[side] = cost;
    }
  }

  template <int kBytes, int kStep>
  static TRUNDLE_INLINE Number offer_of(const Number (&edge)[kTile], const Steps<Number> &between,
                                       const Number (&frame)[kTile], Number (&kept)[kTile]) {
    using R = Row<Number, kBytes>;
    using Vector = typename R::Vector;
    R own, beyond;
    own.load(edge);
    own.store(kept);
    beyond.load(frame);
    const R next = step_from<kStep>(own, between);
    Vector best = Vector{} + kFar;
    each<R::kParts>(TRUNDLE_LAMBDA(auto k) {
      best = least(best, next.part[k] < beyond.part[k] ? next.part[k] : Vector{} + kFar);
    });
    return least_lane(best);
  }

  TileSteps<Cost, Number> steps_;
  std::uint64_t up_, down_;  // rows that changed since they were last relaxed from, upward and downward
  std::uint64_t entered_;    // rows that changed from the sides, and are to be relaxed along themselves
};

}  // namespace trundle
