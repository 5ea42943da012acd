// The shortest Dubins and Reeds-Shepp curves between poses, without obstacles.
#include "curves/curves.hpp"
#include "curves/reeds_shepp.hpp"
#include "shared/arrays.hpp"

#include <cmath>
#include <utility>

namespace trundle {

// Row i: up to five pairs of length [m], negative backwards, and curvature [1/m]; the rest is 0.
static nb::ndarray<nb::numpy, double> shortest_curves(In<double, 2> starts, In<double, 2> goals, double radius,
                                                      bool reverse) {
  if (starts.shape(1) != 3 || goals.shape(1) != 3 || starts.shape(0) != goals.shape(0)) {
    throw nb::value_error("starts and goals need the same shape (N, 3)");
  }
  if (!(std::isfinite(radius) && radius > 0.0)) throw nb::value_error("the radius must be a positive number");
  const std::size_t count = starts.shape(0);
  for (std::size_t i = 0; i < 3 * count; ++i) {
    if (!(std::fabs(starts.data()[i]) < 1e9 && std::fabs(goals.data()[i]) < 1e9)) {
      throw nb::value_error("poses must be finite, and below 1e9");
    }
  }
  std::vector<double> table(count * 10, 0.0);
  {
    nb::gil_scoped_release release;
    for (std::size_t i = 0; i < count; ++i) {
      const double *a = starts.data() + 3 * i, *b = goals.data() + 3 * i;
      const double cos = std::cos(a[2]), sin = std::sin(a[2]), dx = (b[0] - a[0]) / radius, dy = (b[1] - a[1]) / radius;
      const double x = cos * dx + sin * dy, y = cos * dy - sin * dx, phi = std::remainder(b[2] - a[2], 2.0 * kPi);
      Curve best;
      double shortest = std::numeric_limits<double>::infinity();
      const auto keep = [&](const Curve &curve) {
        const double length = curve.length();
        if (length < shortest) shortest = length, best = curve;
      };
      if (reverse) {
        for_each_reeds_shepp(x, y, phi, keep);
      } else {
        for_each_dubins(x, y, phi, keep);
      }
      for (int k = 0; k < best.count; ++k) {
        table[10 * i + 2 * static_cast<std::size_t>(k)] = best.pieces[k].length * radius;
        table[10 * i + 2 * static_cast<std::size_t>(k) + 1] = best.pieces[k].steer / radius;
      }
    }
  }
  return to_numpy(std::move(table), {count, 5, 2});
}

}  // namespace trundle

void bind_curves(nanobind::module_ &m) {
  namespace nb = nanobind;
  m.def("shortest_curves", &trundle::shortest_curves, nb::arg("starts").noconvert(), nb::arg("goals").noconvert(),
        nb::arg("radius"), nb::arg("reverse"));
}
