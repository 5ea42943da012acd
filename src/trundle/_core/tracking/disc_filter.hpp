// A Kalman filter of constant velocity for one disc, corrected by points of its rim. All that it takes is on the stack.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tracking/sweep.hpp"

namespace trundle::tracking {

class DiscFilter {
 public:
  DiscFilter(Point centre, double radius) : radius(radius), state{centre.x, centre.y, 0.0, 0.0} {
    cov[0][0] = cov[1][1] = kStart * kStart;
    cov[2][2] = cov[3][3] = kStartSpeed * kStartSpeed;
  }

  Point centre() const { return {state[0], state[1]}; }
  double speed() const { return std::sqrt(state[2] * state[2] + state[3] * state[3]); }

  // Go on at constant velocity. `density`: square of how much the velocity may change in a second.
  void predict(double seconds, double density) {
    if (!(seconds > 0.0)) {
      return;
    }
    for (int i = 0; i < 2; ++i) {
      state[i] += seconds * state[i + 2];
    }
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        // Both corners across are those from before.
        cov[i][j] += seconds * (cov[i][j + 2] + cov[i + 2][j]) + seconds * seconds * cov[i + 2][j + 2];
      }
    }
    const double drifts = std::sqrt(drift[0] * drift[0] + drift[1] * drift[1]);
    const double grown = density * (1.0 + kTurning * std::clamp(drifts - kDrifting, 0.0, 1.0));
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        cov[i][j + 2] += seconds * cov[i + 2][j + 2];
      }
    }
    for (int i = 0; i < 2; ++i) {
      cov[i][i] += grown * (seconds * seconds * seconds / 3.0);
      cov[i][i + 2] += grown * (seconds * seconds / 2.0);
      cov[i + 2][i + 2] += grown * seconds;
    }
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        cov[i + 2][j] = cov[j][i + 2];
      }
    }
  }

  // Correct by points of the rim: an iterated extended filter, in which each point is one radius from the centre.
  // `hit_at(i)` gives the point i of `count`, which is at least 1.
  template <typename HitAt>
  void correct(std::size_t count, const HitAt &hit_at) {
    const double weight = std::min(1.0, kMostPoints / static_cast<double>(count)) / (kRim * kRim);
    const Point before = centre();
    Point at = before;
    double share[4][2] = {}, change[4] = {}, info[2][2] = {};
    for (int round = 0; round < kRounds; ++round) {
      double xx = 0.0, xy = 0.0, yy = 0.0, px = 0.0, py = 0.0;
      for (std::size_t i = 0; i < count; ++i) {
        const Point point = hit_at(i);
        const double dx = point.x - at.x, dy = point.y - at.y;
        const double distance = std::max(std::sqrt(dx * dx + dy * dy), 1e-6);
        const double x = dx / distance, y = dy / distance, beyond = distance - radius;
        xx += x * x, xy += x * y, yy += y * y, px += x * beyond, py += y * beyond;
      }
      info[0][0] = xx * weight, info[0][1] = info[1][0] = xy * weight, info[1][1] = yy * weight;
      const double off[2] = {at.x - before.x, at.y - before.y};
      const double pull[2] = {px * weight + (info[0][0] * off[0] + info[0][1] * off[1]),
                              py * weight + (info[1][0] * off[0] + info[1][1] * off[1])};
      // The inverse of 1 + info · covariance, 2 × 2 with a positive determinant.
      double m[2][2];
      for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) {
          m[i][j] = (i == j ? 1.0 : 0.0) + (info[i][0] * cov[0][j] + info[i][1] * cov[1][j]);
        }
      }
      const double determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
      const double inverse[2][2] = {{m[1][1] / determinant, -m[0][1] / determinant},
                                    {-m[1][0] / determinant, m[0][0] / determinant}};
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 2; ++j) {
          share[i][j] = cov[i][0] * inverse[0][j] + cov[i][1] * inverse[1][j];
        }
        change[i] = share[i][0] * pull[0] + share[i][1] * pull[1];
      }
      at = {before.x + change[0], before.y + change[1]};
    }
    const double variance[2] = {cov[0][0], cov[1][1]};
    double gain[4][2], changed[4][4];
    for (int i = 0; i < 4; ++i) {
      state[i] += change[i];
      for (int j = 0; j < 2; ++j) {
        gain[i][j] = share[i][0] * info[0][j] + share[i][1] * info[1][j];
      }
    }
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        changed[i][j] = cov[i][j] - (gain[i][0] * cov[0][j] + gain[i][1] * cov[1][j]);
      }
    }
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        cov[i][j] = 0.5 * (changed[i][j] + changed[j][i]);
      }
    }
    // Corrections of one sign, scan after scan: it speeds up or turns.
    for (int i = 0; i < 2; ++i) {
      const double expected = std::sqrt(std::max(variance[i] - cov[i][i], 1e-9));
      drift[i] += kDriftShare * (change[i] / expected - drift[i]);
    }
  }

  // Change the radius; the side that faces a sensor stays where it is.
  void resize(double changed, Point sensor) {
    const double dx = state[0] - sensor.x, dy = state[1] - sensor.y;
    const double share = (changed - radius) / std::max(std::sqrt(dx * dx + dy * dy), 1e-6);
    state[0] += dx * share, state[1] += dy * share;
    radius = changed;
  }

  // Standard deviation of the velocity in its own direction.
  double speed_deviation() const {
    const double speeds = std::max(speed(), 1e-9), x = state[2] / speeds, y = state[3] / speeds;
    const double variance = x * (cov[2][2] * x + cov[2][3] * y) + y * (cov[3][2] * x + cov[3][3] * y);
    return std::sqrt(std::max(variance, 0.0));
  }

  double radius;
  double state[4];        // x, y, vx, vy
  double cov[4][4] = {};  // of the state
  double drift[2] = {};

 private:
  static constexpr double kStartSpeed = 1.0;  // standard deviation of the velocity of something new [m/s]
  static constexpr double kStart = 0.1;
  static constexpr double kRim = 0.03;         // of a point from the disc that stands for any shape
  static constexpr double kMostPoints = 12.0;  // errors of neighbouring points are alike: more points tell no more
  static constexpr int kRounds = 2;
  static constexpr double kDriftShare = 0.3, kDrifting = 1.0, kTurning = 30.0;
};

}  // namespace trundle::tracking
