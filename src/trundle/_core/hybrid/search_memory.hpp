// The nodes of a hybrid A* search, its queue and its set of closed states, kept from one query to the next.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "costmap/pose_checker.hpp"
#include "hybrid/lazy_cost_to_go.hpp"
#include "shared/open_list.hpp"

namespace trundle {

// States by 64-bit keys, in an open hash table; entries of earlier queries do not count.
class StateSet {
 public:
  void begin() {
    if (table_.empty()) table_.resize(1024);
    if (++stamp_ == 0) {
      std::fill(table_.begin(), table_.end(), Entry{});
      stamp_ = 1;
    }
    size_ = 0;
  }
  bool contains(std::uint64_t key) const { return table_[find(key)].stamp == stamp_; }
  void insert(std::uint64_t key) {
    if (2 * ++size_ > table_.size()) grow();
    table_[find(key)] = {key, stamp_};
  }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return table_.capacity() * sizeof(Entry); }

 private:
  struct Entry {
    std::uint64_t key = 0;
    std::uint32_t stamp = 0;
  };

  std::size_t find(std::uint64_t key) const {
    const std::size_t mask = table_.size() - 1;
    // Fibonacci hashing: Knuth, The Art of Computer Programming, volume 3, section 6.4.
    std::size_t i = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 20) & mask;
    while (table_[i].stamp == stamp_ && table_[i].key != key) i = (i + 1) & mask;
    return i;
  }
  void grow() {
    std::vector<Entry> old(table_.size() * 2);
    old.swap(table_);
    for (const Entry &entry : old) {
      if (entry.stamp == stamp_) table_[find(entry.key)] = entry;
    }
  }

  std::vector<Entry> table_;
  std::uint32_t stamp_ = 0;
  std::size_t size_ = 0;
};

struct HybridNode {
  double x, y;            // [m], on the grid
  double cost;            // from the start
  double to_go;           // lower bound on the cost to the goal
  std::uint32_t parent;
  std::uint8_t heading;   // in steps from the start's yaw
  std::uint8_t motion;    // by which it was reached
  bool checked;           // whether the motion to here was checked; `cost` and `to_go` are exact then
};

struct QueueEntry {
  double sum;
  std::uint32_t node;
  // The least sum first, and of equal ones the newest.
  bool operator<(const QueueEntry &other) const {
    return sum != other.sum ? sum > other.sum : node < other.node;
  }
};

struct HybridMemory {
  struct PocketMemory {
    struct Step {
      std::uint32_t parent;  // the pose that the motion leads to
      std::uint8_t motion;
    };

    std::vector<PlanarPose> poses;
    std::vector<Step> steps;  // of each pose
    OpenList<QueueEntry> queue;
    StateSet closed;

    std::size_t bytes() const {
      return poses.capacity() * sizeof(PlanarPose) + steps.capacity() * sizeof(Step) + queue.bytes() + closed.bytes();
    }
  };

  std::vector<HybridNode> nodes;
  OpenList<QueueEntry> queue;
  StateSet closed;
  LazyCostToGo field, fine_field;
  PoseChecker checker;
  PocketMemory pocket;

  std::size_t bytes() const {
    return nodes.capacity() * sizeof(HybridNode) + queue.bytes() + closed.bytes() +
           field.bytes() + fine_field.bytes() + checker.bytes() + pocket.bytes();
  }
};

}  // namespace trundle
