// Hybrid A*: Dolgov, Thrun, Montemerlo and Diebel, "Practical search techniques in path planning for autonomous
// driving" (STAIR 2008), section 2: continuous poses, one for each cell and heading; two heuristics, of which the larger counts;
// and curves straight to the goal that are tried on the way.
//
// What is added: the heuristics are worked out only where they are asked for, and a node is checked with the footprint
// when it is taken from the queue, not when it is put there, as most never are taken. Weighted A* (Pohl 1970) ends once
// no way that is cheaper by more than its weight can be left. A guide that leads where the footprint does not fit is led
// another way, and curves also end where a search backwards from a goal that is hard to reach has come out.
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
  HybridSearch(const HybridSettings &settings, const HybridQuery &query, const Patience &patience, HybridMemory &memory,
               const StateGrid &states = kStates)
      : settings_(settings),
        model_(settings.model),
        query_(query),
        patience_(patience),
        memory_(memory),
        guide_(settings, query_, patience, memory),
        pocket_(settings_, query_, weights_, patience, memory, states),
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

  HybridWay find() {
    HybridWay way;
    status_ = patience_.left();
    if (status_ == SearchStatus::kFound) begin();
    if (!memory_.queue.empty() && std::isinf(memory_.nodes[0].to_go)) {
      way.closed_off = true;
      memory_.queue.clear();
    }
    while (!memory_.queue.empty() && status_ == SearchStatus::kFound) {
      const QueueEntry entry = memory_.queue.top();
      if (entry.sum >= best_cost_ || spent_after_first()) break;
      memory_.queue.pop();
      if (!settle(entry)) continue;
      if (query_.partial) keep_nearest(entry.node);
      if (++expansions_ > query_.max_expansions) {
        way.spent = true;
        break;
      }
      if (best_node_ == kNoNode) {
        if (is_in_pocket()) way.pocket = true;
        keep_advance(entry.node);
      }
      if (way.pocket && is_near_enough()) break;
      if (expansions_ == kDoubtful && best_node_ == kNoNode && guide_.is_closed_off(status_)) {
        way.closed_off = true;
        break;
      }
      if (expansions_ % 64 == 0 && (status_ = patience_.left()) != SearchStatus::kFound) break;
      if (--until_shot_ <= 0) shoot(entry.node);
      expand(entry.node);
    }
    if (best_node_ == kNoNode && status_ == SearchStatus::kFound && !way.spent && !way.closed_off && !way.pocket) {
      way.stuck = expansions_ < kFirstLook * static_cast<std::uint64_t>(states_.halves * states_.halves);
      way.closed_off = !way.stuck && guide_.is_closed_off(status_);
    }
    finish(way);
    return way;
  }

 private:
  static constexpr std::uint64_t kDoubtful = 10'000, kFirstLook = 256, kLongLook = 2'000, kPatient = 2'000;  // expansions
  static constexpr std::uint64_t kNoAdvance = 1'500;
  static constexpr std::size_t kNoWayIn = ~std::size_t{0};
  static constexpr int kDetours = 40;
  static constexpr std::uint32_t kNoNode = ~std::uint32_t{0};

  // To the goal from elsewhere.
  struct WayIn {
    PlanarPose from;
    std::vector<Stretch> parts;
    double cost;
  };

  void begin() {
    for (int k = 0; k < states_.headings; ++k) {
      yaws_[k] = query_.start.yaw + k * states_.heading_step();
      cos_[k] = std::cos(yaws_[k]), sin_[k] = std::sin(yaws_[k]);
    }
    memory_.nodes.push_back({query_.start.x, query_.start.y, 0.0, guide_.least_cost(query_.start), kNoNode, 0, 0, true});
    // Where the way is open nothing else is needed, and no field is begun.
    shoot(0);
    HybridNode &start = memory_.nodes[0];
    if (best_cost_ > settings_.heuristic_weight * start.to_go) {
      start.to_go = std::max(start.to_go, guide_.field_at(start.x, start.y, status_));
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

  static int direction_of(const Stretch &part) { return (part.length > 0.0) - (part.length < 0.0); }

  // By the map's cells, or halves of them, so that what lies on the map lies in one of these.
  std::int64_t cell(double metres) const {
    return static_cast<std::int64_t>(metres * states_.halves / query_.resolution) / factor_;
  }

  std::uint64_t key_of(const HybridNode &node) const {
    const auto cols = static_cast<std::uint64_t>((query_.cols * states_.halves + factor_ - 1) / factor_);
    const auto row = static_cast<std::uint64_t>(cell(node.y)), col = static_cast<std::uint64_t>(cell(node.x));
    return (row * cols + col) * static_cast<std::uint64_t>(states_.headings) + node.heading;
  }

  // Take a node from the queue; false where it is not to be expanded, or not yet.
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
    if (!memory_.checker.fits(pose_of(parent), motion.stretch, weights_, model_.turn_cost, kInfinite, sum)) {
      return false;
    }
    const double dearer = motion.direction < 0 ? model_.reverse_penalty : 1.0;
    node.cost = parent.cost + dearer * sum + change(parent, motion);
    node.to_go = guide_.at_least(pose_of(node), node.to_go);
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
      const PlanarPose to = motion.stretch.from(pose_of(from), cos_[from.heading], sin_[from.heading]);
      const std::uint8_t cost = memory_.checker.cost_at(to.x, to.y);
      if (cost >= PoseChecker::kInscribed) continue;
      HybridNode node{to.x, to.y, 0.0, 0.0, index, 0, static_cast<std::uint8_t>(m), false};
      node.heading = static_cast<std::uint8_t>((from.heading + motion.bins + states_.headings) % states_.headings);
      if (memory_.closed.contains(key_of(node))) continue;
      node.to_go = guide_.field_at(to.x, to.y, status_);
      if (std::isinf(node.to_go)) continue;
      const float least = std::min(weights_[memory_.checker.cost_at(from.x, from.y)], weights_[cost]);
      node.cost = from.cost + motion.cost * static_cast<double>(least) + change(from, motion);
      if (node.cost + node.to_go >= best_cost_) continue;
      memory_.nodes.push_back(node);
      push(static_cast<std::uint32_t>(memory_.nodes.size() - 1));
    }
  }

  // A guide that leads through a gap where the footprint does not fit lets the search fill all that lies before. After so
  // many expansions that got no nearer to the goal, by what the guide says, it leads around what comes next.
  void keep_advance(std::uint32_t index) {
    const HybridNode &node = memory_.nodes[index];
    const double left = guide_.field_at(node.x, node.y, status_);
    if (left < least_left_) least_left_ = left, foremost_ = index, advanced_at_ = expansions_;
    if (expansions_ - advanced_at_ < kNoAdvance || detours_ == kDetours) return;
    ++detours_;
    least_left_ = kInfinite, advanced_at_ = expansions_;
    guide_.avoid_ahead(memory_.nodes[foremost_].x, memory_.nodes[foremost_].y, status_);
    memory_.queue.change_all([&](QueueEntry &entry) {
      HybridNode &open = memory_.nodes[entry.node];
      open.to_go = guide_.field_at(open.x, open.y, status_);
      if (open.checked) open.to_go = guide_.at_least(pose_of(open), open.to_go);
      entry.sum = open.cost + settings_.heuristic_weight * open.to_go;
    });
  }

  // Whether the goal lies in a pocket, as far as is known: after so many expansions, and each time that there are twice as
  // many, it is looked at for an eighth of that, and later for four times as long, when few goals are left that are in none.
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
    if (is_out_) keep_way_in();
    return found == Pocket::kClosed;
  }

  // How to get to the goal from where the pocket ends, which is easier to come to.
  void keep_way_in() {
    WayIn way{pocket_.exit(), pocket_.way_in(), 0.0};
    PlanarPose pose = way.from;
    int direction = 0;
    for (const Stretch &part : way.parts) {
      double sum = 0.0;
      memory_.checker.fits(pose, part, weights_, model_.turn_cost, kInfinite, sum);
      const int now = direction_of(part);
      if (now * direction < 0) way.cost += model_.change_cost;
      way.cost += (now < 0 ? model_.reverse_penalty : 1.0) * sum;
      direction = now;
      pose = part.from(pose);
    }
    ways_in_.push_back(std::move(way));
  }

  // Whether a search that cannot succeed may end: at once, or where a way to near the goal is wanted, when it has come no
  // nearer for long.
  bool is_near_enough() const { return !query_.partial || expansions_ > 2 * nearest_at_ + kPatient; }

  // Try to end from a node, and keep the cheapest way so far.
  void shoot(std::uint32_t index) {
    const HybridNode &node = memory_.nodes[index];
    // The nearer to the goal the more often, and the longer in vain the less.
    until_shot_ = std::clamp(static_cast<int>(node.to_go / (10.0 * cell_)), 1, 32) + static_cast<int>(expansions_ / 64);
    shoot_at(index, query_.goal, query_.any_yaw, kNoWayIn);
    for (std::size_t i = 0; i < ways_in_.size(); ++i) shoot_at(index, ways_in_[i].from, false, i);
  }

  // At the goal, or at where its way in begins.
  void shoot_at(std::uint32_t index, const PlanarPose &target, bool any_yaw, std::size_t way_in) {
    const HybridNode &node = memory_.nodes[index];
    const double more = way_in != kNoWayIn ? ways_in_[way_in].cost : 0.0;
    const int ahead = way_in != kNoWayIn ? direction_of(ways_in_[way_in].parts.front()) : 0;
    for (const Shot &shot : shots_.find(pose_of(node), target, any_yaw, direction_of(node))) {
      if (node.cost + shot.cost + more >= best_cost_) break;
      const double cost = more + shot_cost(node, shot, ahead, best_cost_ - more);
      if (cost >= best_cost_) continue;
      if (best_node_ == kNoNode) first_found_ = expansions_;
      best_cost_ = cost, best_node_ = index, best_shot_ = shot, best_way_in_ = way_in;
    }
  }

  // Up to the direction `ahead` of what follows; infinite where it is `most` or more.
  double shot_cost(const HybridNode &node, const Shot &shot, int ahead, double most) {
    double cost = node.cost;
    int direction = direction_of(node);
    PlanarPose pose = pose_of(node);
    for (int i = 0; i < shot.count; ++i) {
      const Stretch &part = shot.parts[i];
      const int now = direction_of(part);
      const double dearer = now < 0 ? model_.reverse_penalty : 1.0;
      if (now * direction < 0) cost += model_.change_cost;
      direction = now;
      double sum = 0.0;
      const double room = (most - cost) / dearer;
      if (!memory_.checker.fits(pose, part, weights_, model_.turn_cost, room, sum)) return kInfinite;
      cost += dearer * sum;
      pose = part.from(pose);
    }
    return direction * ahead < 0 ? cost + model_.change_cost : cost;
  }

  // Once there is a way, it looks for a better one for a while that is in proportion; not where the first took a close look.
  bool spent_after_first() const {
    return best_node_ != kNoNode && expansions_ > (states_.close ? first_found_ : 4 * first_found_ + 500);
  }

  // Of nodes as near to the goal the one that was settled first.
  void keep_nearest(std::uint32_t index) {
    const HybridNode &node = memory_.nodes[index];
    const double distance = std::hypot(query_.goal.x - node.x, query_.goal.y - node.y);
    if (distance < nearest_) nearest_ = distance, nearest_node_ = index, nearest_at_ = expansions_;
  }

  // From the start to a node.
  void add_motions(std::uint32_t node, std::vector<Stretch> &parts) const {
    for (; memory_.nodes[node].parent != kNoNode; node = memory_.nodes[node].parent) {
      parts.push_back(motions_[memory_.nodes[node].motion].stretch);
    }
    std::reverse(parts.begin(), parts.end());
  }

  void finish(HybridWay &way) {
    way.expansions = expansions_;
    way.field_cells = guide_.field_cells();
    way.exact_checks = memory_.checker.exact_checks();
    way.status = status_;
    if (best_node_ == kNoNode) {
      if (status_ == SearchStatus::kFound && !way.spent) way.status = SearchStatus::kUnreachable;
      if (nearest_node_ == kNoNode || status_ != SearchStatus::kFound) return;
      way.partial = true;
      way.cost = memory_.nodes[nearest_node_].cost;
      add_motions(nearest_node_, way.parts);
      return;
    }
    way.status = SearchStatus::kFound, way.spent = false;
    way.cost = best_cost_;
    add_motions(best_node_, way.parts);
    way.parts.insert(way.parts.end(), best_shot_.parts, best_shot_.parts + best_shot_.count);
    if (best_way_in_ == kNoWayIn) return;
    const std::vector<Stretch> &last = ways_in_[best_way_in_].parts;
    way.parts.insert(way.parts.end(), last.begin(), last.end());
  }

  static constexpr double kInfinite = std::numeric_limits<double>::infinity();

  const HybridSettings settings_;
  const MotionModel model_;
  const HybridQuery query_;
  const Patience &patience_;
  HybridMemory &memory_;
  HybridGuide guide_;
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
  std::size_t best_way_in_ = kNoWayIn;  // what follows the shot
  std::vector<WayIn> ways_in_;
  bool is_out_ = false;  // whether the last look at the goal's pocket led out of it
  double least_left_ = kInfinite;  // of the nodes, by the guide as it is now, and where that is
  std::uint32_t foremost_ = 0;
  std::uint64_t advanced_at_ = 0;
  int detours_ = 0;
};

}  // namespace trundle
