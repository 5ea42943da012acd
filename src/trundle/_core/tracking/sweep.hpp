// One scan in the odom frame, by the directions of its beams as seen from one place: where the sensor was in the middle
// of it. `View` is what is kept of it, to be compared with points of later scans; `Sweep` is the whole of the newest one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace trundle::tracking {

struct Point {
  double x, y;
};

// What a scan says about a point: nothing, that it saw farther, or that it met a surface there.
enum class Sight : std::uint8_t { kNothing, kThrough, kThere };

struct View {
  double time = 0.0;
  Point sensor{};
  double zero = 0.0, spacing = 0.0;  // direction of the first beam, angle between two
  double per_spacing = 0.0;          // beams per angle
  std::vector<double> bearings;      // of the beams from the first, ascending from 0 to a turn
  std::vector<double> through;       // how far each beam and those beside it saw at least
  std::vector<Point> ends;           // what each beam met, infinity for nothing

  // Both within a margin [m]. `direction` is that of the point from the sensor, where it is known.
  Sight judge(Point point, double margin) const;
  Sight judge(Point point, double margin, double direction) const;

  // Whether a beam goes past a point, or would if it went on.
  bool faces(Point point) const;
};

// A scan as it arrives. Poses are those of the sensor in the odom frame: one, or one for each beam.
struct Scan {
  double time;
  const double *ranges, *angles;
  std::size_t count;
  const double *poses;
  std::size_t pose_count;
  double mount_x, mount_y, mount_yaw, range_min, range_max;
};

// A hit of a scan.
struct Hit {
  Point point;
  double range;
  std::size_t beam;
  bool appeared, still;  // where an earlier scan saw through; part of what stands still
};

class Sweep {
 public:
  // Hits beyond `max_range` and in the robot's outline, counter-clockwise in base_link, are left out.
  void take(const Scan &scan, double max_range, const std::vector<Point> &body, View &view);

  // Order the hits so that each thing is a run of them, and find where things begin, and their end. Things are apart
  // where neighbouring hits have a gap: that of Borges and Aldon, Line Extraction in 2D Range Images for Mobile Robotics
  // (2004), what a surface that the beams graze at 10 degrees leaves between two of them.
  void split();

  // Whether the beams on one side (-1 or 1) of a hit see farther. Beyond the ends of the field of view all is hidden.
  bool sees_past(const Hit &hit, int side) const;

  const View &view() const { return *view_; }
  std::vector<Hit> &hits() { return hits_; }
  const std::vector<Hit> &hits() const { return hits_; }
  const std::vector<std::size_t> &starts() const { return starts_; }

 private:
  bool in_body(const Scan &scan, std::size_t beam, const std::vector<Point> &body, double reach) const;
  void order(const Scan &scan, View &view);

  const View *view_ = nullptr;
  std::vector<Hit> hits_, turned_;
  std::vector<std::size_t> starts_, order_;
  std::vector<double> sight_;  // how far each beam saw, minus infinity where it measured nothing
  std::vector<double> bearing_, range_;
  std::vector<Point> end_;
  std::vector<std::uint8_t> missing_;
};

}  // namespace trundle::tracking
