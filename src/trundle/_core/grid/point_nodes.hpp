// Points that an any-angle search has reached, and the paths to them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "grid/point_table.hpp"
#include "shared/grid_steps.hpp"

namespace trundle {

// A point in half cells: the corners of cells have even numbers, their centres odd ones.
struct HalfCell {
  std::int32_t x, y;
  bool operator==(const HalfCell &other) const { return x == other.x && y == other.y; }
  std::uint64_t key() const {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32 | static_cast<std::uint32_t>(x);
  }
};

// The points at which a path turns, with its ends.
struct PointPath {
  SearchStatus status = SearchStatus::kUnreachable;
  std::vector<HalfCell> points;

  // In cells; the same in both directions.
  double length() const {
    double forth = 0.0, back = 0.0;
    const auto part = [&](std::size_t i) {
      const double x = points[i].x - points[i - 1].x, y = points[i].y - points[i - 1].y;
      return std::sqrt(x * x + y * y) / 2.0;
    };
    for (std::size_t i = 1; i < points.size(); ++i) forth += part(i);
    for (std::size_t i = points.size(); i-- > 1;) back += part(i);
    return std::min(forth, back);
  }
};

// A point that waits in an `OpenList`; the smallest total is its top.
struct OpenPoint {
  double total;
  std::uint32_t node;
  bool operator<(const OpenPoint &other) const { return total > other.total; }
};

class PointNodes {
 public:
  static constexpr std::uint32_t kSuperseded = ~std::uint32_t{0};

  struct Node {
    HalfCell at;
    std::uint32_t parent;  // the start is its own
    std::uint32_t entry;
    double reached;  // length from the start, in half cells
  };

  const Node &operator[](std::uint32_t node) const { return nodes_[node]; }

  // A new node for a point, unless it was reached by a path as short before.
  std::uint32_t reach(HalfCell at, double reached, std::uint32_t parent) {
    const auto [entry, is_new] = least_.insert(at);
    Least &known = least_[entry];
    if (!is_new && known.reached <= reached) return kSuperseded;
    known.reached = reached;
    nodes_.push_back({at, parent, entry, reached});
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  }

  // Whether its point was reached by a shorter path since.
  bool superseded(std::uint32_t node) const { return nodes_[node].reached > least_[nodes_[node].entry].reached; }

  // The path to a node and from there to a goal, without the points where it goes straight on.
  void trace(std::uint32_t node, HalfCell goal, PointPath &path) const {
    const auto add = [&](HalfCell at) {
      auto &points = path.points;
      if (!points.empty() && points.back() == at) return;
      if (points.size() > 1) {
        const HalfCell a = points[points.size() - 2], b = points.back();
        const std::int64_t turn = (std::int64_t{b.x} - a.x) * (std::int64_t{at.y} - b.y) -
                                  (std::int64_t{b.y} - a.y) * (std::int64_t{at.x} - b.x);
        if (turn == 0) points.pop_back();
      }
      points.push_back(at);
    };
    add(goal);
    for (;; node = nodes_[node].parent) {
      add(nodes_[node].at);
      if (nodes_[node].parent == node) break;
    }
    std::reverse(path.points.begin(), path.points.end());
  }

  void clear() {
    nodes_.clear();
    least_.clear();
  }

  std::size_t bytes() const { return nodes_.capacity() * sizeof(Node) + least_.bytes(); }

 private:
  struct Least {
    HalfCell at;
    double reached;
  };

  std::vector<Node> nodes_;
  PointTable<Least> least_;
};

}  // namespace trundle
