// The cheapest chain of what a path has and of new curves between stations of it, on its course or beside it.
//
// Dynamic programming over the stations, each on its course and, where there is one, beside it, and over the direction
// in which the robot comes there. A new curve counts with the least that it can cost until it is the cheapest way to a
// station, then with what samples say; what it does cost, and whether the footprint has room, is looked at only when it is
// in the cheapest chain. Those that do not hold are left out and the chain is looked for again. What the path has always
// holds.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <vector>

#include "smoothing/edges.hpp"

namespace trundle::smoothing {

class Chain {
 public:
  // `beside[k]` is another course's pose at station k, if it has one there; with none at all the path is only shortened.
  Chain(const std::vector<Piece> &pieces, const std::vector<Station> &stations,
        const std::vector<std::optional<PlanarPose>> &beside, const Prices &prices, double tolerance)
      : pieces_(pieces),
        stations_(stations),
        change_cost_(prices.settings().model.change_cost),
        fresh_(pieces, stations, beside, prices, tolerance) {
    const bool shorten = std::none_of(beside.begin(), beside.end(), [](const auto &pose) { return pose.has_value(); });
    offsets_.assign(2, 0);
    edges_.reserve(12 * stations.size());
    for (std::size_t to = 1; to < stations.size(); ++to) {
      edges_.push_back(fresh_.kept(to));
      for (const int steps : {1, 2, 3, 4, 6, 8, 12, 16}) {
        if (static_cast<std::size_t>(steps) > to || (!shorten && steps > 8)) break;
        const std::size_t from = to - static_cast<std::size_t>(steps);
        if (shorten) {
          if (stations[to].bend - stations[from].bend > kStraight) add(2 * from, 2 * to);
          continue;
        }
        if (beside[from] && beside[to]) add(2 * from + 1, 2 * to + 1);
        if (steps % 2 != 0 || steps == 6) continue;
        if (beside[from]) add(2 * from + 1, 2 * to);
        if (beside[to]) add(2 * from, 2 * to + 1);
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
        if (edge.holds || fresh_.holds(edge, checker)) continue;
        fresh_.seek(edge);
        first = std::min<std::size_t>(first, edge.to / 2);
      }
      if (first == stations_.size()) return pieces_of(chain);
    }
  }

 private:
  static constexpr double kStraight = 1e-6;  // [rad]

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

  void add(std::size_t from, std::size_t to) {
    if (const std::optional<Edge> edge = fresh_.fresh(from, to)) edges_.push_back(*edge);
  }

  void relax(std::size_t first) {
    for (std::size_t k = first; k < stations_.size(); ++k) {
      candidates_.clear();
      for (std::size_t index = offsets_[k]; index < offsets_[k + 1]; ++index) {
        const Edge &edge = edges_[index];
        const Arrival &before = arrivals_[edge.from];
        Candidate best{index, kInfinite, 0};
        for (int d = 0; d < 3; ++d) {
          const double price = before.price[d] + ((d - 1) * edge.course.first < 0 ? change_cost_ : 0.0);
          if (price < best.price) best.price = price, best.before = d;
        }
        if (best.price < kInfinite) candidates_.push_back(best);
      }
      while (!arrive(k)) {
      }
    }
  }

  // The cheapest ways to a station; false where one of them is not sure yet, and its price was advanced.
  bool arrive(std::size_t k) {
    arrivals_[2 * k] = arrivals_[2 * k + 1] = Arrival{};
    double sure[2][3] = {{kInfinite, kInfinite, kInfinite}, {kInfinite, kInfinite, kInfinite}};
    for (const Candidate &candidate : candidates_) {
      const Edge &edge = edges_[candidate.edge];
      const int last = edge.course.last + 1;
      const double price = candidate.price + edge.course.price;
      if (edge.priced) sure[edge.to % 2][last] = std::min(sure[edge.to % 2][last], price);
      Arrival &there = arrivals_[edge.to];
      if (!(price < there.price[last])) continue;
      there.price[last] = price, there.edge[last] = candidate.edge, there.before[last] = candidate.before;
    }
    bool done = true;
    for (const std::size_t node : {2 * k, 2 * k + 1}) {
      for (int d = 0; d < 3; ++d) {
        Edge &edge = edges_[arrivals_[node].edge[d]];
        const double price = arrivals_[node].price[d];
        if (price == kInfinite || edge.priced) continue;
        fresh_.advance(edge, sure[node % 2][d] - (price - edge.course.price));
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
      PlanarPose at = fresh_.node(edge.from).pose;
      for (int i = 0; i < course.count; ++i) {
        const PlanarPose next = i + 1 == course.count ? fresh_.node(edge.to).pose : course.parts[i].from(at);
        out.push_back({at, next, course.parts[i], -1});
        at = next;
      }
    }
    return out;
  }

  const std::vector<Piece> &pieces_;
  const std::vector<Station> &stations_;
  const double change_cost_;
  const Edges fresh_;
  std::vector<Edge> edges_;           // by the station that they lead to
  std::vector<std::size_t> offsets_;  // of the first edge to each station
  std::vector<Arrival> arrivals_;
  std::vector<Candidate> candidates_;
};

}  // namespace trundle::smoothing
