// Straight lines over a grid whose cells have a weight each: what they cost, and the cheapest shortcut of a path.
#include "cost/kernels.hpp"
#include "cost/line_cost.hpp"

#include <algorithm>

namespace trundle {

using namespace lines;

namespace {

// Whether b lies on the straight line from a to c, between them.
bool is_between(const Point &a, const Point &b, const Point &c) {
  const double length = distance(a, c);
  const double off = std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
  const double along = (b.x - a.x) * (c.x - a.x) + (b.y - a.y) * (c.y - a.y);
  return off <= kOnBorder * length && along >= 0.0 && along <= length * length && distance(a, b) <= length;
}

// The cheapest chain of straight lines from the first to the last of the points, through some of those between. From
// each point it looks back along the path until this many lines in a row were blocked or cost too much.
constexpr int kGiveUpAfter = 64;

std::vector<std::int64_t> shorten(const WeightedGrid &grid, const std::vector<Point> &points, double &cost) {
  const std::size_t count = points.size();
  const double cheapest = cheapest_weight(grid.weights);
  std::vector<double> best(count, kInfinity);
  std::vector<std::size_t> before(count, 0);
  best[0] = 0.0;
  for (std::size_t j = 1; j < count; ++j) {
    int failures = 0;
    for (std::size_t i = j; i-- > 0 && failures < kGiveUpAfter; ++failures) {
      const double room = best[j] - best[i];
      if (!(distance(points[i], points[j]) * cheapest < room)) continue;
      const double total = best[i] + line_cost(grid, points[i], points[j], room, cheapest);
      if (total < best[j]) {
        best[j] = total;
        before[j] = i;
        failures = -1;
      }
    }
  }
  cost = best[count - 1];
  std::vector<std::int64_t> chosen;
  if (cost == kInfinity) return chosen;
  for (std::size_t j = count - 1;; j = before[j]) {
    // A chain that goes straight on costs the same with fewer points.
    while (chosen.size() > 1 && is_between(points[chosen[chosen.size() - 2]], points[chosen.back()], points[j])) {
      chosen.pop_back();
    }
    chosen.push_back(static_cast<std::int64_t>(j));
    if (j == 0) break;
  }
  std::reverse(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace

nb::ndarray<nb::numpy, double> line_costs(In<std::uint8_t, 2> costs, In<double, 1> weights, In<double, 2> starts,
                                          In<double, 2> ends) {
  const WeightedGrid grid = make_grid(costs, weights);
  const std::vector<Point> from = read_points(starts), to = read_points(ends);
  if (from.size() != to.size()) throw nb::value_error("as many ends as starts are needed");
  std::vector<double> totals(from.size());
  {
    nb::gil_scoped_release release;
    for (std::size_t i = 0; i < from.size(); ++i) totals[i] = line_cost(grid, from[i], to[i], kInfinity, 0.0);
  }
  return to_numpy(std::move(totals), {from.size()});
}

nb::tuple shortcut(In<std::uint8_t, 2> costs, In<double, 1> weights, In<double, 2> points) {
  const WeightedGrid grid = make_grid(costs, weights);
  const std::vector<Point> polyline = read_points(points);
  if (polyline.empty()) throw nb::value_error("a path needs a point");
  std::vector<std::int64_t> chosen;
  double cost = 0.0;
  {
    nb::gil_scoped_release release;
    chosen = shorten(grid, polyline, cost);
  }
  const std::size_t count = chosen.size();
  return nb::make_tuple(to_numpy(std::move(chosen), {count}), cost);
}

}  // namespace trundle
