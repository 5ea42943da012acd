// Sweeps over one tile of a wavefront: 8 × 8 cells, with a frame of the neighbouring tiles' cells around them.
//
// A cell is reached from its eight neighbours, straight or diagonally, and through each of the eight triangles that it
// makes with two of them. On the far side of a triangle the cost is taken as linear, so that a path may come from
// anywhere between the two (Field D*: Ferguson and Stentz 2006). Eight triangles err less than the usual four between
// straight neighbours. A triangle needs its three cells open, so no corner is cut, but one may be touched.
//
// A sweep (fast sweeping: Zhao 2005) takes the rows one after the other and lowers each by all paths that come from the
// row before it. No cell of a row waits for another of the same row, so a row is done a register at a time. Sweeps run
// up and down on the tile by rows, and right and left on its transpose, until none lowers anything. `pending` holds the
// directions still to sweep in: a sweep that lowers something makes all the others pending.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "shared/registers.hpp"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace trundle {

template <typename Real>
struct TileSweeper {
  static constexpr Real kFar = std::numeric_limits<Real>::infinity();  // cost of a cell not reached; weight of a closed one
  static constexpr int kSide = 8, kFirst = 8, kWidth = 24;  // the tile's columns begin at kFirst, its rows at 1
  static constexpr unsigned kUp = 1, kDown = 2, kRight = 4, kLeft = 8, kAll = 15;  // directions of sweeps

  using Rows = Real[kSide + 2][kWidth];
  struct Plane {
    alignas(64) Rows cost, quarter;  // of the weight
  };
  Plane by_rows, by_cols;  // the tile with its frame, and its transpose
  Real least_gain;         // a cost that falls by less is not passed on

  // Sweeps as `pending` says, and on until nothing falls. Both planes have the costs then. Without `kInterpolate` paths
  // lead from centre to centre alone and touch no corner of a closed cell; without `kWalls` no cell is closed.
  template <bool kInterpolate, bool kWalls>
  void settle(unsigned pending) {
    do {
      pending = sweep_both_directions<kInterpolate, kWalls>(by_rows, pending, kUp, kDown);
      transpose(by_rows.cost, by_cols.cost);
      if (pending == 0) return;
      pending = sweep_both_directions<kInterpolate, kWalls>(by_cols, pending, kRight, kLeft);
      transpose(by_cols.cost, by_rows.cost);
    } while (pending != 0);
  }

  // The least cost that the tile brings to a cell of the frame's row below or above which gains by it; far where none
  // does.
  template <bool kInterpolate, bool kWalls, int kStep>
  Real offer_to_row(const Plane &plane) const {
    constexpr int kEdge = kStep > 0 ? kSide : 1;
    Row own, next, beyond;
    own.load(&plane.cost[kEdge][kFirst]);
    beyond.load(&plane.cost[kEdge + kStep][kFirst]);
    step_from<kInterpolate, kWalls>(plane, kEdge, kEdge + kStep, own, next);
    Vector best = Vector{} + kFar;
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      best = least(best, next.part[k] + least_gain < beyond.part[k] ? next.part[k] : Vector{} + kFar);
    });
    return least_lane(best);
  }

  // The same for the cell at a corner of the frame, by the diagonal.
  template <bool kInterpolate>
  Real offer_to_corner(int row_step, int col_step) const {
    const int row = row_step > 0 ? kSide : 1, col = kFirst + (col_step > 0 ? kSide - 1 : 0);
    const Rows &quarter = by_rows.quarter;
    const bool beside = quarter[row][col + col_step] < kFar, above = quarter[row + row_step][col] < kFar;
    if (!(kInterpolate ? beside || above : beside && above)) return kFar;
    const Real both = quarter[row][col] + quarter[row + row_step][col + col_step];
    const Real cost = by_rows.cost[row][col] + both * kDiagonal;
    return cost + least_gain < by_rows.cost[row + row_step][col + col_step] ? cost : kFar;
  }

  // Whether a cell of the tile or its frame is closed.
  bool has_walls() const {
    Real most = 0;
    for (int row = 0; row < kSide + 2; ++row) {
      for (int col = kFirst - 1; col <= kFirst + kSide; ++col) most = std::max(most, by_rows.quarter[row][col]);
    }
    return !(most < kFar);
  }

  // The tile's own cells, without the frame, four by four.
  static TRUNDLE_INLINE void transpose(const Rows &from, Rows &to) {
    using Four = typename Register<Real, 4 * sizeof(Real)>::Vector;
    for (int row = 1; row <= kSide; row += 4) {
      for (int col = 0; col < kSide; col += 4) {
        Four lanes[4];
        for (int k = 0; k < 4; ++k) std::memcpy(&lanes[k], &from[row + k][kFirst + col], sizeof(Four));
        const Four low_even = zip_low(lanes[0], lanes[2]), high_even = zip_high(lanes[0], lanes[2]);
        const Four low_odd = zip_low(lanes[1], lanes[3]), high_odd = zip_high(lanes[1], lanes[3]);
        const Four columns[4] = {zip_low(low_even, low_odd), zip_high(low_even, low_odd), zip_low(high_even, high_odd),
                                 zip_high(high_even, high_odd)};
        for (int k = 0; k < 4; ++k) std::memcpy(&to[col + 1 + k][kFirst + row - 1], &columns[k], sizeof(Four));
      }
    }
  }

 private:
  static constexpr int kBytes = 16, kLanes = kBytes / static_cast<int>(sizeof(Real)), kParts = kSide / kLanes;
  static constexpr Real kDiagonal = Real(2 * 1.41421356237309505);  // of two quarters
  using Vector = typename Register<Real, kBytes>::Vector;
  using Bits = typename Register<std::int64_t, kBytes>::Vector;

  // Eight cells of a row, in registers.
  struct Row {
    Vector part[kParts];
    TRUNDLE_INLINE void load(const Real *from) {
      each<kParts>(TRUNDLE_LAMBDA(auto k) { std::memcpy(&part[k], from + k * kLanes, kBytes); });
    }
    TRUNDLE_INLINE void store(Real *to) const {
      each<kParts>(TRUNDLE_LAMBDA(auto k) { std::memcpy(to + k * kLanes, &part[k], kBytes); });
    }
  };

  template <typename Four>
  static TRUNDLE_INLINE Four zip_low(const Four &a, const Four &b) {
    return pick(a, b, std::integer_sequence<int, 0, 4, 1, 5>{});
  }
  template <typename Four>
  static TRUNDLE_INLINE Four zip_high(const Four &a, const Four &b) {
    return pick(a, b, std::integer_sequence<int, 2, 6, 3, 7>{});
  }

  static TRUNDLE_INLINE Vector load(const Real *from) {
    Vector lanes;
    std::memcpy(&lanes, from, kBytes);
    return lanes;
  }

  static TRUNDLE_INLINE Vector root(Vector x) {
#if defined(__SSE2__)
    if constexpr (sizeof(Real) == 4) return (Vector)_mm_sqrt_ps((__m128)x);
    if constexpr (sizeof(Real) == 8) return (Vector)_mm_sqrt_pd((__m128d)x);
#endif
    for (int k = 0; k < kLanes; ++k) x[k] = std::sqrt(x[k]);
    return x;
  }

  // Cost of a triangle's third corner. Of the other two, which lie a straight step apart, one is a straight step away
  // and costs `straight`, the other a diagonal step and costs `diagonal`. Far where the cheapest path comes by a
  // corner.
  static TRUNDLE_INLINE Vector through(const Vector &straight, const Vector &diagonal, const Vector &weight) {
    const Vector gap = straight - diagonal, squared = gap * gap, room = weight * weight;
    const Vector cost = root(room - squared) + straight;
    return (gap > 0) & (squared + squared < room) ? cost : Vector{} + kFar;
  }

  // The cost of a diagonal step where the cells beside it let it pass: one open cell does, or without `kInterpolate`
  // both.
  template <bool kInterpolate>
  static TRUNDLE_INLINE Vector if_open(const Vector &cost, const Vector &beside, const Vector &above) {
    if constexpr (kInterpolate) return (beside < kFar) | (above < kFar) ? cost : Vector{} + kFar;
    return (beside < kFar) & (above < kFar) ? cost : Vector{} + kFar;
  }

  // What the cells of the row `to` cost by paths from those of the row `from` beside it, which cost `own`: by both
  // diagonal steps, the straight one, and the two triangles between them.
  template <bool kInterpolate, bool kWalls>
  static TRUNDLE_INLINE void step_from(const Plane &plane, int from, int to, const Row &own, Row &next) {
    const Vector before = load(&plane.cost[from][kFirst - kLanes]), after = load(&plane.cost[from][kFirst + kSide]);
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      constexpr auto kIndices = std::make_integer_sequence<int, kLanes>{};
      const Vector mid = own.part[k];
      const Vector left = pick(k > 0 ? own.part[(k + kParts - 1) % kParts] : before, mid, counted<kLanes - 1>(kIndices));
      const Vector right = pick(mid, k + 1 < kParts ? own.part[(k + 1) % kParts] : after, counted<1>(kIndices));
      const Real *there = &plane.quarter[from][kFirst + k * kLanes], *here = &plane.quarter[to][kFirst + k * kLanes];
      const Vector quarter = load(here), of_mid = load(there), of_left = load(there - 1), of_right = load(there + 1);
      Vector by_left = left + (quarter + of_left) * kDiagonal, by_right = right + (quarter + of_right) * kDiagonal;
      if constexpr (kWalls) {
        by_left = if_open<kInterpolate>(by_left, of_mid, load(here - 1));
        by_right = if_open<kInterpolate>(by_right, of_mid, load(here + 1));
      }
      const Vector base = quarter + quarter + of_mid;
      Vector best = least(least(by_left, by_right), mid + (base + of_mid));
      if constexpr (kInterpolate) {
        best = least(through(mid, left, base + of_left), best);
        best = least(through(mid, right, base + of_right), best);
      }
      next.part[k] = best;
    });
  }

  // Sweeps forward and backward along a plane while either is pending; returns the directions that are pending then.
  template <bool kInterpolate, bool kWalls>
  TRUNDLE_INLINE unsigned sweep_both_directions(Plane &plane, unsigned pending, unsigned forward, unsigned backward) {
    while (pending & (forward | backward)) {
      if (pending & forward) {
        pending &= ~forward;
        if (sweep<kInterpolate, kWalls, 1>(plane)) pending |= kAll & ~forward;
      }
      if (pending & backward) {
        pending &= ~backward;
        if (sweep<kInterpolate, kWalls, -1>(plane)) pending |= kAll & ~backward;
      }
    }
    return pending;
  }

  // Returns whether any cost fell.
  template <bool kInterpolate, bool kWalls, int kStep>
  TRUNDLE_INLINE bool sweep(Plane &plane) {
    int row = kStep > 0 ? 0 : kSide + 1;
    Row own, next, old;
    own.load(&plane.cost[row][kFirst]);
    Bits fell = {};
    for (int n = 0; n < kSide; ++n) {
      step_from<kInterpolate, kWalls>(plane, row, row + kStep, own, next);
      row += kStep;
      old.load(&plane.cost[row][kFirst]);
      each<kParts>(TRUNDLE_LAMBDA(auto k) {
        fell |= reinterpret_cast<Bits>(next.part[k] + least_gain < old.part[k]);
        own.part[k] = least(next.part[k], old.part[k]);
      });
      own.store(&plane.cost[row][kFirst]);
    }
    return joined_bits(fell) != 0;
  }
};

}  // namespace trundle
