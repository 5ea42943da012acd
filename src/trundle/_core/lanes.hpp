// Four numbers side by side, one for each of four directions.
#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#if defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace trundle {

template <typename Real>
struct Four {
  using Whole = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
  typedef Real Lanes __attribute__((vector_size(4 * sizeof(Real))));
  typedef Whole Mask __attribute__((vector_size(4 * sizeof(Real))));  // all bits of a lane, or none

  static void fill(Lanes &lanes, Real value) { lanes = Lanes{value, value, value, value}; }

  // The first and the second numbers of four pairs.
  static void load_pairs(const Real *a, const Real *b, const Real *c, const Real *d, Lanes &first, Lanes &second) {
#if defined(__SSE2__)
    if constexpr (sizeof(Real) == 4) {
      const __m128 low = pair(a, b), high = pair(c, d);
      first = (Lanes)_mm_shuffle_ps(low, high, _MM_SHUFFLE(2, 0, 2, 0));
      second = (Lanes)_mm_shuffle_ps(low, high, _MM_SHUFFLE(3, 1, 3, 1));
      return;
    }
#endif
    first = Lanes{a[0], b[0], c[0], d[0]};
    second = Lanes{a[1], b[1], c[1], d[1]};
  }

  // Each lane gets the next one's number, the last the first's; or the other way round.
  static void turn(const Lanes &from, Lanes &to) { to = Lanes{from[1], from[2], from[3], from[0]}; }
  static void turn_back(const Lanes &from, Lanes &to) { to = Lanes{from[3], from[0], from[1], from[2]}; }

  static void take_root(Lanes &x) {
    if constexpr (sizeof(Real) == 4) {
#if defined(__SSE2__)
      x = (Lanes)_mm_sqrt_ps((__m128)x);
      return;
#elif defined(__aarch64__)
      x = (Lanes)vsqrtq_f32((float32x4_t)x);
      return;
#endif
    }
    x = Lanes{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
  }

  // A bit for each lane.
  static unsigned bits(const Mask &mask) {
#if defined(__SSE2__)
    if constexpr (sizeof(Real) == 4) return static_cast<unsigned>(_mm_movemask_ps((__m128)mask));
#endif
    return static_cast<unsigned>((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
  }

 private:
#if defined(__SSE2__)
  static __m128 pair(const Real *a, const Real *b) {
    return _mm_loadh_pi(_mm_loadl_pi(_mm_setzero_ps(), reinterpret_cast<const __m64 *>(a)),
                        reinterpret_cast<const __m64 *>(b));
  }
#endif
};

}  // namespace trundle
