// The cheapest chain of a path's own pieces and of new curves between its stations: a lazy shortest path.
//
// The graph: each station has a node on the path and, where an elastic band leads beside it, one on the band. Edges
// lead from node to node: the path's own pieces from a station to the next, and new curves that skip some stations. As
// a change of direction costs something, a node has a label for each direction in which the robot arrives there.
//
// Idea (lazy search: Dellin and Srinivasa 2016): to cost a curve exactly, and to check the footprint along it, takes
// far longer than the search. So an edge begins with a lower bound, is sampled when it is the best to its node by that,
// and is checked exactly when it is in the cheapest chain. One that fails is replaced by its next kind of curve, or
// removed, and the stations from it on are relaxed again.
//
// Invariants: an edge's cost is a lower bound until it is sampled, so no cheaper chain is overlooked by what was
// sampled. Stations are in order, so one pass of dynamic programming relaxes all. The path's own pieces always hold, so
// there is always a chain; and every edge has finitely many kinds of curves, so the search ends.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <vector>

#include "smoothing/curve_edges.hpp"

namespace trundle::smoothing {

class LazyChain {
 public:
  // `band[k]` is the elastic band's pose at station k, if it has one there. With none at all, the path is only
  // shortened.
  LazyChain(const std::vector<Piece> &pieces, const std::vector<Station> &stations,
            const std::vector<std::optional<PlanarPose>> &band, const CostModel &costs, double tolerance)
      : pieces_(pieces),
        stations_(stations),
        change_cost_(costs.settings().model.change_cost),
        curves_(pieces, stations, band, costs, tolerance) {
    const bool has_band = std::any_of(band.begin(), band.end(), [](const auto &pose) { return pose.has_value(); });
    first_edges_.assign(2, 0);
    edges_.reserve(12 * stations.size());
    for (std::size_t to = 1; to < stations.size(); ++to) {
      edges_.push_back(curves_.own_pieces(to));
      if (has_band) {
        add_curves_along_band(to, band);
      } else {
        add_shortcuts(to);
      }
      first_edges_.push_back(edges_.size());
    }
    labels_.resize(2 * stations.size());
    labels_[0].cost[1] = 0.0;
  }

  std::vector<Piece> find(PoseChecker &checker) {
    std::size_t changed = 1;
    while (true) {
      relax_from(changed);
      const std::vector<std::size_t> chain = trace();
      changed = check(chain, checker);
      if (changed == stations_.size()) return pieces_of(chain);
    }
  }

 private:
  static constexpr double kStraight = 1e-6;  // [rad]
  static constexpr int kDirections = 3;      // backward, standing and forward: -1, 0 and 1, plus 1

  // The cheapest chains to a node, by the direction of their last piece.
  struct Label {
    double cost[kDirections] = {kInfinite, kInfinite, kInfinite};
    std::size_t edge[kDirections] = {};
    int before[kDirections] = {};  // direction of the label that the edge comes from
  };

  // An edge to the station being relaxed, with the cheapest chain to where it begins.
  struct Candidate {
    std::size_t edge;
    double cost_before;  // with that of a change of direction there
    int before;
  };

  static std::size_t on_path(std::size_t station) { return 2 * station; }
  static std::size_t on_band(std::size_t station) { return 2 * station + 1; }
  static std::size_t station_of(std::size_t node) { return node / 2; }

  void add_shortcuts(std::size_t to) {
    for (const std::size_t steps : {1, 2, 3, 4, 6, 8, 12, 16}) {
      if (steps > to) break;
      const std::size_t from = to - steps;
      if (stations_[to].bend - stations_[from].bend > kStraight) add_curve(on_path(from), on_path(to));
    }
  }

  void add_curves_along_band(std::size_t to, const std::vector<std::optional<PlanarPose>> &band) {
    for (const std::size_t steps : {1, 2, 3, 4, 6, 8}) {
      if (steps > to) break;
      const std::size_t from = to - steps;
      if (band[from] && band[to]) add_curve(on_band(from), on_band(to));
      if (steps % 2 != 0 || steps == 6) continue;
      if (band[from]) add_curve(on_band(from), on_path(to));
      if (band[to]) add_curve(on_path(from), on_band(to));
    }
  }

  void add_curve(std::size_t from, std::size_t to) {
    if (const std::optional<Edge> edge = curves_.candidate(from, to)) edges_.push_back(*edge);
  }

  void relax_from(std::size_t first) {
    for (std::size_t station = first; station < stations_.size(); ++station) {
      find_candidates(station);
      do {
        relax(station);
      } while (sample_best(station));
    }
  }

  void find_candidates(std::size_t station) {
    candidates_.clear();
    for (std::size_t index = first_edges_[station]; index < first_edges_[station + 1]; ++index) {
      const Edge &edge = edges_[index];
      const Label &from = labels_[edge.from];
      Candidate best{index, kInfinite, 0};
      for (int d = 0; d < kDirections; ++d) {
        const double cost = from.cost[d] + ((d - 1) * edge.curve.first < 0 ? change_cost_ : 0.0);
        if (cost < best.cost_before) best.cost_before = cost, best.before = d;
      }
      if (best.cost_before < kInfinite) candidates_.push_back(best);
    }
  }

  // The labels of a station's two nodes, by what its edges are known to cost.
  void relax(std::size_t station) {
    Label *const labels = &labels_[on_path(station)];
    labels[0] = labels[1] = Label{};
    for (const Candidate &candidate : candidates_) {
      const Edge &edge = edges_[candidate.edge];
      Label &label = labels_[edge.to];
      const int d = edge.curve.last + 1;
      const double cost = candidate.cost_before + edge.curve.cost;
      if (!(cost < label.cost[d])) continue;
      label.cost[d] = cost, label.edge[d] = candidate.edge, label.before[d] = candidate.before;
    }
  }

  // Samples the edges of a station's labels that are lower bounds; whether there was one.
  bool sample_best(std::size_t station) {
    double sampled[2][kDirections];  // the least cost by edges that are sampled
    find_sampled(sampled);
    bool any = false;
    for (const std::size_t node : {on_path(station), on_band(station)}) {
      for (int d = 0; d < kDirections; ++d) {
        Edge &edge = edges_[labels_[node].edge[d]];
        const double cost = labels_[node].cost[d];
        if (cost == kInfinite || edge.is_sampled) continue;
        // Above this another edge is cheaper.
        curves_.refine(edge, sampled[node % 2][d] - (cost - edge.curve.cost));
        any = true;
      }
    }
    return any;
  }

  void find_sampled(double (&least)[2][kDirections]) const {
    for (auto &of_node : least) std::fill_n(of_node, kDirections, kInfinite);
    for (const Candidate &candidate : candidates_) {
      const Edge &edge = edges_[candidate.edge];
      if (!edge.is_sampled) continue;
      double &known = least[edge.to % 2][edge.curve.last + 1];
      known = std::min(known, candidate.cost_before + edge.curve.cost);
    }
  }

  // The edges of the cheapest chain to the path's end.
  std::vector<std::size_t> trace() const {
    std::size_t node = on_path(stations_.size() - 1);
    const Label &end = labels_[node];
    int d = static_cast<int>(std::min_element(end.cost, end.cost + kDirections) - end.cost);
    std::vector<std::size_t> chain;
    while (node != 0) {
      const Label &here = labels_[node];
      chain.push_back(here.edge[d]);
      node = edges_[chain.back()].from;
      d = here.before[d];
    }
    std::reverse(chain.begin(), chain.end());
    return chain;
  }

  // Checks the edges of a chain. Those that fail get their next kind of curve; the first station that one of them leads
  // to is returned, or the number of stations.
  std::size_t check(const std::vector<std::size_t> &chain, PoseChecker &checker) {
    std::size_t changed = stations_.size();
    for (const std::size_t index : chain) {
      Edge &edge = edges_[index];
      if (edge.is_checked || curves_.check(edge, checker)) continue;
      curves_.try_next_kind(edge);
      changed = std::min<std::size_t>(changed, station_of(edge.to));
    }
    return changed;
  }

  std::vector<Piece> pieces_of(const std::vector<std::size_t> &chain) const {
    std::vector<Piece> out;
    for (const std::size_t index : chain) {
      const Edge &edge = edges_[index];
      const CandidateCurve &curve = edge.curve;
      if (curve.count == 0) {
        const std::size_t k = station_of(edge.to);
        out.insert(out.end(), pieces_.begin() + static_cast<std::ptrdiff_t>(stations_[k - 1].piece),
                   pieces_.begin() + static_cast<std::ptrdiff_t>(stations_[k].piece));
        continue;
      }
      PlanarPose at = curves_.node(edge.from).pose;
      for (int i = 0; i < curve.count; ++i) {
        const PlanarPose next = i + 1 == curve.count ? curves_.node(edge.to).pose : curve.parts[i].from(at);
        out.push_back({at, next, curve.parts[i], -1});
        at = next;
      }
    }
    return out;
  }

  const std::vector<Piece> &pieces_;
  const std::vector<Station> &stations_;
  const double change_cost_;
  const CurveEdges curves_;
  std::vector<Edge> edges_;               // by the station that they lead to
  std::vector<std::size_t> first_edges_;  // to each station
  std::vector<Label> labels_;             // by node
  std::vector<Candidate> candidates_;
};

}  // namespace trundle::smoothing
