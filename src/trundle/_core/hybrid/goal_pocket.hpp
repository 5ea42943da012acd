// A search backwards from the goal: whether the robot can come to it from elsewhere, or the goal lies in a pocket that
// is closed to its footprint and its motions.
//
// A hybrid A* search from the start would try every pose outside of the pocket before it fails. This one drives
// backwards in time from the goal, the farthest pose first, and ends as soon as it is out, or when no pose is left:
// mostly after a few dozen poses. From its exit, its motions lead to the goal.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "hybrid/motions.hpp"
#include "hybrid/query.hpp"
#include "hybrid/search_memory.hpp"

namespace trundle {

enum class Pocket { kUnknown, kOpen, kClosed };

class PocketSearch {
 public:
  PocketSearch(const HybridSettings &settings, const HybridQuery &query, const float *weights, const SearchLimits &limits,
               HybridMemory &memory, const StateGrid &states)
      : settings_(settings), query_(query), weights_(weights), limits_(limits), memory_(memory), states_(states) {}

  // What is known after `most` more poses. The pocket is closed only after a second search, in cells half as large and
  // with the shortest motions, and where that is soon over a third, in cells half as large again. These may try more
  // poses, since few goals are left that are not closed in. `status` says why the search was stopped, if it was.
  Pocket look(std::uint64_t most, SearchStatus &status) {
    if (found_ != Pocket::kUnknown) return found_;
    if (halves_ == 0) begin(states_.close ? states_.halves : 1);
    while (go_on(halves_ == 1 ? most : most + kFinePoses, status) == Pocket::kClosed && is_finer_better()) {
      begin(2 * halves_);
    }
    return found_;
  }

  // From now on it is out only twice as far away.
  void go_farther() { far_ *= 2.0, found_ = Pocket::kUnknown; }

  // Where it came out.
  const PlanarPose &exit() const { return exit_; }

  // From there to the goal.
  std::vector<Segment> approach() const {
    std::vector<Segment> parts;
    const auto &steps = memory_.pocket.steps;
    for (HybridMemory::PocketMemory::Step step = steps[exit_index_]; step.parent != kNoPose; step = steps[step.parent]) {
      parts.push_back(motions_[step.motion].segment);
    }
    return parts;
  }

 private:
  static constexpr std::uint64_t kFinePoses = 2'000;
  static constexpr std::size_t kTight = 1'000;  // poses
  static constexpr std::uint32_t kNoPose = ~std::uint32_t{0};

  bool is_finer_better() const {
    return !states_.close && (halves_ == 1 || (halves_ == 2 && memory_.pocket.poses.size() < kTight));
  }

  void begin(int halves) {
    halves_ = halves, found_ = Pocket::kUnknown;
    cell_ = query_.resolution * settings_.factor(query_.resolution) / halves;
    motions_ = hybrid_motions(settings_.model, cell_, states_, halves > 1);
    // It is out where the robot has had room to turn and to manoeuvre.
    if (far_ == 0.0) far_ = 2.5 * memory_.checker.radius() + 2.0 * settings_.model.radius;
    memory_.pocket.poses.clear();
    memory_.pocket.steps.clear();
    memory_.pocket.queue.clear();
    memory_.pocket.closed.begin();
    for (int i = 0; i < (query_.any_yaw ? Shots::kYaws : 1); ++i) {
      const PlanarPose &goal = query_.goal;
      const PlanarPose pose{goal.x, goal.y, goal.yaw + i * (2.0 * kPi / Shots::kYaws)};
      if (!memory_.checker.touches(pose.x, pose.y, pose.yaw)) push(pose, {kNoPose, 0});
    }
  }

  Pocket go_on(std::uint64_t most, SearchStatus &status) {
    auto &queue = memory_.pocket.queue;
    for (; most > 0 && !queue.empty(); --most) {
      if (most % 64 == 0 && (status = limits_.check()) != SearchStatus::kFound) return found_;
      const std::uint32_t node = queue.pop().node;
      const PlanarPose from = memory_.pocket.poses[node];
      for (std::size_t m = 0; m < motions_.size(); ++m) {
        const HybridMotion &motion = motions_[m];
        const Segment back{-motion.segment.length, -motion.segment.turn};
        const PlanarPose to = back.from(from);
        if (memory_.checker.cost_at(to.x, to.y) >= PoseChecker::kInscribed || memory_.pocket.closed.contains(key(to))) {
          continue;
        }
        double sum = 0.0;
        if (!memory_.checker.fits(from, back, weights_, 0.0, kInfinite, sum)) continue;
        push(to, {node, static_cast<std::uint8_t>(m)});
        if (found_ == Pocket::kOpen || !is_out(to)) continue;
        found_ = Pocket::kOpen;
        exit_ = to, exit_index_ = memory_.pocket.poses.size() - 1;
      }
      if (found_ == Pocket::kOpen) return found_;
    }
    if (queue.empty()) found_ = Pocket::kClosed;
    return found_;
  }

  void push(const PlanarPose &pose, HybridMemory::PocketMemory::Step step) {
    HybridMemory::PocketMemory &pocket = memory_.pocket;
    pocket.closed.insert(key(pose));
    pocket.poses.push_back(pose);
    pocket.steps.push_back(step);
    pocket.queue.push({-distance(pose, query_.goal), static_cast<std::uint32_t>(pocket.poses.size() - 1)});
  }

  // Far from the goal, or beside the start.
  bool is_out(const PlanarPose &pose) const {
    return distance(pose, query_.goal) >= far_ || distance(pose, query_.start) < 3.0 * cell_;
  }

  static double distance(const PlanarPose &a, const PlanarPose &b) { return std::hypot(a.x - b.x, a.y - b.y); }

  std::uint64_t key(const PlanarPose &pose) const {
    const auto cols = static_cast<std::uint64_t>(static_cast<double>(query_.cols) * query_.resolution / cell_) + 1;
    const auto row = static_cast<std::uint64_t>(pose.y / cell_), col = static_cast<std::uint64_t>(pose.x / cell_);
    const std::int64_t count = states_.headings;
    const std::int64_t heading = std::lround((pose.yaw - query_.goal.yaw) / states_.heading_step()) % count;
    return (row * cols + col) * static_cast<std::uint64_t>(count) + static_cast<std::uint64_t>((heading + count) % count);
  }

  static constexpr double kInfinite = std::numeric_limits<double>::infinity();

  const HybridSettings &settings_;
  const HybridQuery &query_;
  const float *weights_;
  const SearchLimits &limits_;
  HybridMemory &memory_;
  const StateGrid states_;
  std::vector<HybridMotion> motions_;
  int halves_ = 0;
  double cell_ = 0.0, far_ = 0.0;
  Pocket found_ = Pocket::kUnknown;
  PlanarPose exit_{};
  std::size_t exit_index_ = 0;
};

}  // namespace trundle
