// Hybrid A*: Dolgov, Thrun, Montemerlo and Diebel, "Practical search techniques in path planning for autonomous
// driving" (STAIR 2008), section 2: continuous poses, one for each cell and heading; the larger of two heuristics; and
// analytic expansions, curves straight to the goal that are tried from time to time.
//
// What is added:
// - The heuristics are computed only where they are asked for (heuristic.hpp).
// - A node's footprint is checked when it is taken from the queue, not when it is put there: most never are taken.
// - Weighted A* (Pohl 1970) ends once no path can be left that is cheaper by more than the weight.
// - Where the heuristic leads through a gap that the footprint does not fit, cells there are avoided (`keep_advance`).
// - A goal that is hard to enter is searched backwards, and curves may end where that search came out (goal_pocket.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "hybrid/goal_pocket.hpp"
#include "hybrid/heuristic.hpp"
#include "hybrid/motions.hpp"
#include "hybrid/query.hpp"
#include "hybrid/search_memory.hpp"
#include "hybrid/shots.hpp"

namespace trundle {

class HybridSearch {
 public:
  HybridSearch(const HybridSettings &settings, const HybridQuery &query, const SearchLimits &limits, HybridMemory &memory,
               const StateGrid &states = kStates)
      : settings_(settings),
        model_(settings.model),
        query_(query),
        limits_(limits),
        memory_(memory),
        heuristic_(settings, query_, limits, memory),
        pocket_(settings_, query_, weights_, limits, memory, states),
        shots_(settings.model),
        states_(states),
        factor_(settings.factor(query.resolution)),
        cell_(query.resolution * factor_ / states.halves),
        motions_(hybrid_motions(settings.model, cell_, states, states.close)) {
    for (int cost = 0; cost < 256; ++cost) {
      const double weight = cost >= PoseChecker::kInscribed ? 0.0 : 1.0 + settings.cost_weight * cost / 252.0;
      weights_[cost] = static_cast<float>(weight);
    }
    memory.nodes.clear();
    memory.queue.clear();
    memory.closed.begin();
    memory.checker.begin(query.costs, query.rows, query.cols, query.resolution, query.outline, query.corners,
                         query.step, query.inner);
  }

  HybridPath find() {
    HybridPath path;
    status_ = limits_.check();
    if (status_ == SearchStatus::kFound) begin();
    if (!memory_.queue.empty() && std::isinf(memory_.nodes[0].to_go)) {
      path.closed_off = true;
      memory_.queue.clear();
    }
    while (!memory_.queue.empty() && status_ == SearchStatus::kFound) {
      const QueueEntry entry = memory_.queue.top();
      if (entry.sum >= best_cost_ || spent_after_first()) break;
      memory_.queue.pop();
      if (!settle(entry)) continue;
      if (query_.partial) keep_nearest(entry.node);
      if (++expansions_ > query_.max_expansions) {
        path.spent = true;
        break;
      }
      if (best_node_ == kNoNode) {
        if (is_in_pocket()) path.pocket = true;
        keep_advance(entry.node);
      }
      if (path.pocket && is_near_enough()) break;
      if (expansions_ == kDoubtful && best_node_ == kNoNode && heuristic_.is_closed_off(status_)) {
        path.closed_off = true;
        break;
      }
      if (expansions_ % 64 == 0 && (status_ = limits_.check()) != SearchStatus::kFound) break;
      if (--until_shot_ <= 0) shoot(entry.node);
      expand(entry.node);
    }
    if (best_node_ == kNoNode && status_ == SearchStatus::kFound && !path.spent && !path.closed_off && !path.pocket) {
      path.stuck = expansions_ < kFirstLook * static_cast<std::uint64_t>(states_.halves * states_.halves);
      path.closed_off = !path.stuck && heuristic_.is_closed_off(status_);
    }
    finish(path);
    return path;
  }

 private:
  static constexpr std::uint64_t kDoubtful = 10'000, kFirstLook = 256, kLongLook = 2'000, kMinNearest = 2'000;  // expansions
  static constexpr std::uint64_t kNoAdvance = 1'500;
  static constexpr std::size_t kNoApproach = ~std::size_t{0};
  static constexpr int kDetours = 40;
  static constexpr std::uint32_t kNoNode = ~std::uint32_t{0};

  // From the exit of the goal's pocket to the goal.
  struct Approach {
    PlanarPose from;
    std::vector<Segment> parts;
    double cost;
  };

  void begin() {
    for (int k = 0; k < states_.headings; ++k) {
      yaws_[k] = query_.start.yaw + k * states_.heading_step();
      cos_[k] = std::cos(yaws_[k]), sin_[k] = std::sin(yaws_[k]);
    }
    memory_.nodes.push_back({query_.start.x, query_.start.y, 0.0, heuristic_.least_cost(query_.start), kNoNode, 0, 0, true});
    // Where a curve is free, no field is needed.
    shoot(0);
    HybridNode &start = memory_.nodes[0];
    if (best_cost_ > settings_.heuristic_weight * start.to_go) {
      start.to_go = std::max(start.to_go, heuristic_.field_at(start.x, start.y, status_));
    }
    push(0);
  }

  void push(std::uint32_t node) {
    const HybridNode &n = memory_.nodes[node];
    memory_.queue.push({n.cost + settings_.heuristic_weight * n.to_go, node});
  }

  PlanarPose pose_of(const HybridNode &node) const { return {node.x, node.y, yaws_[node.heading]}; }

  int direction_of(const HybridNode &node) const {
    return node.parent == kNoNode ? 0 : motions_[node.motion].direction;
  }

  static int direction_of(const Segment &part) { return (part.length > 0.0) - (part.length < 0.0); }

  // By the map's cells, or parts of them, so that every point of the map lies in one of these.
  std::int64_t cell(double metres) const {
    return static_cast<std::int64_t>(metres * states_.halves / query_.resolution) / factor_;
  }

  std::uint64_t key_of(const HybridNode &node) const {
    const auto cols = static_cast<std::uint64_t>((query_.cols * states_.halves + factor_ - 1) / factor_);
    const auto row = static_cast<std::uint64_t>(cell(node.y)), col = static_cast<std::uint64_t>(cell(node.x));
    return (row * cols + col) * static_cast<std::uint64_t>(states_.headings) + node.heading;
  }

  // Closes a node from the queue; false where it must not be expanded, or not yet.
  bool settle(const QueueEntry &entry) {
    HybridNode &node = memory_.nodes[entry.node];
    const std::uint64_t key = key_of(node);
    if (memory_.closed.contains(key)) return false;
    if (!node.checked) {
      const HybridNode &parent = memory_.nodes[node.parent];
      if (!check(parent, motions_[node.motion], node)) return false;
      const double sum = node.cost + settings_.heuristic_weight * node.to_go;
      if (sum > entry.sum + 1e-9 && !memory_.queue.empty() && sum > memory_.queue.top().sum) {
        push(entry.node);
        return false;
      }
    }
    memory_.closed.insert(key);
    return true;
  }

  bool check(const HybridNode &parent, const HybridMotion &motion, HybridNode &node) {
    double sum = 0.0;
    if (!memory_.checker.fits(pose_of(parent), motion.segment, weights_, model_.turn_cost, kInfinite, sum)) {
      return false;
    }
    const double factor = motion.direction < 0 ? model_.reverse_penalty : 1.0;
    node.cost = parent.cost + factor * sum + change(parent, motion);
    node.to_go = heuristic_.at_least(pose_of(node), node.to_go);
    node.checked = true;
    return true;
  }

  double change(const HybridNode &from, const HybridMotion &motion) const {
    return direction_of(from) * motion.direction < 0 ? model_.change_cost : 0.0;
  }

  void expand(std::uint32_t index) {
    for (std::size_t m = 0; m < motions_.size(); ++m) {
      const HybridMotion &motion = motions_[m];
      const HybridNode from = memory_.nodes[index];
      const PlanarPose to = motion.segment.from(pose_of(from), cos_[from.heading], sin_[from.heading]);
      const std::uint8_t cost = memory_.checker.cost_at(to.x, to.y);
      if (cost >= PoseChecker::kInscribed) continue;
      HybridNode node{to.x, to.y, 0.0, 0.0, index, 0, static_cast<std::uint8_t>(m), false};
      node.heading = static_cast<std::uint8_t>((from.heading + motion.bins + states_.headings) % states_.headings);
      if (memory_.closed.contains(key_of(node))) continue;
      node.to_go = heuristic_.field_at(to.x, to.y, status_);
      if (std::isinf(node.to_go)) continue;
      const float least = std::min(weights_[memory_.checker.cost_at(from.x, from.y)], weights_[cost]);
      node.cost = from.cost + motion.cost * static_cast<double>(least) + change(from, motion);
      if (node.cost + node.to_go >= best_cost_) continue;
      memory_.nodes.push_back(node);
      push(static_cast<std::uint32_t>(memory_.nodes.size() - 1));
    }
  }

  // Where the heuristic leads through a gap that the footprint does not fit, the search fills everything before the
  // gap. After `kNoAdvance` expansions that came no nearer to the goal, by the heuristic, the cells that it leads
  // through next are avoided.
  void keep_advance(std::uint32_t index) {
    const HybridNode &node = memory_.nodes[index];
    const double left = heuristic_.field_at(node.x, node.y, status_);
    if (left < least_left_) least_left_ = left, foremost_ = index, advanced_at_ = expansions_;
    if (expansions_ - advanced_at_ < kNoAdvance || detours_ == kDetours) return;
    ++detours_;
    least_left_ = kInfinite, advanced_at_ = expansions_;
    heuristic_.avoid_ahead(memory_.nodes[foremost_].x, memory_.nodes[foremost_].y, status_);
    memory_.queue.change_all([&](QueueEntry &entry) {
      HybridNode &open = memory_.nodes[entry.node];
      open.to_go = heuristic_.field_at(open.x, open.y, status_);
      if (open.checked) open.to_go = heuristic_.at_least(pose_of(open), open.to_go);
      entry.sum = open.cost + settings_.heuristic_weight * open.to_go;
    });
  }

  // Whether the goal is known to lie in a closed pocket. It is searched after `kFirstLook` expansions, and again each
  // time that there are twice as many: for an eighth as many poses, and later for four times as many, when most goals
  // that are left do lie in one.
  bool is_in_pocket() {
    if (expansions_ != next_look_) return false;
    const std::uint64_t poses = next_look_ < kLongLook ? next_look_ / 8 : 4 * next_look_;
    next_look_ *= 2;
    if (is_out_) {
      if (expansions_ < kDoubtful) return false;
      pocket_.go_farther();
    }
    const Pocket found = pocket_.look(poses, status_);
    is_out_ = found == Pocket::kOpen;
    if (is_out_) keep_approach();
    return found == Pocket::kClosed;
  }

  // Keeps the motions from the pocket's exit, which is easier to reach, to the goal.
  void keep_approach() {
    Approach path{pocket_.exit(), pocket_.approach(), 0.0};
    PlanarPose pose = path.from;
    int direction = 0;
    for (const Segment &part : path.parts) {
      double sum = 0.0;
      memory_.checker.fits(pose, part, weights_, model_.turn_cost, kInfinite, sum);
      const int now = direction_of(part);
      if (now * direction < 0) path.cost += model_.change_cost;
      path.cost += (now < 0 ? model_.reverse_penalty : 1.0) * sum;
      direction = now;
      pose = part.from(pose);
    }
    approaches_.push_back(std::move(path));
  }

  // Whether a search that cannot succeed may end: at once, or, where a path to the nearest pose is wanted, when it has
  // come no nearer for long.
  bool is_near_enough() const { return !query_.partial || expansions_ > 2 * nearest_at_ + kMinNearest; }

  // Tries curves from a node to the goal, and keeps the cheapest path so far.
  void shoot(std::uint32_t index) {
    const HybridNode &node = memory_.nodes[index];
    // More often near the goal, and less often the longer none was found.
    until_shot_ = std::clamp(static_cast<int>(node.to_go / (10.0 * cell_)), 1, 32) + static_cast<int>(expansions_ / 64);
    shoot_at(index, query_.goal, query_.any_yaw, kNoApproach);
    for (std::size_t i = 0; i < approaches_.size(); ++i) shoot_at(index, approaches_[i].from, false, i);
  }

  // To the goal, or to where an approach begins.
  void shoot_at(std::uint32_t index, const PlanarPose &target, bool any_yaw, std::size_t approach) {
    const HybridNode &node = memory_.nodes[index];
    const double more = approach != kNoApproach ? approaches_[approach].cost : 0.0;
    const int ahead = approach != kNoApproach ? direction_of(approaches_[approach].parts.front()) : 0;
    for (const Shot &shot : shots_.find(pose_of(node), target, any_yaw, direction_of(node))) {
      if (node.cost + shot.cost + more >= best_cost_) break;
      const double cost = more + shot_cost(node, shot, ahead, best_cost_ - more);
      if (cost >= best_cost_) continue;
      if (best_node_ == kNoNode) first_found_ = expansions_;
      best_cost_ = cost, best_node_ = index, best_shot_ = shot, best_approach_ = approach;
    }
  }

  // With the change to the direction `ahead` of what follows; infinite where it is `most` or more.
  double shot_cost(const HybridNode &node, const Shot &shot, int ahead, double most) {
    double cost = node.cost;
    int direction = direction_of(node);
    PlanarPose pose = pose_of(node);
    for (int i = 0; i < shot.count; ++i) {
      const Segment &part = shot.parts[i];
      const int now = direction_of(part);
      const double factor = now < 0 ? model_.reverse_penalty : 1.0;
      if (now * direction < 0) cost += model_.change_cost;
      direction = now;
      double sum = 0.0;
      const double room = (most - cost) / factor;
      if (!memory_.checker.fits(pose, part, weights_, model_.turn_cost, room, sum)) return kInfinite;
      cost += factor * sum;
      pose = part.from(pose);
    }
    return direction * ahead < 0 ? cost + model_.change_cost : cost;
  }

  // Once there is a path, a better one is searched for as long again in proportion; shorter in small cells.
  bool spent_after_first() const {
    return best_node_ != kNoNode && expansions_ > (states_.close ? first_found_ : 4 * first_found_ + 500);
  }

  // Of nodes equally near to the goal, the one that was closed first.
  void keep_nearest(std::uint32_t index) {
    const HybridNode &node = memory_.nodes[index];
    const double distance = std::hypot(query_.goal.x - node.x, query_.goal.y - node.y);
    if (distance < nearest_) nearest_ = distance, nearest_node_ = index, nearest_at_ = expansions_;
  }

  // From the start to a node.
  void add_motions(std::uint32_t node, std::vector<Segment> &parts) const {
    for (; memory_.nodes[node].parent != kNoNode; node = memory_.nodes[node].parent) {
      parts.push_back(motions_[memory_.nodes[node].motion].segment);
    }
    std::reverse(parts.begin(), parts.end());
  }

  void finish(HybridPath &path) {
    path.expansions = expansions_;
    path.field_cells = heuristic_.field_cells();
    path.exact_checks = memory_.checker.exact_checks();
    path.status = status_;
    if (best_node_ == kNoNode) {
      if (status_ == SearchStatus::kFound && !path.spent) path.status = SearchStatus::kUnreachable;
      if (nearest_node_ == kNoNode || status_ != SearchStatus::kFound) return;
      path.partial = true;
      path.cost = memory_.nodes[nearest_node_].cost;
      add_motions(nearest_node_, path.parts);
      return;
    }
    path.status = SearchStatus::kFound, path.spent = false;
    path.cost = best_cost_;
    add_motions(best_node_, path.parts);
    path.parts.insert(path.parts.end(), best_shot_.parts, best_shot_.parts + best_shot_.count);
    if (best_approach_ == kNoApproach) return;
    const std::vector<Segment> &last = approaches_[best_approach_].parts;
    path.parts.insert(path.parts.end(), last.begin(), last.end());
  }

  static constexpr double kInfinite = std::numeric_limits<double>::infinity();

  const HybridSettings settings_;
  const MotionModel model_;
  const HybridQuery query_;
  const SearchLimits &limits_;
  HybridMemory &memory_;
  HybridHeuristic heuristic_;
  PocketSearch pocket_;
  Shots shots_;
  const StateGrid states_;
  const int factor_;
  const double cell_;
  const std::vector<HybridMotion> motions_;
  int until_shot_ = 0;
  float weights_[256];
  double yaws_[kMostHeadings], cos_[kMostHeadings], sin_[kMostHeadings];
  SearchStatus status_ = SearchStatus::kFound;
  std::uint64_t expansions_ = 0, first_found_ = 0, next_look_ = kFirstLook, nearest_at_ = 0;
  double best_cost_ = kInfinite;
  std::uint32_t best_node_ = kNoNode, nearest_node_ = kNoNode;
  double nearest_ = kInfinite;
  Shot best_shot_;
  std::size_t best_approach_ = kNoApproach;  // what follows the shot
  std::vector<Approach> approaches_;
  bool is_out_ = false;  // whether the last search of the goal's pocket led out of it
  double least_left_ = kInfinite;  // of the nodes, by the heuristic as it is now, and which node that is
  std::uint32_t foremost_ = 0;
  std::uint64_t advanced_at_ = 0;
  int detours_ = 0;
};

}  // namespace trundle
