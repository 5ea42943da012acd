// `MissionDriver`: whole drives along planned paths, each from its start to its goal or to where it needs more.
//
// Each control period has the decisions of the navigator with regulated pure pursuit, and the motion of the kinematic
// simulator, with their operations in their order. What they would do beyond following the path (recover, give up, touch
// something) ends a drive as handed over: Python drives that mission from its start.
//
// `MissionRun` is one of these drives, whose commands somebody else may change on their way to the wheels, or decide on.
#pragma once

#include "missions/progress.hpp"
#include "missions/pure_pursuit.hpp"
#include "shared/arrays.hpp"
#include "shared/ramp.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace trundle {

class MissionRun;

class MissionDriver {
 public:
  enum Ending : std::int64_t { kArrived, kTimedOut, kTouched, kBlocked, kLost, kStood, kBeyond, kHeld, kDriving };

  // `limits`: forward, reverse and turning speed, both accelerations, wheel radius, track width, the wheels' largest
  // speed, the length of a substep and the number of them in a control period, and the length of that.
  // `goal`: tolerances of position and yaw, and the speeds below which the robot stands.
  // `progress`: radius, angle and time allowance.
  MissionDriver(In<std::uint8_t, 2> costs, In<std::uint8_t, 2> free, double resolution, In<double, 1> origin,
                In<double, 1> inflation, In<double, 2> outline, In<double, 2> padded, In<double, 1> limits,
                In<double, 1> pursuit, In<double, 1> goal, In<double, 1> progress);

  // Drive missions. Of all paths one after the other: their poses and the directions of their legs (one more than there
  // are, for each path), and the poses that are checked with how far along each is; `path_ends` and `check_ends` have
  // where those of each mission end. A goal without a yaw has none that is a number.
  //
  // Returns the rows (x, y, yaw, v, w, and the command v, w) of all missions, where those of each end, and how each
  // ended, with its control periods without a valid command.
  nb::tuple drive(In<double, 2> starts, In<double, 2> goals, In<double, 1> time_limits, In<double, 2> paths,
                  In<bool, 1> backward, In<std::int64_t, 1> path_ends, In<double, 2> checks, In<double, 1> along,
                  In<std::int64_t, 1> check_ends, std::int64_t threads) const;

  // Begin one of them, to be stepped. `patience`: radius, angle and time of standing, after which a robot that is held by
  // what changes its commands may be taken to be stuck.
  std::unique_ptr<MissionRun> begin(In<double, 1> start, In<double, 1> goal, double time_limit, In<double, 2> path,
                                    In<bool, 1> backward, In<double, 2> check, In<double, 1> along,
                                    In<double, 1> patience) const;

 private:
  friend class MissionRun;
  struct Mission {
    missions::Pose start, goal;
    bool any_yaw;
    double time_limit;
    const double *path;
    const bool *backward;
    std::size_t poses;
    const double *check, *along;
    std::size_t checked;
  };
  struct Driven {
    std::vector<double> rows;
    std::int64_t ending = kBeyond, standing = 0;
  };
  struct Patience {
    double radius = 0.0, angle = 0.0, seconds = 0.0;
  };

  // A drive in progress. The mission's arrays and the driver must live as long.
  class Drive {
   public:
    Drive(const MissionDriver &driver, const Mission &mission, const Patience &patience);
    // Log the state; `kDriving`, or how the drive ends instead of another command.
    std::int64_t look();
    // Take the command of this period; `kDriving`, or how the drive ends instead.
    std::int64_t take(const missions::Twist &chosen);
    // Both, with the command of pure pursuit in between.
    std::int64_t decide();
    void move(const missions::Twist &sent);

    Driven driven;
    missions::Twist command{0.0, 0.0};

   private:
    std::int64_t end(std::int64_t ending) { return driven.ending = ending; }
    double time() const { return static_cast<double>(steps_) * driver_.timestep_; }
    missions::Twist twist() const { return {motion_.v, motion_.w}; }

    const MissionDriver &driver_;
    const Mission &mission_;
    missions::PurePursuit pursuit_;
    missions::FollowedPath followed_;
    missions::PathProgress along_path_;
    missions::BlockWatch watch_;
    missions::ProgressChecker progress_, place_;
    double patience_;
    missions::Touching touching_;
    RampedMotion motion_;
    missions::Pose real_;
    missions::Twist sent_{0.0, 0.0};
    std::int64_t steps_ = 0;
    bool has_touched_, is_held_ = false;
  };

  void check_mission(const Mission &mission) const;
  void drive_one(const Mission &mission, Driven &driven) const;
  bool is_reached(const Mission &mission, const missions::Pose &pose, const missions::Twist &twist) const;
  bool move(missions::Pose &pose, RampedMotion &motion, const missions::Twist &command, missions::Touching &touching) const;

  std::vector<std::uint8_t> costs_, free_;
  missions::Outline footprint_, padded_;
  std::optional<missions::Ground> ground_;
  missions::SpeedLimits limits_;
  missions::PursuitSettings pursuit_;
  RampLimits ramp_;
  double timestep_, period_;
  std::int64_t substeps_;
  double xy_tolerance_, yaw_tolerance_, stopped_v_, stopped_w_;
  double progress_radius_, progress_angle_, progress_allowance_;
};

class MissionRun {
 public:
  MissionRun(const MissionDriver &driver, const MissionDriver::Mission &mission,
             const MissionDriver::Patience &patience);

  // Decide on the command of the next control period: how the drive ends instead (`kDriving` where it goes on), the
  // state (x, y, yaw, v, w), and the command (v, w).
  nb::tuple decide();
  // The same in two parts, where somebody else decides: how the drive ends instead of another command, and the state;
  nb::tuple look();
  // and how it ends instead of driving this command.
  std::int64_t take(double v, double w);
  // Drive one control period with what is sent instead of the command.
  void move(double v, double w);
  // The rows so far, as of `MissionDriver::drive`, and the control periods without a valid command.
  nb::tuple result() const;

 private:
  // Refuse calls out of turn.
  void begin_period();

  std::vector<double> path_, check_, along_;
  std::unique_ptr<bool[]> backward_;
  MissionDriver::Mission mission_;
  MissionDriver::Drive drive_;
  bool may_move_ = false, may_take_ = false;
};

}  // namespace trundle
