// What one scan shows: where it hit something, and how far each beam and those beside it saw. One pass for each scan, as
// every control period needs it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "rays/kernels.hpp"
#include "rays/lone_hits.hpp"
#include "shared/directions.hpp"

namespace trundle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kAside = 3;  // an edge may be seen by another beam in the next scan

// The least of each range and those beside it. The ends of the field of view are neighbours, as of a full turn.
std::vector<double> seen_through(const std::vector<double> &ranges) {
  const std::size_t count = ranges.size();
  std::vector<double> least(count);
  if (count < kAside) {
    std::fill(least.begin(), least.end(), count > 0 ? *std::min_element(ranges.begin(), ranges.end()) : kInfinity);
    return least;
  }
  std::vector<double> around(count + 2 * kAside);
  std::copy(ranges.begin(), ranges.end(), around.begin() + kAside);
  std::copy(ranges.end() - kAside, ranges.end(), around.begin());
  std::copy(ranges.begin(), ranges.begin() + kAside, around.end() - kAside);
  for (std::size_t i = 0; i < count; ++i) {
    double found = around[i];
    for (std::size_t aside = 1; aside <= 2 * kAside; ++aside) found = std::min(found, around[i + aside]);
    least[i] = found;
  }
  return least;
}

}  // namespace

nb::tuple place_scan(In<double, 1> ranges, In<double, 1> angles, In<double, 1> mount, In<double, 1> base,
                     In<double, 2> body, double range_min, double range_max, In<double, 1> sensor,
                     In<double, 1> earlier_ranges, In<double, 1> earlier_angles, In<double, 1> earlier_sensor) {
  const std::size_t count = ranges.shape(0), earlier_count = earlier_ranges.shape(0);
  if (angles.shape(0) != count || earlier_angles.shape(0) != earlier_count) {
    throw std::invalid_argument("place_scan needs as many ranges as angles");
  }
  for (const auto *pose : {&mount, &base, &sensor, &earlier_sensor}) {
    if (pose->shape(0) != 3) throw std::invalid_argument("place_scan needs poses x, y, yaw");
  }
  if (body.shape(1) != 3) throw std::invalid_argument("the body needs normals and how far it reaches along them");
  std::vector<double> points, through, directions(angles.data(), angles.data() + count);
  {
    nb::gil_scoped_release released;
    const std::vector<std::int64_t> lone =
        lone_hits_of({ranges.data(), angles.data(), sensor.data(), 0, count},
                     {earlier_ranges.data(), earlier_angles.data(), earlier_sensor.data(), 0, earlier_count}, range_min, range_max);
    std::vector<double> seen(ranges.data(), ranges.data() + count);
    for (const std::int64_t i : lone) seen[static_cast<std::size_t>(i)] = kInfinity;  // as the beams beside it
    points.resize(2 * count);
    double *next = points.data();
    const double *m = mount.data(), *at = base.data(), *side = body.data();
    const double cos = std::cos(at[2]), sin = std::sin(at[2]);
    const Directions &beams = directions_of(angles.data(), count, m[2]);
    for (std::size_t i = 0; i < count; ++i) {
      const double range = seen[i];
      if (range >= range_min && range <= range_max) {
        const double x = m[0] + range * beams.cos[i], y = m[1] + range * beams.sin[i];
        bool within = body.shape(0) > 0;
        for (std::size_t j = 0; j < body.shape(0) && within; ++j) {
          within = x * side[3 * j] + y * side[3 * j + 1] <= side[3 * j + 2];
        }
        if (!within && std::isfinite(x) && std::isfinite(y)) {
          *next++ = at[0] + cos * x - sin * y;
          *next++ = at[1] + sin * x + cos * y;
        }
      }
      if (!(range >= range_min)) seen[i] = -kInfinity;  // beside one that measured nothing
    }
    points.resize(static_cast<std::size_t>(next - points.data()));
    if (count > 0 && directions.front() > directions.back()) {
      std::reverse(directions.begin(), directions.end());
      std::reverse(seen.begin(), seen.end());
    }
    through = seen_through(seen);
  }
  const std::size_t hits = points.size() / 2;
  return nb::make_tuple(to_numpy(std::move(points), {hits, 2}), to_numpy(std::move(directions), {count}),
                        to_numpy(std::move(through), {count}));
}

}  // namespace trundle
