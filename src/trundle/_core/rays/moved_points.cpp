// What moves, by two scans of one lidar alone: hits that are where the earlier scan saw through, and hits of the earlier
// scan that the later one sees through. A thing of which either is found gets the velocity of the middle of its box;
// what turns on the spot has none, so hits that have moved in also get one each, from the nearest hit of the earlier
// scan.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

#include "rays/kernels.hpp"
#include "shared/bearing.hpp"

namespace trundle {
namespace {

constexpr double kTurn = 6.28318530717958647692;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSame = 0.1;  // ranges this close are those of one surface: ten times the noise of a lidar
constexpr double kAppearedShare = 0.3;
constexpr double kGap = 0.3;      // between two things
constexpr double kLargest = 3.0;  // larger things are walls
constexpr std::size_t kLeastPoints = 3;
constexpr double kNear = 5.0;             // from the sensor: farther away, nothing turns into the robot soon
constexpr std::size_t kAtOnce = 200;      // points, which bounds the work
constexpr double kFastest = 4.0;
constexpr double kSure = 1e-9;  // share by which two squares differ, whatever their rounding
constexpr int kMostSteps = 8;  // from where a beam is expected; unevenly spaced ones are searched
constexpr double kLeastLimit = 1e-3;  // below, a limit itself is rounded by more

struct Points {
  const double *xy;
  std::size_t count;

  double x(std::size_t i) const { return xy[2 * i]; }
  double y(std::size_t i) const { return xy[2 * i + 1]; }
};

// -1 where (x, y) is surely nearer than a positive limit, 1 where it is surely farther; 0 where `std::hypot` must tell,
// which takes longer than all else here.
int side_of(double x, double y, double limit) {
  const double square = x * x + y * y, allowed = limit * limit;
  return square < allowed * (1.0 - kSure) ? -1 : square > allowed * (1.0 + kSure) ? 1 : 0;
}

bool is_within(double x, double y, double limit) {
  const int side = side_of(x, y, limit);
  return side != 0 ? side < 0 : std::hypot(x, y) <= limit;
}

bool is_farther(double x, double y, double limit) {
  const int side = side_of(x, y, limit);
  return side != 0 ? side > 0 : std::hypot(x, y) > limit;
}

struct Thing {  // a run of neighbouring points without a gap, and the box around it
  std::size_t first, end;
  double low_x, low_y, high_x, high_y;

  double middle_x() const { return 0.5 * (low_x + high_x); }
  double middle_y() const { return 0.5 * (low_y + high_y); }
  bool is_small() const { return is_within(high_x - low_x, high_y - low_y, kLargest); }
};

std::vector<Thing> things_of(const Points &points) {
  std::vector<Thing> things;
  for (std::size_t i = 0; i < points.count; ++i) {
    const double x = points.x(i), y = points.y(i);
    if (i == 0 || is_farther(x - points.x(i - 1), y - points.y(i - 1), kGap)) {
      things.push_back({i, i, x, y, x, y});
    }
    Thing &thing = things.back();
    thing.end = i + 1;
    thing.low_x = std::min(thing.low_x, x), thing.low_y = std::min(thing.low_y, y);
    thing.high_x = std::max(thing.high_x, x), thing.high_y = std::max(thing.high_y, y);
  }
  return things;
}

// One scan, placed: its hits, where its sensor was, and how far its beams saw.
struct Seen {
  Points points;
  const double *sensor, *angles, *through;
  std::size_t beams;
};

// `std::fmod` of a turn; it is exact, and so is the difference of numbers that are this close.
double remainder_of(double angle) {
  if (std::abs(angle) < kTurn) return angle;
  return std::abs(angle) <= 2.0 * kTurn ? angle - std::copysign(kTurn, angle) : std::fmod(angle, kTurn);
}

// The first beam of ascending angles that is not before a bearing; `guess` is where it is if they are evenly spaced.
std::size_t first_from(const Seen &by, double bearing, double guess) {
  // Not a number where the spacing is 0.
  auto index = guess > 0.0 ? static_cast<std::size_t>(std::min(guess, static_cast<double>(by.beams))) : 0;
  for (int steps = 0; steps < kMostSteps; ++steps) {
    if (index > 0 && !(by.angles[index - 1] < bearing)) {
      --index;
    } else if (index < by.beams && by.angles[index] < bearing) {
      ++index;
    } else {
      return index;
    }
  }
  return static_cast<std::size_t>(std::lower_bound(by.angles, by.angles + by.beams, bearing) - by.angles);
}

// Which points are where another scan saw through.
std::vector<char> seen_through(const Points &points, const Seen &by) {
  std::vector<char> found(points.count, 0);
  if (by.beams == 0) {
    return found;
  }
  const double first = by.angles[0], last = by.angles[by.beams - 1];
  const double spacing = (last - first) / static_cast<double>(std::max<std::size_t>(by.beams - 1, 1));
  const double per_spacing = 1.0 / spacing;
  std::vector<double> bearings(points.count);
  bearings_from(by.sensor[0], by.sensor[1], points.xy, 2, points.count, bearings.data());
  for (std::size_t i = 0; i < points.count; ++i) {
    const double dx = points.x(i) - by.sensor[0], dy = points.y(i) - by.sensor[1];
    double rest = remainder_of(bearings[i] - by.sensor[2] - first);
    rest = rest < 0.0 ? rest + kTurn : rest;
    const double bearing = rest + first;
    if (bearing - last > 2.0 * spacing) {
      continue;
    }
    const std::size_t after = first_from(by, bearing, std::ceil((bearing - first) * per_spacing));
    const double least = by.through[std::min(after, by.beams - 1)], limit = least - kSame;
    const int side = limit > kLeastLimit ? side_of(dx, dy, limit) : 0;
    found[i] = side != 0 ? side < 0 : std::hypot(dx, dy) + kSame < least;
  }
  return found;
}

// Those of some points near the sensor that have two neighbours beside them among these.
std::vector<char> runs_of(const std::vector<char> &some, const Points &points, const double *sensor) {
  const std::size_t count = points.count;
  std::vector<char> runs(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    if (!some[i]) continue;
    const auto at = [&](std::size_t ahead) { return some[(i + ahead) % count] != 0; };
    const std::size_t back = count - 1, back2 = 2 * count - 2;
    runs[i] = (at(back) || (at(back2) && at(1))) && (at(1) || (at(2) && at(back))) &&
              is_within(points.x(i) - sensor[0], points.y(i) - sensor[1], kNear);
  }
  return runs;
}

bool has_enough(const std::vector<char> &some) {
  return std::count(some.begin(), some.end(), 1) >= static_cast<std::ptrdiff_t>(kLeastPoints);
}

bool has_run(const Thing &thing, const std::vector<char> &runs) {
  return std::count(runs.begin() + static_cast<std::ptrdiff_t>(thing.first),
                    runs.begin() + static_cast<std::ptrdiff_t>(thing.end), 1) >= static_cast<std::ptrdiff_t>(kLeastPoints);
}

// The velocities of things that have moved since an earlier scan; whether there are any. One that slides along the beams
// shows it at its ends alone: at one it comes to where there was nothing, at the other it leaves.
bool move_things(const Points &points, const Points &before, const std::vector<char> &appeared,
                 const std::vector<char> &came, const std::vector<char> &left, double seconds,
                 std::vector<double> &velocities) {
  bool moves = false;
  std::vector<Thing> old = things_of(before);
  old.erase(std::remove_if(old.begin(), old.end(), [](const Thing &one) { return !one.is_small(); }), old.end());
  for (const Thing &thing : things_of(points)) {
    if (old.empty() || thing.end - thing.first < kLeastPoints || !thing.is_small()) {
      continue;
    }
    double least = kInfinity, vx = 0.0, vy = 0.0;
    const Thing *nearest = nullptr;
    for (const Thing &one : old) {
      const double dx = thing.middle_x() - one.middle_x(), dy = thing.middle_y() - one.middle_y();
      const double apart = dx * dx + dy * dy;
      if (apart < least) {
        least = apart, vx = dx / seconds, vy = dy / seconds, nearest = &one;
      }
    }
    std::size_t count = 0;
    for (std::size_t i = thing.first; i < thing.end; ++i) {
      count += appeared[i] ? 1 : 0;
    }
    const bool is_there = count >= kLeastPoints &&
                          static_cast<double>(count) >= kAppearedShare * static_cast<double>(thing.end - thing.first);
    if (nearest != nullptr && (is_there || has_run(thing, came) || has_run(*nearest, left)) &&
        std::hypot(vx, vy) <= kFastest) {
      moves = true;
      for (std::size_t i = thing.first; i < thing.end; ++i) {
        velocities[2 * i] = vx, velocities[2 * i + 1] = vy;
      }
    }
  }
  return moves;
}

// Points that have come to where there was nothing: (x, y, vx, vy) of each.
std::vector<double> edges_of(const Points &points, const Points &before, const std::vector<char> &came, double seconds) {
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < points.count && before.count > 0; ++i) {
    if (came[i]) {
      index.push_back(i);
    }
  }
  std::vector<double> edges;
  if (index.size() < kLeastPoints) {
    return edges;
  }
  const std::size_t step = std::max<std::size_t>(1, (index.size() + kAtOnce - 1) / kAtOnce);
  for (std::size_t k = 0; k < index.size(); k += step) {
    const double x = points.x(index[k]), y = points.y(index[k]);
    double least = kInfinity;
    std::size_t nearest = 0;
    for (std::size_t j = 0; j < before.count; ++j) {
      const double dx = x - before.x(j), dy = y - before.y(j), apart = dx * dx + dy * dy;
      if (apart < least) {
        least = apart, nearest = j;
      }
    }
    const double vx = (x - before.x(nearest)) / seconds, vy = (y - before.y(nearest)) / seconds;
    if (std::hypot(vx, vy) <= kFastest) {
      edges.insert(edges.end(), {x, y, vx, vy});
    }
  }
  if (edges.size() < 4 * kLeastPoints) {
    edges.clear();
  }
  return edges;
}

}  // namespace

nb::tuple find_moved(In<double, 2> points, In<double, 1> sensor, In<double, 1> angles, In<double, 1> through,
                     In<double, 2> earlier, In<double, 1> earlier_sensor, In<double, 1> earlier_angles,
                     In<double, 1> earlier_through, double seconds) {
  if (points.shape(1) != 2 || earlier.shape(1) != 2) throw nb::value_error("find_moved needs points (x, y)");
  if (sensor.shape(0) != 3 || earlier_sensor.shape(0) != 3) throw nb::value_error("find_moved needs poses (x, y, yaw)");
  if (angles.shape(0) != through.shape(0) || earlier_angles.shape(0) != earlier_through.shape(0)) {
    throw nb::value_error("find_moved needs a range for each angle");
  }
  if (!(seconds > 0.0)) throw nb::value_error("find_moved needs scans one after the other");
  const std::size_t count = points.shape(0);
  std::vector<double> velocities(2 * count, 0.0), edges;
  bool moves = false;
  {
    nb::gil_scoped_release released;
    const Seen now{{points.data(), count}, sensor.data(), angles.data(), through.data(), angles.shape(0)};
    const Seen before{{earlier.data(), earlier.shape(0)},
                      earlier_sensor.data(),
                      earlier_angles.data(),
                      earlier_through.data(),
                      earlier_angles.shape(0)};
    const std::vector<char> appeared = seen_through(now.points, before);
    const std::vector<char> came = runs_of(appeared, now.points, now.sensor);
    const std::vector<char> left = runs_of(seen_through(before.points, now), before.points, before.sensor);
    if (has_enough(appeared) || has_enough(left)) {  // else nothing moves, as nearly always
      moves = move_things(now.points, before.points, appeared, came, left, seconds, velocities);
      edges = edges_of(now.points, before.points, came, seconds);
    }
  }
  const std::size_t found = edges.size() / 4;
  return nb::make_tuple(to_numpy(std::move(velocities), {count, 2}), moves, to_numpy(std::move(edges), {found, 4}));
}

}  // namespace trundle
