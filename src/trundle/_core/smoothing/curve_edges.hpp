// Edges of the lazy chain: new curves between nodes on a path and on the band beside it, and what they cost.
//
// An edge's cost is refined in steps, each only when it is asked for: the least that any curve between its ends can
// cost; the least that its cheapest curve can cost; about what that curve costs, by samples; and whether it holds,
// exactly, with the footprint. There are two kinds of curves: of wide arcs first, which can be driven faster, then of
// the tightest.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "smoothing/arc_line_arc.hpp"
#include "smoothing/pieces.hpp"

namespace trundle::smoothing {

struct CandidateCurve {
  double cost = kInfinite;
  int first = 0, last = 0;  // directions
  int count = 0;            // of parts; 0: the path's own pieces, or not looked for yet
  Segment parts[5];
};

// Two to a station: on the path, and on the band.
struct Node {
  PlanarPose pose;
  Heading heading;
};

struct Edge {
  std::size_t from, to;  // nodes
  int kinds_tried;       // of curves
  bool is_sampled;       // or the cost is a lower bound
  bool is_checked;       // the curve holds: it costs what it may, and the footprint has room
  CandidateCurve curve;
};

class CurveEdges {
 public:
  CurveEdges(const std::vector<Piece> &pieces, const std::vector<Station> &stations,
             const std::vector<std::optional<PlanarPose>> &band, const CostModel &costs, double tolerance)
      : pieces_(pieces),
        stations_(stations),
        costs_(costs),
        model_(costs.settings().model),
        allowed_(1.0 + tolerance) {
    nodes_.reserve(2 * stations.size());
    for (std::size_t k = 0; k < stations.size(); ++k) {
      for (const PlanarPose &pose : {stations[k].pose, band[k].value_or(stations[k].pose)}) {
        nodes_.push_back({pose, Heading::of(pose)});
      }
    }
  }

  const Node &node(std::size_t index) const { return nodes_[index]; }

  // The path's own pieces to a station from the one before.
  Edge own_pieces(std::size_t to) const {
    const Station &a = stations_[to - 1], &b = stations_[to];
    CandidateCurve curve;
    curve.cost = b.sum.total - a.sum.total, curve.first = curve.last = pieces_[a.piece].direction();
    return {2 * to - 2, 2 * to, kKinds, true, true, curve};
  }

  // An edge of a new curve, at the least that any curve would cost; none where no curve can be cheap enough.
  std::optional<Edge> candidate(std::size_t from, std::size_t to) const {
    if (!is_driven(from, to)) return std::nullopt;
    Edge edge{from, to, 0, false, false, {}};
    const Limits limits = limits_of(edge);
    const Heading &a = nodes_[from].heading, &b = nodes_[to].heading;
    const double dx = b.x - a.x, dy = b.y - a.y, apart = std::sqrt(dx * dx + dy * dy);
    double least = apart;
    if (limits.changes == 0 && apart > kNothing) {
      // Somewhere between, the robot drives along the straight line's direction, so it turns by both angles to that in
      // all.
      const double turn = (std::fabs(a.cos * dy - a.sin * dx) + std::fabs(b.cos * dy - b.sin * dx)) / apart;
      least += costs_.settings().curve_weight * turn / (kWide * model_.radius);
    }
    if (!(apart < limits.line && least < limits.total)) return std::nullopt;
    edge.curve.cost = least, edge.curve.first = limits.first, edge.curve.last = limits.last;
    return edge;
  }

  // Refines an edge's cost by one step. Sampling ends above `most`: the cost stays a lower bound then.
  void refine(Edge &edge, double most) const {
    if (edge.curve.count == 0) {
      try_next_kind(edge);
    } else {
      sample(edge, most);
    }
  }

  // Replaces the curve by the cheapest one of the next kind that has one, at the least that it can cost; by none, at
  // infinity, where no kind is left.
  void try_next_kind(Edge &edge) const {
    const Limits limits = limits_of(edge);
    edge.curve = CandidateCurve{};
    edge.is_sampled = false;
    while (edge.kinds_tried < kKinds && edge.curve.count == 0) {
      const double radius = (edge.kinds_tried++ == 0 ? kWide : 1.0) * model_.radius;
      find_cheapest(edge, radius, limits);
    }
  }

  // Whether an edge's curve costs what it may, exactly, and the footprint has room along it.
  bool check(Edge &edge, PoseChecker &checker) const {
    static constexpr float kNoWeights[256] = {};
    PlanarPose pose = nodes_[edge.from].pose;
    Heading at = nodes_[edge.from].heading;
    // The path is free at its poses, but may have less padding there than a new curve needs.
    if (checker.touches(pose.x, pose.y, pose.yaw)) return false;
    double left = limits_of(edge).line, sum = 0.0;
    for (int i = 0; i < edge.curve.count; ++i) {
      const Segment &part = edge.curve.parts[i];
      left -= costs_.line(at, part, left);
      if (!(left >= 0.0) || !checker.fits(pose, part, kNoWeights, 0.0, kInfinite, sum)) return false;
      pose = part.from(pose);
    }
    return edge.is_checked = true;
  }

 private:
  static constexpr int kKinds = 2;
  static constexpr double kNothing = 1e-9;
  static constexpr double kWide = 3.0;  // radius of wide arcs over the tightest

  // What a curve may be to replace the path between its stations.
  struct Limits {
    double line, total;
    int changes, first, last;  // most changes of direction, and the directions in which it begins and ends
  };

  // Whether the robot drives between two nodes, and does not only turn in place.
  bool is_driven(std::size_t from, std::size_t to) const {
    const Station &a = stations_[from / 2], &b = stations_[to / 2];
    return a.forward != b.forward || a.back != b.back;
  }

  Limits limits_of(const Edge &edge) const {
    const Station &a = stations_[edge.from / 2], &b = stations_[edge.to / 2];
    std::size_t first = a.piece, last = b.piece - 1;
    while (pieces_[first].is_turn()) ++first;
    while (pieces_[last].is_turn()) --last;
    Limits limits{allowed_ * (b.sum.line - a.sum.line), kInfinite, b.changes - a.changes, pieces_[first].direction(),
                  pieces_[last].direction()};
    if (edge.from % 2 == 0 && edge.to % 2 == 0) {
      // Between nodes on the path, nothing that costs more than the path's own pieces is in the cheapest chain.
      limits.total = b.sum.total - a.sum.total + (limits.changes + 1) * model_.change_cost;
    }
    return limits;
  }

  // The cheapest curve of arcs of a radius. Where the path changes direction it is a Reeds-Shepp curve, of the tightest
  // arcs alone.
  void find_cheapest(Edge &edge, double radius, const Limits &limits) const {
    const Heading &begin = nodes_[edge.from].heading, &end = nodes_[edge.to].heading;
    const Station &a = stations_[edge.from / 2], &b = stations_[edge.to / 2];
    const auto keep = [&](const Curve &curve, int direction) {
      keep_if_cheaper(edge.curve, curve, radius, direction, limits);
    };
    if (b.back == a.back) {
      for_each_smooth_curve(begin, end, radius, [&](const Curve &curve) { keep(curve, 1); });
    } else if (b.forward == a.forward) {
      for_each_smooth_curve(begin.reversed(), end.reversed(), radius, [&](const Curve &curve) { keep(curve, -1); });
    } else if (edge.kinds_tried == kKinds) {
      const double dx = end.x - begin.x, dy = end.y - begin.y;
      const double phi = std::atan2(begin.cos * end.sin - begin.sin * end.cos, begin.cos * end.cos + begin.sin * end.sin);
      for_each_reeds_shepp((begin.cos * dx + begin.sin * dy) / radius, (begin.cos * dy - begin.sin * dx) / radius, phi,
                           [&](const Curve &curve) { keep(curve, 1); });
    }
  }

  // Compares the least that the curves can cost.
  void keep_if_cheaper(CandidateCurve &best, const Curve &curve, double radius, int sign, const Limits &limits) const {
    CandidateCurve candidate;
    candidate.cost = 0.0;
    double length = 0.0;
    int changes = 0;
    for (int i = 0; i < curve.count; ++i) {
      const CurvePiece &piece = curve.pieces[i];
      if (std::fabs(piece.length) < kNothing) continue;
      const Segment part{sign * piece.length * radius, piece.length * piece.steer};
      const int direction = part.length > 0.0 ? 1 : -1;
      if (candidate.last * direction < 0) ++changes, candidate.cost += model_.change_cost;
      if (candidate.count == 0) candidate.first = direction;
      candidate.last = direction;
      candidate.cost += costs_.lower_bound(part);
      length += std::fabs(part.length);
      candidate.parts[candidate.count++] = part;
    }
    const bool has_room = changes <= limits.changes && length < limits.line;
    const bool fits_ends = candidate.first == limits.first && candidate.last == limits.last;
    if (candidate.count == 0 || !has_room || !fits_ends) return;
    if (candidate.cost < std::min(limits.total, best.cost)) best = candidate;
  }

  void sample(Edge &edge, double most) const {
    const Limits limits = limits_of(edge);
    CandidateCurve &curve = edge.curve;
    Heading at = nodes_[edge.from].heading;
    double line = 0.0, total = curve.cost;  // parts that are not sampled yet count with the least that they can cost
    for (int i = 0; i < curve.count; ++i) {
      const Segment &part = curve.parts[i];
      const double length = std::fabs(part.length), factor = costs_.driving_factor(part.length);
      const double left = limits.line - line, room = length + (most - total) / factor;
      const double sum = costs_.sampled_line(at, part, std::min(left, room));
      line += sum, total += factor * (sum - length);
      if (sum == kInfinite && room < left) {  // above `most`
        curve.cost = most + kNothing * (1.0 + most);
        return;
      }
      if (!(total < limits.total)) {
        try_next_kind(edge);
        return;
      }
    }
    curve.cost = total, edge.is_sampled = true;
  }

  const std::vector<Piece> &pieces_;
  const std::vector<Station> &stations_;
  const CostModel &costs_;
  const MotionModel model_;
  const double allowed_;  // share of the path's line integral
  std::vector<Node> nodes_;
};

}  // namespace trundle::smoothing
