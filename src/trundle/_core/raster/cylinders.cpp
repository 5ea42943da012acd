// Rasters of cylinders that are not upright: the part in a height band, seen from above.
//
// Its outline is the hull of the parts of the two rims between the heights and of the sections at the heights. Both are
// arcs of the angle φ around the axis, with φ = 0 at the top of a rim, sampled so finely that the chords stay within a
// slack of them. Few points do unless the outline passes a cell's edge nearer than that; then more are taken.
#include "raster/kernels.hpp"
#include "raster/raster.hpp"
#include "shared/hull.hpp"

namespace trundle {

namespace {

constexpr double kCoarse = 1e-4, kFinest = 2e-7;  // Slack of an outline [m].
constexpr double kFiner = 1.0 / 32.0;

struct Cylinder {
  Point3 middle, axis, upward, sideways;  // Upward: across the axis, to the top of a rim.
  double radius, half, swing;             // Swing: height of a rim's top above the rim's middle.

  explicit Cylinder(const double *numbers)
      : middle{numbers[0], numbers[1], numbers[2]}, axis{numbers[3], numbers[4], numbers[5]}, radius(numbers[6]),
        half(0.5 * numbers[7]) {
    const double slope = std::hypot(axis.x, axis.y);
    upward = {-axis.z * axis.x / slope, -axis.z * axis.y / slope, (1.0 - axis.z * axis.z) / slope};
    sideways = {axis.y * upward.z - axis.z * upward.y, axis.z * upward.x - axis.x * upward.z,
                axis.x * upward.y - axis.y * upward.x};
    swing = radius * slope;
  }

  Point2 at(double cosine, double sine, double along) const {
    return {middle.x + radius * (cosine * upward.x + sine * sideways.x) + along * axis.x,
            middle.y + radius * (cosine * upward.y + sine * sideways.y) + along * axis.y};
  }
};

// Add the points at angles ±φ whose cosine is between two numbers, as far apart as an ellipse of this semi-axis [m]
// allows; `along` says how far along the axis a cosine's point lies.
template <typename Along>
void add_arcs(const Cylinder &cylinder, double low, double high, double semi_axis, double slack, Along along,
              std::vector<Point2> &points) {
  if (!(low <= 1.0 && high >= -1.0)) return;
  const double first = std::acos(std::min(1.0, high)), last = std::acos(std::max(-1.0, low));
  const double steps = 1.0 + std::ceil((last - first) * std::sqrt(semi_axis / (8.0 * slack)));
  for (double i = 0.0; i <= steps; i += 1.0) {
    const double angle = first + (last - first) * (i / steps);
    const double cosine = std::cos(angle), sine = std::sin(angle), place = along(cosine);
    points.push_back(cylinder.at(cosine, sine, place));
    points.push_back(cylinder.at(cosine, -sine, place));
  }
}

// Points whose hull is the cylinder between two heights, seen from above, or lacks at most `slack` [m] of it.
void slice(const Cylinder &cylinder, double low, double high, double slack, std::vector<Point2> &points) {
  const double swing = cylinder.swing, half = cylinder.half, lean = cylinder.axis.z;
  points.clear();
  for (const double end : {-half, half}) {
    const double base = cylinder.middle.z + end * lean;
    add_arcs(cylinder, (low - base) / swing, (high - base) / swing, cylinder.radius, slack, [&](double) { return end; }, points);
  }
  const double rise = std::abs(lean) * half;  // Height of an end's middle above the cylinder's.
  for (const double height : {low, high}) {
    const double lift = height - cylinder.middle.z;
    if (rise <= 0.5 * kFinest) {
      for (const double end : {-half, half})
        add_arcs(cylinder, lift / swing, lift / swing, cylinder.radius, slack, [&](double) { return end; }, points);
      continue;
    }
    const auto along = [&](double cosine) { return std::clamp((lift - swing * cosine) / lean, -half, half); };
    add_arcs(cylinder, (lift - rise) / swing, (lift + rise) / swing, cylinder.radius / std::abs(lean), slack, along, points);
  }
}

}  // namespace

void raster_cylinders(Cells cells, In<double, 2> cylinders, double low, double high, double resolution, double depth,
                      bool centre) {
  if (cylinders.shape(1) != 8) throw std::invalid_argument("cylinders need shape (N, 8): middle, axis, radius, length");
  Raster raster(cells, resolution, depth, centre);
  nb::gil_scoped_release released;
  const double scale = 1.0 / resolution;
  std::vector<Point2> points, hull;
  for (std::size_t i = 0; i < cylinders.shape(0); ++i) {
    const Cylinder cylinder(cylinders.data() + 8 * i);
    for (double slack = kCoarse;; slack = std::max(slack * kFiner, kFinest)) {
      slice(cylinder, low, high, slack, points);
      if (points.empty()) break;
      for (Point2 &point : points) point = {point.x * scale, point.y * scale};
      convex_hull(points, hull);
      if (slack <= kFinest) {
        raster.add_with_slack(hull.data(), hull.size(), slack * scale);
        break;
      }
      if (raster.add_if_sure(hull.data(), hull.size(), (slack + kFinest) * scale)) break;
    }
  }
}

}  // namespace trundle
