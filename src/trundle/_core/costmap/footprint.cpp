// A convex footprint at many poses against the blocked cells of a costmap: does it touch, and how far away are they.
//
// Everything is in grid units: cell (row, col) is the square [col, col + 1] × [row, row + 1].
#include "costmap/footprint_distance.hpp"
#include "costmap/footprint_sweep.hpp"
#include "costmap/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trundle {

namespace {

using namespace footprint;

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
