// The processor's registers as vectors of numbers, in the notation of GCC and Clang.
#pragma once

#include <cstdint>
#include <cstring>
#include <utility>

// Everything is inlined into one function, so that registers stay registers; but not for sanitizers, which take minutes
// to compile that.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TRUNDLE_INLINE inline
#define TRUNDLE_LAMBDA(...) [&](__VA_ARGS__)
#define TRUNDLE_TARGET(...)  // functions that are not inlined would be compiled for another processor
#else
#define TRUNDLE_INLINE inline __attribute__((always_inline))
#define TRUNDLE_LAMBDA(...) [&](__VA_ARGS__) __attribute__((always_inline))
#define TRUNDLE_TARGET(...) __attribute__((target(__VA_ARGS__)))
#endif

// Where a kernel may choose AVX2 when it runs.
#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define TRUNDLE_AVX2 1
#endif

namespace trundle {

// A register of `kBytes` bytes as a vector of numbers.
template <typename Number, int kBytes>
struct Register {
  typedef Number Vector __attribute__((vector_size(kBytes)));
};

template <typename Vector>
using Lane = std::remove_reference_t<decltype(std::declval<Vector &>()[0])>;

template <typename Vector>
constexpr int kLaneCount = sizeof(Vector) / sizeof(Lane<Vector>);

template <typename Vector, int... kFrom>
TRUNDLE_INLINE Vector pick(Vector low, Vector high, std::integer_sequence<int, kFrom...>) {
#if defined(__clang__)
  return __builtin_shufflevector(low, high, kFrom...);
#else
  using Index = std::conditional_t<sizeof(Lane<Vector>) == 8, std::int64_t,
                                   std::conditional_t<sizeof(Lane<Vector>) == 4, std::int32_t,
                                   std::conditional_t<sizeof(Lane<Vector>) == 2, std::int16_t, std::int8_t>>>;
  using Indices = typename Register<Index, sizeof(Vector)>::Vector;
  return __builtin_shuffle(low, high, Indices{kFrom...});
#endif
}

template <int kFirst, int... k>
constexpr auto counted(std::integer_sequence<int, k...>) {
  return std::integer_sequence<int, (kFirst + k)...>{};
}

// Rotates the lanes up or down by `kBy`; what leaves at one end comes in at the other.
template <int kBy = 1, typename Vector>
TRUNDLE_INLINE Vector rotated_up(Vector lanes) {
  constexpr int kLanes = kLaneCount<Vector>;
  return pick(lanes, lanes, counted<kLanes - kBy>(std::make_integer_sequence<int, kLanes>{}));
}

template <int kBy = 1, typename Vector>
TRUNDLE_INLINE Vector rotated_down(Vector lanes) {
  return pick(lanes, lanes, counted<kBy>(std::make_integer_sequence<int, kLaneCount<Vector>>{}));
}

template <typename Vector>
TRUNDLE_INLINE Vector least(Vector a, Vector b) {
  return a < b ? a : b;
}

// Reduces the lanes: half of them are joined with the other half, a quarter with the next, and so on. Every lane holds
// the result.
template <int kBy, typename Vector, typename Join>
TRUNDLE_INLINE Vector joined(Vector lanes, Join join) {
  if constexpr (kBy == 0) {
    return lanes;
  } else {
    const Vector turned = pick(lanes, lanes, counted<kBy>(std::make_integer_sequence<int, kLaneCount<Vector>>{}));
    return joined<kBy / 2>(join(lanes, turned), join);
  }
}

template <typename Vector>
TRUNDLE_INLINE Lane<Vector> joined_bits(Vector bits) {
  return joined<kLaneCount<Vector> / 2>(bits, TRUNDLE_LAMBDA(Vector a, Vector b) { return a | b; })[0];
}

template <typename Vector>
TRUNDLE_INLINE Lane<Vector> least_lane(Vector numbers) {
  return joined<kLaneCount<Vector> / 2>(numbers, TRUNDLE_LAMBDA(Vector a, Vector b) { return least(a, b); })[0];
}

// Calls the body for each of `kCount` registers, unrolled: an array that a loop runs over may stay in memory.
template <typename Body, int... k>
TRUNDLE_INLINE void each_of(Body body, std::integer_sequence<int, k...>) {
  (body(std::integral_constant<int, k>{}), ...);
}

template <int kCount, typename Body>
TRUNDLE_INLINE void each(Body body) {
  each_of(body, std::make_integer_sequence<int, kCount>{});
}

template <int kHalf, int... k>
constexpr auto interleaved(std::integer_sequence<int, k...>) {
  constexpr int kLanes = sizeof...(k);
  return std::integer_sequence<int, (kHalf * kLanes / 2 + k / 2 + k % 2 * kLanes)...>{};
}

template <int kOdd, int... k>
constexpr auto every_other(std::integer_sequence<int, k...>) {
  return std::integer_sequence<int, (2 * k + kOdd)...>{};
}

// Deals a row to registers as cards: the first cell to the first register, the next to the next. A cell's neighbours
// then stand in its own lane of the registers next to its own, but for those of the first register and the last.
template <int kHands = 1, typename Vector, int kParts>
TRUNDLE_INLINE void deal(Vector (&row)[kParts]) {
  if constexpr (kHands < kParts) {
    constexpr auto kInOrder = std::make_integer_sequence<int, kLaneCount<Vector>>{};
    Vector dealt[kParts];
    each<kParts / 2>(TRUNDLE_LAMBDA(auto k) {
      dealt[k] = pick(row[2 * k], row[2 * k + 1], every_other<0>(kInOrder));
      dealt[k + kParts / 2] = pick(row[2 * k], row[2 * k + 1], every_other<1>(kInOrder));
    });
    deal<2 * kHands>(dealt);
    each<kParts>(TRUNDLE_LAMBDA(auto k) { row[k] = dealt[k]; });
  }
}

// Puts the cells of a dealt row in order again: registers are interleaved with those half of them away, as a deck is
// shuffled.
template <int kHands = 1, typename Vector, int kParts>
TRUNDLE_INLINE void gather(Vector (&row)[kParts]) {
  if constexpr (kHands < kParts) {
    constexpr auto kInOrder = std::make_integer_sequence<int, kLaneCount<Vector>>{};
    Vector shuffled[kParts];
    each<kParts / 2>(TRUNDLE_LAMBDA(auto k) {
      shuffled[2 * k] = pick(row[k], row[k + kParts / 2], interleaved<0>(kInOrder));
      shuffled[2 * k + 1] = pick(row[k], row[k + kParts / 2], interleaved<1>(kInOrder));
    });
    gather<2 * kHands>(shuffled);
    each<kParts>(TRUNDLE_LAMBDA(auto k) { row[k] = shuffled[k]; });
  }
}

}  // namespace trundle
