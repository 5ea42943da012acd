// A row of cells in registers: what a step from it brings to the next row, and steps within it.
#pragma once

#include "shared/registers.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>

namespace trundle {

constexpr int kTile = 32;  // cells of a row, and rows of a tile

// Costs to go are whole numbers where the cells' costs are, with 1393/985 = √2 less 2.6e-7 for the diagonals.
template <typename Number>
struct Scale {
  static constexpr Number kStraight = 985, kDiagonal = 1393;
  static constexpr Number kFar = Number{1} << (sizeof(Number) * 8 - 3);  // four of them, and one more, still fit
  static constexpr double kUnit = 2.0 * 985.0;
};

template <>
struct Scale<double> {
  static constexpr double kStraight = 0.5, kDiagonal = 0.70710678118654752440;
  static constexpr double kFar = 1e300;
  static constexpr double kUnit = 1.0;
};

// What steps between two rows that lie next to each other cost, by the cell of the lower one: of one straight up to a
// column, of one to it from the left, and of one to it from the right. kFar or more where there is a wall, and where
// the step would come from beyond the row's ends: those belong to other rows.
template <typename Number>
struct Steps {
  alignas(64) Number straight[kTile], left[kTile], right[kTile];
};

// The cells of a row, dealt to registers.
template <typename Number, int kBytes>
struct Row {
  static constexpr int kLanes = kBytes / static_cast<int>(sizeof(Number)), kParts = kTile / kLanes;
  static constexpr Number kFar = Scale<Number>::kFar;
  using Vector = typename Register<Number, kBytes>::Vector;
  using Bits = typename Register<std::int64_t, kBytes>::Vector;
  Vector part[kParts];

  // Where a cell of a row stands.
  static constexpr int place(int cell) { return cell % kParts * kLanes + cell / kParts; }

  // Register by register: compilers copy all at once in pieces of their own choice.
  TRUNDLE_INLINE void load(const Number (&from)[kTile]) {
    each<kParts>(TRUNDLE_LAMBDA(auto k) { std::memcpy(&part[k], from + k * kLanes, kBytes); });
  }
  TRUNDLE_INLINE void store(Number (&to)[kTile]) const {
    each<kParts>(TRUNDLE_LAMBDA(auto k) { std::memcpy(to + k * kLanes, &part[k], kBytes); });
  }

  TRUNDLE_INLINE bool operator!=(const Row &other) const {
    Bits all = {};
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      all |= reinterpret_cast<Bits>(part[k]) ^ reinterpret_cast<Bits>(other.part[k]);
    });
    return joined_bits(all) != 0;
  }
};

// What the cells of the next row get by a step from this one; the next is the higher one, or the lower one.
template <int kStep, typename Number, int kBytes>
TRUNDLE_INLINE Row<Number, kBytes> step_from(const Row<Number, kBytes> &own, const Steps<Number> &steps) {
  using Vector = typename Row<Number, kBytes>::Vector;
  constexpr int kParts = Row<Number, kBytes>::kParts;
  Row<Number, kBytes> straight, left, right, next;
  straight.load(steps.straight);
  left.load(steps.left);
  right.load(steps.right);
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
  return next;
}

constexpr int log_of(int n) { return n <= 1 ? 0 : 1 + log_of(n / 2); }

// Relax a row's cells from each other until nothing changes. `steps` are what steps to each cell from the one before
// it cost, at most kFar, and kFar to the first.
//
// Whole numbers go both ways side by side: in each lane from cell to cell; then lanes from those beside them, from
// those two away and from those four away; and so from the lanes beside them to all cells.
template <typename Number, int kBytes>
TRUNDLE_INLINE void relax_along(const Number (&steps)[kTile], Row<Number, kBytes> &row) {
  using R = Row<Number, kBytes>;
  using Vector = typename R::Vector;
  constexpr int kParts = R::kParts, kLast = kParts - 1;
  R step;
  step.load(steps);
  const Vector step_down = turned_down(step.part[0]);
  if constexpr (std::is_integral_v<Number>) {
    const auto sum = TRUNDLE_LAMBDA(Vector a, Vector b) { return least(a + b, Vector{} + R::kFar); };
    R up = row, down = row, into_up, into_down;  // what it costs to get into a lane as far as a cell
    into_up.part[0] = step.part[0];
    into_down.part[kLast] = step_down;
    each<kLast>(TRUNDLE_LAMBDA(auto k) {
      constexpr int kUp = k + 1, kDown = kLast - 1 - k;
      up.part[kUp] = least(up.part[kUp], up.part[kUp - 1] + step.part[kUp]);
      down.part[kDown] = least(down.part[kDown], down.part[kDown + 1] + step.part[kDown + 1]);
      into_up.part[kUp] = sum(into_up.part[kUp - 1], step.part[kUp]);
      into_down.part[kDown] = sum(into_down.part[kDown + 1], step.part[kDown + 1]);
    });
    Vector high = up.part[kLast], through_up = into_up.part[kLast];
    Vector low = down.part[0], through_down = into_down.part[0];
    each<log_of(R::kLanes)>(TRUNDLE_LAMBDA(auto n) {
      constexpr int kBy = 1 << n;
      high = least(high, turned_up<kBy>(high) + through_up);
      low = least(low, turned_down<kBy>(low) + through_down);
      through_up = sum(through_up, turned_up<kBy>(through_up));
      through_down = sum(through_down, turned_down<kBy>(through_down));
    });
    const Vector from_left = turned_up(high), from_right = turned_down(low);
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      const Vector way = least(from_left + into_up.part[k], from_right + into_down.part[k]);
      row.part[k] = least(least(up.part[k], down.part[k]), way);
    });
  } else {  // sums are rounded: only those of single steps are the same whatever the order
    R before;
    do {
      before = row;
      row.part[0] = least(row.part[0], turned_up(row.part[kLast]) + step.part[0]);
      each<kLast>(TRUNDLE_LAMBDA(auto k) {
        row.part[k + 1] = least(row.part[k + 1], row.part[k] + step.part[k + 1]);
      });
      row.part[kLast] = least(row.part[kLast], turned_down(row.part[0]) + step_down);
      each<kLast>(TRUNDLE_LAMBDA(auto k) {
        constexpr int kDown = kLast - 1 - k;
        row.part[kDown] = least(row.part[kDown], row.part[kDown + 1] + step.part[kDown + 1]);
      });
    } while (row != before);
  }
}

}  // namespace trundle
