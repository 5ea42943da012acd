#include "tracking/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "shared/bearing.hpp"
#include "shared/directions.hpp"

namespace trundle::tracking {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;
constexpr double kTurn = 2.0 * kHalfTurn;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::ptrdiff_t kAside = 2;   // beams that are looked at on both sides
constexpr double kAcross = 0.7;  // of the margin, across beams that see past a point
constexpr double kOffBeam = 1.01;      // spacings that a point may be off the nearest beam
constexpr double kTie = 1e-9;          // so that the first beam's own direction is not a whole turn
constexpr double kGrazing = kHalfTurn / 18.0;
constexpr double kLeastGap = 0.12, kPast = 0.15;

// An angle of -2 to 2 turns as one of 0 to 1 turn.
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

// Any angle as one of 0 to 1 turn; 0 for what is no number.
double wrapped(double angle) {
  double rest = std::abs(angle) < kTurn ? angle : std::fmod(angle, kTurn);  // which is exact, and slow
  if (rest < 0.0) {
    rest += kTurn;
  }
  return std::isfinite(rest) ? rest : 0.0;
}

std::ptrdiff_t around(std::ptrdiff_t beam, std::ptrdiff_t count) { return ((beam % count) + count) % count; }

// The first of some ascending angles that is not before one; `guess` is where it is if they are evenly spaced.
std::ptrdiff_t first_from(const std::vector<double> &angles, double from, double guess) {
  const auto count = static_cast<std::ptrdiff_t>(angles.size());
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

Sight View::judge(Point point, double margin) const {
  return judge(point, margin, bearing_of(point.y - sensor.y, point.x - sensor.x));
}

Sight View::judge(Point point, double margin, double direction) const {
  const auto beams = static_cast<std::ptrdiff_t>(bearings.size());
  if (beams == 0) {
    return Sight::kNothing;
  }
  const double dx = point.x - sensor.x, dy = point.y - sensor.y;
  const double bearing = turned(direction - zero + kTie);
  if (!std::isfinite(bearing)) {
    return Sight::kNothing;
  }
  const double from = bearing - 0.5 * spacing;
  std::ptrdiff_t beam = std::min(first_from(bearings, from, std::ceil(from * per_spacing)), beams - 1);
  if (!(apart(bearing, bearings[beam]) <= kOffBeam * spacing)) {
    beam = 0;  // past the last beam: of a full turn the first one is the nearest
    if (!(apart(bearing, bearings[0]) <= kOffBeam * spacing)) {
      return Sight::kNothing;
    }
  }
  const double distance = std::sqrt(dx * dx + dy * dy);
  const bool sees_past = through[beam] > distance + margin;
  // The noise of a hit that was seen from elsewhere lies across these beams: close to the sensor it crosses many of them.
  const double near = (sees_past ? kAcross : 1.0) * margin + 0.5 * spacing * distance;
  const auto is_there = [&](std::ptrdiff_t index) {
    const Point &end = ends[index >= 0 && index < beams ? index : around(index, beams)];
    const double ex = end.x - point.x, ey = end.y - point.y;
    return ex * ex + ey * ey < near * near;
  };
  std::ptrdiff_t aside = kAside;
  if (sees_past) {
    const double across = std::ceil(near / (spacing * distance)), most = 0.5 * static_cast<double>(beams);
    aside = std::max(aside, static_cast<std::ptrdiff_t>(across < most ? across : most));
  } else if (is_there(beam)) {  // as most are, of what stands
    return Sight::kThere;
  }
  for (std::ptrdiff_t index = beam - aside; index <= beam + aside; ++index) {
    if (is_there(index)) {
      return Sight::kThere;
    }
  }
  return sees_past ? Sight::kThrough : Sight::kNothing;
}

bool View::faces(Point point) const {
  if (bearings.empty()) {
    return false;
  }
  const double bearing = turned(bearing_of(point.y - sensor.y, point.x - sensor.x) - zero + kTie);
  return bearing <= bearings.back() + kOffBeam * spacing || bearing >= kTurn - kOffBeam * spacing;
}

// The beams in the order of their directions, into `order_`.
void Sweep::order(const Scan &scan, View &view) {
  const std::size_t count = scan.count;
  double zero = count > 0 ? bearing_[0] : 0.0;
  if (count > 1 && bearing_[1] < bearing_[0]) {
    zero = bearing_[count - 1];
  }
  bool ascending = true;
  for (std::size_t i = 0; i < count; ++i) {
    bearing_[i] = wrapped(bearing_[i] - zero + kTie);
    ascending = ascending && (i == 0 || bearing_[i] >= bearing_[i - 1]);
  }
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!ascending) {
    std::sort(order_.begin(), order_.end(), [this](std::size_t a, std::size_t b) {
      return bearing_[a] < bearing_[b] || (bearing_[a] == bearing_[b] && a < b);
    });
  }
  view.zero = turned(std::fmod(zero, kTurn));
  view.spacing = kTurn / static_cast<double>(std::max<std::size_t>(count, 1));
  view.bearings.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    view.bearings[i] = bearing_[order_[i]];
  }
  if (count > 1) {
    view.spacing = (view.bearings[count - 1] - view.bearings[0]) / static_cast<double>(count - 1);
  }
  view.per_spacing = 1.0 / view.spacing;
}

void Sweep::take(const Scan &scan, double max_range, const std::vector<Point> &body, View &view) {
  const std::size_t count = scan.count;
  const auto beams = static_cast<std::ptrdiff_t>(count);
  const double *middle = scan.poses + 3 * (scan.pose_count / 2);
  view_ = &view;
  view.time = scan.time;
  view.sensor = {middle[0], middle[1]};
  bearing_.resize(count), range_.resize(count), end_.resize(count);
  const Directions *still = scan.pose_count > 1 ? nullptr : &directions_of(scan.angles, count, scan.poses[2]);
  for (std::size_t i = 0; i < count; ++i) {
    const double range = scan.ranges[i];
    const bool measured = range >= scan.range_min && range <= scan.range_max;
    const double reach = measured ? range : scan.range_max;
    const double *pose = scan.poses + (scan.pose_count > 1 ? 3 * i : 0);
    const double direction = scan.angles[i] + pose[2];
    const double cos = still ? still->cos[i] : std::cos(direction), sin = still ? still->sin[i] : std::sin(direction);
    end_[i] = {pose[0] + reach * cos, pose[1] + reach * sin};
    bearing_[i] = direction, range_[i] = reach;
    if (scan.pose_count > 1) {
      const double dx = end_[i].x - view.sensor.x, dy = end_[i].y - view.sensor.y;
      bearing_[i] = bearing_of(dy, dx), range_[i] = std::sqrt(dx * dx + dy * dy);
    }
  }
  order(scan, view);
  double body_reach = 0.0;
  for (const Point &corner : body) {
    const double dx = corner.x - scan.mount_x, dy = corner.y - scan.mount_y;
    body_reach = std::max(body_reach, std::sqrt(dx * dx + dy * dy));
  }
  sight_.resize(count), missing_.resize(count), view.ends.resize(count), view.through.resize(count);
  hits_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t beam = order_[i];
    const double range = scan.ranges[beam];
    const bool measured = range >= scan.range_min && range <= scan.range_max;
    // Infinity is a measurement: nothing up to the longest range.
    sight_[i] = measured || range == kInfinity ? range_[beam] : -kInfinity;
    missing_[i] = std::isnan(range) ? 1 : 0;
    view.ends[i] = measured ? end_[beam] : Point{kInfinity, kInfinity};
    if (measured && range_[beam] <= max_range && !in_body(scan, beam, body, body_reach)) {
      hits_.push_back({end_[beam], range_[beam], i, false, false});
    }
  }
  // Minus infinity where half of the beams around are missing.
  for (std::ptrdiff_t i = 0; i < beams; ++i) {
    double least = kInfinity;
    int gaps = 0;
    for (std::ptrdiff_t index = i - kAside; index <= i + kAside; ++index) {
      const std::ptrdiff_t beam = index >= 0 && index < beams ? index : around(index, beams);
      gaps += missing_[beam];
      least = missing_[beam] ? least : std::min(least, sight_[beam]);
    }
    view.through[i] = gaps > kAside ? -kInfinity : least;
  }
}

bool Sweep::in_body(const Scan &scan, std::size_t beam, const std::vector<Point> &body, double reach) const {
  const double range = scan.ranges[beam];
  if (body.empty() || !(range >= 0.0 && range <= reach)) {
    return false;
  }
  const double angle = scan.angles[beam] + scan.mount_yaw;
  const double x = scan.mount_x + range * std::cos(angle), y = scan.mount_y + range * std::sin(angle);
  for (std::size_t k = 0; k < body.size(); ++k) {
    const Point &a = body[k], &b = body[k + 1 < body.size() ? k + 1 : 0];
    if (!((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x) >= 0.0)) {
      return false;
    }
  }
  return true;
}

void Sweep::split() {
  const std::size_t count = hits_.size();
  const double spacing = view_->spacing;
  const double allowed = std::sin(spacing) / std::sin(std::max(kGrazing - spacing, 0.05));
  starts_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const Point &last = hits_[i > 0 ? i - 1 : count - 1].point;
    const double dx = hits_[i].point.x - last.x, dy = hits_[i].point.y - last.y;
    if (std::sqrt(dx * dx + dy * dy) > kLeastGap + hits_[i].range * allowed) {
      starts_.push_back(i);
    }
  }
  if (starts_.empty() && count > 0) {
    starts_.push_back(0);
  }
  const std::size_t first = starts_.empty() ? 0 : starts_[0];
  if (first > 0) {  // the ends of a full turn are one thing
    turned_.resize(count);
    std::rotate_copy(hits_.begin(), hits_.begin() + static_cast<std::ptrdiff_t>(first), hits_.end(), turned_.begin());
    hits_.swap(turned_);
    for (std::size_t &start : starts_) {
      start -= first;
    }
  }
  starts_.push_back(count);
}

bool Sweep::sees_past(const Hit &hit, int side) const {
  const auto beams = static_cast<std::ptrdiff_t>(sight_.size()), beam = static_cast<std::ptrdiff_t>(hit.beam);
  const std::ptrdiff_t next = beam + side, second = beam + 2 * side;
  const bool turns = static_cast<double>(beams) * view_->spacing >= kTurn - 0.5 * view_->spacing;
  if (!turns && (second < 0 || second >= beams)) {
    return false;
  }
  return std::min(sight_[around(next, beams)], sight_[around(second, beams)]) > hit.range + kPast;
}

}  // namespace trundle::tracking
