// The arrays of one tick, checked, as the numbers that the rollouts work with.
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

struct Request {
  In<double, 1> state, model, noise;
  In<double, 2> discs;
  In<std::uint8_t, 2> nearness;
  In<float, 2> to_go;
  double resolution, unit;
  In<double, 1> goal;
  In<double, 2> movers;
  In<double, 1> weights, bounds;
};

// Every finite number that is accepted is below this, so that no product of a few of them is infinite.
constexpr double kMost = 1e6;

inline void refuse_unless(bool good, const char *message) {
  if (!good) throw std::invalid_argument(message);
}

inline void refuse_wild(const double *numbers, std::size_t count, const char *message) {
  for (std::size_t i = 0; i < count; ++i) refuse_unless(std::fabs(numbers[i]) <= kMost, message);
}

inline void check(const Request &request) {
  const auto sized = [](const In<double, 1> &array, std::size_t size, const char *message) {
    refuse_unless(array.shape(0) == size, message);
  };
  sized(request.state, 7, "the state needs 7 numbers: x, y, yaw, v, w and the accelerations of v and w");
  sized(request.model, 7, "the model needs 7 numbers: dt, v_min, v_max, w_max and three accelerations");
  sized(request.noise, 5, "the noise needs 5 numbers: deviations of v and w, share, seed, shift");
  sized(request.goal, 7, "the goal needs 7 numbers: x, y, yaw, has_yaw, reach, fade, direction");
  sized(request.weights, 15, "there must be 15 weights");
  sized(request.bounds, 5, "there must be 5 bounds");
  refuse_unless(request.discs.shape(1) == 2 && request.discs.shape(0) >= 1 && request.discs.shape(0) <= kMaxDiscs,
                "the discs need shape (1 to 8, 2)");
  refuse_unless(request.movers.shape(1) == 7 && request.movers.shape(0) <= 1024, "the movers need shape (up to 1024, 7)");
  const std::size_t rows = request.nearness.shape(0), cols = request.nearness.shape(1);
  refuse_unless(rows >= 2 && cols >= 2 && rows <= 4096 && cols <= 4096, "the window needs 2 to 4096 rows and columns");
  refuse_unless(request.to_go.shape(0) == rows && request.to_go.shape(1) == cols,
                "nearness and cost to go need the same shape");
  refuse_wild(request.state.data(), 7, "the state must be finite, and below 1e6");
  refuse_wild(request.model.data(), 7, "the model must be finite, and below 1e6");
  refuse_wild(request.goal.data(), 7, "the goal must be finite, and below 1e6");
  refuse_wild(request.discs.data(), request.discs.size(), "the discs must be finite, and below 1e6");
  refuse_wild(request.movers.data(), request.movers.size(), "the movers must be finite, and below 1e6");
  const double *model = request.model.data(), *noise = request.noise.data();
  refuse_unless(model[0] >= 1e-4 && model[0] <= 10.0, "dt must be within 1e-4 and 10 s");
  refuse_unless(model[1] <= 0.0 && model[2] >= 0.0 && model[3] >= 0.0, "v_min must be at most 0, v_max and w_max at least 0");
  refuse_unless(model[4] >= 1e-4 && model[5] >= 1e-4 && model[6] >= 1e-4, "the accelerations must be at least 1e-4");
  refuse_unless(std::fabs(request.state.data()[4]) * model[0] <= 1.0 && model[3] * model[0] <= 1.0,
                "the robot must turn by at most 1 rad in a step");
  refuse_unless(noise[0] >= 0.0 && noise[0] <= 1e3 && noise[1] >= 0.0 && noise[1] <= 1e3,
                "the deviations must be within 0 and 1000");
  refuse_unless(noise[2] > 0.0 && noise[2] <= 1.0, "the share must be above 0, and at most 1");
  refuse_unless(noise[3] >= 0.0 && noise[3] < 9e15 && noise[4] >= 0.0 && noise[4] <= kMost,
                "the seed and the shift must be at least 0");
  refuse_unless(request.resolution >= 1e-4 && request.resolution <= 1e3, "the resolution must be within 1e-4 and 1000 m");
  refuse_unless(request.unit >= 1e-6 && request.unit <= 1e3, "the unit must be within 1e-6 and 1000 m");
  for (std::size_t i = 0; i < 15; ++i) {
    refuse_unless(request.weights.data()[i] >= 0.0 && request.weights.data()[i] <= kMost,
                  "the weights must be within 0 and 1e6");
  }
  for (std::size_t i = 0; i < 5; ++i) {
    refuse_unless(request.bounds.data()[i] >= 0.0 && request.bounds.data()[i] <= kMost,
                  "the bounds must be within 0 and 1e6");
  }
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
  const double *model = request.model.data();
  const double dt = model[0];
  return {static_cast<float>(dt),
          static_cast<float>(model[1]),
          static_cast<float>(model[2]),
          static_cast<float>(model[3]),
          static_cast<float>(model[4] * dt),
          static_cast<float>(model[5] * dt),
          static_cast<float>(model[6] * dt),
          static_cast<float>(0.5 * dt / request.resolution)};
}

inline Start read_start(const Request &request) {
  const double *state = request.state.data(), dt = request.model.data()[0];
  return {static_cast<float>(state[0] / request.resolution),
          static_cast<float>(state[1] / request.resolution),
          static_cast<float>(std::cos(state[2])),
          static_cast<float>(std::sin(state[2])),
          static_cast<float>(state[3]),
          static_cast<float>(state[4]),
          static_cast<float>(state[5] * dt),
          static_cast<float>(state[6] * dt)};
}

inline Goal read_goal(const Request &request) {
  const double *goal = request.goal.data(), cell = request.resolution;
  const double fade = std::max(goal[5], 1e-3);
  return {static_cast<float>(goal[0] / cell),
          static_cast<float>(goal[1] / cell),
          static_cast<float>(std::cos(goal[2])),
          static_cast<float>(std::sin(goal[2])),
          static_cast<float>(goal[4] / cell),
          static_cast<float>(cell / fade),
          goal[6] > 0.0 ? 1.0f : goal[6] < 0.0 ? -1.0f : 0.0f,
          goal[4] > 0.0,
          goal[4] > 0.0 && goal[3] > 0.0};
}

inline Weights read_weights(const Request &request, int steps) {
  const double *w = request.weights.data(), *model = request.model.data();
  const double dt = model[0], v_change = model[4] * dt, w_change = model[6] * dt;
  const auto per_step = [&](double weight, double unit) { return static_cast<float>(weight / (steps * unit * unit)); };
  return {static_cast<float>(w[0]),
          static_cast<float>(w[1]),
          static_cast<float>(w[2]),
          static_cast<float>(w[3]),
          static_cast<float>(w[4]),
          static_cast<float>(w[5]),
          static_cast<float>(w[6]),
          static_cast<float>(w[7]),
          static_cast<float>(w[8]),
          static_cast<float>(w[10] * dt),
          static_cast<float>(w[11] * dt),
          per_step(w[12], v_change),
          per_step(w[12], w_change),
          per_step(w[13], v_change),
          per_step(w[13], w_change),
          static_cast<float>(w[14] * dt)};
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
    disc.offset = static_cast<float>(given[0] / request.resolution);
    disc.room = static_cast<float>(254.0 - given[1] / request.unit);
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
  const double dt = request.model.data()[0], cell = request.resolution;
  const double margin = request.bounds.data()[1], sigmas = request.bounds.data()[2];
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
                                                           static_cast<float>(request.weights.data()[9] * certainty * dt),
                                                           static_cast<float>(certainty * soon)};
    }
  }
}

// Copies the costs to go, from 0 to a cost above all others for what is unreachable or no number; returns that.
inline float read_to_go(const Request &request, float *copy) {
  constexpr float kLargest = 1e6f;
  const float *given = request.to_go.data();
  const std::size_t count = request.to_go.size();
  float most = 0.0f;
  for (std::size_t i = 0; i < count; ++i) {
    const float cost = given[i] < kLargest ? given[i] : 0.0f;
    most = cost > most ? cost : most;
  }
  const auto across = static_cast<float>(request.resolution) * static_cast<float>(request.to_go.shape(0) + request.to_go.shape(1));
  const float unreachable = most + across;
  for (std::size_t i = 0; i < count; ++i) {
    const float cost = given[i] < kLargest ? given[i] : unreachable;
    copy[i] = cost > 0.0f ? cost : 0.0f;
  }
  return unreachable;
}

}  // namespace trundle::mppi
