// One tile of a cost field: a square of cells with a frame of the neighbours' cells around it, settled by sweeps.
//
// A sweep takes the rows one after the other and relaxes each from the row before it, straight and along both diagonals:
// no cell of a row waits for another of the same row, so rows are done a register at a time. Sweeps run up and down, and,
// on the transposed tile, right and left. Only rows next to one that changed are done again, until none changes.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

namespace trundle {

constexpr int kTile = 32;

// Costs to go are whole numbers where the cells' costs are, with 1393/985 = √2 less 2.6e-7 for the diagonals.
template <typename Number>
struct Scale {
  static constexpr Number kStraight = 985, kDiagonal = 1393;
  static constexpr Number kFar = Number{1} << (sizeof(Number) * 8 - 3);  // three of them still fit
  static constexpr double kUnit = 2.0 * 985.0;
};

template <>
struct Scale<double> {
  static constexpr double kStraight = 0.5, kDiagonal = 0.70710678118654752440;
  static constexpr double kFar = 1e300;
  static constexpr double kUnit = 1.0;
};

// The largest cost of a type is a wall.
template <typename Cost>
inline bool is_wall(Cost cost) {
  if constexpr (std::is_floating_point_v<Cost>) {
    return std::isinf(cost);
  } else {
    return cost == std::numeric_limits<Cost>::max();
  }
}

#define TRUNDLE_INLINE inline __attribute__((always_inline))

// As many numbers as fit into a register of so many bytes.
template <typename Number, int kBytes>
struct Register {
  typedef Number Vector __attribute__((vector_size(kBytes)));
};

template <typename Number>
struct Tile {
  static constexpr int kFirst = 8;                    // where a row's own cells begin, after room for the frame
  static constexpr int kStride = kTile + 2 * kFirst;  // of a row
  using Rows = Number[kTile + 2][kStride];            // own rows are 1 to kTile

  struct Plane {
    alignas(64) Rows value;     // cost to go
    alignas(64) Rows straight;  // what half a straight step in the cell costs; kFar in a wall
    alignas(64) Rows diagonal;  // the same for a diagonal step
  };

  Plane upright, turned;

  // Rows of a plane that changed since they were last relaxed from, upward and downward; bit r for row r.
  struct Changed {
    std::uint64_t up, down;
  };

  static constexpr std::uint64_t kAll = (std::uint64_t{1} << (kTile + 2)) - 1;
  static constexpr std::uint64_t kLowFrame = 1, kHighFrame = std::uint64_t{1} << (kTile + 1);

  template <int kBytes>
  TRUNDLE_INLINE void settle(bool everywhere);

 private:
  template <int kBytes, int kStep>
  static TRUNDLE_INLINE void sweep(Plane &plane, Changed &rows, Changed &cols);

  static TRUNDLE_INLINE void transpose(const Rows &from, Rows &to) {
    for (int row = 0; row < kTile; row += 4) {
      for (int col = 0; col < kTile; col += 4) transpose_block(from, to, row, col);
    }
  }

  static TRUNDLE_INLINE void transpose_block(const Rows &from, Rows &to, int row, int col) {
    Number block[4][4];
    for (int r = 0; r < 4; ++r) {
      for (int c = 0; c < 4; ++c) block[c][r] = from[1 + row + r][kFirst + col + c];
    }
    for (int c = 0; c < 4; ++c) std::memcpy(&to[1 + col + c][kFirst + row], block[c], sizeof block[c]);
  }

  static TRUNDLE_INLINE void transpose_frame(const Rows &from, Rows &to) {
    for (int k = 0; k < kTile + 2; ++k) {
      to[k][kFirst - 1] = from[0][kFirst - 1 + k];
      to[k][kFirst + kTile] = from[kTile + 1][kFirst - 1 + k];
      to[0][kFirst - 1 + k] = from[k][kFirst - 1];
      to[kTile + 1][kFirst - 1 + k] = from[k][kFirst + kTile];
    }
  }
};

// Relax every row that follows a changed one; what changes is noted for the other way and for the other plane.
template <typename Number>
template <int kBytes, int kStep>
TRUNDLE_INLINE void Tile<Number>::sweep(Plane &plane, Changed &rows, Changed &cols) {
  constexpr int kLanes = kBytes / static_cast<int>(sizeof(Number));
  using Vector = typename Register<Number, kBytes>::Vector;
  using Bits = typename Register<std::int64_t, kBytes>::Vector;
  using Word = std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint64_t>;
  constexpr Number kFar = Scale<Number>::kFar;
  std::uint64_t &ahead = kStep > 0 ? rows.up : rows.down, &back = kStep > 0 ? rows.down : rows.up;
  Bits changed_cols[kTile / kLanes] = {};
  bool any = false;
  for (int n = 0, row = kStep > 0 ? 1 : kTile; n < kTile; ++n, row += kStep) {
    if (((ahead >> (row - kStep)) & 1) == 0) continue;
    const Number *value = plane.value[row - kStep], *straight = plane.straight[row - kStep];
    const Number *diagonal = plane.diagonal[row - kStep], *own_straight = plane.straight[row];
    const Number *own_diagonal = plane.diagonal[row];
    Number *own = plane.value[row];
    Bits changed = {};
    for (int k = 0; k < kTile / kLanes; ++k) {
      const int at = kFirst + k * kLanes;
      Vector before, step, here, left, right, side, turn;
      std::memcpy(&step, straight + at, kBytes);
      std::memcpy(&before, value + at, kBytes);
      std::memcpy(&here, own_straight + at, kBytes);
      Vector best = before + step + here;
      std::memcpy(&left, value + at - 1, kBytes);
      std::memcpy(&turn, diagonal + at - 1, kBytes);
      std::memcpy(&side, own_straight + at - 1, kBytes);
      left += turn;
      if constexpr (std::is_integral_v<Number>) {
        left |= side & kFar;  // a wall at the corner
      } else {
        left = side >= kFar ? side : left;
      }
      std::memcpy(&right, value + at + 1, kBytes);
      std::memcpy(&turn, diagonal + at + 1, kBytes);
      std::memcpy(&side, own_straight + at + 1, kBytes);
      right += turn;
      if constexpr (std::is_integral_v<Number>) {
        right |= side & kFar;
      } else {
        right = side >= kFar ? side : right;
      }
      left = left < right ? left : right;
      if constexpr (std::is_integral_v<Number>) {
        left |= step & kFar;  // a wall at the corner that both share
      } else {
        left = step >= kFar ? step : left;
      }
      std::memcpy(&turn, own_diagonal + at, kBytes);
      left += turn;
      best = left < best ? left : best;
      Vector old;
      std::memcpy(&old, own + at, kBytes);
      best = best < old ? best : old;
      std::memcpy(own + at, &best, kBytes);
      Bits old_bits, new_bits;
      std::memcpy(&old_bits, &old, kBytes);
      std::memcpy(&new_bits, &best, kBytes);
      changed |= old_bits ^ new_bits;
      changed_cols[k] |= old_bits ^ new_bits;
    }
    std::int64_t difference = 0;
    for (int lane = 0; lane < kBytes / 8; ++lane) difference |= changed[lane];
    if (difference != 0) {
      ahead |= std::uint64_t{1} << row;
      back |= std::uint64_t{1} << row;
      any = true;
    }
  }
  ahead = 0;
  if (!any) return;
  std::uint64_t mask = 0;
  for (int k = 0; k < kTile / kLanes; ++k) {
    Word lanes[kLanes];
    std::memcpy(lanes, &changed_cols[k], kBytes);
    for (int lane = 0; lane < kLanes; ++lane) {
      if (lanes[lane] != 0) mask |= std::uint64_t{1} << (1 + k * kLanes + lane);
    }
  }
  cols.up |= mask;
  cols.down |= mask;
}

// Sweep until nothing changes. The upright plane is loaded whole; at first its frame alone counts as changed, or all.
template <typename Number>
template <int kBytes>
TRUNDLE_INLINE void Tile<Number>::settle(bool everywhere) {
  transpose(upright.straight, turned.straight);
  transpose(upright.diagonal, turned.diagonal);
  transpose_frame(upright.straight, turned.straight);
  transpose_frame(upright.diagonal, turned.diagonal);
  transpose_frame(upright.value, turned.value);
  Changed rows{kLowFrame, kHighFrame}, cols{kLowFrame, kHighFrame};
  if (everywhere) rows = cols = {kAll, kAll};
  while (true) {
    while (rows.up || rows.down) {
      if (rows.up) sweep<kBytes, 1>(upright, rows, cols);
      if (rows.down) sweep<kBytes, -1>(upright, rows, cols);
    }
    transpose(upright.value, turned.value);
    if (!cols.up && !cols.down) break;
    while (cols.up || cols.down) {
      if (cols.up) sweep<kBytes, 1>(turned, cols, rows);
      if (cols.down) sweep<kBytes, -1>(turned, cols, rows);
    }
    transpose(turned.value, upright.value);
    if (!rows.up && !rows.down) break;
  }
}

}  // namespace trundle
