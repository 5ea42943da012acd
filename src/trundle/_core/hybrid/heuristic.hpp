// The heuristic of a hybrid A* search: the larger of two costs from a pose to the goal, that of a point around the
// obstacles and that of the robot without obstacles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "hybrid/query.hpp"
#include "hybrid/search_memory.hpp"

namespace trundle {

class HybridHeuristic {
 public:
  HybridHeuristic(const HybridSettings &settings, const HybridQuery &query, const SearchLimits &limits, HybridMemory &memory)
      : model_(settings.model),
        query_(query),
        per_cost_(static_cast<float>(settings.cost_weight / 252.0)),
        limits_(limits),
        memory_(memory),
        detour_(settings.model.most_detour()),
        factor_(kFieldCells * settings.factor(query.resolution)) {}

  // Cost of the shortest curve.
  double least_cost(const PlanarPose &pose) const {
    const double dx = query_.goal.x - pose.x, dy = query_.goal.y - pose.y;
    if (query_.any_yaw) return std::hypot(dx, dy);
    const double cos = std::cos(pose.yaw), sin = std::sin(pose.yaw);
    return model_.least_cost(cos * dx + sin * dy, cos * dy - sin * dx,
                             wrap(std::remainder(query_.goal.yaw - pose.yaw, 2.0 * kPi)));
  }

  // The larger of that and what is known already. Most poses have such a long path around obstacles that no curve is
  // needed.
  double at_least(const PlanarPose &pose, double known) const {
    const double distance = std::hypot(query_.goal.x - pose.x, query_.goal.y - pose.y);
    return known >= distance + detour_ ? known : std::max(known, least_cost(pose));
  }

  // Cost of a point; its field is begun when this is first asked. `status` says why it was stopped, if it was.
  double field_at(double x, double y, SearchStatus &status) {
    if (!begun_) begin_field();
    const float cells = memory_.field.at(cell(y), cell(x), limits_, status);
    return static_cast<double>(cells) * query_.resolution * factor_;
  }

  // Leads around what comes next from a point, where that is possible: the cells that the field leads through cost
  // more.
  void avoid_ahead(double x, double y, SearchStatus &status) {
    LazyCostToGo::Cell here{cell(y), cell(x)};
    memory_.field.at(here.row, here.col, limits_, status);
    for (int i = 0; i < kAvoidedCells; ++i) {
      avoided_.push_back(here);
      here = memory_.field.next(here);
    }
    begin_field();
  }

  // Whether no path of a point leads to the goal, by the map's own cells: the field's may reach across thin walls. This
  // takes long, and is for searches that take long or fail.
  bool is_closed_off(SearchStatus &status) {
    const auto of = [&](double metres) { return static_cast<std::int64_t>(metres / query_.resolution); };
    const PlanarPose &start = query_.start, &goal = query_.goal;
    memory_.fine_field.begin(query_.costs, query_.rows, query_.cols, 1, per_cost_);
    memory_.fine_field.set_goal(of(goal.y), of(goal.x), of(start.y), of(start.x));
    return std::isinf(memory_.fine_field.at(of(start.y), of(start.x), limits_, status));
  }

  std::uint64_t field_cells() const { return settled_ + (begun_ ? memory_.field.expanded() : 0); }

 private:
  static constexpr int kFieldCells = 2;  // cells of states along a cell of the field
  static constexpr int kAvoidedCells = 4;  // of the field

  void begin_field() {
    settled_ = field_cells();
    memory_.field.begin(query_.costs, query_.rows, query_.cols, factor_, per_cost_, avoided_);
    const PlanarPose &start = query_.start, &goal = query_.goal;
    memory_.field.set_goal(cell(goal.y), cell(goal.x), cell(start.y), cell(start.x));
    begun_ = true;
  }

  // By the map's cells, so that every point of the map lies in one of these.
  std::int64_t cell(double metres) const { return static_cast<std::int64_t>(metres / query_.resolution) / factor_; }

  const MotionModel model_;
  const HybridQuery &query_;
  const float per_cost_;
  const SearchLimits &limits_;
  HybridMemory &memory_;
  const double detour_;
  const int factor_;
  bool begun_ = false;
  std::uint64_t settled_ = 0;  // by fields before this
  std::vector<LazyCostToGo::Cell> avoided_;
};

}  // namespace trundle
