// Hits that a lidar returned too soon, as from dust or rain: all beams beside such a one saw past it, and the scan before
// saw nothing there. Something thin that stands is seen again by the next scan; a wall at a grazing angle has its next
// hit nearer on one side.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

#include "rays/kernels.hpp"
#include "rays/lone_hits.hpp"

namespace trundle {
namespace {

constexpr double kTurn = 6.28318530717958647692;
constexpr std::size_t kAside = 2;  // beams on each side: one of them may have no return
constexpr double kPast = 0.15;     // seven times a noise of 2 cm: the beams beside saw past by so much, ...
constexpr double kSteep = 3.0;     // ... and by so many spacings, as beside what juts out
// What was seen before is as close as this along the beam, and across it as this and two spacings: dust close to the lidar
// must not confirm dust 40 degrees beside it, and what is close and lone is thinner than a finger.
constexpr double kAlong = 0.1, kAcross = 0.03, kSpacings = 2.0;

// A number of -half a turn to half a turn.
double wrapped(double angle) { return angle - kTurn * std::round(angle / kTurn); }

// Whether the beams beside one saw past its hit by `margin`. One that measured nothing (NaN) tells nothing.
bool stands_alone(const ScanBeams &beams, std::size_t beam, double margin) {
  const double limit = beams.ranges[beam] + margin;
  for (std::size_t aside = 1; aside <= kAside; ++aside) {
    const std::size_t after = beam + aside, before = beam + beams.count - aside;
    const double right = beams.ranges[after < beams.count ? after : after - beams.count];
    const double left = beams.ranges[before < beams.count ? before : before - beams.count];
    if (right <= limit || left <= limit) return false;
  }
  return true;
}

// Whether a scan hit something that close to a point, along and across the beam.
bool has_hit(const ScanBeams &beams, double least, double most, double x, double y, double across) {
  if (beams.count == 0) return false;
  const double *sensor = beams.poses + beams.stride * (beams.count / 2);  // in the middle of the scan
  const double dx = x - sensor[0], dy = y - sensor[1], distance = std::sqrt(dx * dx + dy * dy);
  const double bearing = std::atan2(dy, dx) - sensor[2];
  for (std::size_t i = 0; i < beams.count; ++i) {
    const double range = beams.ranges[i];
    if (std::abs(range - distance) <= kAlong && range >= least && range <= most &&
        std::abs(wrapped(beams.angles[i] - bearing)) * distance <= across) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::int64_t> lone_hits_of(const ScanBeams &scan, const ScanBeams &before, double least, double most) {
  std::vector<std::int64_t> found;
  if (scan.count <= 2 * kAside) return found;
  const double spacing = std::abs(scan.angles[scan.count - 1] - scan.angles[0]) / static_cast<double>(scan.count - 1);
  for (std::size_t i = 0; i < scan.count; ++i) {
    const double range = scan.ranges[i];
    if (!(range >= least && range <= most)) continue;
    const double apart = spacing * range;
    if (!stands_alone(scan, i, kPast + kSteep * apart)) continue;
    const double *pose = scan.poses + scan.stride * i, direction = pose[2] + scan.angles[i];
    const double x = pose[0] + range * std::cos(direction), y = pose[1] + range * std::sin(direction);
    if (!has_hit(before, least, most, x, y, kAcross + kSpacings * apart)) found.push_back(static_cast<std::int64_t>(i));
  }
  return found;
}

nb::ndarray<nb::numpy, std::int64_t> find_lone_hits(In<double, 1> ranges, In<double, 1> angles, In<double, 2> sensor,
                                                    In<double, 1> earlier_ranges, In<double, 1> earlier_angles,
                                                    In<double, 2> earlier_sensor, double range_min, double range_max) {
  const std::size_t count = ranges.shape(0), earlier_count = earlier_ranges.shape(0);
  if (angles.shape(0) != count || earlier_angles.shape(0) != earlier_count) {
    throw std::invalid_argument("find_lone_hits needs as many ranges as angles");
  }
  const auto is_placed = [](const In<double, 2> &poses, std::size_t beams) {
    return poses.shape(1) == 3 && (poses.shape(0) == 1 || poses.shape(0) == beams);
  };
  if (!is_placed(sensor, count) || (earlier_count > 0 && !is_placed(earlier_sensor, earlier_count))) {
    throw std::invalid_argument("find_lone_hits needs poses (x, y, yaw), one or one for each beam");
  }
  const auto beams_of = [](const In<double, 1> &some, const In<double, 1> &directions, const In<double, 2> &poses) {
    return ScanBeams{some.data(), directions.data(), poses.data(), poses.shape(0) > 1 ? std::size_t{3} : 0, some.shape(0)};
  };
  std::vector<std::int64_t> found = lone_hits_of(beams_of(ranges, angles, sensor),
                                                 beams_of(earlier_ranges, earlier_angles, earlier_sensor), range_min, range_max);
  const std::size_t size = found.size();
  return to_numpy(std::move(found), {size});
}

}  // namespace trundle
