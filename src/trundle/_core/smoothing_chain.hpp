// The cheapest chain of what a path has and of new curves between stations of it, on its course or beside it.
//
// Dynamic programming over the stations, each on its course and, where there is one, beside it, and over the direction
// in which the robot comes there. New curves are priced at once, and checked with the footprint only when they are in the
// cheapest chain; those that do not hold are left out and the chain is looked for again. What the path has always holds.
#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

#include "smoothing_pieces.hpp"

namespace trundle::smoothing {

class Chain {
 public:
  // `beside[k]` is another course's pose at station k, if it has one there; with none at all the path is only shortened.
  Chain(const std::vector<Piece> &pieces, const std::vector<Station> &stations,
        const std::vector<std::optional<PlanarPose>> &beside, const Prices &prices, double tolerance)
      : pieces_(pieces),
        stations_(stations),
        beside_(beside),
        prices_(prices),
        model_(prices.settings().model),
        tolerance_(1.0 + tolerance) {
    const bool shorten = std::none_of(beside.begin(), beside.end(), [](const auto &pose) { return pose.has_value(); });
    offsets_.push_back(0);
    offsets_.push_back(0);
    for (std::size_t to = 1; to < stations.size(); ++to) {
      add_kept(to);
      for (const int steps : {1, 2, 3, 4, 6, 8, 12, 16}) {
        if (static_cast<std::size_t>(steps) > to || (!shorten && steps > 8)) break;
        const std::size_t from = to - static_cast<std::size_t>(steps);
        if (shorten) {
          if (stations[to].bend - stations[from].bend > kStraight) add_new(from, 0, to, 0);
          continue;
        }
        if (beside[from] && beside[to]) add_new(from, 1, to, 1);
        if (steps % 2 != 0 || steps == 6) continue;
        if (beside[from]) add_new(from, 1, to, 0);
        if (beside[to]) add_new(from, 0, to, 1);
      }
      offsets_.push_back(edges_.size());
    }
    arrivals_.resize(2 * stations.size());
    arrivals_[0].price[1] = 0.0;
  }

  std::vector<Piece> cheapest(PoseChecker &checker) {
    std::size_t first = 1;
    while (true) {
      relax(first);
      const std::vector<std::size_t> chain = trace();
      first = stations_.size();
      for (const std::size_t index : chain) {
        Edge &edge = edges_[index];
        if (edge.holds || holds(edge, checker)) continue;
        if (!find_course(edge)) edge.course.price = kInfinite;
        first = std::min<std::size_t>(first, edge.to / 2);
      }
      if (first == stations_.size()) return pieces_of(chain);
    }
  }

 private:
  static constexpr double kStraight = 1e-6;  // [rad]
  static constexpr double kNothing = 1e-9;
  static constexpr double kWide = 3.0;  // times the least radius; bends driven faster, tried first

  struct Course {
    double price = kInfinite;
    int first = 0, last = 0;  // directions
    int count = 0;            // 0: what the path has
    Stretch parts[5];
  };

  // Nodes are two to a station: on the path's course, and beside it.
  struct Edge {
    std::size_t from, to;
    Course course;
    int tries;   // kinds of curves that were looked for
    bool holds;  // with the footprint
  };

  // The cheapest ways to a node by the direction of the last piece: backwards, standing, forward.
  struct Arrival {
    double price[3] = {kInfinite, kInfinite, kInfinite};
    std::size_t edge[3] = {};
    int before[3] = {};
  };

  const PlanarPose &pose(std::size_t node) const {
    return node % 2 == 0 ? stations_[node / 2].pose : *beside_[node / 2];
  }

  void add_kept(std::size_t to) {
    const Station &a = stations_[to - 1], &b = stations_[to];
    const int direction = pieces_[a.piece].direction();
    Course course;
    course.price = b.sum.whole - a.sum.whole, course.first = course.last = direction;
    edges_.push_back({2 * to - 2, 2 * to, course, 2, true});
  }

  void add_new(std::size_t from, int from_beside, std::size_t to, int to_beside) {
    Edge edge{2 * from + static_cast<std::size_t>(from_beside), 2 * to + static_cast<std::size_t>(to_beside), {}, 0, false};
    if (find_course(edge)) edges_.push_back(edge);
  }

  struct Limits {
    double line, whole;
    int changes, first, last;  // most changes of direction, and the directions in which it begins and ends
  };

  int first_direction(std::size_t piece) const {
    while (pieces_[piece].is_turn()) ++piece;
    return pieces_[piece].direction();
  }
  int last_direction(std::size_t piece) const {
    while (pieces_[piece].is_turn()) --piece;
    return pieces_[piece].direction();
  }

  // The cheapest curve of an edge, of wide arcs where there is one; asked again, of the tightest.
  bool find_course(Edge &edge) const {
    const Station &a = stations_[edge.from / 2], &b = stations_[edge.to / 2];
    const int forward = b.forward - a.forward, back = b.back - a.back;
    if (forward + back == 0) return false;
    Limits limits{tolerance_ * (b.sum.line - a.sum.line), kInfinite, b.changes - a.changes, first_direction(a.piece),
                  last_direction(b.piece - 1)};
    if (edge.from % 2 == 0 && edge.to % 2 == 0) {
      // Between the same nodes nothing dearer than what there is can be in the cheapest chain.
      limits.whole = b.sum.whole - a.sum.whole + (limits.changes + 1) * model_.change_cost;
    }
    const PlanarPose &start = pose(edge.from), &end = pose(edge.to);
    const Heading begin = Heading::of(start);
    const double dx = end.x - start.x, dy = end.y - start.y;
    const double x = begin.cos * dx + begin.sin * dy, y = begin.cos * dy - begin.sin * dx;
    if (std::hypot(x, y) >= limits.line) return false;
    const double phi = wrap(std::remainder(end.yaw - start.yaw, 2.0 * kPi));
    while (edge.tries < 2) {
      const double radius = (edge.tries++ == 0 ? kWide : 1.0) * model_.radius;
      const int way = forward > 0 ? 1 : -1;
      edge.course = Course{};
      if (forward == 0 || back == 0) {
        for_each_dubins<false>(way * x / radius, way * y / radius, phi,
                               [&](const Curve &curve) { keep_if_cheaper(edge.course, curve, radius, way, limits); });
      } else if (edge.tries == 2) {
        for_each_reeds_shepp(x / radius, y / radius, phi,
                             [&](const Curve &curve) { keep_if_cheaper(edge.course, curve, radius, 1, limits); });
      }
      if (edge.course.count > 0 && price(edge.course, begin, limits)) return true;
    }
    return false;
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

  bool price(Course &course, Heading from, const Limits &limits) const {
    double line = 0.0, whole = 0.0;
    int last = course.first;
    for (int i = 0; i < course.count; ++i) {
      const Stretch &part = course.parts[i];
      const Price price = prices_.of(from, part, limits.line - line);
      const int direction = part.length > 0.0 ? 1 : -1;
      line += price.line, whole += price.whole + (direction != last ? model_.change_cost : 0.0);
      if (!(line <= limits.line && whole < limits.whole)) return false;
      last = direction;
      from = from.go(part);
    }
    course.price = whole;
    return true;
  }

  void relax(std::size_t first) {
    for (std::size_t k = first; k < stations_.size(); ++k) {
      arrivals_[2 * k] = arrivals_[2 * k + 1] = Arrival{};
      for (std::size_t index = offsets_[k]; index < offsets_[k + 1]; ++index) {
        const Edge &edge = edges_[index];
        const Course &course = edge.course;
        if (course.price == kInfinite) continue;
        const Arrival &before = arrivals_[edge.from];
        Arrival &there = arrivals_[edge.to];
        for (int d = 0; d < 3; ++d) {
          const double price = before.price[d] + course.price + ((d - 1) * course.first < 0 ? model_.change_cost : 0.0);
          const int last = course.last + 1;
          if (!(price < there.price[last])) continue;
          there.price[last] = price, there.edge[last] = index, there.before[last] = d;
        }
      }
    }
  }

  std::vector<std::size_t> trace() const {
    std::size_t node = 2 * (stations_.size() - 1);
    const Arrival &end = arrivals_[node];
    int d = static_cast<int>(std::min_element(end.price, end.price + 3) - end.price);
    std::vector<std::size_t> chain;
    while (node != 0) {
      const Arrival &here = arrivals_[node];
      chain.push_back(here.edge[d]);
      node = edges_[chain.back()].from;
      d = here.before[d];
    }
    std::reverse(chain.begin(), chain.end());
    return chain;
  }

  bool holds(Edge &edge, PoseChecker &checker) const {
    PlanarPose at = pose(edge.from);
    double sum = 0.0;
    for (int i = 0; i < edge.course.count; ++i) {
      const Stretch &part = edge.course.parts[i];
      if (!checker.fits(at, part, prices_.fresh(), 0.0, kInfinite, sum)) return false;
      at = part.from(at);
    }
    return edge.holds = true;
  }

  std::vector<Piece> pieces_of(const std::vector<std::size_t> &chain) const {
    std::vector<Piece> out;
    for (const std::size_t index : chain) {
      const Edge &edge = edges_[index];
      const Course &course = edge.course;
      if (course.count == 0) {
        const std::size_t k = edge.to / 2;
        out.insert(out.end(), pieces_.begin() + static_cast<std::ptrdiff_t>(stations_[k - 1].piece),
                   pieces_.begin() + static_cast<std::ptrdiff_t>(stations_[k].piece));
        continue;
      }
      PlanarPose at = pose(edge.from);
      for (int i = 0; i < course.count; ++i) {
        const PlanarPose next = i + 1 == course.count ? pose(edge.to) : course.parts[i].from(at);
        out.push_back({at, next, course.parts[i], -1});
        at = next;
      }
    }
    return out;
  }

  const std::vector<Piece> &pieces_;
  const std::vector<Station> &stations_;
  const std::vector<std::optional<PlanarPose>> &beside_;
  const Prices &prices_;
  const MotionModel model_;
  const double tolerance_;
  std::vector<Edge> edges_;            // by the station that they lead to
  std::vector<std::size_t> offsets_;   // of the first edge to each station
  std::vector<Arrival> arrivals_;
};

}  // namespace trundle::smoothing
