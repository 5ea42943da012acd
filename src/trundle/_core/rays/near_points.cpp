// Points that scans hit: those near a robot, in its frame, and how far they are from its outline at many poses.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "rays/kernels.hpp"

namespace trundle {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void check_points(const In<double, 2> &points, const In<double, 2> &velocities) {
  if (points.shape(1) != 2 || velocities.shape(1) != 2) throw nb::value_error("points and velocities need rows (x, y)");
  if (velocities.shape(0) != 0 && velocities.shape(0) != points.shape(0)) {
    throw nb::value_error("there must be a velocity for each point, or none");
  }
}

}  // namespace

nb::tuple points_around(In<double, 2> points, In<double, 2> velocities, In<double, 1> pose, double seconds, double reach,
                        double horizon) {
  check_points(points, velocities);
  if (pose.shape(0) != 3) throw nb::value_error("points_around needs a pose (x, y, yaw)");
  std::vector<double> places, moved;
  {
    nb::gil_scoped_release released;
    const bool moves = velocities.shape(0) > 0;
    const double cos = std::cos(pose.data()[2]), sin = std::sin(pose.data()[2]);
    places.reserve(points.size());
    moved.reserve(points.size());
    for (std::size_t i = 0; i < points.shape(0); ++i) {
      double x = points.data()[2 * i] - pose.data()[0], y = points.data()[2 * i + 1] - pose.data()[1];
      double vx = 0.0, vy = 0.0, limit = reach;
      if (moves) {
        vx = velocities.data()[2 * i], vy = velocities.data()[2 * i + 1];
        x += seconds * vx, y += seconds * vy;
        limit += horizon * std::hypot(vx, vy);
      }
      if (!(x * x + y * y <= limit * limit)) continue;
      places.insert(places.end(), {x * cos + y * sin, y * cos - x * sin});
      moved.insert(moved.end(), {vx * cos + vy * sin, vy * cos - vx * sin});
    }
  }
  const std::size_t count = places.size() / 2;
  return nb::make_tuple(to_numpy(std::move(places), {count, 2}), to_numpy(std::move(moved), {count, 2}));
}

nb::ndarray<nb::numpy, double> outline_clearances(In<double, 2> points, In<double, 2> velocities, In<double, 2> poses,
                                                  In<double, 1> times, In<double, 2> outline, In<double, 2> sides,
                                                  double padding, std::int64_t rank) {
  check_points(points, velocities);
  if (velocities.shape(0) != points.shape(0)) throw nb::value_error("there must be a velocity for each point");
  if (poses.shape(1) != 3 || sides.shape(1) != 3 || outline.shape(1) != 2 || sides.shape(0) == 0) {
    throw nb::value_error("outline_clearances needs poses (x, y, yaw), corners (x, y) and sides (x, y, distance)");
  }
  if (times.shape(0) != 0 && times.shape(0) != poses.shape(0)) {
    throw nb::value_error("there must be a time for each pose, or none");
  }
  if (rank < 1) throw nb::value_error("the rank must be 1 or more");
  const std::size_t count = poses.shape(0);
  std::vector<double> found(count, kInfinity);
  {
    nb::gil_scoped_release released;
    std::vector<std::array<double, 2>> turned(count);  // cosine and sine
    double low_x = kInfinity, low_y = kInfinity, high_x = -kInfinity, high_y = -kInfinity;
    for (std::size_t k = 0; k < count; ++k) {
      const double *pose = poses.data() + 3 * k;
      const double cos = std::cos(pose[2]), sin = std::sin(pose[2]);
      turned[k] = {cos, sin};
      for (std::size_t i = 0; i < outline.shape(0); ++i) {
        const double *corner = outline.data() + 2 * i;
        const double x = pose[0] + cos * corner[0] - sin * corner[1], y = pose[1] + sin * corner[0] + cos * corner[1];
        low_x = std::min(low_x, x), high_x = std::max(high_x, x);
        low_y = std::min(low_y, y), high_y = std::max(high_y, y);
      }
    }
    low_x -= padding, low_y -= padding, high_x += padding, high_y += padding;
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < points.shape(0); ++i) {
      const double *point = points.data() + 2 * i, *velocity = velocities.data() + 2 * i;
      const bool inside = point[0] >= low_x && point[0] <= high_x && point[1] >= low_y && point[1] <= high_y;
      if (inside || velocity[0] != 0.0 || velocity[1] != 0.0) near.push_back(i);
    }
    const auto place = static_cast<std::size_t>(rank) - 1;
    std::vector<double> apart(near.size());
    for (std::size_t k = 0; k < count && place < near.size(); ++k) {
      const double *pose = poses.data() + 3 * k;
      const auto [cos, sin] = turned[k];
      std::fill(apart.begin(), apart.end(), -kInfinity);
      for (std::size_t s = 0; s < sides.shape(0); ++s) {
        const double *side = sides.data() + 3 * s;
        const double across = cos * side[0] - sin * side[1], up = sin * side[0] + cos * side[1];
        const double edge = across * pose[0] + up * pose[1] + side[2];
        const double time = times.shape(0) ? times.data()[k] : 0.0, far = across * time, high = up * time;
        for (std::size_t j = 0; j < near.size(); ++j) {
          const double *point = points.data() + 2 * near[j], *velocity = velocities.data() + 2 * near[j];
          double distance = across * point[0] + up * point[1] - edge;
          if (time != 0.0) distance += far * velocity[0] + high * velocity[1];
          apart[j] = std::max(apart[j], distance);
        }
      }
      std::nth_element(apart.begin(), apart.begin() + static_cast<std::ptrdiff_t>(place), apart.end());
      found[k] = apart[place];
    }
  }
  return to_numpy(std::move(found), {count});
}

}  // namespace trundle
