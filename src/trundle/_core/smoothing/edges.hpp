// New curves from a place on or beside a path to another: which there are, what they cost, and whether they hold.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "smoothing/curves.hpp"
#include "smoothing/pieces.hpp"

namespace trundle::smoothing {

struct Course {
  double price = kInfinite;
  int first = 0, last = 0;  // directions
  int count = 0;            // 0: what the path has, or not looked for yet
  Stretch parts[5];
};

// Two to a station: on the path's course, and beside it.
struct Node {
  PlanarPose pose;
  Heading heading;
};

struct Edge {
  std::size_t from, to;  // nodes
  int tries;             // kinds of curves that were looked for
  bool priced;           // or the price is the least that it can be
  bool holds;            // at what it does cost, with the footprint
  Course course;
};

class Edges {
 public:
  Edges(const std::vector<Piece> &pieces, const std::vector<Station> &stations,
        const std::vector<std::optional<PlanarPose>> &beside, const Prices &prices, double tolerance)
      : pieces_(pieces), stations_(stations), prices_(prices), model_(prices.settings().model), tolerance_(1.0 + tolerance) {
    nodes_.reserve(2 * stations.size());
    for (std::size_t k = 0; k < stations.size(); ++k) {
      for (const PlanarPose &pose : {stations[k].pose, beside[k].value_or(stations[k].pose)}) {
        nodes_.push_back({pose, Heading::of(pose)});
      }
    }
  }

  const Node &node(std::size_t index) const { return nodes_[index]; }

  // What the path has on the way to station `to`.
  Edge kept(std::size_t to) const {
    const Station &a = stations_[to - 1], &b = stations_[to];
    Course course;
    course.price = b.sum.whole - a.sum.whole, course.first = course.last = pieces_[a.piece].direction();
    return {2 * to - 2, 2 * to, kKinds, true, true, course};
  }

  // An edge of a new curve, if there may be one, at the least that any curve would cost.
  std::optional<Edge> fresh(std::size_t from, std::size_t to) const {
    if (!moves(from, to)) return std::nullopt;
    Edge edge{from, to, 0, false, false, {}};
    const Limits limits = limits_of(edge);
    const Heading &a = nodes_[from].heading, &b = nodes_[to].heading;
    const double dx = b.x - a.x, dy = b.y - a.y, apart = std::sqrt(dx * dx + dy * dy);
    double least = apart;
    if (limits.changes == 0 && apart > kNothing) {
      // Somewhere on the way the robot drives as the straight line leads, so it turns by both angles to that in all.
      const double turn = (std::fabs(a.cos * dy - a.sin * dx) + std::fabs(b.cos * dy - b.sin * dx)) / apart;
      least += prices_.settings().curve_weight * turn / (kWide * model_.radius);
    }
    if (!(apart < limits.line && least < limits.whole)) return std::nullopt;
    edge.course.price = least, edge.course.first = limits.first, edge.course.last = limits.last;
    return edge;
  }

  // Makes the price of an edge surer, or higher: at first the least of the cheapest curve, then about what that costs, unless
  // this is above `most`. Where it cannot be driven the next kind of curve is looked for, and where there is none left the
  // price is infinite.
  void advance(Edge &edge, double most) const {
    if (edge.course.count == 0) {
      seek(edge);
    } else {
      settle(edge, most);
    }
  }

  // The next kind of curve: at first the cheapest of wide arcs, by the least that it can cost, then of the tightest.
  void seek(Edge &edge) const {
    const Limits limits = limits_of(edge);
    const Heading &begin = nodes_[edge.from].heading, &end = nodes_[edge.to].heading;
    const Station &a = stations_[edge.from / 2], &b = stations_[edge.to / 2];
    edge.course = Course{};
    edge.priced = false;
    while (edge.tries < kKinds && edge.course.count == 0) {
      const double radius = (edge.tries++ == 0 ? kWide : 1.0) * model_.radius;
      if (b.back == a.back) {
        for_each_smooth_curve(begin, end, radius,
                              [&](const Curve &curve) { keep_if_cheaper(edge.course, curve, radius, 1, limits); });
      } else if (b.forward == a.forward) {
        for_each_smooth_curve(begin.turned_round(), end.turned_round(), radius,
                              [&](const Curve &curve) { keep_if_cheaper(edge.course, curve, radius, -1, limits); });
      } else if (edge.tries == kKinds) {
        const double dx = end.x - begin.x, dy = end.y - begin.y;
        const double phi = std::atan2(begin.cos * end.sin - begin.sin * end.cos, begin.cos * end.cos + begin.sin * end.sin);
        for_each_reeds_shepp((begin.cos * dx + begin.sin * dy) / radius, (begin.cos * dy - begin.sin * dx) / radius, phi,
                             [&](const Curve &curve) { keep_if_cheaper(edge.course, curve, radius, 1, limits); });
      }
    }
  }

  // Whether a curve costs what it may, and the footprint has room.
  bool holds(Edge &edge, PoseChecker &checker) const {
    static constexpr float kNoWeights[256] = {};
    PlanarPose pose = nodes_[edge.from].pose;
    Heading at = nodes_[edge.from].heading;
    // The path is free at its poses, but may have less padding there than what is new.
    if (checker.touches(pose.x, pose.y, pose.yaw)) return false;
    double left = limits_of(edge).line, sum = 0.0;
    for (int i = 0; i < edge.course.count; ++i) {
      const Stretch &part = edge.course.parts[i];
      left -= prices_.line(at, part, left);
      if (!(left >= 0.0) || !checker.fits(pose, part, kNoWeights, 0.0, kInfinite, sum)) return false;
      pose = part.from(pose);
    }
    return edge.holds = true;
  }

 private:
  static constexpr int kKinds = 2;
  static constexpr double kNothing = 1e-9;
  static constexpr double kWide = 3.0;  // times the least radius; bends driven faster, tried first

  struct Limits {
    double line, whole;
    int changes, first, last;  // most changes of direction, and the directions in which it begins and ends
  };

  bool moves(std::size_t from, std::size_t to) const {
    const Station &a = stations_[from / 2], &b = stations_[to / 2];
    return a.forward != b.forward || a.back != b.back;
  }

  Limits limits_of(const Edge &edge) const {
    const Station &a = stations_[edge.from / 2], &b = stations_[edge.to / 2];
    std::size_t first = a.piece, last = b.piece - 1;
    while (pieces_[first].is_turn()) ++first;
    while (pieces_[last].is_turn()) --last;
    Limits limits{tolerance_ * (b.sum.line - a.sum.line), kInfinite, b.changes - a.changes, pieces_[first].direction(),
                  pieces_[last].direction()};
    if (edge.from % 2 == 0 && edge.to % 2 == 0) {
      // Between the same nodes nothing dearer than what there is can be in the cheapest chain.
      limits.whole = b.sum.whole - a.sum.whole + (limits.changes + 1) * model_.change_cost;
    }
    return limits;
  }

  // By the least that it can cost.
  void keep_if_cheaper(Course &best, const Curve &curve, double radius, int way, const Limits &limits) const {
    Course course;
    course.price = 0.0;
    double length = 0.0;
    int changes = 0;
    for (int i = 0; i < curve.count; ++i) {
      const CurvePiece &piece = curve.pieces[i];
      if (std::fabs(piece.length) < kNothing) continue;
      const Stretch part{way * piece.length * radius, piece.length * piece.steer};
      const int direction = part.length > 0.0 ? 1 : -1;
      if (course.last * direction < 0) ++changes, course.price += model_.change_cost;
      if (course.count == 0) course.first = direction;
      course.last = direction;
      course.price += prices_.least(part);
      length += std::fabs(part.length);
      course.parts[course.count++] = part;
    }
    if (course.count == 0 || changes > limits.changes || course.first != limits.first || course.last != limits.last) {
      return;
    }
    if (length < limits.line && course.price < std::min(limits.whole, best.price)) best = course;
  }

  void settle(Edge &edge, double most) const {
    const Limits limits = limits_of(edge);
    Course &course = edge.course;
    Heading at = nodes_[edge.from].heading;
    double line = 0.0, whole = course.price;  // what was not looked at yet with the least that it can cost
    for (int i = 0; i < course.count; ++i) {
      const Stretch &part = course.parts[i];
      const double length = std::fabs(part.length), dearer = prices_.dearer(part.length);
      const double left = limits.line - line, room = length + (most - whole) / dearer;
      const double sum = prices_.about(at, part, std::min(left, room));
      line += sum, whole += dearer * (sum - length);
      if (sum == kInfinite && room < left) {
        course.price = most + kNothing * (1.0 + most);
        return;
      }
      if (!(whole < limits.whole)) {
        seek(edge);
        return;
      }
    }
    course.price = whole, edge.priced = true;
  }

  const std::vector<Piece> &pieces_;
  const std::vector<Station> &stations_;
  const Prices &prices_;
  const MotionModel model_;
  const double tolerance_;
  std::vector<Node> nodes_;
};

}  // namespace trundle::smoothing
