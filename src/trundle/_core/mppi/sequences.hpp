// Sequences of controls: where samples get theirs from, what the robot does with one, and the mean of all.
#pragma once

#include <algorithm>
#include <vector>

#include "mppi/draws.hpp"
#include "mppi/motion.hpp"

namespace trundle::mppi {

constexpr float kArcSpeeds[] = {-1.0f, -0.5f, 0.0f, 0.25f, 0.5f, 0.75f, 1.0f};  // shares of the limits
constexpr float kArcTurns[] = {-1.0f, -0.5f, -0.25f, -0.1f, 0.0f, 0.1f, 0.25f, 0.5f, 1.0f};
// Draws of one block are wide, those of the next closer to the nominal controls: without the close ones, the robot
// creeps for seconds over the last centimetres, as every sample passes by the goal.
constexpr float kShrink[] = {1.0f, 0.5f, 0.25f, 0.125f};

// Floats of a group of 8 samples' knots.
inline std::size_t row_of(const Problem &problem) {
  return static_cast<std::size_t>(problem.knots) * 2 * kLanesPerHalf;
}

// The controls of the register that begins with a sample.
inline Controls controls_of(const Problem &problem, int sample) {
  const auto row = static_cast<std::ptrdiff_t>(row_of(problem));
  const int lane = sample % kLanesPerHalf;
  if (sample < kArcs) return {problem.zeros, problem.arcs + sample / kLanesPerHalf * row + lane, 1.0f, 1.0f};
  const int block = (sample - kArcs) / kBlock;
  const float sign = (sample - kArcs) % kBlock < kLanesPerHalf ? 1.0f : -1.0f;
  return {problem.nominal, problem.draws + block * row + lane, sign * problem.v_std, sign * problem.w_std};
}

// Standard normal draws for all blocks. The first sample of the first block, and its mirror image, are the nominal
// controls themselves.
inline void draw(const Problem &problem, std::uint64_t seed, std::vector<float> &draws) {
  const std::size_t row = row_of(problem);
  for (std::size_t i = 0; i < draws.size(); ++i) {
    const bool plain = i < row && i % kLanesPerHalf == 0;
    draws[i] = plain ? 0.0f : normal(seed, i) * kShrink[i / row % 4];
  }
}

inline void lay_arcs(const Problem &problem, std::vector<float> &arcs) {
  for (int sample = 0; sample < kArcs; ++sample) {
    // One more than there are pairs: straight on, slowly.
    const bool pair = sample < kArcs - 1;
    const float speed = pair ? kArcSpeeds[sample / 9] : 0.1f, turn = pair ? kArcTurns[sample % 9] : 0.0f;
    const float v = speed < 0.0f ? -speed * problem.model.v_min : speed * problem.model.v_max;
    float *knots = arcs.data() + static_cast<std::size_t>(sample / kLanesPerHalf) * row_of(problem);
    for (int knot = 0; knot < problem.knots; ++knot) {
      float *at = knots + knot * 2 * kLanesPerHalf + sample % kLanesPerHalf;
      at[0] = v;
      at[kLanesPerHalf] = turn * problem.model.w_max;
    }
  }
}

// Another sequence some steps later, its end held; what is no number is 0.
inline void shift(const float *controls, double by, std::vector<float> &shifted) {
  const int last = static_cast<int>(shifted.size() / 2) - 1;
  for (int step = 0; step <= last; ++step) {
    const double at = std::min(step + by, static_cast<double>(last));
    const int first = static_cast<int>(at), next = std::min(first + 1, last);
    const auto part = static_cast<float>(at - first);
    for (int k = 0; k < 2; ++k) {
      const float a = controls[2 * first + k], b = controls[2 * next + k];
      const float value = part > 0.0f ? a + (b - a) * part : a;
      shifted[static_cast<std::size_t>(2 * step + k)] = std::fabs(value) <= 1e6f ? value : 0.0f;
    }
  }
}

// Drives towards the targets of each step, and shows each state from the start on; the robot stands after `stop`.
template <typename Target, typename Show>
void follow(const Problem &problem, Target target, int stop, Show show) {
  Motion<float> robot = at_start<float>(problem.start);
  show(robot);
  for (int step = 0; step < problem.steps; ++step) {
    float target_v, target_w, v = 0.0f, w = 0.0f;
    target(step, target_v, target_w);
    if (step <= stop) speed_up(problem.model, robot, target_v, target_w, v, w);
    move(problem.model, robot, v, w);
    show(robot);
  }
}

// Drives a sample as its rollout does.
template <typename Show>
void drive(const Problem &problem, int sample, int stop, Show show) {
  const Controls controls = controls_of(problem, sample);
  const float share = 1.0f / static_cast<float>(problem.knot_steps);
  const auto target = [&](int step, float &v, float &w) {
    const float *from = controls.draws + step / problem.knot_steps * 2 * kLanesPerHalf, *to = from + 2 * kLanesPerHalf;
    const float fraction = static_cast<float>(step % problem.knot_steps) * share;
    const float v0 = from[0] * controls.v_scale, w0 = from[kLanesPerHalf] * controls.w_scale;
    v = (v0 + (to[0] * controls.v_scale - v0) * fraction) + controls.nominal[2 * step];
    w = (w0 + (to[kLanesPerHalf] * controls.w_scale - w0) * fraction) + controls.nominal[2 * step + 1];
  };
  follow(problem, target, stop, show);
}

// The mean of the samples' controls by their weights, whose sum is 1: the mean of the draws at the knots, as controls
// are straight lines between those, and of the arcs. `knots` has room for a row.
inline void average(const Problem &problem, const float *weights, std::vector<float> &knots, std::vector<float> &mean) {
  const std::size_t row = row_of(problem);
  float arcs = 0.0f, arc_v = 0.0f, arc_w = 0.0f;
  for (int sample = 0; sample < kArcs; ++sample) {
    const float *arc = controls_of(problem, sample).draws;
    arcs += weights[sample];
    arc_v += weights[sample] * arc[0];
    arc_w += weights[sample] * arc[kLanesPerHalf];
  }
  std::fill(knots.begin(), knots.end(), 0.0f);
  for (int first = kArcs; first < problem.samples; first += kBlock) {
    const float *draws = controls_of(problem, first).draws, *own = weights + first;
    float pull[kLanesPerHalf];
    for (int lane = 0; lane < kLanesPerHalf; ++lane) pull[lane] = own[lane] - own[kLanesPerHalf + lane];
    for (std::size_t i = 0; i < row; i += kLanesPerHalf) {
      for (std::size_t lane = 0; lane < kLanesPerHalf; ++lane) knots[i + lane] += pull[lane] * draws[i + lane];
    }
  }
  const auto knot = [&](int k, int which) {
    const float *lanes = knots.data() + (2 * k + which) * kLanesPerHalf;
    return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
  };
  for (int step = 0; step < problem.steps; ++step) {
    const int k = step / problem.knot_steps;
    const float part = static_cast<float>(step % problem.knot_steps) / static_cast<float>(problem.knot_steps);
    for (int which = 0; which < 2; ++which) {
      const float from = knot(k, which), to = knot(k + 1, which);
      const float scale = which == 0 ? problem.v_std : problem.w_std;
      const auto at = static_cast<std::size_t>(2 * step + which);
      mean[at] = problem.nominal[at] * (1.0f - arcs) + (from + (to - from) * part) * scale + (which == 0 ? arc_v : arc_w);
    }
  }
}

}  // namespace trundle::mppi
