// Points that searches in any direction have reached, found by a hash of the place, and the ways they lead to.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "grid_steps.hpp"

namespace trundle {

// A place in half cells: the corners of cells have even numbers, their centres odd ones.
struct HalfCell {
  std::int32_t x, y;
  bool operator==(const HalfCell &other) const { return x == other.x && y == other.y; }
};

// The points that a way turns at, with its ends.
struct PointWay {
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

class PointNodes {
 public:
  static constexpr std::uint32_t kOutdone = ~std::uint32_t{0};

  struct Node {
    HalfCell at;
    std::uint32_t parent;  // the start is its own
    std::uint32_t place;
    double reached;  // length from the start, in half cells
  };

  const Node &operator[](std::uint32_t node) const { return nodes_[node]; }

  // A new node for a place, unless it was reached by as short a way before.
  std::uint32_t reach(HalfCell at, double reached, std::uint32_t parent) {
    if (least_.size() * 2 >= slots_.size()) grow();
    std::size_t slot = hash(at);
    for (;; slot = (slot + 1) & (slots_.size() - 1)) {
      if (slots_[slot].generation != generation_) {
        slots_[slot] = {generation_, static_cast<std::uint32_t>(least_.size())};
        least_.push_back({at, reached});
        break;
      }
      Least &known = least_[slots_[slot].place];
      if (!(known.at == at)) continue;
      if (known.reached <= reached) return kOutdone;
      known.reached = reached;
      break;
    }
    nodes_.push_back({at, parent, slots_[slot].place, reached});
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  }

  // Whether a place was reached by a way of at most this length.
  bool reached_within(HalfCell at, double length) const {
    if (slots_.empty()) return false;
    for (std::size_t slot = hash(at);; slot = (slot + 1) & (slots_.size() - 1)) {
      if (slots_[slot].generation != generation_) return false;
      const Least &known = least_[slots_[slot].place];
      if (known.at == at) return known.reached <= length;
    }
  }

  // Whether its place was reached by a shorter way since.
  bool outdone(std::uint32_t node) const { return nodes_[node].reached > least_[nodes_[node].place].reached; }

  // The way to a node and from there to a goal, without the points where it goes straight on.
  void trace(std::uint32_t node, HalfCell goal, PointWay &way) const {
    const auto add = [&](HalfCell at) {
      auto &points = way.points;
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
    std::reverse(way.points.begin(), way.points.end());
  }

  void clear() {
    nodes_.clear();
    least_.clear();
    if (++generation_ == 0) {
      std::fill(slots_.begin(), slots_.end(), Slot{0, 0});
      generation_ = 1;
    }
  }

  std::size_t bytes() const {
    return slots_.capacity() * sizeof(Slot) + nodes_.capacity() * sizeof(Node) + least_.capacity() * sizeof(Least);
  }

 private:
  struct Slot {
    std::uint32_t generation, place;
  };
  struct Least {
    HalfCell at;
    double reached;
  };

  std::size_t hash(HalfCell at) const {
    const std::uint64_t key =
        static_cast<std::uint64_t>(static_cast<std::uint32_t>(at.y)) << 32 | static_cast<std::uint32_t>(at.x);
    return static_cast<std::size_t>(key * 0x9e3779b97f4a7c15ULL >> shift_);
  }

  void grow() {
    slots_.assign(std::max<std::size_t>(512, slots_.size() * 2), Slot{0, 0});
    generation_ = 1;
    shift_ = 64;
    for (std::size_t size = slots_.size(); size > 1; size /= 2) --shift_;
    for (std::size_t i = 0; i < least_.size(); ++i) {
      std::size_t slot = hash(least_[i].at);
      while (slots_[slot].generation == generation_) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = {generation_, static_cast<std::uint32_t>(i)};
    }
  }

  std::vector<Slot> slots_;
  std::uint32_t generation_ = 0;
  int shift_ = 64;
  std::vector<Node> nodes_;
  std::vector<Least> least_;
};

}  // namespace trundle
