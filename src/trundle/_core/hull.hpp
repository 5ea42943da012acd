// Convex hulls of points in the plane.
#pragma once

#include "raster.hpp"

namespace trundle {

// Convex hull (Andrew's monotone chain); sorts `points`, counter-clockwise result in `hull`.
inline void convex_hull(std::vector<Point2> &points, std::vector<Point2> &hull) {
  std::sort(points.begin(), points.end(),
            [](const Point2 &a, const Point2 &b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  hull.clear();
  const auto turns_left = [](const Point2 &o, const Point2 &a, const Point2 &b) {
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x) > 0.0;
  };
  const auto extend = [&](const Point2 &point, std::size_t floor) {
    while (hull.size() >= floor + 2 && !turns_left(hull[hull.size() - 2], hull.back(), point)) hull.pop_back();
    hull.push_back(point);
  };
  for (const Point2 &point : points) extend(point, 0);
  const std::size_t floor = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) extend(points[i], floor);
  if (hull.size() > 1) hull.pop_back();
}

}  // namespace trundle
