// Directions of a scan's beams as unit vectors. The costmap, the tracker and the collision monitor turn the same beams by
// the same yaw in one control period, and by that of the lidar's mount in all of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <deque>
#include <vector>

#include "shared/sine_cosine.hpp"

namespace trundle {

struct Directions {
  double yaw;
  std::vector<double> angles, cos, sin;

  bool is_of(const double *beams, std::size_t count, double turn) const {
    return turn == yaw && count == angles.size() && std::memcmp(beams, angles.data(), count * sizeof(double)) == 0;
  }
};

// Cosines and sines of `angles[i] + yaw`. They are kept for the thread's last questions: those about the lidars of a robot
// or two. The answer holds until the next question.
inline const Directions &directions_of(const double *angles, std::size_t count, double yaw) {
  constexpr std::size_t kKept = 12, kMany = 20000;
  static thread_local std::deque<Directions> kept;
  auto found = std::find_if(kept.begin(), kept.end(), [&](const Directions &one) { return one.is_of(angles, count, yaw); });
  if (found == kept.end()) {
    if (count > kMany) kept.clear();
    if (kept.size() < kKept) kept.emplace_back();
    found = kept.end() - 1;
    found->yaw = yaw;
    found->angles.assign(angles, angles + count);
    found->cos.resize(count), found->sin.resize(count);
    turn_directions(angles, yaw, count, found->cos.data(), found->sin.data());
  }
  std::rotate(kept.begin(), found, found + 1);
  return kept.front();
}

}  // namespace trundle
