// The cheapest chain of what a path has and of new curves between stations of it, on its course or beside it.
//
// Dynamic programming over the stations, each on its course and, where there is one, beside it, and over the direction
// in which the robot comes there. A new curve counts with the least that it can cost until it is the cheapest way to a
// station, then with what samples say; what it does cost, and whether the footprint has room, is looked at only when it is
// in the cheapest chain. Those that do not hold are left out and the chain is looked for again. What the path has always
// holds.
#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

#include "smoothing_curves.hpp"
#include "smoothing_pieces.hpp"

namespace trundle::smoothing {

class Chain {
 public:
  // `beside[k]` is another course's pose at station k, if it has one there; with none at all the path is only shortened.
  Chain(const std::vector<Piece> &pieces, const std::vector<Station> &stations,
        const std::vector<std::optional<PlanarPose>> &beside, const Prices &prices, double tolerance)
      : pieces_(pieces), stations_(stations), prices_(prices), model_(prices.settings().model), tolerance_(1.0 + tolerance) {
    for (std::size_t k = 0; k < stations.size(); ++k) {
      for (const PlanarPose &pose : {stations[k].pose, beside[k].value_or(stations[k].pose)}) {
        nodes_.push_back({pose, Heading::of(pose)});
      }
    }
    const bool shorten = std::none_of(beside.begin(), beside.end(), [](const auto &pose) { return pose.has_value(); });
    offsets_.assign(2, 0);
    edges_.reserve(12 * stations.size());
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
        seek(edge);
        first = std::min<std::size_t>(first, edge.to / 2);
      }
      if (first == stations_.size()) return pieces_of(chain);
    }
  }

 private:
  static constexpr double kStraight = 1e-6;  // [rad]
  static constexpr double kNothing = 1e-9;
  static constexpr float kNoWeights[256] = {};
  static constexpr double kWide = 3.0;  // times the least radius; bends driven faster, tried first

  struct Course {
    double price = kInfinite;
    int first = 0, last = 0;  // directions
    int count = 0;            // 0: what the path has
    Stretch parts[5];
  };

  // Two to a station: on the path's course, and beside it.
  struct Node {
    PlanarPose pose;
    Heading heading;
  };

  struct Edge {
    std::size_t from, to;  // nodes
    Course course;
    int tries;    // kinds of curves that were looked for
    bool priced;  // or the price is the least that it can be
    bool holds;   // at what it does cost, with the footprint
  };

  // The cheapest ways to a node by the direction of the last piece: backwards, standing, forward.
  struct Arrival {
    double price[3] = {kInfinite, kInfinite, kInfinite};
    std::size_t edge[3] = {};
    int before[3] = {};
  };

  // An edge to the station that is looked at, with the cheapest way to its beginning.
  struct Candidate {
    std::size_t edge;
    double price;  // up to there, with a change of direction there
    int before;
  };

  void add_kept(std::size_t to) {
    const Station &a = stations_[to - 1], &b = stations_[to];
    const int direction = pieces_[a.piece].direction();
    Course course;
    course.price = b.sum.whole - a.sum.whole, course.first = course.last = direction;
    edges_.push_back({2 * to - 2, 2 * to, course, 2, true, true});
  }

  void add_new(std::size_t from, int from_beside, std::size_t to, int to_beside) {
    Edge edge{2 * from + static_cast<std::size_t>(from_beside), 2 * to + static_cast<std::size_t>(to_beside), {}, 0, false,
              false};
    if (seek(edge)) edges_.push_back(edge);
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

  Limits limits_of(const Edge &edge) const {
    const Station &a = stations_[edge.from / 2], &b = stations_[edge.to / 2];
    Limits limits{tolerance_ * (b.sum.line - a.sum.line), kInfinite, b.changes - a.changes, first_direction(a.piece),
                  last_direction(b.piece - 1)};
    if (edge.from % 2 == 0 && edge.to % 2 == 0) {
      // Between the same nodes nothing dearer than what there is can be in the cheapest chain.
      limits.whole = b.sum.whole - a.sum.whole + (limits.changes + 1) * model_.change_cost;
    }
    return limits;
  }

  // The cheapest curve of an edge by the least that it can cost, of wide arcs where there is one; asked again, of the
  // tightest, and then none.
  bool seek(Edge &edge) const {
    const Station &a = stations_[edge.from / 2], &b = stations_[edge.to / 2];
    const int forward = b.forward - a.forward, back = b.back - a.back;
    edge.course = Course{};
    edge.priced = false;
    if (forward + back == 0) return false;
    const Limits limits = limits_of(edge);
    const Heading &begin = nodes_[edge.from].heading, &end = nodes_[edge.to].heading;
    const double dx = end.x - begin.x, dy = end.y - begin.y;
    if (dx * dx + dy * dy >= limits.line * limits.line) return false;
    while (edge.tries < 2) {
      const double radius = (edge.tries++ == 0 ? kWide : 1.0) * model_.radius;
      if (forward == 0 || back == 0) {
        const int way = forward > 0 ? 1 : -1;
        for_each_smooth_curve(way > 0 ? begin : begin.turned_round(), way > 0 ? end : end.turned_round(), radius,
                              [&](const Curve &curve) { keep_if_cheaper(edge.course, curve, radius, way, limits); });
      } else if (edge.tries == 2) {
        const double phi = std::atan2(begin.cos * end.sin - begin.sin * end.cos, begin.cos * end.cos + begin.sin * end.sin);
        for_each_reeds_shepp((begin.cos * dx + begin.sin * dy) / radius, (begin.cos * dy - begin.sin * dx) / radius, phi,
                             [&](const Curve &curve) { keep_if_cheaper(edge.course, curve, radius, 1, limits); });
      }
      if (edge.course.count > 0) return true;
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

  // About what the curve of an edge costs; where that is too much, the next one's least.
  void settle(Edge &edge) const {
    const Limits limits = limits_of(edge);
    Course &course = edge.course;
    Heading at = nodes_[edge.from].heading;
    double line = 0.0, whole = 0.0;
    int last = course.first;
    for (int i = 0; i < course.count; ++i) {
      const Stretch &part = course.parts[i];
      const Price price = prices_.about(at, part, limits.line - line);
      const int direction = part.length > 0.0 ? 1 : -1;
      line += price.line, whole += price.whole + (direction != last ? model_.change_cost : 0.0);
      if (!(line <= limits.line && whole < limits.whole)) {
        seek(edge);
        return;
      }
      last = direction;
    }
    course.price = whole, edge.priced = true;
  }

  void relax(std::size_t first) {
    for (std::size_t k = first; k < stations_.size(); ++k) {
      candidates_.clear();
      for (std::size_t index = offsets_[k]; index < offsets_[k + 1]; ++index) {
        const Edge &edge = edges_[index];
        const Arrival &before = arrivals_[edge.from];
        Candidate best{index, kInfinite, 0};
        for (int d = 0; d < 3; ++d) {
          const double price = before.price[d] + ((d - 1) * edge.course.first < 0 ? model_.change_cost : 0.0);
          if (price < best.price) best.price = price, best.before = d;
        }
        if (best.price < kInfinite) candidates_.push_back(best);
      }
      while (!arrive(k)) {
      }
    }
  }

  // The cheapest ways to a station; false where one of them had to be priced for that.
  bool arrive(std::size_t k) {
    arrivals_[2 * k] = arrivals_[2 * k + 1] = Arrival{};
    for (const Candidate &candidate : candidates_) {
      const Edge &edge = edges_[candidate.edge];
      const int last = edge.course.last + 1;
      const double price = candidate.price + edge.course.price;
      Arrival &there = arrivals_[edge.to];
      if (!(price < there.price[last])) continue;
      there.price[last] = price, there.edge[last] = candidate.edge, there.before[last] = candidate.before;
    }
    bool done = true;
    for (const std::size_t node : {2 * k, 2 * k + 1}) {
      for (int d = 0; d < 3; ++d) {
        Edge &edge = edges_[arrivals_[node].edge[d]];
        if (arrivals_[node].price[d] == kInfinite || edge.priced) continue;
        settle(edge);
        done = false;
      }
    }
    return done;
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
    PlanarPose pose = nodes_[edge.from].pose;
    Heading at = nodes_[edge.from].heading;
    double left = limits_of(edge).line, sum = 0.0;
    for (int i = 0; i < edge.course.count; ++i) {
      const Stretch &part = edge.course.parts[i];
      left -= prices_.line(at, part, left);
      if (!(left >= 0.0) || !checker.fits(pose, part, kNoWeights, 0.0, kInfinite, sum)) return false;
      pose = part.from(pose);
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
      PlanarPose at = nodes_[edge.from].pose;
      for (int i = 0; i < course.count; ++i) {
        const PlanarPose next = i + 1 == course.count ? nodes_[edge.to].pose : course.parts[i].from(at);
        out.push_back({at, next, course.parts[i], -1});
        at = next;
      }
    }
    return out;
  }

  const std::vector<Piece> &pieces_;
  const std::vector<Station> &stations_;
  const Prices &prices_;
  const MotionModel model_;
  const double tolerance_;
  std::vector<Node> nodes_;
  std::vector<Edge> edges_;            // by the station that they lead to
  std::vector<std::size_t> offsets_;   // of the first edge to each station
  std::vector<Arrival> arrivals_;
  std::vector<Candidate> candidates_;
};

}  // namespace trundle::smoothing
