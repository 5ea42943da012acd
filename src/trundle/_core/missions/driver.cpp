// `MissionDriver`: its checks, the loop of one drive, and its threads.
#include "missions/driver.hpp"

#include "shared/checks.hpp"

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <system_error>
#include <thread>

namespace trundle {

namespace {

using namespace missions;

constexpr double kMostPeriods = 1e6, kLongest = 1e4;

std::vector<double> corners_of(const In<double, 2> &outline) {
  require(outline.shape(0) >= 3 && outline.shape(1) == 2 && is_finite(outline), "an outline needs shape (N, 2)");
  const std::size_t count = outline.shape(0);
  const double *p = outline.data();
  for (std::size_t i = 0; i < count; ++i) {
    const double *a = p + 2 * i, *b = p + 2 * ((i + 1) % count), *c = p + 2 * ((i + 2) % count);
    require((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) > 0.0,
            "an outline must be convex and counter-clockwise");
  }
  return {p, p + outline.size()};
}

Pose stands_at(const Pose &pose) { return {pose.x, pose.y, wrap_angle(pose.yaw)}; }

}  // namespace

MissionDriver::MissionDriver(In<std::uint8_t, 2> costs, In<std::uint8_t, 2> free, double resolution,
                             In<double, 1> origin, In<double, 1> inflation, In<double, 2> outline,
                             In<double, 2> padded, In<double, 1> limits, In<double, 1> pursuit, In<double, 1> goal,
                             In<double, 1> progress)
    : costs_(costs.data(), costs.data() + costs.size()), free_(free.data(), free.data() + free.size()),
      footprint_(corners_of(outline)), padded_(corners_of(padded)) {
  require(costs.size() > 0 && costs.shape(0) == free.shape(0) && costs.shape(1) == free.shape(1),
          "costs and free squares need one shape (rows, cols)");
  require(resolution > 1e-6 && resolution < 1e6, "the resolution must be a positive number");
  require(origin.size() == 3 && is_finite(origin), "the origin needs three numbers");
  require(inflation.size() == 3 && is_finite(inflation) && inflation.data()[1] > 0.0, "the inflation has three numbers");
  require(limits.size() == 11 && pursuit.size() == 13 && goal.size() == 4 && progress.size() == 3,
          "there are 11 limits, 13 settings of pursuit, 4 of the goal and 3 of progress");
  const double *l = limits.data(), *p = pursuit.data();
  for (std::size_t i = 0; i < 11; ++i) require(l[i] >= 0.0, "limits must not be negative");
  for (std::size_t i = 0; i < 13; ++i) require(p[i] >= 0.0, "settings must not be negative");
  require(l[3] > 0.0 && l[4] > 0.0 && l[5] > 0.0 && l[6] > 0.0 && l[8] > 0.0 && l[10] > 0.0,
          "accelerations, wheels, track and periods must be positive");
  require(l[9] >= 1.0 && l[9] <= 1e4, "a control period has 1 to 10,000 substeps");
  require(p[2] > 1e-3 && p[12] < 1e3, "the lookahead must be positive, and the padding below a kilometre");
  limits_ = {l[0], l[1], l[2], l[3], l[4]};
  ramp_ = {l[3] * l[8], l[4] * l[8], l[5], l[6], l[7]};
  timestep_ = l[8], period_ = l[10];
  substeps_ = static_cast<std::int64_t>(l[9]);
  pursuit_ = {p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11], p[12]};
  const double *g = goal.data(), *r = progress.data(), *o = origin.data(), *f = inflation.data();
  xy_tolerance_ = g[0], yaw_tolerance_ = g[1], stopped_v_ = g[2], stopped_w_ = g[3];
  progress_radius_ = r[0], progress_angle_ = r[1], progress_allowance_ = r[2];
  ground_.emplace(footprint::Costs{costs_.data(), static_cast<std::ptrdiff_t>(costs.shape(0)),
                                   static_cast<std::ptrdiff_t>(costs.shape(1))},
                  footprint::Frame{o[0], o[1], o[2], std::cos(o[2]), std::sin(o[2]), resolution}, free_.data(),
                  Inflation{f[0], f[1], f[2]});
}

bool MissionDriver::is_reached(const Mission &mission, const Pose &pose, const Twist &twist) const {
  if (length(mission.goal.x - pose.x, mission.goal.y - pose.y) > xy_tolerance_) return false;
  if (!mission.any_yaw && !(std::abs(wrap_angle(mission.goal.yaw - pose.yaw)) <= yaw_tolerance_)) return false;
  return std::abs(twist.v) <= stopped_v_ && std::abs(twist.w) <= stopped_w_;
}

// Drive one control period; returns whether the footprint has touched a blocked cell or the map's edge.
bool MissionDriver::move(Pose &pose, RampedMotion &motion, const Twist &command, Touching &touching) const {
  const Twist target = limits_.clamp(command);
  const double fastest = std::max(std::abs(motion.ramp_v), std::abs(target.v));
  const double turning = std::max(std::abs(motion.ramp_w), std::abs(target.w));
  const double seconds = static_cast<double>(substeps_) * timestep_ * (1.0 + 1e-9);
  const bool is_free = ground_->is_surely_free(pose, footprint_, fastest * seconds, turning * seconds);
  double last_v = std::nan(""), last_w = 0.0, by_length = 0.0, by_turn = 0.0;
  ArcShares arc(0.0);
  bool touched = false;
  for (std::int64_t i = 0; i < substeps_; ++i) {
    motion.approach(target.v, target.w, ramp_);
    if (motion.v != last_v || motion.w != last_w) {
      last_v = motion.v, last_w = motion.w;
      by_length = motion.v * timestep_, by_turn = motion.w * timestep_;
      arc = ArcShares(by_turn);
    }
    const double cos = std::cos(pose.yaw), sin = std::sin(pose.yaw);
    pose.x += by_length * (cos * arc.along - sin * arc.across);
    pose.y += by_length * (sin * arc.along + cos * arc.across);
    pose.yaw += by_turn;
    touched = touched || (!is_free && touching.collides(*ground_, footprint_, pose));
  }
  return touched;
}

MissionDriver::Drive::Drive(const MissionDriver &driver, const Mission &mission, const Patience &patience)
    : driver_(driver), mission_(mission),
      pursuit_(driver.limits_, driver.ramp_.track_width, driver.footprint_, driver.padded_, driver.pursuit_),
      followed_(mission.check, mission.along, mission.checked),
      progress_(driver.progress_radius_, driver.progress_angle_), place_(patience.radius, patience.angle),
      patience_(patience.seconds), real_(mission.start) {
  pursuit_.set_path(mission.path, mission.backward, mission.poses);
  has_touched_ = touching_.collides(*driver.ground_, driver.footprint_, real_);
}

std::int64_t MissionDriver::Drive::look() {
  const Pose pose = stands_at(real_);
  driven.rows.insert(driven.rows.end(), {pose.x, pose.y, pose.yaw, motion_.v, motion_.w, sent_.v, sent_.w});
  if (has_touched_) return end(kTouched);
  if (driver_.is_reached(mission_, pose, twist())) return end(kArrived);
  const bool is_patient = place_.standing(pose, time()) <= patience_;
  if (is_held_) {  // what stops the robot may move away
    if (!is_patient) return end(kHeld);
    progress_.reset();
  }
  if (!(progress_.standing(pose, time()) <= driver_.progress_allowance_)) return end(kStood);
  followed_.advance(pose.x, pose.y);
  return end(kDriving);
}

std::int64_t MissionDriver::Drive::take(const Twist &chosen) {
  command = chosen;
  if (along_path_.may_be_lost(followed_.left(), twist(), driver_.period_)) return end(kLost);
  if (watch_.is_blocked(command, twist(), driver_.period_)) return end(kBlocked);
  return end(time() >= mission_.time_limit - 1e-9 ? kTimedOut : kDriving);
}

std::int64_t MissionDriver::Drive::decide() {
  if (const std::int64_t ending = look(); ending != kDriving) return ending;
  const std::optional<Twist> found = pursuit_.compute(*driver_.ground_, stands_at(real_), twist(), driver_.period_);
  if (pursuit_.is_beyond()) return end(kBeyond);
  if (!found) ++driven.standing;
  return take(found.value_or(Twist{0.0, 0.0}));
}

void MissionDriver::Drive::move(const Twist &sent) {
  const Twist stand{0.0, 0.0};
  is_held_ = sent == stand && !(command == stand);
  has_touched_ = driver_.move(real_, motion_, sent, touching_);
  steps_ += driver_.substeps_;
  sent_ = sent;
}

void MissionDriver::drive_one(const Mission &mission, Driven &driven) const {
  Drive drive(*this, mission, Patience());
  while (drive.decide() == kDriving) drive.move(drive.command);
  driven = std::move(drive.driven);
}

MissionRun::MissionRun(const MissionDriver &driver, const MissionDriver::Mission &mission,
                       const MissionDriver::Patience &patience)
    : path_(mission.path, mission.path + 3 * mission.poses), check_(mission.check, mission.check + 3 * mission.checked),
      along_(mission.along, mission.along + mission.checked), backward_(new bool[mission.poses]), mission_(mission),
      drive_(driver, [&]() -> const MissionDriver::Mission & {
        std::copy_n(mission.backward, mission.poses, backward_.get());
        mission_.path = path_.data(), mission_.backward = backward_.get();
        mission_.check = check_.data(), mission_.along = along_.data();
        return mission_;
      }(), patience) {}

void MissionRun::begin_period() {
  if (may_move_ || may_take_) throw nb::value_error("the robot has to move before the next decision");
  if (!drive_.driven.rows.empty() && drive_.driven.ending != MissionDriver::kDriving) {
    throw nb::value_error("the drive has ended");
  }
}

nb::tuple MissionRun::decide() {
  begin_period();
  const std::int64_t ending = drive_.decide();
  may_move_ = ending == MissionDriver::kDriving;
  const double *row = drive_.driven.rows.data() + drive_.driven.rows.size() - 7;
  return nb::make_tuple(ending, row[0], row[1], row[2], row[3], row[4], drive_.command.v, drive_.command.w);
}

nb::tuple MissionRun::look() {
  begin_period();
  const std::int64_t ending = drive_.look();
  may_take_ = ending == MissionDriver::kDriving;
  const double *row = drive_.driven.rows.data() + drive_.driven.rows.size() - 7;
  return nb::make_tuple(ending, row[0], row[1], row[2], row[3], row[4]);
}

std::int64_t MissionRun::take(double v, double w) {
  if (!may_take_) throw nb::value_error("there is nothing to decide on: look first");
  if (!(std::abs(v) < 1e9 && std::abs(w) < 1e9)) throw nb::value_error("a command must be finite");
  may_take_ = false;
  const std::int64_t ending = drive_.take({v, w});
  may_move_ = ending == MissionDriver::kDriving;
  return ending;
}

void MissionRun::move(double v, double w) {
  if (!may_move_) throw nb::value_error("there is no command to be sent: decide first");
  if (!(std::abs(v) < 1e9 && std::abs(w) < 1e9)) throw nb::value_error("a command must be finite");
  may_move_ = false;
  drive_.move({v, w});
}

nb::tuple MissionRun::result() const {
  std::vector<double> rows = drive_.driven.rows;
  const std::size_t count = rows.size() / 7;
  return nb::make_tuple(to_numpy(std::move(rows), {count, 7}), drive_.driven.standing);
}

void MissionDriver::check_mission(const Mission &mission) const {
  require(std::abs(mission.goal.x) < 1e9 && std::abs(mission.goal.y) < 1e9, "goals must be finite");
  require(mission.time_limit >= 0.0 && mission.time_limit / period_ <= kMostPeriods,
          "a time limit has at most a million control periods");
  double far = 0.0;
  for (std::size_t i = 0; i + 1 < mission.poses; ++i) {
    const double *pose = mission.path + 3 * i;
    far += length(pose[3] - pose[0], pose[4] - pose[1]);
  }
  require(far <= kLongest, "a path is at most 10 km long");
}

std::unique_ptr<MissionRun> MissionDriver::begin(In<double, 1> start, In<double, 1> goal, double time_limit,
                                                 In<double, 2> path, In<bool, 1> backward, In<double, 2> check,
                                                 In<double, 1> along, In<double, 1> patience) const {
  require(start.size() == 3 && is_finite(start) && goal.size() == 3, "a start and a goal have three numbers");
  require(path.shape(0) > 0 && path.shape(1) == 3 && is_finite(path) && backward.size() == path.shape(0),
          "a path needs shape (P, 3)");
  require(check.shape(0) > 0 && check.shape(1) == 3 && is_finite(check) && along.size() == check.shape(0),
          "its check needs shape (C, 3)");
  require(patience.size() == 3 && is_finite(patience), "the patience has three numbers");
  const double *s = start.data(), *g = goal.data(), *p = patience.data();
  const Mission mission{{s[0], s[1], s[2]}, {g[0], g[1], g[2]}, !std::isfinite(g[2]), time_limit,    path.data(),
                        backward.data(),    path.shape(0),      check.data(),         along.data(), check.shape(0)};
  check_mission(mission);
  return std::make_unique<MissionRun>(*this, mission, Patience{p[0], p[1], p[2]});
}

nb::tuple MissionDriver::drive(In<double, 2> starts, In<double, 2> goals, In<double, 1> time_limits,
                               In<double, 2> paths, In<bool, 1> backward, In<std::int64_t, 1> path_ends,
                               In<double, 2> checks, In<double, 1> along, In<std::int64_t, 1> check_ends,
                               std::int64_t threads) const {
  const std::size_t count = time_limits.size();
  require(starts.shape(0) == count && starts.shape(1) == 3 && is_finite(starts), "starts need shape (N, 3)");
  require(goals.shape(0) == count && goals.shape(1) == 3, "goals need shape (N, 3)");
  require(path_ends.size() == count && check_ends.size() == count, "each mission needs the ends of its path and check");
  require(paths.shape(1) == 3 && is_finite(paths) && backward.size() == paths.shape(0), "paths need shape (P, 3)");
  require(checks.shape(1) == 3 && is_finite(checks) && along.size() == checks.shape(0), "checks need shape (C, 3)");
  std::vector<Mission> all;
  std::int64_t path = 0, check = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t path_end = path_ends.data()[i], check_end = check_ends.data()[i];
    require(path < path_end && check < check_end && static_cast<std::size_t>(path_end) <= paths.shape(0) &&
                static_cast<std::size_t>(check_end) <= checks.shape(0),
            "each mission needs a path with poses, and its check");
    const double *start = starts.data() + 3 * i, *goal = goals.data() + 3 * i;
    all.push_back({{start[0], start[1], start[2]},
                   {goal[0], goal[1], goal[2]},
                   !std::isfinite(goal[2]),
                   time_limits.data()[i],
                   paths.data() + 3 * path,
                   backward.data() + path,
                   static_cast<std::size_t>(path_end - path),
                   checks.data() + 3 * check,
                   along.data() + check,
                   static_cast<std::size_t>(check_end - check)});
    check_mission(all.back());
    path = path_end, check = check_end;
  }
  std::vector<Driven> driven(count);
  {
    nb::gil_scoped_release release;
    std::atomic<std::size_t> next{0};
    std::atomic<bool> has_memory{true};
    const auto run = [&] {
      try {
        for (std::size_t i = next++; i < count && has_memory; i = next++) drive_one(all[i], driven[i]);
      } catch (const std::bad_alloc &) {
        has_memory = false;
      }
    };
    std::vector<std::thread> others;
    try {
      const auto useful = std::min(static_cast<std::size_t>(std::max<std::int64_t>(threads, 1)), count);
      for (std::size_t i = 1; i < useful; ++i) others.emplace_back(run);
    } catch (const std::system_error &) {
      // The machine has no more threads to give; those that run do all.
    }
    run();
    for (std::thread &other : others) other.join();
    if (!has_memory) throw std::bad_alloc();
  }
  std::vector<double> rows;
  std::vector<std::int64_t> ends, endings;
  for (Driven &one : driven) {
    rows.insert(rows.end(), one.rows.begin(), one.rows.end());
    ends.push_back(static_cast<std::int64_t>(rows.size() / 7));
    endings.insert(endings.end(), {one.ending, one.standing});
    one.rows = {};
  }
  const std::size_t total = rows.size() / 7;
  return nb::make_tuple(to_numpy(std::move(rows), {total, 7}), to_numpy(std::move(ends), {count}),
                        to_numpy(std::move(endings), {count, 2}));
}

}  // namespace trundle
