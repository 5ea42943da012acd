// Straight lines over a grid whose cells have a weight each: what one costs, and the cheapest way to cut a path short.
//
// Points are (x, y) in grid units: cell (row, col) is the square [col, col + 1] × [row, row + 1]. A line costs
// ∫ weight ds, clipped exactly at the cells' borders. A line along a border takes the dearer of the two cells; one
// through the corner of four cells needs all of them free.
#include "arrays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trundle {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kOnBorder = 1e-9;

struct Point {
  double x, y;
};

struct Grid {
  const std::uint8_t *costs;
  const double *weights;  // by cost, 256 entries, 0 where a cell is blocked
  std::int64_t rows, cols;

  // 0 where the cell is blocked or outside.
  double weight(std::int64_t row, std::int64_t col) const {
    if (row < 0 || row >= rows || col < 0 || col >= cols) return 0.0;
    return weights[costs[row * cols + col]];
  }
};

double distance(const Point &a, const Point &b) { return std::hypot(b.x - a.x, b.y - a.y); }

// A line parallel to an axis on the border of two rows (or columns) of cells.
bool runs_on_border(double a, double b) {
  return std::abs(a - b) < kOnBorder && std::abs(a - std::round(a)) < kOnBorder;
}

double along_border(const Grid &grid, const Point &a, const Point &b, bool horizontal) {
  const auto line = static_cast<std::int64_t>(std::llround(horizontal ? a.y : a.x));
  const double from = horizontal ? std::min(a.x, b.x) : std::min(a.y, b.y);
  const double to = horizontal ? std::max(a.x, b.x) : std::max(a.y, b.y);
  double total = 0.0;
  for (auto k = static_cast<std::int64_t>(std::floor(from)); static_cast<double>(k) < to; ++k) {
    const double first = horizontal ? grid.weight(line - 1, k) : grid.weight(k, line - 1);
    const double second = horizontal ? grid.weight(line, k) : grid.weight(k, line);
    if (first == 0.0 || second == 0.0) return kInfinity;
    const double length = std::min(to, static_cast<double>(k + 1)) - std::max(from, static_cast<double>(k));
    total += length * std::max(first, second);
  }
  return total;
}

// Cost of the line from a to b; infinity where it is blocked, or as soon as it must come to more than `limit` (with
// `cheapest` as the smallest weight).
double line_cost(const Grid &grid, const Point &a, const Point &b, double limit, double cheapest) {
  if (runs_on_border(a.y, b.y)) return along_border(grid, a, b, true);
  if (runs_on_border(a.x, b.x)) return along_border(grid, a, b, false);
  const double dx = b.x - a.x, dy = b.y - a.y, length = std::hypot(dx, dy);
  const std::int64_t step_col = dx > 0 ? 1 : -1, step_row = dy > 0 ? 1 : -1;
  // A point on a border belongs to the cell that the line goes into.
  auto first_cell = [](double value, std::int64_t step) {
    const double nearest = std::round(value);
    if (std::abs(value - nearest) < kOnBorder) return static_cast<std::int64_t>(nearest) - (step > 0 ? 0 : 1);
    return static_cast<std::int64_t>(std::floor(value));
  };
  std::int64_t col = first_cell(a.x, step_col), row = first_cell(a.y, step_row);
  const double per_col = dx != 0.0 ? std::abs(1.0 / dx) : 0.0;
  const double per_row = dy != 0.0 ? std::abs(1.0 / dy) : 0.0;
  const double start_col = dx != 0.0 ? (static_cast<double>(col + (step_col > 0 ? 1 : 0)) - a.x) / dx : kInfinity;
  const double start_row = dy != 0.0 ? (static_cast<double>(row + (step_row > 0 ? 1 : 0)) - a.y) / dy : kInfinity;
  const double near = kOnBorder / std::max(length, kOnBorder);
  std::int64_t cols_done = 0, rows_done = 0;
  double at = 0.0, total = 0.0;
  while (true) {
    const double weight = grid.weight(row, col);
    if (weight == 0.0) return kInfinity;
    const double next_col = start_col + static_cast<double>(cols_done) * per_col;
    const double next_row = start_row + static_cast<double>(rows_done) * per_row;
    const double next = std::min(next_col, next_row);
    if (next >= 1.0 - near) return total + (1.0 - at) * length * weight;
    total += (next - at) * length * weight;
    at = next;
    if (total + (1.0 - at) * length * cheapest > limit) return kInfinity;
    if (std::abs(next_col - next_row) <= near) {
      if (grid.weight(row + step_row, col) == 0.0 || grid.weight(row, col + step_col) == 0.0) return kInfinity;
      col += step_col;
      row += step_row;
      ++cols_done;
      ++rows_done;
    } else if (next_col < next_row) {
      col += step_col;
      ++cols_done;
    } else {
      row += step_row;
      ++rows_done;
    }
  }
}

double cheapest_weight(const double *weights) {
  double cheapest = kInfinity;
  for (int cost = 0; cost < 256; ++cost) {
    if (weights[cost] > 0.0) cheapest = std::min(cheapest, weights[cost]);
  }
  return cheapest;
}

// Whether b lies on the straight line from a to c, between them.
bool is_between(const Point &a, const Point &b, const Point &c) {
  const double length = distance(a, c);
  const double off = std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
  const double along = (b.x - a.x) * (c.x - a.x) + (b.y - a.y) * (c.y - a.y);
  return off <= kOnBorder * length && along >= 0.0 && along <= length * length;
}

// The cheapest chain of straight lines from the first to the last of the points, through some of those between. From
// each point it looks back along the path until this many lines in a row were blocked or too dear.
constexpr int kGiveUpAfter = 64;

std::vector<std::int64_t> shorten(const Grid &grid, const std::vector<Point> &points, double &cost) {
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

std::vector<Point> read_points(const In<double, 2> &array) {
  if (array.shape(1) != 2) throw nb::value_error("points need shape (N, 2)");
  std::vector<Point> points(array.shape(0));
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = {array.data()[2 * i], array.data()[2 * i + 1]};
    if (!(std::abs(points[i].x) < 1e9 && std::abs(points[i].y) < 1e9)) throw nb::value_error("points must be finite");
  }
  return points;
}

Grid make_grid(const In<std::uint8_t, 2> &costs, const In<double, 1> &weights) {
  if (weights.size() != 256) throw nb::value_error("the weights need one entry for each of the 256 costs");
  return {costs.data(), weights.data(), static_cast<std::int64_t>(costs.shape(0)),
          static_cast<std::int64_t>(costs.shape(1))};
}

}  // namespace

static nb::ndarray<nb::numpy, double> line_costs(In<std::uint8_t, 2> costs, In<double, 1> weights, In<double, 2> starts,
                                                 In<double, 2> ends) {
  const Grid grid = make_grid(costs, weights);
  const std::vector<Point> from = read_points(starts), to = read_points(ends);
  if (from.size() != to.size()) throw nb::value_error("as many ends as starts are needed");
  std::vector<double> totals(from.size());
  {
    nb::gil_scoped_release release;
    for (std::size_t i = 0; i < from.size(); ++i) totals[i] = line_cost(grid, from[i], to[i], kInfinity, 0.0);
  }
  return to_numpy(std::move(totals), {from.size()});
}

static nb::tuple shortcut(In<std::uint8_t, 2> costs, In<double, 1> weights, In<double, 2> points) {
  const Grid grid = make_grid(costs, weights);
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

void bind_line_of_sight(nanobind::module_ &m) {
  namespace nb = nanobind;
  m.def("line_costs", &trundle::line_costs, nb::arg("costs").noconvert(), nb::arg("weights").noconvert(),
        nb::arg("starts").noconvert(), nb::arg("ends").noconvert());
  m.def("shortcut", &trundle::shortcut, nb::arg("costs").noconvert(), nb::arg("weights").noconvert(),
        nb::arg("points").noconvert());
}
