// Bearings of many points at once; shared/bearing.hpp says what they are.
#include "shared/bearing.hpp"

#include "shared/registers.hpp"

namespace trundle {
namespace {

TRUNDLE_INLINE void all_bearings(double x, double y, const double *points, std::size_t stride, std::size_t count,
                                 double *__restrict bearings) {
  for (std::size_t i = 0; i < count; ++i) {
    bearings[i] = bearing_of_usual(points[i * stride + 1] - y, points[i * stride] - x);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double dx = points[i * stride] - x, dy = points[i * stride + 1] - y;
    if (!is_usual(dy, dx)) bearings[i] = std::atan2(dy, dx);
  }
}

#ifdef TRUNDLE_AVX2
TRUNDLE_TARGET("avx2") void all_bearings_avx2(double x, double y, const double *points, std::size_t stride,
                                              std::size_t count, double *bearings) {
  all_bearings(x, y, points, stride, count, bearings);
}
#endif

}  // namespace

void bearings_from(double x, double y, const double *points, std::size_t stride, std::size_t count, double *bearings) {
#ifdef TRUNDLE_AVX2
  if (__builtin_cpu_supports("avx2")) return all_bearings_avx2(x, y, points, stride, count, bearings);
#endif
  all_bearings(x, y, points, stride, count, bearings);
}

}  // namespace trundle
