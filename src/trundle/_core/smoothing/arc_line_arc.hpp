// Curves of an arc, a line and an arc that lead forward from one heading to another: Dubins (1957).
#pragma once

#include <algorithm>
#include <cmath>

#include "smoothing/cost_model.hpp"

namespace trundle::smoothing {

// Visits those whose arcs turn by half a circle at most, in units of the radius. Directions and tangents tell which
// those are: no other angle has to be computed.
template <typename Visit>
void for_each_smooth_curve(const Heading &from, const Heading &to, double radius, Visit &&visit) {
  constexpr double kRounding = 1e-9;
  for (const int side : {1, -1}) {
    for (const int last_side : {side, -side}) {
      // From the centre of the first circle to that of the last.
      const double first = side * radius, last = last_side * radius, offset = first - last;
      const double x = to.x - last * to.sin - (from.x - first * from.sin);
      const double y = to.y + last * to.cos - (from.y + first * from.cos);
      const double apart = x * x + y * y;
      if (apart < offset * offset) continue;
      const double straight = std::sqrt(apart - offset * offset);
      double cos = from.cos, sin = from.sin;  // of the line
      if (apart > kRounding * radius * kRounding * radius) {
        cos = (x * straight - y * offset) / apart, sin = (x * offset + y * straight) / apart;
      }
      const double out = side * (from.cos * sin - from.sin * cos), in = last_side * (cos * to.sin - sin * to.cos);
      if (out < -kRounding || in < -kRounding) continue;
      Curve curve;
      curve.add(std::atan2(std::max(out, 0.0), from.cos * cos + from.sin * sin), side);
      curve.add(straight / radius, 0);
      curve.add(std::atan2(std::max(in, 0.0), cos * to.cos + sin * to.sin), last_side);
      visit(curve);
    }
  }
}

}  // namespace trundle::smoothing
