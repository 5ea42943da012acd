// Rollouts of a register of samples and their costs, in one pass: noise, limits, motion and critics stay in registers,
// and no trajectory is stored.
//
// A sample that touches something stands still from that step on: what it costs does not depend on the samples beside
// it, so that it is the same in registers of any width. Costs of obstacles are per metre driven, so standing still near
// one is no better than passing it. Cost to go, heading and the goal's yaw are looked at where noise has a knot.
#pragma once

#include "mppi/sequences.hpp"

namespace trundle::mppi {

template <int kBytes>
class Rollout {
  using V = Floats<kBytes>;
  using I = typename Ints<V>::Type;

 public:
  TRUNDLE_INLINE explicit Rollout(const Problem &problem)
      : p_(problem),
        robot_(at_start<V>(problem.start)),
        v_change_(fill<V>(problem.start.v_change)),
        w_change_(fill<V>(problem.start.w_change)),
        alive_(I{} == I{}),
        hit_step_(fill<I>(problem.steps)) {}

  TRUNDLE_INLINE void run(const Controls &controls) {
    const float share = 1.0f / static_cast<float>(p_.knot_steps);
    int step = 0;
    for (int knot = 0; step < p_.steps; ++knot) {
      const float *from = controls.draws + knot * 2 * kLanesPerHalf, *to = from + 2 * kLanesPerHalf;
      const V v0 = loaded<V>(from) * controls.v_scale, w0 = loaded<V>(from + kLanesPerHalf) * controls.w_scale;
      const V v1 = loaded<V>(to) * controls.v_scale, w1 = loaded<V>(to + kLanesPerHalf) * controls.w_scale;
      const V dv = v1 - v0, dw = w1 - w0;
      for (int part = 0; part < p_.knot_steps && step < p_.steps; ++part, ++step) {
        const float fraction = static_cast<float>(part) * share;
        const float *nominal = controls.nominal + 2 * step;
        advance((v0 + dv * fraction) + nominal[0], (w0 + dw * fraction) + nominal[1], step);
      }
      look_ahead();
      if (joined_bits(alive_) == 0) {
        for (++knot; knot < p_.checkpoints; ++knot) add_checkpoint();  // nothing changes any more
        break;
      }
    }
    finish();
  }

  TRUNDLE_INLINE void write(const Outcome &outcome, int first, int count) const {
    const V costs = cost_;
    for (int lane = 0; lane < count; ++lane) {
      outcome.costs[first + lane] = costs[lane];
      outcome.hit_step[first + lane] = hit_step_[lane];
      outcome.contact[first + lane] = contact_[lane] > 0.0f ? 1 : 0;
    }
  }

 private:
  TRUNDLE_INLINE void advance(V target_v, V target_w, int step) {
    const V zero{};
    V v, w;
    speed_up(p_.model, robot_, target_v, target_w, v, w);
    v = alive_ ? v : zero;
    w = alive_ ? w : zero;
    const V dv = v - robot_.v, dw = w - robot_.w;
    move(p_.model, robot_, v, w);

    const V speed = absolute(v), length = speed * p_.model.dt;
    const V jerk_v = dv - v_change_, jerk_w = dw - w_change_;
    v_change_ = dv;
    w_change_ = dw;
    const V over = largest(speed - p_.speed_limit, zero);
    V added = dv * dv * p_.weights.v_acceleration + dw * dw * p_.weights.w_acceleration;
    added = added + (jerk_v * jerk_v * p_.weights.v_jerk + jerk_w * jerk_w * p_.weights.w_jerk);
    added = added + absolute(w) * p_.weights.twirl + over * over * p_.weights.speed;
    added = added + largest(v * -p_.goal.direction, zero) * p_.weights.direction;

    const V room = least_room(), near = largest(1.0f - room * p_.near_scale, zero);
    added = added + near * near * length * (p_.weights.obstacle + speed * p_.weights.obstacle_speed);
    added = added + mover_costs(step);
    cost_ = cost_ + (alive_ ? added : zero);

    const I hit = alive_ & (room <= zero);
    hit_step_ = hit ? fill<I>(step) : hit_step_;
    alive_ = alive_ & ~hit;
  }

  // Bytes between the discs and the nearest obstacle; 0 or less for a contact.
  TRUNDLE_INLINE V least_room() const {
    const V zero{}, last_col = fill<V>(static_cast<float>(p_.cols) - 0.5f),
            last_row = fill<V>(static_cast<float>(p_.rows) - 0.5f);
    V room = fill<V>(1e9f);
    for (int k = 0; k < p_.disc_count; ++k) {
      const Disc &disc = p_.discs[k];
      const I col = whole(between(robot_.x + robot_.cos * disc.offset, zero, last_col));
      const I row = whole(between(robot_.y + robot_.sin * disc.offset, zero, last_row));
      room = least(disc.room - looked_up<V>(p_.nearness, row * p_.cols + col), room);
    }
    return room;
  }

  TRUNDLE_INLINE V mover_costs(int step) {
    V sum{};
    const V zero{}, rear = fill<V>(p_.capsule_rear), front = fill<V>(p_.capsule_front);
    for (int m = 0; m < p_.mover_count; ++m) {
      const MoverStep &mover = p_.movers[step * p_.mover_count + m];
      const V dx = mover.x - robot_.x, dy = mover.y - robot_.y;
      const V ahead = dx * robot_.cos + dy * robot_.sin, left = dy * robot_.cos - dx * robot_.sin;
      const V beyond = ahead - between(ahead, rear, front);
      const V share = largest(mover.peak - (beyond * beyond + left * left) * mover.slope, zero);
      sum = sum + share * share * mover.weight;
      const I touches = alive_ & (share >= 1.0f);
      contact_ = largest(touches ? fill<V>(mover.certainty) : zero, contact_);
    }
    return sum;
  }

  // Cost to go by bilinear interpolation between the cells' centres, and the direction in which it falls.
  TRUNDLE_INLINE V cost_to_go(V &fall_x, V &fall_y) const {
    const V zero{}, far = fill<V>(p_.unreachable);
    const V col = between(robot_.x - 0.5f, zero, fill<V>(static_cast<float>(p_.cols - 1)));
    const V row = between(robot_.y - 0.5f, zero, fill<V>(static_cast<float>(p_.rows - 1)));
    const I last_col = fill<I>(p_.cols - 2), last_row = fill<I>(p_.rows - 2);
    const I c = least(whole(col), last_col), r = least(whole(row), last_row);
    const V tx = col - floats<V>(c), ty = row - floats<V>(r);
    const I index = r * p_.cols + c;
    V a = looked_up<V>(p_.to_go, index), b = looked_up<V>(p_.to_go + 1, index);
    V d = looked_up<V>(p_.to_go + p_.cols, index), e = looked_up<V>(p_.to_go + p_.cols + 1, index);
    // Unreachable cells rise a little above their neighbours, so that infinity spoils no slope.
    const V rim = least(least(least(a, b), least(d, e)) + p_.edge, far);
    a = a < far ? a : rim;
    b = b < far ? b : rim;
    d = d < far ? d : rim;
    e = e < far ? e : rim;
    const V lower = a + (b - a) * tx, upper = d + (e - d) * tx;
    fall_x = (a - b) + ((d - e) - (a - b)) * ty;
    fall_y = lower - upper;
    return lower + (upper - lower) * ty;
  }

  TRUNDLE_INLINE void look_ahead() {
    const V zero{};
    V fall_x, fall_y;
    V to_go = cost_to_go(fall_x, fall_y), near = zero;
    if (p_.goal.within) {
      const V dx = p_.goal.x - robot_.x, dy = p_.goal.y - robot_.y, distance = roots(dx * dx + dy * dy);
      const auto straight = distance < p_.goal.reach;
      to_go = straight ? distance * p_.resolution : to_go;
      fall_x = straight ? dx : fall_x;
      fall_y = straight ? dy : fall_y;
      near = largest(1.0f - distance * p_.goal.inverse_fade, zero);
    }
    to_go_ = to_go;
    const V slope = roots(largest(fall_x * fall_x + fall_y * fall_y, fill<V>(1e-12f)));
    const V along = (fall_x * robot_.cos + fall_y * robot_.sin) / slope;
    const V ahead = p_.goal.direction != 0.0f ? along * p_.goal.direction : absolute(along);
    heading_ = largest(p_.heading_free - cosine_of_half(ahead), zero) * (1.0f - near);
    if (p_.goal.has_yaw) {
      const V towards = robot_.cos * p_.goal.cos + robot_.sin * p_.goal.sin;
      yaw_ = 1.0f - cosine_of_half(towards) * near;  // highest away from the goal: no barrier around it
    }
    add_checkpoint();
  }

  TRUNDLE_INLINE void add_checkpoint() {
    to_go_sum_ = to_go_sum_ + to_go_;
    heading_sum_ = heading_sum_ + heading_;
    yaw_sum_ = yaw_sum_ + yaw_;
  }

  // Falls most steeply at 180 degrees, where the cosine itself is flat.
  static TRUNDLE_INLINE V cosine_of_half(V cosine) { return roots(largest(0.5f + 0.5f * cosine, V{})); }

  TRUNDLE_INLINE void finish() {
    const V zero{};
    const Weights &weights = p_.weights;
    const float share = 1.0f / static_cast<float>(p_.checkpoints), whole_time = 1.0f / static_cast<float>(p_.steps);
    cost_ = cost_ + to_go_sum_ * (weights.to_go * share) + to_go_ * weights.to_go_end;
    cost_ = cost_ + heading_sum_ * (weights.heading * share) + yaw_sum_ * (weights.yaw * share);
    const V stop = alive_ ? robot_.v * robot_.v * p_.stop_scale : zero;
    cost_ = cost_ + largest(stop - to_go_, zero) * weights.overshoot + contact_ * weights.contact;
    const V left = 1.0f + (static_cast<float>(p_.steps) - floats<V>(hit_step_)) * whole_time;
    cost_ = cost_ + (alive_ ? zero : left * weights.collision);
  }

  const Problem &p_;
  Motion<V> robot_;
  V v_change_, w_change_;
  V cost_{}, to_go_{}, heading_{}, yaw_{}, to_go_sum_{}, heading_sum_{}, yaw_sum_{}, contact_{};
  I alive_, hit_step_;
};

// The samples from `first` on; both are multiples of 16.
template <int kBytes>
TRUNDLE_INLINE void roll_samples(const Problem &problem, const Outcome &outcome, int first, int end) {
  constexpr int kLanes = kBytes / 4;
  for (int sample = first; sample < end; sample += kLanes) {
    Rollout<kBytes> rollout(problem);
    rollout.run(controls_of(problem, sample));
    rollout.write(outcome, sample, kLanes);
  }
}

}  // namespace trundle::mppi
