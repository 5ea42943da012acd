// Normals of surfaces from the points of neighbouring beams: a line through up to three points on either side.
#include "mapping/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "localization/checks.hpp"

namespace trundle {

using namespace localization;

Floats find_normals(In<double, 2> points, In<double, 2> sensors, double gap, double least) {
  check_points(points);
  check_points(sensors);
  refuse_unless(points.shape(0) == sensors.shape(0), "each point needs a sensor");
  refuse_unless(gap >= 0.0 && gap <= 10.0 && least > 0.0 && least <= 1e3, "the gaps must be positive");
  const auto count = static_cast<std::ptrdiff_t>(points.shape(0));
  std::vector<double> out(points.size(), 0.0);
  {
    nb::gil_scoped_release release;
    const double *p = points.data(), *s = sensors.data();
    constexpr std::ptrdiff_t kSide = 3;
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      const double range = std::hypot(p[2 * i] - s[2 * i], p[2 * i + 1] - s[2 * i + 1]);
      const double most = std::max(least, gap * range), around = std::max(2.0 * least, 2.0 * gap * range);
      double n = 1.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;  // from the point itself
      for (const std::ptrdiff_t step : {std::ptrdiff_t{-1}, std::ptrdiff_t{1}}) {
        for (std::ptrdiff_t k = 1, j = i; k <= kSide; ++k) {
          const std::ptrdiff_t next = j + step;
          if (next < 0 || next >= count) break;
          if (std::hypot(p[2 * next] - p[2 * j], p[2 * next + 1] - p[2 * j + 1]) > most) break;
          const double dx = p[2 * next] - p[2 * i], dy = p[2 * next + 1] - p[2 * i + 1];
          if (std::hypot(dx, dy) > around) break;
          n += 1.0, x += dx, y += dy, xx += dx * dx, xy += dx * dy, yy += dy * dy;
          j = next;
        }
      }
      if (n < 3.0) continue;
      xx -= x * x / n, xy -= x * y / n, yy -= y * y / n;
      const double mean = 0.5 * (xx + yy), half = std::hypot(0.5 * (xx - yy), xy);
      const double large = mean + half, small = std::max(0.0, mean - half);
      if (!(large > 0.0) || small > 0.1 * large) continue;  // round: a corner, or clutter
      const double along = 0.5 * std::atan2(2.0 * xy, xx - yy);
      double nx = -std::sin(along), ny = std::cos(along);
      if (nx * (s[2 * i] - p[2 * i]) + ny * (s[2 * i + 1] - p[2 * i + 1]) < 0.0) nx = -nx, ny = -ny;
      out[static_cast<std::size_t>(2 * i)] = nx, out[static_cast<std::size_t>(2 * i + 1)] = ny;
    }
  }
  return to_numpy(std::move(out), {static_cast<std::size_t>(count), 2});
}

}  // namespace trundle
