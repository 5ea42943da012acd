// Directions of many beams at once; shared/sine_cosine.hpp says how.
#include "shared/registers.hpp"
#include "shared/sine_cosine.hpp"

namespace trundle {
namespace {

TRUNDLE_INLINE void turn_all(const double *angles, double turn, std::size_t count, double *__restrict cosines,
                             double *__restrict sines) {
  for (std::size_t i = 0; i < count; ++i) {
    const SinCos direction = sin_cos_of_usual(angles[i] + turn);
    cosines[i] = direction.cos, sines[i] = direction.sin;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double direction = angles[i] + turn;
    if (!(std::abs(direction) <= kMostUsualAngle)) cosines[i] = std::cos(direction), sines[i] = std::sin(direction);
  }
}

#ifdef TRUNDLE_AVX2
TRUNDLE_TARGET("avx2") void turn_all_avx2(const double *angles, double turn, std::size_t count, double *cosines,
                                          double *sines) {
  turn_all(angles, turn, count, cosines, sines);
}
#endif

}  // namespace

void turn_directions(const double *angles, double turn, std::size_t count, double *cosines, double *sines) {
#ifdef TRUNDLE_AVX2
  if (__builtin_cpu_supports("avx2")) return turn_all_avx2(angles, turn, count, cosines, sines);
#endif
  turn_all(angles, turn, count, cosines, sines);
}

}  // namespace trundle
