// Sine and cosine of our own, one by one; shared/sine_cosine.hpp says how.
#pragma once

#include <cmath>
#include <cstdint>

#include "shared/sine_cosine.hpp"

namespace trundle::batch {

// std::floor of a number of at most 2^62, which is a call of the C library where a processor may lack SSE 4.1.
inline double floor_of(double number) {
  const double whole = static_cast<double>(static_cast<std::int64_t>(number));
  return number < whole ? whole - 1.0 : whole;
}

inline SinCos sin_cos(double angle) {
  if (!(std::abs(angle) < 1e6)) angle = std::remainder(angle, 6.283185307179586);  // exact by IEEE 754
  if (std::abs(angle) < 0.03) {
    // Four terms are below half a unit in the last place.
    const double z = angle * angle;
    return {angle + angle * (z * (-1.0 / 6.0 + z * (1.0 / 120.0 - z * (1.0 / 5040.0)))),
            1.0 - (0.5 * z - z * (z * (1.0 / 24.0 - z * (1.0 / 720.0 - z * (1.0 / 40320.0)))))};
  }
  return sin_cos_of_usual(angle);
}

}  // namespace trundle::batch
