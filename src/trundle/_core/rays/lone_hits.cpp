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

namespace trundle {
namespace {

constexpr double kTurn = 6.28318530717958647692;
constexpr std::size_t kAside = 2;  // beams on each side: one of them may have no return
constexpr double kPast = 0.15;     // seven times a noise of 2 cm: the beams beside saw past by so much, ...
constexpr double kSteep = 3.0;     // ... and by so many spacings, as beside what juts out
// What was seen before is as close as this along the beam, and across it as this and two spacings: dust close to the lidar
// must not confirm dust 40 degrees beside it, and what is close and lone is thinner than a finger.
constexpr double kAlong = 0.1, kAcross = 0.03, kSpacings = 2.0;

struct Beams {
  const double *ranges, *angles, *sensor;
  std::size_t count;
  double least, most;
};

// A number of -half a turn to half a turn.
double wrapped(double angle) { return angle - kTurn * std::round(angle / kTurn); }

// Whether the beams beside one saw past its hit by `margin`. One that measured nothing (NaN) tells nothing.
bool stands_alone(const Beams &beams, std::size_t beam, double margin) {
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
bool has_hit(const Beams &beams, double x, double y, double across) {
  const double dx = x - beams.sensor[0], dy = y - beams.sensor[1], distance = std::sqrt(dx * dx + dy * dy);
  const double bearing = std::atan2(dy, dx) - beams.sensor[2];
  for (std::size_t i = 0; i < beams.count; ++i) {
    const double range = beams.ranges[i];
    if (std::abs(range - distance) <= kAlong && range >= beams.least && range <= beams.most &&
        std::abs(wrapped(beams.angles[i] - bearing)) * distance <= across) {
      return true;
    }
  }
  return false;
}

}  // namespace

nb::ndarray<nb::numpy, std::int64_t> find_lone_hits(In<double, 1> ranges, In<double, 1> angles, In<double, 2> sensor,
                                                    In<double, 1> earlier_ranges, In<double, 1> earlier_angles,
                                                    In<double, 2> earlier_sensor, double range_min, double range_max) {
  const std::size_t count = ranges.shape(0), earlier_count = earlier_ranges.shape(0);
  if (angles.shape(0) != count || earlier_angles.shape(0) != earlier_count) {
    throw std::invalid_argument("find_lone_hits needs as many ranges as angles");
  }
  if (sensor.shape(1) != 3 || earlier_sensor.shape(1) != 3 || earlier_sensor.shape(0) < 1 ||
      (sensor.shape(0) != 1 && sensor.shape(0) != count)) {
    throw std::invalid_argument("find_lone_hits needs poses (x, y, yaw), one or one for each beam");
  }
  std::vector<std::int64_t> found;
  const Beams now{ranges.data(), angles.data(), sensor.data(), count, range_min, range_max};
  const double *middle = earlier_sensor.data() + 3 * (earlier_sensor.shape(0) / 2);
  const Beams before{earlier_ranges.data(), earlier_angles.data(), middle, earlier_count, range_min, range_max};
  if (count > 2 * kAside) {
    const double spacing = std::abs(angles.data()[count - 1] - angles.data()[0]) / static_cast<double>(count - 1);
    for (std::size_t i = 0; i < count; ++i) {
      const double range = now.ranges[i];
      if (!(range >= range_min && range <= range_max)) continue;
      const double apart = spacing * range;
      if (!stands_alone(now, i, kPast + kSteep * apart)) continue;
      const double *pose = now.sensor + (sensor.shape(0) > 1 ? 3 * i : 0), direction = pose[2] + now.angles[i];
      const double x = pose[0] + range * std::cos(direction), y = pose[1] + range * std::sin(direction);
      if (!has_hit(before, x, y, kAcross + kSpacings * apart)) found.push_back(static_cast<std::int64_t>(i));
    }
  }
  const std::size_t size = found.size();
  return to_numpy(std::move(found), {size});
}

}  // namespace trundle
