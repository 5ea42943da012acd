// What one tick is given, in metres and radians, checked, and as the numbers that the rollouts work with.
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <vector>

#include "mppi/problem.hpp"
#include "shared/arrays.hpp"

namespace trundle::mppi {

using Sequence = nb::ndarray<float, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

// Where the robot is in the window's frame and how it moves, with its accelerations during the last period.
struct State {
  double x, y, yaw, v, w, v_rate, w_rate;
};

// The length of a step, and what the robot can do. Above `speed_limit` speed costs something.
struct Limits {
  double dt, v_min, v_max, w_max, acceleration, deceleration, angular_acceleration, speed_limit;
};

// How samples differ from the controls; `share` of them takes effect, and the controls are shifted by `shift` steps.
struct Noise {
  double v_std, w_std, share, seed, shift;
};

// The square of the map around the robot.
struct Window {
  In<std::uint8_t, 2> nearness;
  In<float, 2> to_go;
  double resolution, unit;
};

struct Aim {
  double x, y, yaw;
  bool has_yaw;
  double reach, fade, direction;
};

// The weights of the critics, then the distances and angles from which on they count.
struct Critics {
  double collision, contact, to_go, to_go_end, heading, yaw, overshoot, obstacle, obstacle_speed, mover, direction, twirl,
      acceleration, jerk, speed;
  double obstacle_reach, mover_margin, mover_sigmas, free_heading;
};

struct Request {
  const State &state;
  const Limits &limits;
  const Noise &noise;
  In<double, 2> discs;
  const Window &window;
  const Aim &aim;
  In<double, 2> movers;
  const Critics &critics;
};

// Every finite number that is accepted is below this, so that no product of a few of them is infinite.
constexpr double kMost = 1e6;

inline void refuse_unless(bool good, const char *message) {
  if (!good) throw std::invalid_argument(message);
}

inline void refuse_wild(const double *numbers, std::size_t count, const char *message) {
  for (std::size_t i = 0; i < count; ++i) refuse_unless(std::fabs(numbers[i]) <= kMost, message);
}

inline void refuse_wild(std::initializer_list<double> numbers, const char *message) {
  refuse_wild(numbers.begin(), numbers.size(), message);
}

inline void refuse_outside(std::initializer_list<double> numbers, const char *message) {
  for (const double number : numbers) refuse_unless(number >= 0.0 && number <= kMost, message);
}

inline void check(const Request &request) {
  const State &state = request.state;
  const Limits &limits = request.limits;
  const Noise &noise = request.noise;
  const Window &window = request.window;
  const Aim &aim = request.aim;
  const Critics &c = request.critics;
  refuse_unless(request.discs.shape(1) == 2 && request.discs.shape(0) >= 1 && request.discs.shape(0) <= kMaxDiscs,
                "the discs need shape (1 to 8, 2)");
  refuse_unless(request.movers.shape(1) == 7 && request.movers.shape(0) <= 1024, "the movers need shape (up to 1024, 7)");
  const std::size_t rows = window.nearness.shape(0), cols = window.nearness.shape(1);
  refuse_unless(rows >= 2 && cols >= 2 && rows <= 4096 && cols <= 4096, "the window needs 2 to 4096 rows and columns");
  refuse_unless(window.to_go.shape(0) == rows && window.to_go.shape(1) == cols,
                "nearness and cost to go need the same shape");
  refuse_wild({state.x, state.y, state.yaw, state.v, state.w, state.v_rate, state.w_rate},
              "the state must be finite, and below 1e6");
  refuse_wild({limits.dt, limits.v_min, limits.v_max, limits.w_max, limits.acceleration, limits.deceleration,
               limits.angular_acceleration},
              "the limits must be finite, and below 1e6");
  refuse_wild({aim.x, aim.y, aim.yaw, aim.reach, aim.fade, aim.direction}, "the aim must be finite, and below 1e6");
  refuse_wild(request.discs.data(), request.discs.size(), "the discs must be finite, and below 1e6");
  refuse_wild(request.movers.data(), request.movers.size(), "the movers must be finite, and below 1e6");
  refuse_unless(limits.dt >= 1e-4 && limits.dt <= 10.0, "dt must be within 1e-4 and 10 s");
  refuse_unless(limits.v_min <= 0.0 && limits.v_max >= 0.0 && limits.w_max >= 0.0,
                "v_min must be at most 0, v_max and w_max at least 0");
  refuse_unless(limits.acceleration >= 1e-4 && limits.deceleration >= 1e-4 && limits.angular_acceleration >= 1e-4,
                "the accelerations must be at least 1e-4");
  refuse_unless(std::fabs(state.w) * limits.dt <= 1.0 && limits.w_max * limits.dt <= 1.0,
                "the robot must turn by at most 1 rad in a step");
  refuse_unless(noise.v_std >= 0.0 && noise.v_std <= 1e3 && noise.w_std >= 0.0 && noise.w_std <= 1e3,
                "the deviations must be within 0 and 1000");
  refuse_unless(noise.share > 0.0 && noise.share <= 1.0, "the share must be above 0, and at most 1");
  refuse_unless(noise.seed >= 0.0 && noise.seed < 9e15 && noise.shift >= 0.0 && noise.shift <= kMost,
                "the seed and the shift must be at least 0");
  refuse_unless(window.resolution >= 1e-4 && window.resolution <= 1e3, "the resolution must be within 1e-4 and 1000 m");
  refuse_unless(window.unit >= 1e-6 && window.unit <= 1e3, "the unit must be within 1e-6 and 1000 m");
  refuse_outside({c.collision, c.contact, c.to_go, c.to_go_end, c.heading, c.yaw, c.overshoot, c.obstacle,
                  c.obstacle_speed, c.mover, c.direction, c.twirl, c.acceleration, c.jerk, c.speed},
                 "the weights must be within 0 and 1e6");
  refuse_outside({c.obstacle_reach, c.mover_margin, c.mover_sigmas, c.free_heading, limits.speed_limit},
                 "the bounds must be within 0 and 1e6");
  for (std::size_t k = 0; k < request.discs.shape(0); ++k) {
    refuse_unless(request.discs.data()[2 * k + 1] >= 0.0, "the discs' radii must be at least 0");
  }
  for (std::size_t m = 0; m < request.movers.shape(0); ++m) {
    const double *mover = request.movers.data() + 7 * m;
    refuse_unless(mover[4] >= 0.0 && mover[5] >= 0.0 && mover[6] >= 0.0,
                  "the movers' radii and variances must be at least 0");
  }
}

inline Model read_model(const Request &request) {
  const Limits &limits = request.limits;
  const double dt = limits.dt;
  return {static_cast<float>(dt),
          static_cast<float>(limits.v_min),
          static_cast<float>(limits.v_max),
          static_cast<float>(limits.w_max),
          static_cast<float>(limits.acceleration * dt),
          static_cast<float>(limits.deceleration * dt),
          static_cast<float>(limits.angular_acceleration * dt),
          static_cast<float>(0.5 * dt / request.window.resolution)};
}

inline Start read_start(const Request &request) {
  const State &state = request.state;
  const double cell = request.window.resolution, dt = request.limits.dt;
  return {static_cast<float>(state.x / cell),
          static_cast<float>(state.y / cell),
          static_cast<float>(std::cos(state.yaw)),
          static_cast<float>(std::sin(state.yaw)),
          static_cast<float>(state.v),
          static_cast<float>(state.w),
          static_cast<float>(state.v_rate * dt),
          static_cast<float>(state.w_rate * dt)};
}

inline Goal read_goal(const Request &request) {
  const Aim &aim = request.aim;
  const double cell = request.window.resolution, fade = std::max(aim.fade, 1e-3);
  return {static_cast<float>(aim.x / cell),
          static_cast<float>(aim.y / cell),
          static_cast<float>(std::cos(aim.yaw)),
          static_cast<float>(std::sin(aim.yaw)),
          static_cast<float>(aim.reach / cell),
          static_cast<float>(cell / fade),
          aim.direction > 0.0 ? 1.0f : aim.direction < 0.0 ? -1.0f : 0.0f,
          aim.reach > 0.0,
          aim.reach > 0.0 && aim.has_yaw};
}

inline Weights read_weights(const Request &request, int steps) {
  const Critics &c = request.critics;
  const Limits &limits = request.limits;
  const double dt = limits.dt, v_change = limits.acceleration * dt, w_change = limits.angular_acceleration * dt;
  const auto per_step = [&](double weight, double unit) { return static_cast<float>(weight / (steps * unit * unit)); };
  return {static_cast<float>(c.collision),
          static_cast<float>(c.contact),
          static_cast<float>(c.to_go),
          static_cast<float>(c.to_go_end),
          static_cast<float>(c.heading),
          static_cast<float>(c.yaw),
          static_cast<float>(c.overshoot),
          static_cast<float>(c.obstacle),
          static_cast<float>(c.obstacle_speed),
          static_cast<float>(c.direction * dt),
          static_cast<float>(c.twirl * dt),
          per_step(c.acceleration, v_change),
          per_step(c.acceleration, w_change),
          per_step(c.jerk, v_change),
          per_step(c.jerk, w_change),
          static_cast<float>(c.speed * dt)};
}

// The discs by the byte from which on they touch something. One that does so at the start may go on, but no nearer.
inline int read_discs(const Request &request, Problem &problem) {
  const std::size_t count = request.discs.shape(0);
  problem.disc_count = static_cast<int>(count);
  problem.capsule_rear = std::numeric_limits<float>::infinity();
  problem.capsule_front = -problem.capsule_rear;
  int touching = 0;
  const auto clamped = [](float cells, std::int32_t most) {
    return static_cast<std::int32_t>(std::min(std::max(cells, 0.0f), static_cast<float>(most) - 0.5f));
  };
  for (std::size_t k = 0; k < count; ++k) {
    const double *given = request.discs.data() + 2 * k;
    Disc &disc = problem.discs[k];
    disc.offset = static_cast<float>(given[0] / request.window.resolution);
    disc.room = static_cast<float>(254.0 - given[1] / request.window.unit);
    problem.capsule_rear = std::min(problem.capsule_rear, disc.offset);
    problem.capsule_front = std::max(problem.capsule_front, disc.offset);
    const std::int32_t col = clamped(problem.start.x + problem.start.cos * disc.offset, problem.cols);
    const std::int32_t row = clamped(problem.start.y + problem.start.sin * disc.offset, problem.rows);
    const auto here = static_cast<float>(problem.nearness[row * problem.cols + col]);
    if (here >= disc.room) {
      ++touching;
      disc.room = here + 0.5f;
    }
  }
  return touching;
}

// A contact at the end of the horizon costs less by this share than one now: until then there may be a way round.
constexpr double kLaterCounts = 0.5;

// Where the movers will be, and how sure that is, by step and mover.
inline void read_movers(const Request &request, int steps, std::vector<MoverStep> &table) {
  const std::size_t count = request.movers.shape(0);
  table.resize(std::max(table.size(), count * static_cast<std::size_t>(steps)));
  double radius = 0.0;
  for (std::size_t k = 0; k < request.discs.shape(0); ++k) radius = std::max(radius, request.discs.data()[2 * k + 1]);
  const double dt = request.limits.dt, cell = request.window.resolution;
  const double margin = request.critics.mover_margin, sigmas = request.critics.mover_sigmas;
  for (int step = 0; step < steps; ++step) {
    const double t = dt * (step + 1), soon = 1.0 - kLaterCounts * step / steps;
    for (std::size_t m = 0; m < count; ++m) {
      const double *mover = request.movers.data() + 7 * m;
      const double variance = mover[5] + mover[6] * t * t;
      const double touch = std::max((mover[4] + radius) / cell, 1e-3);
      const double reach = touch + std::max((margin + sigmas * std::sqrt(variance)) / cell, 1e-2);
      const double slope = 1.0 / (reach * reach - touch * touch);
      const double certainty = touch * touch / (touch * touch + 2.0 * variance / (cell * cell));
      table[static_cast<std::size_t>(step) * count + m] = {static_cast<float>((mover[0] + mover[2] * t) / cell),
                                                           static_cast<float>((mover[1] + mover[3] * t) / cell),
                                                           static_cast<float>(reach * reach * slope),
                                                           static_cast<float>(slope),
                                                           static_cast<float>(request.critics.mover * certainty * dt),
                                                           static_cast<float>(certainty * soon)};
    }
  }
}

// Copies the costs to go, from 0 to a cost above all others for what is unreachable or no number; returns that.
inline float read_to_go(const Window &window, float *copy) {
  constexpr float kLargest = 1e6f;
  const float *given = window.to_go.data();
  const std::size_t count = window.to_go.size();
  float most = 0.0f;
  for (std::size_t i = 0; i < count; ++i) {
    const float cost = given[i] < kLargest ? given[i] : 0.0f;
    most = cost > most ? cost : most;
  }
  const auto across = static_cast<float>(window.resolution) * static_cast<float>(window.to_go.shape(0) + window.to_go.shape(1));
  const float unreachable = most + across;
  for (std::size_t i = 0; i < count; ++i) {
    const float cost = given[i] < kLargest ? given[i] : unreachable;
    copy[i] = cost > 0.0f ? cost : 0.0f;
  }
  return unreachable;
}

}  // namespace trundle::mppi
