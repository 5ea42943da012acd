// Convex hulls of points in the plane.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace trundle {

// Convex hull (Andrew's monotone chain) of points with finite x and y; sorts `points`, counter-clockwise result in
// `hull`.
template <typename Point>
void convex_hull(std::vector<Point> &points, std::vector<Point> &hull) {
  std::sort(points.begin(), points.end(),
            [](const Point &a, const Point &b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  hull.clear();
  const auto turns_left = [](const Point &o, const Point &a, const Point &b) {
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x) > 0.0;
  };
  const auto extend = [&](const Point &point, std::size_t floor) {
    while (hull.size() >= floor + 2 && !turns_left(hull[hull.size() - 2], hull.back(), point)) hull.pop_back();
    hull.push_back(point);
  };
  for (const Point &point : points) extend(point, 0);
  const std::size_t floor = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) extend(points[i], floor);
  if (hull.size() > 1) hull.pop_back();
}

}  // namespace trundle
