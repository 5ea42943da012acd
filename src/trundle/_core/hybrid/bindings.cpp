// `HybridAStar` and `flood_poses` as Python sees them: paths of an oriented footprint between poses.
#include "curves/segments.hpp"
#include "hybrid/kernels.hpp"
#include "hybrid/search.hpp"
#include "shared/arrays.hpp"
#include "shared/call_limits.hpp"
#include "shared/memory_pool.hpp"

#include <nanobind/stl/optional.h>

#include <cmath>
#include <memory>
#include <utility>

namespace trundle {

namespace {

// Poses along the parts, and for each pose but the first whether it is reached backwards.
void sample(const PlanarPose &start, const PlanarPose &goal, const std::vector<Segment> &parts, double spacing,
            std::vector<double> &poses, std::vector<std::uint8_t> &backward) {
  const auto add = [&](const PlanarPose &pose, bool back) {
    poses.insert(poses.end(), {pose.x, pose.y, pose.yaw});
    backward.push_back(back ? 1 : 0);
  };
  poses = {start.x, start.y, start.yaw};
  const PlanarPose end = for_each_pose(start, parts, spacing, add);
  if (parts.empty()) add(goal, false);
  // Without what rounding added up along the parts.
  poses[poses.size() - 3] = goal.x, poses[poses.size() - 2] = goal.y;
  if (!parts.empty()) poses[poses.size() - 1] = end.yaw;
}

bool is_number(double value, double least, double most) { return value >= least && value <= most; }

}  // namespace

class HybridAStar {
 public:
  HybridAStar(double radius, bool reverse, bool in_place, double reverse_penalty, double change_cost, double turn_cost,
              double cost_weight, double heuristic_weight, double cell_size)
      : settings_{{radius, reverse, in_place, reverse_penalty, change_cost, turn_cost}, cost_weight, heuristic_weight,
                  cell_size} {
    if (!is_number(radius, 0.0, 1e6) || (radius < 1e-3 && !(radius == 0.0 && in_place))) {
      throw nb::value_error("the radius must be from 0.001 to 1e6, or 0 for a robot that turns in place");
    }
    if (!is_number(reverse_penalty, 1.0, 1e6) || !is_number(change_cost, 0.0, 1e6) || !is_number(turn_cost, 0.0, 1e6) ||
        !is_number(cost_weight, 0.0, 1e3) || !is_number(heuristic_weight, 1.0, 1e3) ||
        !is_number(cell_size, 1e-6, 1e6)) {
      throw nb::value_error("a cost or weight is out of range");
    }
  }

  nb::tuple plan(In<std::uint8_t, 2> costs, double resolution, In<double, 2> outline, In<double, 1> start,
                 In<double, 1> goal, bool any_yaw, double step, double spacing, std::uint64_t max_expansions,
                 std::optional<double> seconds, Flag cancel, bool partial, std::optional<In<double, 2>> inner,
                 bool thorough) const {
    const HybridQuery query{costs.data(),     static_cast<std::int64_t>(costs.shape(0)),
                            static_cast<std::int64_t>(costs.shape(1)),
                            resolution,       outline.data(),
                            outline.shape(0), pose_of(start),
                            pose_of(goal),    any_yaw,
                            step,             max_expansions,
                            inner ? inner->data() : nullptr,
                            thorough,
                            partial};
    if (outline.shape(1) != 2 || outline.shape(0) < 3) throw nb::value_error("the outline needs shape (N, 2), N >= 3");
    if (inner && (inner->shape(1) != 2 || inner->shape(0) != outline.shape(0))) {
      throw nb::value_error("the inner outline needs the shape of the outline");
    }
    if (!is_number(resolution, 1e-6, 1e6) || !is_number(step, 1e-6, 1e6) || !is_number(spacing, 1e-6, 1e6)) {
      throw nb::value_error("resolution, step and spacing must be positive numbers");
    }
    for (const PlanarPose &pose : {query.start, query.goal}) {
      if (!is_inside(query, pose)) throw nb::value_error("start and goal must lie on the grid");
    }
    const CallLimits limits(seconds, cancel);
    HybridPath path;
    std::vector<double> poses, parts;
    std::vector<std::uint8_t> backward;
    {
      nb::gil_scoped_release release;
      std::unique_ptr<HybridMemory> memory = pool_.borrow();
      path = search(query, limits, *memory);
      pool_.give_back(std::move(memory));
      if ((path.status == SearchStatus::kFound && !path.spent) || path.partial) {
        const std::vector<Segment> joined = merged(path.parts);
        PlanarPose end = query.goal;
        if (path.partial) {
          end = query.start;
          for (const Segment &part : joined) end = part.from(end);
        }
        sample(query.start, end, joined, spacing, poses, backward);
        for (const Segment &part : joined) parts.insert(parts.end(), {part.length, part.turn});
      }
    }
    limits.rethrow();
    const std::size_t count = poses.size() / 3, legs = backward.size(), pieces = parts.size() / 2;
    int status = path.spent ? 4 : static_cast<int>(path.status);
    if (path.status == SearchStatus::kUnreachable && !path.spent) {
      if (path.closed_off) status = 5;
      if (path.pocket) status = 6;
      if (path.stuck) status = 7;
    }
    return nb::make_tuple(status, to_numpy(std::move(poses), {count, 3}),
                          to_numpy(std::move(backward), {legs}), to_numpy(std::move(parts), {pieces, 2}), path.cost,
                          nb::make_tuple(path.expansions, path.field_cells, path.exact_checks));
  }

  // Memory that is kept for the next query.
  std::size_t bytes() const { return pool_.bytes(); }

 private:
  HybridPath search(const HybridQuery &query, const SearchLimits &limits, HybridMemory &memory) const {
    if (query.thorough) return look_closely(query, limits, memory);
    HybridPath path = HybridSearch(settings_, query, limits, memory).find();
    // A start that is hard to get away from may be a matter of shorter motions; a goal is not, as curves end there.
    if (path.stuck && path.status == SearchStatus::kUnreachable) {
      path = HybridSearch(settings_, query, limits, memory, kHalfStates).find();
    }
    return path;
  }

  // A gap that a robot fits with a centimetre to spare may lie between the states and motions of the first search.
  // Returns the answer of the closest search, or of the first one that found a path or was spent.
  HybridPath look_closely(HybridQuery query, const SearchLimits &limits, HybridMemory &memory) const {
    query.max_expansions = std::min(query.max_expansions, kMostClose);
    HybridPath path;
    for (const StateGrid &states : {kHalfStates, kCloseStates, kClosestStates}) {
      const std::uint64_t before = path.expansions;
      path = HybridSearch(settings_, query, limits, memory, states).find();
      const bool soon_over = path.expansions < kSoonOver;
      path.expansions += before;
      const bool is_over = path.status != SearchStatus::kUnreachable || path.spent || path.closed_off;
      if (is_over || (states.close && !soon_over)) break;
    }
    return path;
  }

  static constexpr std::uint64_t kMostClose = 100'000, kSoonOver = 5'000;  // expansions

  static PlanarPose pose_of(const In<double, 1> &values) {
    if (values.shape(0) != 3) throw nb::value_error("a pose needs three numbers");
    return {values.data()[0], values.data()[1], values.data()[2]};
  }

  static bool is_inside(const HybridQuery &query, const PlanarPose &pose) {
    const double col = pose.x / query.resolution, row = pose.y / query.resolution;
    return col >= 0.0 && row >= 0.0 && col < static_cast<double>(query.cols) && row < static_cast<double>(query.rows) &&
           std::fabs(pose.yaw) < 1e6;
  }

  const HybridSettings settings_;
  mutable MemoryPool<HybridMemory> pool_;
};

}  // namespace trundle

void bind_hybrid(nanobind::module_ &m) {
  namespace nb = nanobind;
  nb::class_<trundle::HybridAStar>(m, "HybridAStar")
      .def(nb::init<double, bool, bool, double, double, double, double, double, double>(), nb::kw_only(),
           nb::arg("radius"), nb::arg("reverse"), nb::arg("in_place"), nb::arg("reverse_penalty"),
           nb::arg("change_cost"), nb::arg("turn_cost"), nb::arg("cost_weight"), nb::arg("heuristic_weight"),
           nb::arg("cell_size"))
      .def("plan", &trundle::HybridAStar::plan, nb::arg("costs").noconvert(), nb::arg("resolution"),
           nb::arg("outline").noconvert(), nb::arg("start").noconvert(), nb::arg("goal").noconvert(),
           nb::arg("any_yaw"), nb::arg("step"), nb::arg("spacing"), nb::arg("max_expansions"),
           nb::arg("seconds").none(), nb::arg("cancel").none(), nb::arg("partial") = false,
           nb::arg("inner").noconvert() = nb::none(), nb::arg("thorough") = false)
      .def_prop_ro("bytes", &trundle::HybridAStar::bytes);
  m.def("flood_poses", &trundle::flood_poses, nb::arg("costs").noconvert(), nb::arg("resolution"),
        nb::arg("outline").noconvert(), nb::arg("start").noconvert(), nb::arg("any_yaw"), nb::arg("goal").noconvert(),
        nb::arg("goal_any_yaw"), nb::arg("cell"), nb::arg("headings"), nb::arg("most"), nb::arg("seconds").none(),
        nb::arg("cancel").none());
}
