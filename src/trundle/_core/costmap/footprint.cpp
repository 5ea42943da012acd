// A convex footprint at many poses against the blocked cells of a costmap: does it touch, and how far away are they.
//
// Everything is in grid units: cell (row, col) is the square [col, col + 1] × [row, row + 1].
#include "costmap/footprint_sweep.hpp"
#include "costmap/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trundle {

namespace {

using namespace footprint;

double square(double value) { return value * value; }

// Squared distance from a point to a segment.
double to_segment(double x, double y, const Point &a, const Point &b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double t = std::clamp(((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return square(a.x + t * dx - x) + square(a.y + t * dy - y);
}

// Squared distance between a convex polygon and a cell that do not overlap: it is taken at a corner of one of them.
double to_cell(const std::vector<Point> &polygon, double col, double row) {
  double best = kInfinity;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point &p = polygon[i];
    const double dx = std::max({col - p.x, p.x - (col + 1.0), 0.0});
    const double dy = std::max({row - p.y, p.y - (row + 1.0), 0.0});
    best = std::min(best, dx * dx + dy * dy);
    for (int corner = 0; corner < 4; ++corner) {
      best = std::min(best, to_segment(col + (corner & 1), row + (corner >> 1), polygon[j], p));
    }
  }
  return best;
}

// Distance to the nearest blocked cell or to the map's edge, at most `cap`, of a polygon that touches nothing.
double nearest(const Costs &costs, const std::vector<Point> &polygon, const Box &box, double cap) {
  double best = std::min({cap, box.min_x, box.min_y, static_cast<double>(costs.cols) - box.max_x,
                          static_cast<double>(costs.rows) - box.max_y});
  best = std::max(best, 0.0);
  double searched = 0.0;
  for (double window = std::min(best, 4.0); searched < best; window = std::min(best, 2.0 * window)) {
    const auto first_row = static_cast<std::ptrdiff_t>(std::floor(std::max(0.0, box.min_y - window)));
    const auto first_col = static_cast<std::ptrdiff_t>(std::floor(std::max(0.0, box.min_x - window)));
    const auto last_row = std::min(costs.rows, static_cast<std::ptrdiff_t>(std::ceil(box.max_y + window))) - 1;
    const auto last_col = std::min(costs.cols, static_cast<std::ptrdiff_t>(std::ceil(box.max_x + window))) - 1;
    double best_squared = best * best;
    for (std::ptrdiff_t r = first_row; r <= last_row; ++r) {
      const double dy = std::max({static_cast<double>(r) - box.max_y, box.min_y - static_cast<double>(r + 1), 0.0});
      if (dy * dy >= best_squared) continue;
      const std::uint8_t *cells = costs.data + r * costs.cols;
      for (auto c = next_blocked(cells, first_col, last_col); c <= last_col; c = next_blocked(cells, c + 1, last_col)) {
        const double dx = std::max({static_cast<double>(c) - box.max_x, box.min_x - static_cast<double>(c + 1), 0.0});
        if (dx * dx + dy * dy >= best_squared) continue;
        // A cell with blocked cells on all four sides is behind one of them.
        if (r > 0 && r + 1 < costs.rows && c > 0 && c + 1 < costs.cols && costs.blocked(r - 1, c) &&
            costs.blocked(r + 1, c) && costs.blocked(r, c - 1) && costs.blocked(r, c + 1)) {
          continue;
        }
        best_squared = std::min(best_squared, to_cell(polygon, static_cast<double>(c), static_cast<double>(r)));
      }
    }
    best = std::min(best, std::sqrt(best_squared));
    searched = window;
  }
  return best;
}

Frame make_frame(double resolution, double x, double y, double yaw) {
  return {x, y, yaw, std::cos(yaw), std::sin(yaw), resolution};
}

void check_arguments(const In<double, 2> &outline, const In<double, 2> &poses, double resolution) {
  if (!(resolution > 0.0 && std::isfinite(resolution))) throw nb::value_error("the resolution must be a positive number");
  if (outline.shape(1) != 2 || outline.shape(0) < 3) throw nb::value_error("the outline needs shape (N, 2) with N >= 3");
  if (poses.shape(1) != 3) throw nb::value_error("the poses need shape (N, 3)");
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (!(std::abs(outline.data()[i]) < 1e100)) throw nb::value_error("the outline must be finite");
  }
}

// Counter-clockwise, with no corner repeated.
bool is_convex(const In<double, 2> &outline) {
  const std::size_t corners = outline.shape(0);
  const double *p = outline.data();
  for (std::size_t i = 0; i < corners; ++i) {
    const double *a = p + 2 * i, *b = p + 2 * ((i + 1) % corners), *c = p + 2 * ((i + 2) % corners);
    const double turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
    if (!(turn > 0.0)) return false;
  }
  return true;
}

}  // namespace

nb::ndarray<nb::numpy, bool> footprint_collides(In<std::uint8_t, 2> cells, double resolution, double origin_x,
                                                double origin_y, double origin_yaw, In<double, 2> outline,
                                                In<double, 2> poses) {
  check_arguments(outline, poses, resolution);
  const std::size_t count = poses.shape(0);
  auto hits = std::make_unique<bool[]>(count);
  {
    nb::gil_scoped_release release;
    const Costs costs{cells.data(), static_cast<std::ptrdiff_t>(cells.shape(0)),
                      static_cast<std::ptrdiff_t>(cells.shape(1))};
    const Frame frame = make_frame(resolution, origin_x, origin_y, origin_yaw);
    std::vector<Point> polygon;
    Box box{};
    Spans spans;
    for (std::size_t i = 0; i < count; ++i) {
      hits[i] = collides(costs, frame, outline.data(), outline.shape(0), poses.data() + 3 * i, polygon, box,
                          spans);
    }
  }
  bool *data = hits.release();
  nb::capsule owner(data, [](void *p) noexcept { delete[] static_cast<bool *>(p); });
  return nb::ndarray<nb::numpy, bool>(data, {count}, owner);
}

nb::ndarray<nb::numpy, double> footprint_sweep(In<std::uint8_t, 2> cells, double resolution, double origin_x,
                                               double origin_y, double origin_yaw, In<double, 2> outline,
                                               In<double, 2> first, In<double, 2> last) {
  check_arguments(outline, first, resolution);
  check_arguments(outline, last, resolution);
  if (first.shape(0) != last.shape(0)) throw nb::value_error("each motion needs a first and a last pose");
  if (!is_convex(outline)) throw nb::value_error("the outline must be convex and counter-clockwise");
  const std::size_t count = first.shape(0);
  std::vector<double> shares(count);
  {
    nb::gil_scoped_release release;
    Sweep sweep;
    sweep.begin({cells.data(), static_cast<std::ptrdiff_t>(cells.shape(0)), static_cast<std::ptrdiff_t>(cells.shape(1))},
                make_frame(resolution, origin_x, origin_y, origin_yaw), outline.data(), outline.shape(0));
    for (std::size_t i = 0; i < count; ++i) {
      shares[i] = sweep.free_share(first.data() + 3 * i, last.data() + 3 * i);
    }
  }
  return to_numpy(std::move(shares), {count});
}

nb::ndarray<nb::numpy, double> footprint_clearance(In<std::uint8_t, 2> cells, double resolution, double origin_x,
                                                   double origin_y, double origin_yaw, In<double, 2> outline,
                                                   In<double, 2> poses, double cap) {
  check_arguments(outline, poses, resolution);
  const std::size_t count = poses.shape(0);
  std::vector<double> distances(count);
  {
    nb::gil_scoped_release release;
    const Costs costs{cells.data(), static_cast<std::ptrdiff_t>(cells.shape(0)),
                      static_cast<std::ptrdiff_t>(cells.shape(1))};
    const Frame frame = make_frame(resolution, origin_x, origin_y, origin_yaw);
    std::vector<Point> polygon;
    Box box{};
    Spans spans;
    for (std::size_t i = 0; i < count; ++i) {
      const bool hit = collides(costs, frame, outline.data(), outline.shape(0), poses.data() + 3 * i, polygon, box,
                          spans);
      distances[i] = hit ? 0.0 : std::min(cap, resolution * nearest(costs, polygon, box, cap / resolution));
    }
  }
  return to_numpy(std::move(distances), {count});
}

}  // namespace trundle
