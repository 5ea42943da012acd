// One tile of a cost field: a square of cells with a frame of the neighbours' cells around it, settled by sweeps.
//
// A sweep takes the rows one after the other and relaxes each from the row before it, straight and along both
// diagonals: no cell of a row waits for another of the same row, so a row is done a register at a time, and stays in
// registers for the next. Sweeps run up and down, and, on the transposed tile, right and left. Only rows next to one
// that changed are done again, until none changes.
#pragma once

#include "field_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trundle {

constexpr int kTile = 32;

// Costs to go are whole numbers where the cells' costs are, with 1393/985 = √2 less 2.6e-7 for the diagonals.
template <typename Number>
struct Scale {
  static constexpr Number kStraight = 985, kDiagonal = 1393;
  static constexpr Number kFar = Number{1} << (sizeof(Number) * 8 - 3);  // four of them still fit
  static constexpr double kUnit = 2.0 * 985.0;
};

template <>
struct Scale<double> {
  static constexpr double kStraight = 0.5, kDiagonal = 0.70710678118654752440;
  static constexpr double kFar = 1e300;
  static constexpr double kUnit = 1.0;
};

template <typename Number>
struct Tile {
  static constexpr Number kFar = Scale<Number>::kFar;

  // The tile as rows, each dealt to registers. What steps from one row to the next cost stands in the row of the
  // lower one: of a step straight up to a column, of one to it from the left, and of one to it from the right; kFar
  // or more where there is a wall, and where the step would come from beyond the row's ends: those are the other
  // plane's.
  struct Plane {
    alignas(64) Number value[kTile + 2][kTile];  // cost to go; own rows are 1 to kTile
    alignas(64) Number straight[kTile + 1][kTile], left[kTile + 1][kTile], right[kTile + 1][kTile];
  };

  // Rows of a plane that changed since they were last relaxed from, upward and downward, and that changed at all; bit
  // r for row r.
  struct Changed {
    std::uint64_t up = 0, down = 0, ever = 0;

    TRUNDLE_INLINE void add(std::uint64_t mask) {
      up |= mask;
      down |= mask;
      ever |= mask;
    }
  };

  Plane upright, turned;
  Number corner_value[4], corner_step[4];  // the frame's corners and the steps from them: low left, low right, high...
  Changed rows, cols;

  // The least cost that a neighbour gets by a step from here, where that is less than it has; kFar where it gains
  // nothing.
  struct Gains {
    Number low, high, left, right, corner[4];
  };

  // Begin with the frame and with what is known of the tile's own cells, where anything is.
  template <int kBytes>
  TRUNDLE_INLINE void begin(const Number *known) {
    if (known != nullptr) {
      std::memcpy(upright.value[1], known, sizeof(Number) * kTile * kTile);
    } else {
      std::fill_n(&upright.value[1][0], kTile * kTile, kFar);
    }
    rows = frame_of(upright);
    cols = frame_of(turned);
    for (int corner = 0; corner < 4; ++corner) {
      const Number value = corner_value[corner] + corner_step[corner];
      improve<kBytes>(corner < 2 ? 0 : kTile - 1, corner % 2 == 0 ? 0 : kTile - 1, value);
    }
  }

  template <int kBytes>
  TRUNDLE_INLINE void improve(int row, int col, Number value) {
    Number &own = upright.value[1 + row][col % Row<kBytes>::kParts * Row<kBytes>::kLanes + col / Row<kBytes>::kParts];
    if (!(value < own)) return;
    own = value;
    rows.add(std::uint64_t{2} << row);
    cols.add(std::uint64_t{2} << col);
  }

  // Sweep until nothing changes.
  template <int kBytes>
  TRUNDLE_INLINE void settle() {
    while (true) {
      while (rows.up || rows.down) {
        if (rows.up) sweep<kBytes, 1>(upright, rows, cols);
        if (rows.down) sweep<kBytes, -1>(upright, rows, cols);
      }
      transpose<kTile, Row<kBytes>::kParts>(upright.value[1], turned.value[1]);
      if (!cols.up && !cols.down) break;
      while (cols.up || cols.down) {
        if (cols.up) sweep<kBytes, 1>(turned, cols, rows);
        if (cols.down) sweep<kBytes, -1>(turned, cols, rows);
      }
      transpose<kTile, Row<kBytes>::kParts>(turned.value[1], upright.value[1]);
      if (!rows.up && !rows.down) break;
    }
  }

  template <int kBytes>
  TRUNDLE_INLINE Gains gains() const {
    Gains gains;
    gains.low = gain<kBytes, -1>(upright);
    gains.high = gain<kBytes, 1>(upright);
    gains.left = gain<kBytes, -1>(turned);
    gains.right = gain<kBytes, 1>(turned);
    for (int corner = 0; corner < 4; ++corner) {
      const Number own = upright.value[corner < 2 ? 1 : kTile][corner % 2 == 0 ? 0 : kTile - 1] + corner_step[corner];
      gains.corner[corner] = own < corner_value[corner] ? own : kFar;
    }
    return gains;
  }

 private:
  static constexpr std::uint64_t kLowFrame = 1, kHighFrame = std::uint64_t{1} << (kTile + 1);

  // The frame's rows, where anything is known of them.
  static TRUNDLE_INLINE Changed frame_of(const Plane &plane) {
    return {any_near(plane.value[0]) ? kLowFrame : 0, any_near(plane.value[kTile + 1]) ? kHighFrame : 0, 0};
  }

  static TRUNDLE_INLINE bool any_near(const Number (&row)[kTile]) {
    Number nearest = kFar;
    for (const Number value : row) nearest = std::min(nearest, value);
    return nearest < kFar;
  }

  template <int kBytes>
  struct Row {
    static constexpr int kLanes = kBytes / static_cast<int>(sizeof(Number)), kParts = kTile / kLanes;
    using Vector = typename Register<Number, kBytes>::Vector;
    using Bits = typename Register<std::int64_t, kBytes>::Vector;
    Vector part[kParts];

    // Register by register: compilers copy all at once in pieces of their own choice.
    TRUNDLE_INLINE void load(const Number (&from)[kTile]) {
      each<kParts>(TRUNDLE_LAMBDA(auto k) { std::memcpy(&part[k], from + k * kLanes, kBytes); });
    }
    TRUNDLE_INLINE void store(Number (&to)[kTile]) const {
      each<kParts>(TRUNDLE_LAMBDA(auto k) { std::memcpy(to + k * kLanes, &part[k], kBytes); });
    }
  };

  // What the cells of the next row get by a step from this one.
  template <int kBytes, int kStep>
  static TRUNDLE_INLINE void step_from(const Plane &plane, int row, const Row<kBytes> &own, Row<kBytes> &next) {
    using Vector = typename Row<kBytes>::Vector;
    constexpr int kParts = Row<kBytes>::kParts;
    const int lower = kStep > 0 ? row : row - 1;
    Row<kBytes> straight, left, right;
    straight.load(plane.straight[lower]);
    left.load(plane.left[lower]);
    right.load(plane.right[lower]);
    if constexpr (kStep > 0) {
      const Vector below_first = turned_up(own.part[kParts - 1]), beyond_last = turned_down(own.part[0]);
      each<kParts>(TRUNDLE_LAMBDA(auto k) {
        left.part[k] += k > 0 ? own.part[(k + kParts - 1) % kParts] : below_first;
        right.part[k] += k + 1 < kParts ? own.part[(k + 1) % kParts] : beyond_last;
        next.part[k] = least(own.part[k] + straight.part[k], least(left.part[k], right.part[k]));
      });
    } else {
      each<kParts>(TRUNDLE_LAMBDA(auto k) {
        left.part[k] += own.part[k];
        right.part[k] += own.part[k];
      });
      const Vector below_first = turned_up(right.part[kParts - 1]), beyond_last = turned_down(left.part[0]);
      each<kParts>(TRUNDLE_LAMBDA(auto k) {
        const Vector from_left = k > 0 ? right.part[(k + kParts - 1) % kParts] : below_first;
        const Vector from_right = k + 1 < kParts ? left.part[(k + 1) % kParts] : beyond_last;
        next.part[k] = least(own.part[k] + straight.part[k], least(from_left, from_right));
      });
    }
  }

  // Relax every row that follows a changed one; what changes is noted for the other way and for the other plane.
  template <int kBytes, int kStep>
  static TRUNDLE_INLINE void sweep(Plane &plane, Changed &rows, Changed &cols) {
    using Bits = typename Row<kBytes>::Bits;
    constexpr int kParts = Row<kBytes>::kParts;
    constexpr std::uint64_t kSources = ((std::uint64_t{1} << kTile) - 1) << (kStep > 0 ? 0 : 2);
    std::uint64_t open = (kStep > 0 ? rows.up : rows.down) & kSources, changed_rows = 0;
    Bits changed_cols[kParts] = {};
    (kStep > 0 ? rows.up : rows.down) = 0;
    if (open == 0) return;
    int row = kStep > 0 ? __builtin_ctzll(open) : 63 - __builtin_clzll(open);
    Row<kBytes> own, next, old;
    own.load(plane.value[row]);
    // Rows between changed ones are relaxed too: to pass them by would take longer.
    do {
      step_from<kBytes, kStep>(plane, row, own, next);
      row += kStep;
      old.load(plane.value[row]);
      Bits changed = {};
      each<kParts>(TRUNDLE_LAMBDA(auto k) {
        own.part[k] = least(next.part[k], old.part[k]);
        const Bits bits = reinterpret_cast<Bits>(own.part[k]) ^ reinterpret_cast<Bits>(old.part[k]);
        changed |= bits;
        changed_cols[k] |= bits;
      });
      own.store(plane.value[row]);
      const std::uint64_t bit = std::uint64_t{joined_bits(changed) != 0} << row;
      changed_rows |= bit;
      open |= bit & kSources;
    } while ((kStep > 0 ? open >> row : open << (63 - row)) != 0);
    (kStep > 0 ? rows.down : rows.up) |= changed_rows;
    rows.ever |= changed_rows;
    cols.add(std::uint64_t{cells_set<Number>(changed_cols)} << 1);
  }

  template <int kBytes, int kStep>
  static TRUNDLE_INLINE Number gain(const Plane &plane) {
    using Vector = typename Row<kBytes>::Vector;
    constexpr int kEdge = kStep > 0 ? kTile : 1;
    Row<kBytes> own, next, beyond;
    own.load(plane.value[kEdge]);
    beyond.load(plane.value[kEdge + kStep]);
    step_from<kBytes, kStep>(plane, kEdge, own, next);
    Vector best = Vector{} + kFar;
    each<Row<kBytes>::kParts>(TRUNDLE_LAMBDA(auto k) {
      best = least(best, next.part[k] < beyond.part[k] ? next.part[k] : Vector{} + kFar);
    });
    return least_lane(best);
  }
};

}  // namespace trundle
