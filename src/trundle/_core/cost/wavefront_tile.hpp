// A square of 8 × 8 cells of a field of costs, with a frame of the neighbours' cells around it, settled by sweeps.
//
// A cell is reached from its eight neighbours, straight or diagonally, and through each of the eight triangles that it
// makes with two of them: between these the cost is taken as linear, so that the way may come from anywhere between (as in
// Field D*: Ferguson and Stentz, 2006). Eight triangles err less than the four between straight neighbours that are usual.
// A triangle needs its three cells open, so no corner is cut, but one may be touched.
//
// A sweep takes the rows one after the other and lowers each by all ways that come from the row before it. No cell of a
// row waits for another of the same row, so a row is done a register at a time. Sweeps run up and down, and, on the turned
// square, right and left (Zhao, 2005, sweeps whole maps so), until none lowers anything.
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
struct FrontSquare {
  static constexpr Real kFar = std::numeric_limits<Real>::infinity();  // cost where nothing came; weight where closed
  static constexpr int kSide = 8, kFrom = 8, kWidth = 24;  // own columns begin at `kFrom`: the frame's are on either side
  // Where sweeps go: bits of what is still to be done.
  static constexpr unsigned kUp = 1, kDown = 2, kRight = 4, kLeft = 8, kAll = 15;

  using Rows = Real[kSide + 2][kWidth];
  struct Plane {
    alignas(64) Rows cost, quarter;  // of the weight
  };
  Plane upright, turned;
  Real worthwhile;  // lowered by less than this a cost is not passed on

  // Sweep as `pending` says, and on until nothing changes. Both planes have the costs then. Without `kBetween` ways go
  // from centre to centre alone and touch no corner of a closed cell; without `kWalls` no cell is closed.
  template <bool kBetween, bool kWalls>
  void settle(unsigned pending) {
    do {
      pending = sweep_both<kBetween, kWalls>(upright, pending, kUp, kDown);
      turn(upright.cost, turned.cost);
      if (pending == 0) return;
      pending = sweep_both<kBetween, kWalls>(turned, pending, kRight, kLeft);
      turn(turned.cost, upright.cost);
    } while (pending != 0);
  }

  // The least cost that a cell of the frame's row below or above gets from here, where it gains by it.
  template <bool kBetween, bool kWalls, int kStep>
  Real gain(const Plane &plane) const {
    constexpr int kEdge = kStep > 0 ? kSide : 1;
    Row own, next, beyond;
    own.load(&plane.cost[kEdge][kFrom]);
    beyond.load(&plane.cost[kEdge + kStep][kFrom]);
    step_from<kBetween, kWalls>(plane, kEdge, kEdge + kStep, own, next);
    Vector best = Vector{} + kFar;
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      best = least(best, next.part[k] + worthwhile < beyond.part[k] ? next.part[k] : Vector{} + kFar);
    });
    return least_lane(best);
  }

  // The same for the cell of the frame's corner, by the diagonal.
  template <bool kBetween>
  Real corner_gain(int row_step, int col_step) const {
    const int row = row_step > 0 ? kSide : 1, col = kFrom + (col_step > 0 ? kSide - 1 : 0);
    const Rows &quarter = upright.quarter;
    const bool beside = quarter[row][col + col_step] < kFar, above = quarter[row + row_step][col] < kFar;
    if (!(kBetween ? beside || above : beside && above)) return kFar;
    const Real both = quarter[row][col] + quarter[row + row_step][col + col_step];
    const Real cost = upright.cost[row][col] + both * kDiagonal;
    return cost + worthwhile < upright.cost[row + row_step][col + col_step] ? cost : kFar;
  }

  bool has_walls() const {
    Real most = 0;
    for (int row = 0; row < kSide + 2; ++row) {
      for (int col = kFrom - 1; col <= kFrom + kSide; ++col) most = std::max(most, upright.quarter[row][col]);
    }
    return !(most < kFar);
  }

  // Own cells, rows for columns.
  static TRUNDLE_INLINE void turn(const Rows &from, Rows &to) {
    using Four = typename Register<Real, 4 * sizeof(Real)>::Vector;
    for (int row = 1; row <= kSide; row += 4) {
      for (int col = 0; col < kSide; col += 4) {
        Four lanes[4];
        for (int k = 0; k < 4; ++k) std::memcpy(&lanes[k], &from[row + k][kFrom + col], sizeof(Four));
        const Four low_even = zip_low(lanes[0], lanes[2]), high_even = zip_high(lanes[0], lanes[2]);
        const Four low_odd = zip_low(lanes[1], lanes[3]), high_odd = zip_high(lanes[1], lanes[3]);
        const Four columns[4] = {zip_low(low_even, low_odd), zip_high(low_even, low_odd), zip_low(high_even, high_odd),
                                 zip_high(high_even, high_odd)};
        for (int k = 0; k < 4; ++k) std::memcpy(&to[col + 1 + k][kFrom + row - 1], &columns[k], sizeof(Four));
      }
    }
  }

 private:
  static constexpr int kBytes = 16, kLanes = kBytes / static_cast<int>(sizeof(Real)), kParts = kSide / kLanes;
  static constexpr Real kDiagonal = Real(2 * 1.41421356237309505);  // of two quarters
  using Vector = typename Register<Real, kBytes>::Vector;
  using Bits = typename Register<std::int64_t, kBytes>::Vector;

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

  // What third corners of triangles cost: the two others are a straight step from each other, one is a straight step away
  // and costs `more`, the other a diagonal one and costs `less`. Far where the cheapest way comes by a corner.
  static TRUNDLE_INLINE Vector through(const Vector &more, const Vector &less, const Vector &weight) {
    const Vector gap = more - less, squared = gap * gap, room = weight * weight;
    const Vector cost = root(room - squared) + more;
    return (gap > 0) & (squared + squared < room) ? cost : Vector{} + kFar;
  }

  // Diagonal steps only past cells that are open: one, or with centres alone both.
  template <bool kBetween>
  static TRUNDLE_INLINE Vector past(const Vector &cost, const Vector &beside, const Vector &above) {
    if constexpr (kBetween) return (beside < kFar) | (above < kFar) ? cost : Vector{} + kFar;
    return (beside < kFar) & (above < kFar) ? cost : Vector{} + kFar;
  }

  // What the cells of the row `to` get from those of the row `from` beside it, which cost `own`.
  template <bool kBetween, bool kWalls>
  static TRUNDLE_INLINE void step_from(const Plane &plane, int from, int to, const Row &own, Row &next) {
    const Vector before = load(&plane.cost[from][kFrom - kLanes]), after = load(&plane.cost[from][kFrom + kSide]);
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      constexpr auto kIndices = std::make_integer_sequence<int, kLanes>{};
      const Vector mid = own.part[k];
      const Vector left = pick(k > 0 ? own.part[(k + kParts - 1) % kParts] : before, mid, counted<kLanes - 1>(kIndices));
      const Vector right = pick(mid, k + 1 < kParts ? own.part[(k + 1) % kParts] : after, counted<1>(kIndices));
      const Real *there = &plane.quarter[from][kFrom + k * kLanes], *here = &plane.quarter[to][kFrom + k * kLanes];
      const Vector quarter = load(here), of_mid = load(there), of_left = load(there - 1), of_right = load(there + 1);
      Vector by_left = left + (quarter + of_left) * kDiagonal, by_right = right + (quarter + of_right) * kDiagonal;
      if constexpr (kWalls) {
        by_left = past<kBetween>(by_left, of_mid, load(here - 1));
        by_right = past<kBetween>(by_right, of_mid, load(here + 1));
      }
      const Vector base = quarter + quarter + of_mid;
      Vector best = least(least(by_left, by_right), mid + (base + of_mid));
      if constexpr (kBetween) {
        best = least(through(mid, left, base + of_left), best);
        best = least(through(mid, right, base + of_right), best);
      }
      next.part[k] = best;
    });
  }

  template <bool kBetween, bool kWalls>
  TRUNDLE_INLINE unsigned sweep_both(Plane &plane, unsigned pending, unsigned ahead, unsigned back) {
    while (pending & (ahead | back)) {
      if (pending & ahead) {
        pending &= ~ahead;
        if (sweep<kBetween, kWalls, 1>(plane)) pending |= kAll & ~ahead;
      }
      if (pending & back) {
        pending &= ~back;
        if (sweep<kBetween, kWalls, -1>(plane)) pending |= kAll & ~back;
      }
    }
    return pending;
  }

  // Answers whether anything got cheaper.
  template <bool kBetween, bool kWalls, int kStep>
  TRUNDLE_INLINE bool sweep(Plane &plane) {
    int row = kStep > 0 ? 0 : kSide + 1;
    Row own, next, old;
    own.load(&plane.cost[row][kFrom]);
    Bits changed = {};
    for (int n = 0; n < kSide; ++n) {
      step_from<kBetween, kWalls>(plane, row, row + kStep, own, next);
      row += kStep;
      old.load(&plane.cost[row][kFrom]);
      each<kParts>(TRUNDLE_LAMBDA(auto k) {
        changed |= reinterpret_cast<Bits>(next.part[k] + worthwhile < old.part[k]);
        own.part[k] = least(next.part[k], old.part[k]);
      });
      own.store(&plane.cost[row][kFrom]);
    }
    return joined_bits(changed) != 0;
  }
};

}  // namespace trundle
