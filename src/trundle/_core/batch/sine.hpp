// Sine and cosine of our own: the same bits from every compiler and C library, which their own are not.
//
// The angle is reduced to [−π/4, π/4] with π/2 in three parts (Cody and Waite 1980), the rest is Taylor's series up to the
// term below half a unit in the last place. Both are within 1e-15 of the true values.
#pragma once

#include <cmath>
#include <cstdint>

namespace trundle::batch {

struct SinCos {
  double sin, cos;
};

// std::floor of a number of at most 2^62, which is a call of the C library where a processor may lack SSE 4.1.
inline double floor_of(double number) {
  const double whole = static_cast<double>(static_cast<std::int64_t>(number));
  return number < whole ? whole - 1.0 : whole;
}

inline SinCos sin_cos(double angle) {
  constexpr double kTwoOverPi = 0.63661977236758134308;
  // The first two parts have 33 bits each, so that their products with the number of quarter turns are exact.
  constexpr double kFirst = 0x1.921fb544p+0, kSecond = 0x1.0b4611a6p-34, kThird = 0x1.3198a2e037073p-69;
  if (!(std::abs(angle) < 1e6)) angle = std::remainder(angle, 6.283185307179586);  // exact by IEEE 754
  if (std::abs(angle) < 0.03) {
    // Four terms are below half a unit in the last place.
    const double z = angle * angle;
    return {angle + angle * (z * (-1.0 / 6.0 + z * (1.0 / 120.0 - z * (1.0 / 5040.0)))),
            1.0 - (0.5 * z - z * (z * (1.0 / 24.0 - z * (1.0 / 720.0 - z * (1.0 / 40320.0)))))};
  }
  const double turns = floor_of(angle * kTwoOverPi + 0.5);
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
  switch (static_cast<std::int64_t>(turns) & 3) {
    case 0: return {sin, cos};
    case 1: return {cos, -sin};
    case 2: return {-sin, -cos};
    default: return {-cos, sin};
  }
}

}  // namespace trundle::batch
