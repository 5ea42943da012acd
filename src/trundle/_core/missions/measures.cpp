// Two segments that do not cross are nearest at an end of one of them; two convex polygons overlap where a corner of one
// lies in the other, or two edges cross.
#include "missions/measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace trundle {

namespace {

struct Corner {
  double x, y;
};

struct Nearest {
  double squared = std::numeric_limits<double>::infinity(), x = 0.0, y = 0.0;

  // Take the way from the segment `a` to `b` to a point.
  void look(const Corner &point, const Corner &a, const Corner &b) {
    const double dx = b.x - a.x, dy = b.y - a.y, ox = point.x - a.x, oy = point.y - a.y;
    const double along = dx * dx + dy * dy;
    const double share = std::clamp((ox * dx + oy * dy) / (along > 0.0 ? along : 1.0), 0.0, 1.0);
    const double rx = ox - share * dx, ry = oy - share * dy, away = rx * rx + ry * ry;
    if (away < squared) squared = away, x = rx, y = ry;
  }
};

// Positive where a point is on the left of the line from `a` to `b`.
double side(const Corner &a, const Corner &b, const Corner &point) {
  return (b.x - a.x) * (point.y - a.y) - (b.y - a.y) * (point.x - a.x);
}

bool is_inside(const Corner *polygon, std::size_t count, const Corner &point, bool either_sense) {
  bool left = true, right = either_sense;
  for (std::size_t i = 0, j = count - 1; i < count; j = i++) {
    const double at = side(polygon[j], polygon[i], point);
    left = left && at >= 0.0;
    right = right && at <= 0.0;
  }
  return left || right;
}

// Twice its area, of either sign; a polygon without one is on both sides of its line.
double doubled_area(const Corner *polygon, std::size_t count) {
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const Corner &a = polygon[i], &b = polygon[(i + 1) % count];
    sum += a.x * b.y - b.x * a.y;
  }
  return sum;
}

double distance(const Corner *one, std::size_t corners, const Corner *other, std::size_t others, bool has_area,
                double least) {
  Nearest nearest;
  for (std::size_t i = 0, j = corners - 1; i < corners; j = i++) {
    for (std::size_t k = 0, l = others - 1; k < others; l = k++) {
      if (side(one[j], one[i], other[l]) * side(one[j], one[i], other[k]) < 0.0 &&
          side(other[l], other[k], one[j]) * side(other[l], other[k], one[i]) < 0.0) {
        return 0.0;
      }
      nearest.look(other[k], one[j], one[i]);
      nearest.look(one[i], other[l], other[k]);
    }
  }
  for (std::size_t k = 0; k < others; ++k) {
    if (is_inside(one, corners, other[k], false)) return 0.0;
  }
  if (has_area && is_inside(other, others, one[0], true)) return 0.0;
  return std::min(least, std::hypot(nearest.x, nearest.y));
}

template <typename Array>
void check_finite(const Array &values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(std::abs(values.data()[i]) < 1e100)) throw nb::value_error("corners and points must be finite");
  }
}

}  // namespace

nb::ndarray<nb::numpy, double> polyline_distances(In<double, 2> points, In<double, 2> corners) {
  if (points.shape(1) != 2 || corners.shape(1) != 2 || corners.shape(0) == 0) {
    throw nb::value_error("points need shape (N, 2), and corners (M, 2) with M >= 1");
  }
  check_finite(points);
  check_finite(corners);
  const std::size_t count = points.shape(0), legs = std::max<std::size_t>(corners.shape(0) - 1, 1);
  const auto *point = reinterpret_cast<const Corner *>(points.data());
  const auto *corner = reinterpret_cast<const Corner *>(corners.data());
  const bool is_one = corners.shape(0) == 1;
  std::vector<double> distances(count);
  {
    nb::gil_scoped_release release;
    for (std::size_t i = 0; i < count; ++i) {
      Nearest nearest;
      for (std::size_t leg = 0; leg < legs; ++leg) nearest.look(point[i], corner[leg], corner[is_one ? leg : leg + 1]);
      distances[i] = std::sqrt(nearest.squared);
    }
  }
  return to_numpy(std::move(distances), {count});
}

nb::ndarray<nb::numpy, double> outline_distances(In<double, 3> outlines, In<double, 3> polygons) {
  if (outlines.shape(2) != 2 || polygons.shape(2) != 2 || outlines.shape(1) < 3 || polygons.shape(1) == 0) {
    throw nb::value_error("outlines need shape (P, N, 2) with N >= 3, and polygons (Q, M, 2) with M >= 1");
  }
  check_finite(outlines);
  check_finite(polygons);
  constexpr double kLeastArea = 1e-12;  // twice the area [m²] below which it is rounding noise
  const std::size_t count = outlines.shape(0), corners = outlines.shape(1);
  const std::size_t others = polygons.shape(1), shapes = polygons.shape(0);
  const auto *outline = reinterpret_cast<const Corner *>(outlines.data());
  const auto *polygon = reinterpret_cast<const Corner *>(polygons.data());
  std::vector<double> distances(count, std::numeric_limits<double>::infinity());
  {
    nb::gil_scoped_release release;
    std::vector<char> has_area(shapes);
    for (std::size_t q = 0; q < shapes; ++q) {
      has_area[q] = std::abs(doubled_area(polygon + q * others, others)) > kLeastArea;
    }
    for (std::size_t p = 0; p < count; ++p) {
      for (std::size_t q = 0; q < shapes && distances[p] > 0.0; ++q) {
        distances[p] = distance(outline + p * corners, corners, polygon + q * others, others, has_area[q] != 0,
                                distances[p]);
      }
    }
  }
  return to_numpy(std::move(distances), {count});
}

}  // namespace trundle
