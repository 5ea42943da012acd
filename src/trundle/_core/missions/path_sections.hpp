// A path cut into sections, as `trundle.control.sections` cuts it.
#pragma once

#include "missions/plane.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace trundle::missions {

struct Vertex {
  double x, y, turn;
  bool backward;
};

struct Motion {
  Pose first, last;  // their yaws are not wrapped
};

inline Motion turn_by(const Pose &pose, double turn) { return {pose, {pose.x, pose.y, pose.yaw + turn}}; }

// A polyline that is driven without stopping, and the turn in place at its end.
class Section {
 public:
  Section(std::vector<Place> corners, double turn_at_end, bool is_backward)
      : points(std::move(corners)), end_turn(turn_at_end), backward(is_backward) {
    starts.push_back(0.0);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const double dx = points[i].x - points[i - 1].x, dy = points[i].y - points[i - 1].y;
      starts.push_back(starts.back() + missions::length(dx, dy));
      headings.push_back(std::atan2(dy, dx));
      cosines.push_back(std::cos(headings.back()));
      sines.push_back(std::sin(headings.back()));
    }
    length = starts.back();
  }

  std::vector<Place> points;
  std::vector<double> starts, headings, cosines, sines;
  double length, end_turn;
  bool backward;

  Place point_at(double s) const {
    const std::size_t leg = leg_at(s);
    const double along = s - starts[leg];
    return {points[leg].x + along * cosines[leg], points[leg].y + along * sines[leg]};
  }

  // Arc length of the point nearest to (x, y) between `s` and `s + window`.
  double project(double x, double y, double s, double window) const {
    double best = s, best_distance = std::numeric_limits<double>::infinity();
    for (std::size_t leg = leg_at(s); leg < headings.size(); ++leg) {
      const double start = starts[leg], end = starts[leg + 1];
      if (start > s + window) break;
      double along = (x - points[leg].x) * cosines[leg] + (y - points[leg].y) * sines[leg];
      along = std::min(std::min(std::max(std::max(start + along, start), s), end), s + window);
      const Place at = point_at(along);
      const double distance = missions::length(x - at.x, y - at.y);
      if (distance < best_distance - 1e-12) best = along, best_distance = distance;
    }
    return best;
  }

  // The lines along it and the turn at its end, as a robot drives them.
  std::vector<Motion> motions() const {
    const double turned = backward ? kPi : 0.0;
    std::vector<Motion> all;
    for (std::size_t i = 0; i < headings.size(); ++i) {
      const double yaw = headings[i] + turned;
      all.push_back({{points[i].x, points[i].y, yaw}, {points[i + 1].x, points[i + 1].y, yaw}});
    }
    all.push_back(turn_by(all.back().last, end_turn));
    return all;
  }

 private:
  std::size_t leg_at(double s) const {
    const auto after = std::upper_bound(starts.begin(), starts.end(), s) - starts.begin();
    return static_cast<std::size_t>(
        std::min<std::ptrdiff_t>(std::max<std::ptrdiff_t>(after - 1, 0), static_cast<std::ptrdiff_t>(headings.size()) - 1));
  }
};

// Places where a path starts, bends and ends, with the turn at each. `poses` has three numbers a pose, and
// `backward` one for each leg between two.
inline std::vector<Vertex> path_vertices(const double *poses, const bool *backward, std::size_t count) {
  constexpr double kSamePlace = 1e-6, kStraight = 1e-4;
  struct Stop {
    double x, y, turned;
    bool backward;
  };
  std::vector<Stop> stops;
  for (std::size_t i = 0; i < count; ++i) {
    const double *pose = poses + 3 * i;
    if (!stops.empty() && length(pose[0] - stops.back().x, pose[1] - stops.back().y) <= kSamePlace) {
      stops.back().turned += wrap_angle(pose[2] - pose[-1]);
    } else {
      stops.push_back({pose[0], pose[1], 0.0, i > 0 && backward[i - 1]});
    }
  }
  double yaw = poses[2];
  const std::size_t last = stops.size() - 1;
  std::vector<Vertex> vertices;
  for (std::size_t i = 0; i <= last; ++i) {
    double heading = poses[3 * (count - 1) + 2];
    const bool leaves_backward = i < last && stops[i + 1].backward;
    if (i < last) {
      heading = std::atan2(stops[i + 1].y - stops[i].y, stops[i + 1].x - stops[i].x);
      if (leaves_backward) heading += kPi;
    }
    const double turn = stops[i].turned + wrap_angle(heading - yaw - stops[i].turned);
    const bool is_cusp = 0 < i && i < last && stops[i].backward != stops[i + 1].backward;
    if (i == 0 || i == last || is_cusp || std::abs(turn) > kStraight) {
      vertices.push_back({stops[i].x, stops[i].y, turn, leaves_backward});
      yaw = heading;
    }
  }
  return vertices;
}

inline bool changes_direction(const std::vector<Vertex> &vertices, std::size_t i) {
  return 0 < i && i + 1 < vertices.size() && vertices[i].backward != vertices[i - 1].backward;
}

inline std::vector<Section> cut_sections(const std::vector<Vertex> &vertices, const std::vector<bool> &stops) {
  std::vector<Section> sections;
  std::vector<Place> points{{vertices[0].x, vertices[0].y}};
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    points.push_back({vertices[i].x, vertices[i].y});
    if (stops[i] || changes_direction(vertices, i) || i + 1 == vertices.size()) {
      const Place last = points.back();
      sections.emplace_back(std::move(points), vertices[i].turn, vertices[i - 1].backward);
      points = {last};
    }
  }
  return sections;
}

}  // namespace trundle::missions
