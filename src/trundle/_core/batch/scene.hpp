// What robots drive among: maps with their frames, and movers on recorded tracks. All of it is read only but for the
// members of crowds, who are where they are for one robot.
#pragma once

#include "batch/outlines.hpp"
#include "batch/sine.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace trundle::batch {

struct Map {
  JumpField field;
  double x, y, yaw;
  SinCos turn;

  // A point of the map frame, in cell units.
  Point to_cells(double px, double py, double resolution) const {
    const double dx = px - x, dy = py - y;
    return {(turn.cos * dx + turn.sin * dy) / resolution, (turn.cos * dy - turn.sin * dx) / resolution};
  }
};

struct Pose {
  double x, y, yaw;
};

// A disc about its frame's origin, or a convex polygon; of a member of a crowd the track is of no use.
struct Mover {
  double radius;  // of the disc, or of the circle about the origin that has the polygon in it
  std::vector<Point> corners;
  const double *track;  // (x, y, yaw) at each sample
  bool is_disc() const { return corners.empty(); }
};

// Movers [first, end) of one recording; positions between samples are interpolated, and after the last one they stand.
struct Recording {
  std::size_t first, end;
};

// The members of the crowds that are around one robot now: movers from `first` on.
struct Members {
  std::size_t first = 0;
  std::vector<Pose> poses;
};

struct Movers {
  std::vector<Mover> all;
  std::vector<Recording> recordings;
  std::size_t samples = 0;
  double period = 1.0;

  Pose at(std::size_t mover, double time, const Members &members) const {
    if (mover - members.first < members.poses.size()) return members.poses[mover - members.first];
    const double *track = all[mover].track;
    const double sample = std::max(time / period, 0.0);
    const double whole = std::floor(sample);
    if (!(whole < static_cast<double>(samples - 1))) {
      const double *last = track + 3 * (samples - 1);
      return {last[0], last[1], last[2]};
    }
    const double *from = track + 3 * static_cast<std::size_t>(whole), *to = from + 3, share = sample - whole;
    return {from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1]),
            from[2] + share * (to[2] - from[2])};
  }
};

}  // namespace trundle::batch
