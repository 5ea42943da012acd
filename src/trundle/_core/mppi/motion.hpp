// The robot's motion over one step of the model: targets clamped to the limits of speed and acceleration, then an arc.
//
// Heading is kept as cosine and sine and turned by the angle of a step, whose cosine and sine are a series: its error is
// below 1e-7 up to 0.3 rad. A step moves along the mean of its first and its last direction.
#pragma once

#include "mppi/lanes.hpp"
#include "mppi/problem.hpp"

namespace trundle::mppi {

template <typename V>
struct Motion {
  V x, y, cos, sin, v, w;
};

template <typename V>
TRUNDLE_INLINE Motion<V> at_start(const Start &start) {
  return {fill<V>(start.x),   fill<V>(start.y), fill<V>(start.cos),
          fill<V>(start.sin), fill<V>(start.v), fill<V>(start.w)};
}

// The speeds after a step towards the targets.
template <typename V>
TRUNDLE_INLINE void speed_up(const Model &model, const Motion<V> &from, V target_v, V target_w, V &v, V &w) {
  const V zero{}, faster = fill<V>(model.faster), slower = fill<V>(model.slower), turn = fill<V>(model.turn);
  target_v = between(target_v, fill<V>(model.v_min), fill<V>(model.v_max));
  target_w = between(target_w, fill<V>(-model.w_max), fill<V>(model.w_max));
  const V up = from.v < zero ? slower : faster, down = from.v > zero ? slower : faster;
  v = between(target_v, from.v - down, from.v + up);
  w = between(target_w, from.w - turn, from.w + turn);
}

template <typename V>
TRUNDLE_INLINE void move(const Model &model, Motion<V> &robot, V v, V w) {
  const V angle = w * model.dt, square = angle * angle;
  const V cos = 1.0f - square * (0.5f - square * (1.0f / 24.0f));
  const V sin = angle * (1.0f - square * (1.0f / 6.0f - square * (1.0f / 120.0f)));
  const V next_cos = robot.cos * cos - robot.sin * sin, next_sin = robot.sin * cos + robot.cos * sin;
  const V half = v * model.half_step;
  robot.x = robot.x + half * (robot.cos + next_cos);
  robot.y = robot.y + half * (robot.sin + next_sin);
  robot.cos = next_cos;
  robot.sin = next_sin;
  robot.v = v;
  robot.w = w;
}

}  // namespace trundle::mppi
