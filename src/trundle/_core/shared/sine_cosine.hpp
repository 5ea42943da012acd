// Sine and cosine of our own: the same bits from every compiler and C library, which their own are not, and several at
// once where compilers see a loop.
//
// The angle is reduced to [−π/4, π/4] with π/2 in three parts (Cody and Waite 1980), the rest is Taylor's series up to the
// term below half a unit in the last place. Both are within 1e-15 of the true values.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace trundle {

struct SinCos {
  double sin, cos;
};

constexpr double kMostUsualAngle = 1e6;

// Of an angle of at most a million. Without a branch, as compilers vectorise that.
inline SinCos sin_cos_of_usual(double angle) {
  constexpr double kTwoOverPi = 0.63661977236758134308;
  // The first two parts have 33 bits each, so that their products with the number of quarter turns are exact.
  constexpr double kFirst = 0x1.921fb544p+0, kSecond = 0x1.0b4611a6p-34, kThird = 0x1.3198a2e037073p-69;
  const double turns = std::floor(angle * kTwoOverPi + 0.5);
  const double r = ((angle - turns * kFirst) - turns * kSecond) - turns * kThird;
  const double z = r * r;
  double s = -1.0 / 1307674368000.0 + z * (1.0 / 355687428096000.0);
  s = 1.0 / 6227020800.0 + z * s;
  s = -1.0 / 39916800.0 + z * s;
  s = 1.0 / 362880.0 + z * s;
  s = -1.0 / 5040.0 + z * s;
  s = 1.0 / 120.0 + z * s;
  s = -1.0 / 6.0 + z * s;
  const double sin = r + r * (z * s);
  double c = 1.0 / 20922789888000.0 - z * (1.0 / 6402373705728000.0);
  c = -1.0 / 87178291200.0 + z * c;
  c = 1.0 / 479001600.0 + z * c;
  c = -1.0 / 3628800.0 + z * c;
  c = 1.0 / 40320.0 + z * c;
  c = -1.0 / 720.0 + z * c;
  c = 1.0 / 24.0 + z * c;
  const double cos = 1.0 - (0.5 * z - z * (z * c));
  const auto quarter = static_cast<std::int32_t>(turns);
  const double across = (quarter & 1) != 0 ? cos : sin, along = (quarter & 1) != 0 ? sin : cos;
  return {(quarter & 2) != 0 ? -across : across, ((quarter + 1) & 2) != 0 ? -along : along};
}

// Cosines and sines of `angles[i] + turn`.
void turn_directions(const double *angles, double turn, std::size_t count, double *cosines, double *sines);

}  // namespace trundle
