// Registers of samples: a lane holds one sample's number. The same code runs on single numbers, for one sample alone.
//
// Comparisons are written so that a NaN loses: `least(a, b)` and `largest(a, b)` answer `b` where `a` is none.
#pragma once

#include <cmath>
#include <cstdint>

#include "shared/registers.hpp"

namespace trundle::mppi {

template <int kBytes>
using Floats = typename Register<float, kBytes>::Vector;

template <typename V>
struct Ints {
  using Type = typename Register<std::int32_t, sizeof(V)>::Vector;
};

template <>
struct Ints<float> {
  using Type = std::int32_t;
};

template <typename V, typename Number>
TRUNDLE_INLINE V fill(Number number) {
  if constexpr (std::is_same_v<V, float>) {
    return number;
  } else {
    V out{};
    for (int lane = 0; lane < kLaneCount<V>; ++lane) out[lane] = number;
    return out;
  }
}

template <typename V>
TRUNDLE_INLINE V largest(V a, V b) {
  return a > b ? a : b;
}

template <typename V>
TRUNDLE_INLINE V between(V number, V low, V high) {
  return least(largest(number, low), high);
}

template <typename V>
TRUNDLE_INLINE V absolute(V number) {
  return largest(number, -number);
}

// Towards 0; the numbers must fit.
template <typename V>
TRUNDLE_INLINE typename Ints<V>::Type whole(V numbers) {
  return __builtin_convertvector(numbers, typename Ints<V>::Type);
}

template <typename V>
TRUNDLE_INLINE V floats(typename Ints<V>::Type numbers) {
  return __builtin_convertvector(numbers, V);
}

// Of numbers that are not negative.
template <typename V>
TRUNDLE_INLINE V roots(V numbers) {
  float lanes[kLaneCount<V>];
  std::memcpy(lanes, &numbers, sizeof lanes);
  for (float &lane : lanes) lane = std::sqrt(lane);
  std::memcpy(&numbers, lanes, sizeof lanes);
  return numbers;
}

// What a table holds at each lane's index, which is not negative.
template <typename V>
TRUNDLE_INLINE V looked_up(const float *table, typename Ints<V>::Type index) {
  V out{};
  for (int lane = 0; lane < kLaneCount<V>; ++lane) out[lane] = table[static_cast<std::uint32_t>(index[lane])];
  return out;
}

// The same of bytes. Four are read at once, lowest first, as single ones are gathered slowly: the table needs three more
// at its end.
template <typename V>
TRUNDLE_INLINE V looked_up(const std::uint8_t *table, typename Ints<V>::Type index) {
  typename Ints<V>::Type out{};
  for (int lane = 0; lane < kLaneCount<V>; ++lane) {
    std::int32_t four;
    std::memcpy(&four, table + static_cast<std::uint32_t>(index[lane]), sizeof four);
    out[lane] = four;
  }
  return floats<V>(out & 0xff);
}

template <typename V>
TRUNDLE_INLINE V loaded(const float *from) {
  V out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

}  // namespace trundle::mppi
