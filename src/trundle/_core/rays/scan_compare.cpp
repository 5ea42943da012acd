// Points against an earlier scan.
#include <algorithm>
#include <cmath>
#include <vector>

#include "rays/kernels.hpp"

namespace trundle {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;
constexpr double kTurn = 2.0 * kHalfTurn;
constexpr int kMostAside = 16;
constexpr double kOffBeam = 1.01;  // spacings that a point may be off the nearest beam

// An angle of −2 to 2 turns as one of 0 to 1 turn.
double turned(double angle) {
  if (angle < 0.0) {
    angle += angle < -kTurn ? 2.0 * kTurn : kTurn;
  }
  return angle >= kTurn ? angle - kTurn : angle;
}

// Between two angles of 0 to 1 turn.
double apart(double a, double b) {
  const double off = std::abs(a - b);
  return off > kHalfTurn ? kTurn - off : off;
}

// The first of some ascending angles that is not before one; `guess` is where it is if they are evenly spaced.
std::ptrdiff_t first_from(const double *angles, std::ptrdiff_t count, double from, double guess) {
  // Not a number where the spacing is 0.
  auto index = guess > 0.0 ? static_cast<std::ptrdiff_t>(std::min(guess, static_cast<double>(count))) : 0;
  while (index > 0 && angles[index - 1] >= from) {
    --index;
  }
  while (index < count && angles[index] < from) {
    ++index;
  }
  return index;
}

}  // namespace

nb::ndarray<nb::numpy, std::uint8_t> compare_scan(In<double, 1> bearings, In<double, 1> through, In<double, 2> ends,
                                                  double x, double y, double zero, double spacing,
                                                  In<double, 2> points, double margin, int aside) {
  const auto beams = static_cast<std::ptrdiff_t>(bearings.shape(0));
  const std::size_t count = points.shape(0);
  if (through.shape(0) != bearings.shape(0) || ends.shape(0) != bearings.shape(0) || ends.shape(1) != 2 ||
      points.shape(1) != 2) {
    throw nb::value_error("compare_scan needs a range and an end (x, y) for each bearing, and points (x, y)");
  }
  if (aside < 0 || aside > kMostAside) {
    throw nb::value_error("compare_scan compares with 0 to 16 beams aside");
  }
  std::vector<std::uint8_t> seen(count, 0);
  {
    nb::gil_scoped_release released;
    const double *angle = bearings.data();
    const double start = turned(std::fmod(zero, kTurn));
    for (std::size_t i = 0; i < count && beams > 0; ++i) {
      const double px = points.data()[2 * i], py = points.data()[2 * i + 1];
      const double bearing = turned(std::atan2(py - y, px - x) - start + 1e-9);
      if (!std::isfinite(bearing)) {
        continue;
      }
      const double from = bearing - 0.5 * spacing;
      std::ptrdiff_t beam = std::min(first_from(angle, beams, from, std::ceil(from / spacing)), beams - 1);
      if (!(apart(bearing, angle[beam]) <= kOffBeam * spacing)) {
        beam = 0;  // past the last beam: of a full turn the first one is the nearest
        if (!(apart(bearing, angle[0]) <= kOffBeam * spacing)) {
          continue;
        }
      }
      const double distance = std::sqrt((px - x) * (px - x) + (py - y) * (py - y));
      if (through.data()[beam] > distance + margin) {
        seen[i] = 1;
        continue;
      }
      const double near = margin + 0.5 * spacing * distance;
      for (int shift = -aside; shift <= aside; ++shift) {
        const double *end = ends.data() + 2 * (((beam + shift) % beams + beams) % beams);
        const double dx = end[0] - px, dy = end[1] - py;
        if (dx * dx + dy * dy < near * near) {
          seen[i] = 2;
          break;
        }
      }
    }
  }
  return to_numpy(std::move(seen), {count});
}

}  // namespace trundle
