// What one tick asks: where the robot is, how it can move, and what costs something. Lengths in the window are in cells.
#pragma once

#include <cstdint>
#include <vector>

namespace trundle::mppi {

constexpr int kArcs = 64;   // samples that are constant arcs
constexpr int kBlock = 16;  // samples of a block: 8 draws, and their mirror images
constexpr int kLanesPerHalf = 8;
constexpr int kMaxDiscs = 8;

// Differential drive. Speeds in m/s and rad/s, the changes of speed those of one step.
struct Model {
  float dt, v_min, v_max, w_max;
  float faster, slower, turn;  // largest change of v away from 0 and towards it, and of w
  float half_step;             // cells by which 1 m/s moves the robot in half a step
};

struct Start {
  float x, y, cos, sin, v, w;   // x and y in cells
  float v_change, w_change;     // during the step before
};

struct Disc {
  float offset;  // cells ahead of base_link
  float room;    // the byte from which on the disc touches something
};

struct Goal {
  float x, y;  // cells
  float cos, sin;
  float reach;        // cells within which the straight distance counts
  float inverse_fade;  // 1 / cells over which the heading's cost fades and that of the goal's yaw begins
  float direction;    // 1 forward, -1 backward, 0 both
  bool within, has_yaw;
};

// A mover at the end of a step. With d the distance in cells, its cost is weight · (peak − d² · slope)², while that is
// positive; from 1 on it is a contact.
struct MoverStep {
  float x, y, peak, slope, weight, certainty;
};

struct Weights {
  float collision, contact, to_go, to_go_end, heading, yaw, overshoot, obstacle, obstacle_speed, direction, twirl,
      v_acceleration, w_acceleration, v_jerk, w_jerk, speed;
};

struct Problem {
  int samples, steps, knot_steps, knots, checkpoints;
  Model model;
  Start start;
  Goal goal;
  Weights weights;
  int disc_count;
  Disc discs[kMaxDiscs];
  float capsule_rear, capsule_front;  // cells ahead of base_link, between which the discs' centres are
  float near_scale;                   // 1 / bytes within which obstacles have a cost
  float heading_free;                 // cosine of half the heading error that is free
  float speed_limit;
  float stop_scale;  // 1 / (2 deceleration)
  std::int32_t rows, cols;
  float resolution, unreachable, edge;  // cost to go of an unreachable cell; by how much one may exceed its neighbours
  const std::uint8_t *nearness;         // 254 occupied, 255 unknown, otherwise 254 − distance in units; 3 more bytes
  const float *to_go;                   // 0 to unreachable, no NaN
  int mover_count;
  const MoverStep *movers;  // by step and mover
  const float *nominal;     // v, w by step
  const float *zeros;       // as many zeros
  const float *arcs;        // as draws: [group of 8][knot][v, w][8]
  const float *draws;       // standard normal: [block][knot][v, w][8]
  float v_std, w_std;
};

// The controls of a register of samples: nominal + draws, which are multiplied by the deviations.
struct Controls {
  const float *nominal;  // v, w by step
  const float *draws;    // [knot][v, w][8], from the register's first lane on
  float v_scale, w_scale;
};

// What became of the samples.
struct Outcome {
  float *costs;
  std::int32_t *hit_step;  // the step in which it first touched something, or the number of steps
  std::uint8_t *contact;   // whether it touches a mover
};

}  // namespace trundle::mppi
