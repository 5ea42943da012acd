// Rows of a cost field in registers: relaxed from the row beside them, and along themselves.
//
// A row is dealt to registers as cards: cell c stands in register c mod kParts, in lane c / kParts. The cells before
// and after those of a register stand in the same lanes of the registers beside it, so that neighbours meet without a
// shuffle, but for the first register and the last: there the lanes are rotated by one. What wraps around the row's
// ends costs kFar and brings nothing.
//
// Relaxing along a row of whole numbers is a prefix scan over (min, +) in each direction: within lanes, from part to
// part; then across lanes in log2 steps (Hillis and Steele 1986); then from the lane before into every cell. Sums of
// floating point numbers depend on their order, so there single steps are repeated until nothing changes: the result is
// the same whatever the order of rows and tiles.
#pragma once

#include "shared/registers.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>

namespace trundle {

constexpr int kTile = 32;  // cells of a row, and rows of a tile

// Costs to go are whole numbers where the cells' costs are, with 1393/985 = √2 − 2.6e-7 for the diagonals.
template <typename Number>
struct Scale {
  static constexpr Number kStraight = 985, kDiagonal = 1393;
  static constexpr Number kFar = Number{1} << (sizeof(Number) * 8 - 3);  // unreachable, or a wall; the sum of five still fits
  static constexpr double kUnit = 2.0 * 985.0;
};

template <>
struct Scale<double> {
  static constexpr double kStraight = 0.5, kDiagonal = 0.70710678118654752440;
  static constexpr double kFar = 1e300;
  static constexpr double kUnit = 1.0;
};

// What steps cost between two rows that lie next to each other, by the cell of the lower one: straight up from a cell,
// from the next row's cell to the left, and from that to the right. kFar or more where there is a wall, and where the
// step would come from beyond the row's ends: those belong to other rows.
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

  // Where a cell of the row is stored.
  static constexpr int index_of(int cell) { return cell % kParts * kLanes + cell / kParts; }

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

// The cells before those of part k of a dealt row, and the cells after them.
template <int k, typename Vector, int kParts>
TRUNDLE_INLINE Vector cells_before(const Vector (&part)[kParts]) {
  if constexpr (k > 0) return part[k - 1];
  else return rotated_up(part[kParts - 1]);
}

template <int k, typename Vector, int kParts>
TRUNDLE_INLINE Vector cells_after(const Vector (&part)[kParts]) {
  if constexpr (k + 1 < kParts) return part[k + 1];
  else return rotated_down(part[0]);
}

// What the cells of the next row cost by a step from this one. With kStep > 0 the next row is the higher one.
template <int kStep, typename Number, int kBytes>
TRUNDLE_INLINE Row<Number, kBytes> step_from(const Row<Number, kBytes> &own, const Steps<Number> &steps) {
  constexpr int kParts = Row<Number, kBytes>::kParts;
  Row<Number, kBytes> straight, left, right, next;
  straight.load(steps.straight);
  left.load(steps.left);
  right.load(steps.right);
  if constexpr (kStep > 0) {  // steps are stored at the cell that they lead to: add the cells beside it
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      left.part[k] += cells_before<k>(own.part);
      right.part[k] += cells_after<k>(own.part);
      next.part[k] = least(own.part[k] + straight.part[k], least(left.part[k], right.part[k]));
    });
  } else {  // and here at the cell that they come from: add that, then move the sums beside it
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      left.part[k] += own.part[k];
      right.part[k] += own.part[k];
    });
    each<kParts>(TRUNDLE_LAMBDA(auto k) {
      next.part[k] = least(own.part[k] + straight.part[k], least(cells_before<k>(right.part), cells_after<k>(left.part)));
    });
  }
  return next;
}

constexpr int log2_of(int n) { return n <= 1 ? 0 : 1 + log2_of(n / 2); }

// A prefix scan along a row in one direction, 1 or −1: what its cells cost by paths from others of their lane
// (`reached`), what the steps cost that lead from the lane before to each cell (`entry`), and what the last cell of the
// lane before costs (`before`). A cell then costs the less of `reached` and `before + entry`.
template <int kDirection, typename Number, int kBytes>
struct LaneScan {
  using R = Row<Number, kBytes>;
  using Vector = typename R::Vector;
  static constexpr int kParts = R::kParts;

  R reached, entry;
  Vector before;

  TRUNDLE_INLINE LaneScan(const R &row, const R &step) {
    constexpr int kBegin = kDirection > 0 ? 0 : kParts - 1, kEnd = kParts - 1 - kBegin;
    reached.part[kBegin] = row.part[kBegin];
    entry.part[kBegin] = step_to<kBegin>(step);
    each<kParts - 1>(TRUNDLE_LAMBDA(auto n) {
      constexpr int kFrom = kBegin + kDirection * n, kTo = kFrom + kDirection;
      reached.part[kTo] = least(row.part[kTo], reached.part[kFrom] + step_to<kTo>(step));
      entry.part[kTo] = sum(entry.part[kFrom], step_to<kTo>(step));
    });
    Vector last = reached.part[kEnd], through = entry.part[kEnd];  // of each lane, and of as many lanes as were joined
    each<log2_of(R::kLanes)>(TRUNDLE_LAMBDA(auto n) {
      last = least(last, rotated<(1 << n)>(last) + through);
      through = sum(through, rotated<(1 << n)>(through));
    });
    before = rotated<1>(last);
  }

  TRUNDLE_INLINE Vector cost(int k) const { return least(reached.part[k], before + entry.part[k]); }

 private:
  // Steps are stored at the later cell.
  template <int k>
  static TRUNDLE_INLINE Vector step_to(const R &step) {
    if constexpr (kDirection > 0) return step.part[k];
    else return cells_after<k>(step.part);
  }
  template <int kBy>
  static TRUNDLE_INLINE Vector rotated(Vector lanes) {
    if constexpr (kDirection > 0) return rotated_up<kBy>(lanes);
    else return rotated_down<kBy>(lanes);
  }
  static TRUNDLE_INLINE Vector sum(Vector a, Vector b) { return least(a + b, Vector{} + R::kFar); }
};

// Relaxes a row's cells from each other until nothing changes. `steps` are what steps to each cell from the one before
// it cost, at most kFar, and kFar to the first.
template <typename Number, int kBytes>
TRUNDLE_INLINE void relax_along(const Number (&steps)[kTile], Row<Number, kBytes> &row) {
  using R = Row<Number, kBytes>;
  constexpr int kLast = R::kParts - 1;
  R step;
  step.load(steps);
  if constexpr (std::is_integral_v<Number>) {
    const LaneScan<1, Number, kBytes> up(row, step);
    const LaneScan<-1, Number, kBytes> down(row, step);
    each<R::kParts>(TRUNDLE_LAMBDA(auto k) { row.part[k] = least(up.cost(k), down.cost(k)); });
  } else {
    const auto first_step_down = cells_after<kLast>(step.part);
    R before;
    do {
      before = row;
      row.part[0] = least(row.part[0], cells_before<0>(row.part) + step.part[0]);
      each<kLast>(TRUNDLE_LAMBDA(auto k) {
        row.part[k + 1] = least(row.part[k + 1], row.part[k] + step.part[k + 1]);
      });
      row.part[kLast] = least(row.part[kLast], cells_after<kLast>(row.part) + first_step_down);
      each<kLast>(TRUNDLE_LAMBDA(auto k) {
        constexpr int kDown = kLast - 1 - k;
        row.part[kDown] = least(row.part[kDown], row.part[kDown + 1] + step.part[kDown + 1]);
      });
    } while (row != before);
  }
}

}  // namespace trundle
