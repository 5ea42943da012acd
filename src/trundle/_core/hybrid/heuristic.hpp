// What is at least left from a pose to the goal of a hybrid A* search, two bounds of which the larger counts: what it costs
// a point that goes round the obstacles, and the robot where there are none.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "hybrid/query.hpp"
#include "hybrid/search_memory.hpp"

namespace trundle {

class HybridGuide {
 public:
  HybridGuide(const HybridSettings &settings, const HybridQuery &query, const Patience &patience, HybridMemory &memory)
      : model_(settings.model),
        query_(query),
        per_cost_(static_cast<float>(settings.cost_weight / 252.0)),
        patience_(patience),
        memory_(memory),
        detour_(settings.model.most_detour()),
        factor_(kFieldCells * settings.factor(query.resolution)) {}

  // Of the shortest curve.
  double least_cost(const PlanarPose &pose) const {
    const double dx = query_.goal.x - pose.x, dy = query_.goal.y - pose.y;
    if (query_.any_yaw) return std::hypot(dx, dy);
    const double cos = std::cos(pose.yaw), sin = std::sin(pose.yaw);
    return model_.least_cost(cos * dx + sin * dy, cos * dy - sin * dx,
                             wrap(std::remainder(query_.goal.yaw - pose.yaw, 2.0 * kPi)));
  }

  // The larger of that and what is known already; most poses are so far round that a curve need not be looked for.
  double at_least(const PlanarPose &pose, double known) const {
    const double distance = std::hypot(query_.goal.x - pose.x, query_.goal.y - pose.y);
    return known >= distance + detour_ ? known : std::max(known, least_cost(pose));
  }

  // Of a point; its field is begun when this is first asked. Where patience ends `status` says so.
  double field_at(double x, double y, SearchStatus &status) {
    if (!begun_) begin_field();
    const float cells = memory_.field.at(cell(y), cell(x), patience_, status);
    return static_cast<double>(cells) * query_.resolution * factor_;
  }

  // Leads another way from a point, where there is one: what the field leads through next becomes dear.
  void avoid_ahead(double x, double y, SearchStatus &status) {
    LazyCostToGo::Place here{cell(y), cell(x)};
    memory_.field.at(here.row, here.col, patience_, status);
    for (int i = 0; i < kAvoidedCells; ++i) {
      avoided_.push_back(here);
      here = memory_.field.next(here);
    }
    begin_field();
  }

  // Whether a point cannot get there. The field's cells may reach across thin walls, and those of the map do not; this is
  // for searches that take long or fail.
  bool is_closed_off(SearchStatus &status) {
    const auto of = [&](double metres) { return static_cast<std::int64_t>(metres / query_.resolution); };
    const PlanarPose &start = query_.start, &goal = query_.goal;
    memory_.fine_field.begin(query_.costs, query_.rows, query_.cols, 1, per_cost_);
    memory_.fine_field.set_goal(of(goal.y), of(goal.x), of(start.y), of(start.x));
    return std::isinf(memory_.fine_field.at(of(start.y), of(start.x), patience_, status));
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

  // By the map's cells, so that what lies on the map lies in one of these.
  std::int64_t cell(double metres) const { return static_cast<std::int64_t>(metres / query_.resolution) / factor_; }

  const MotionModel model_;
  const HybridQuery &query_;
  const float per_cost_;
  const Patience &patience_;
  HybridMemory &memory_;
  const double detour_;
  const int factor_;
  bool begun_ = false;
  std::uint64_t settled_ = 0;  // by fields before this
  std::vector<LazyCostToGo::Place> avoided_;
};

}  // namespace trundle
