// `PathSmoother` as Python sees it: a path's course made of curves that the robot can drive, clear of costs, with room
// for its footprint.
//
// Two rounds: the first replaces parts of the path by shorter curves, the second by curves along an elastic band beside
// it.
#include "curves/segments.hpp"
#include "shared/arrays.hpp"
#include "shared/memory_pool.hpp"
#include "smoothing/elastic_band.hpp"
#include "smoothing/lazy_chain.hpp"

#include <nanobind/stl/optional.h>

#include <optional>
#include <utility>

namespace trundle {

namespace {

using namespace smoothing;

constexpr double kSamePlace = 1e-9;
constexpr int kBands = 1;

struct Request {
  footprint::Costs costs;
  double resolution;
  const double *outline, *inner;  // the padded outline, and the one that has to be free where that is another, or null
  std::size_t corners;
  const double *poses;
  const std::uint8_t *backward;
  std::size_t count;
  double step, spacing;
};

struct Smoothed {
  std::vector<double> poses;
  std::vector<std::uint8_t> backward;
  std::vector<std::int32_t> source;  // for each pose that of the request that it is, or -1
  std::vector<std::uint8_t> kept;    // for each leg whether it is one of the request's, or lies on one
  PathCost before, after;            // the total in the planners' unit
};

// The legs of poses, turns in place among them.
std::vector<Piece> read(const double *poses, const std::uint8_t *backward, std::size_t count) {
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const double *a = poses + 3 * i, *b = a + 3;
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    const double turn = std::remainder(b[2] - a[2], 2.0 * kPi);
    const bool stays = length <= kSamePlace;
    if (stays && std::fabs(turn) <= kSamePlace) continue;
    const double sign = backward[i] != 0 ? -1.0 : 1.0;
    pieces.push_back({{a[0], a[1], a[2]}, {b[0], b[1], b[2]}, {stays ? 0.0 : sign * length, turn},
                      static_cast<std::int32_t>(i)});
  }
  return pieces;
}

PathCost total(const std::vector<Piece> &legs, const CostModel &model) {
  PathCost sum;
  int last = 0;
  for (const Piece &leg : legs) {
    const PathCost price = model.planner_cost(leg);
    sum.line += price.line, sum.total += price.total;
    if (last * leg.direction() < 0) sum.total += model.settings().model.change_cost;
    last = leg.direction();
  }
  return sum;
}

Smoothed write(const Request &request, const std::vector<Piece> &pieces) {
  Smoothed out;
  const auto add = [&](const PlanarPose &pose, bool back, bool kept, std::int32_t source) {
    out.poses.insert(out.poses.end(), {pose.x, pose.y, pose.yaw});
    out.source.push_back(source);
    out.backward.push_back(back ? 1 : 0);
    out.kept.push_back(kept ? 1 : 0);
  };
  const double *first = request.poses;
  out.poses = {first[0], first[1], first[2]};
  out.source = {0};
  for (std::size_t i = 0; i < pieces.size();) {
    const PlanarPose from = pieces[i].from;
    std::size_t end = i + 1;
    if (pieces[i].is_kept()) {
      while (end < pieces.size() && pieces[end].leg == pieces[i].leg) ++end;
      const Piece &last = pieces[end - 1];
      const double *to = request.poses + 3 * (pieces[i].leg + 1);
      const bool whole = last.to.x == to[0] && last.to.y == to[1] && last.to.yaw == to[2];
      add(last.to, last.segment.length < 0.0, true, whole ? last.leg + 1 : -1);
    } else {
      std::vector<Segment> parts{pieces[i].segment};
      while (end < pieces.size() && !pieces[end].is_kept()) parts.push_back(pieces[end++].segment);
      const std::vector<Segment> joined = merged(parts);
      const PlanarPose &to = pieces[end - 1].to;
      for_each_pose(from, joined, request.spacing,
                    [&](const PlanarPose &pose, bool back) { add(pose, back, false, -1); });
      if (joined.empty()) add(to, false, false, -1);
      // Without what rounding added up along the parts.
      out.poses[out.poses.size() - 3] = to.x, out.poses[out.poses.size() - 2] = to.y;
      out.poses[out.poses.size() - 1] = to.yaw;
    }
    i = end;
  }
  out.source.back() = static_cast<std::int32_t>(request.count - 1);
  return out;
}

Smoothed smooth(const Request &request, const Settings &settings, PoseChecker &checker) {
  std::vector<Piece> pieces = read(request.poses, request.backward, request.count);
  if (pieces.empty()) return {};
  checker.begin(request.costs.data, request.costs.rows, request.costs.cols, request.resolution, request.outline,
                request.corners, request.step, request.inner);
  CostModel costs(settings, request.costs, checker, request.resolution, request.spacing);
  int highest = 0;
  for (const Piece &piece : pieces) highest = std::max(highest, costs.highest(piece));
  costs.set_ceiling(highest);
  const PathCost before = total(pieces, costs);
  double length = 0.0;
  for (const Piece &piece : pieces) length += std::fabs(piece.segment.length);
  // On paths of many hundred metres stations lie further apart: there are about 4000 at most.
  const double apart = std::max(std::clamp(settings.model.radius, 0.25, 1.0), length / 4000.0);
  // Each round may use its share of the tolerance.
  const double tolerance = std::pow(1.0 + settings.cost_tolerance, 1.0 / (1 + kBands)) - 1.0;
  const Slope slope(request.costs, checker, settings.cost_weight, request.resolution);
  std::vector<std::vector<Piece>> rounds{std::move(pieces)};
  for (int round = 0; round <= kBands; ++round) {
    std::vector<Piece> cut = rounds.back();
    const std::vector<Station> stations = lay_stations(cut, costs, apart);
    std::vector<std::optional<PlanarPose>> band(stations.size());
    if (round > 0) band = band_poses(cut, stations, 0.4 * apart, settings.curve_weight, slope, checker);
    rounds.push_back(LazyChain(cut, stations, band, costs, tolerance).find(checker));
  }
  // The chords returned are not those that were costed, which matters where cells differ much: drop rounds that fail.
  for (;; rounds.pop_back()) {
    Smoothed out = write(request, rounds.back());
    out.before = before;
    out.after = total(read(out.poses.data(), out.backward.data(), out.source.size()), costs);
    if (rounds.size() == 1 || out.after.line <= (1.0 + settings.cost_tolerance) * before.line) return out;
  }
}

bool is_number(double value, double least, double most) { return value >= least && value <= most; }

}  // namespace

// Keeps memory for the next path; several threads may smooth with it at once.
class PathSmoother {
 public:
  nb::tuple smooth(In<std::uint8_t, 2> costs, double resolution, In<double, 2> outline, In<double, 2> poses,
                   In<std::uint8_t, 1> backward, double radius, double reverse_penalty, double change_cost, double turn_cost,
                   double cost_weight, double curve_weight, double cost_tolerance, double step, double spacing,
                   std::optional<In<double, 2>> inner);

 private:
  MemoryPool<PoseChecker> checkers_;
};

nb::tuple PathSmoother::smooth(In<std::uint8_t, 2> costs, double resolution, In<double, 2> outline, In<double, 2> poses,
                               In<std::uint8_t, 1> backward, double radius, double reverse_penalty, double change_cost,
                               double turn_cost, double cost_weight, double curve_weight, double cost_tolerance,
                               double step, double spacing, std::optional<In<double, 2>> inner) {
  if (outline.shape(1) != 2 || outline.shape(0) < 3) throw nb::value_error("the outline needs shape (N, 2), N >= 3");
  if (inner && (inner->shape(1) != 2 || inner->shape(0) != outline.shape(0))) {
    throw nb::value_error("the inner outline needs the shape of the outline");
  }
  if (poses.shape(1) != 3 || poses.shape(0) < 1 || backward.shape(0) + 1 != poses.shape(0)) {
    throw nb::value_error("the poses need shape (N, 3), N >= 1, and backward shape (N - 1,)");
  }
  if (!is_number(resolution, 1e-6, 1e6) || !is_number(radius, 1e-3, 1e6) || !is_number(step, 1e-6, 1e6) ||
      !is_number(spacing, 1e-6, 1e6)) {
    throw nb::value_error("resolution, radius, step and spacing must be positive numbers");
  }
  if (!is_number(reverse_penalty, 1.0, 1e6) || !is_number(change_cost, 0.0, 1e6) || !is_number(turn_cost, 0.0, 1e6) ||
      !is_number(cost_weight, 0.0, 1e6) || !is_number(curve_weight, 0.0, 1e6) || !is_number(cost_tolerance, 0.0, 1e6)) {
    throw nb::value_error("a cost, weight or tolerance is out of range");
  }
  for (std::size_t i = 0; i < 3 * poses.shape(0); ++i) {
    if (!(std::fabs(poses.data()[i]) < 1e6)) throw nb::value_error("poses must be finite, and below 1e6");
  }
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < poses.shape(0); ++i) {
    const double *a = poses.data() + 3 * i;
    length += std::hypot(a[3] - a[0], a[4] - a[1]);
  }
  if (length > 1e7 * std::min({resolution, step, spacing})) {
    throw nb::value_error("resolution, step or spacing is out of range: more than ten million of them are on the path");
  }
  const Request request{{costs.data(), static_cast<std::ptrdiff_t>(costs.shape(0)), static_cast<std::ptrdiff_t>(costs.shape(1))},
                        resolution, outline.data(), inner ? inner->data() : nullptr, outline.shape(0), poses.data(), backward.data(), poses.shape(0),
                        step, spacing};
  const Settings settings{{radius, true, true, reverse_penalty, change_cost, turn_cost}, cost_weight, curve_weight, cost_tolerance};
  Smoothed out;
  {
    nb::gil_scoped_release release;
    std::unique_ptr<PoseChecker> checker = checkers_.borrow();
    out = trundle::smooth(request, settings, *checker);
    checkers_.give_back(std::move(checker));
  }
  const std::size_t count = out.poses.size() / 3, legs = out.kept.size();
  return nb::make_tuple(to_numpy(std::move(out.poses), {count, 3}), to_numpy(std::move(out.backward), {legs}),
                        to_numpy(std::move(out.source), {count}), to_numpy(std::move(out.kept), {legs}),
                        nb::make_tuple(out.before.line, out.before.total, out.after.line, out.after.total));
}

}  // namespace trundle

void bind_smoothing(nanobind::module_ &m) {
  namespace nb = nanobind;
  nb::class_<trundle::PathSmoother>(m, "PathSmoother")
      .def(nb::init<>())
      .def("smooth", &trundle::PathSmoother::smooth, nb::arg("costs").noconvert(), nb::arg("resolution"),
           nb::arg("outline").noconvert(), nb::arg("poses").noconvert(), nb::arg("backward").noconvert(), nb::kw_only(),
           nb::arg("radius"), nb::arg("reverse_penalty"), nb::arg("change_cost"), nb::arg("turn_cost"),
           nb::arg("cost_weight"), nb::arg("curve_weight"), nb::arg("cost_tolerance"), nb::arg("step"),
           nb::arg("spacing"), nb::arg("inner").noconvert() = nb::none());
}
