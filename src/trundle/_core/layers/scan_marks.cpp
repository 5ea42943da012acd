// Marking and clearing by one scan: first the cells that its beams pass and meet are drawn into a small picture of the
// scan, then the picture is added to the evidence. So each cell counts once per scan, and a cell that was hit is not
// cleared by another beam of the same scan.
#include <cmath>
#include <limits>

#include "layers/evidence.hpp"
#include "layers/scan_picture.hpp"
#include "shared/directions.hpp"
#include "shared/registers.hpp"

namespace trundle {

namespace {

constexpr double kMostReach = 1e5;  // cells
constexpr double kMostAngle = 1e6;

struct Limits {
  double range_min, range_max, obstacle_min, obstacle_max, raytrace_min, raytrace_max;
};

// The poses x, y, yaw of the sensor, one or one for each beam, and the robot's outline in its frame.
struct Sensor {
  const double *poses, *corners;
  std::size_t stride, corner_count;
};

// How far the robot's outline goes from the sensor, and a little more than the rounding of `is_inside`.
double reach_of(const Sensor &sensor) {
  double reach = 0.0;
  for (std::size_t i = 0; i < sensor.corner_count; ++i) {
    reach = std::max(reach, std::hypot(sensor.corners[2 * i], sensor.corners[2 * i + 1]));
  }
  return 1.001 * reach;
}

// Beams that mark or clear something, in cells of a grid with cell (0, 0) at (col, row).
std::vector<Beam> read_beams(const Sensor &sensor, const In<double, 1> &angles, const In<double, 1> &ranges,
                             const Limits &limit, bool infinite_is_free, double row, double col, double resolution) {
  std::vector<Beam> beams;
  if (angles.size() == 0) return beams;
  beams.reserve(angles.size());
  const double body_reach = reach_of(sensor);
  const Directions *still = sensor.stride == 0 ? &directions_of(angles.data(), angles.size(), sensor.poses[2]) : nullptr;
  const double start = std::min(limit.raytrace_min / resolution, kMostReach);
  double x = sensor.poses[0] / resolution - col, y = sensor.poses[1] / resolution - row;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double range = ranges.data()[i], angle = angles.data()[i];
    const bool endless = range == std::numeric_limits<double>::infinity();
    const bool is_usable = endless ? infinite_is_free : range >= limit.range_min && range <= limit.range_max;
    if (!is_usable || !(std::abs(angle) <= kMostAngle)) continue;
    if (!endless && range <= body_reach &&
        is_inside(sensor.corners, sensor.corner_count, range * std::cos(angle), range * std::sin(angle))) {
      continue;
    }
    const double *pose = sensor.poses + i * sensor.stride;
    const double dx = still ? still->cos[i] : std::cos(pose[2] + angle);
    const double dy = still ? still->sin[i] : std::sin(pose[2] + angle);
    if (!still) x = pose[0] / resolution - col, y = pose[1] / resolution - row;
    const double end = std::min(endless ? limit.range_max : range, limit.raytrace_max) / resolution;
    const bool marks = !endless && range >= limit.obstacle_min && range <= limit.obstacle_max;
    const double far = marks ? range / resolution : 0.0;
    if (!marks && !(end > start)) continue;
    beams.push_back({x + start * dx, y + start * dy, x + end * dx, y + end * dy, x + far * dx, y + far * dy, dx, dy,
                     end > start, marks});
  }
  return beams;
}

// Whether a cell became marked, unmarked, seen (a level of 1 or more) or surely free (a level of 1). The latter two change
// only where one of the levels is 0 or 1.
TRUNDLE_INLINE std::uint8_t matters(std::uint8_t old, std::uint8_t now) {
  const std::uint8_t old_level = old & kLevel, level = now & kLevel;
  const std::uint8_t old_kind = old_level < 2 ? old_level : std::uint8_t{2}, kind = level < 2 ? level : std::uint8_t{2};
  return static_cast<std::uint8_t>(((old ^ now) & kMarked) | (old_kind ^ kind));
}

// What a scan does to some cells of a row that beams passed; returns whether it changed one that matters.
TRUNDLE_INLINE std::uint8_t clear_cells(const EvidenceRule &rule, const std::uint8_t *__restrict drawn,
                                        std::uint8_t *__restrict evidence, std::uint8_t *__restrict changed,
                                        std::ptrdiff_t count) {
  const std::uint8_t miss = rule.miss, neutral = rule.neutral;
  std::uint8_t any = 0;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::uint8_t old = evidence[i], level = old & kLevel;
    const std::uint8_t from = level == 0 ? neutral : level;
    const auto lowered = static_cast<std::uint8_t>(from > miss ? from - miss : 1);
    const std::uint8_t mark = lowered <= neutral ? std::uint8_t{0} : static_cast<std::uint8_t>(old & kMarked);
    const std::uint8_t now = drawn[i] == kPassed ? static_cast<std::uint8_t>(lowered | mark) : old;
    const std::uint8_t differs = matters(old, now);
    evidence[i] = now;
    changed[i] = differs;
    any |= differs;
  }
  return any;
}

// What a hit does to a cell, and what it does to the one behind that.
std::uint8_t raised(const EvidenceRule &rule, std::uint8_t old) {
  const int level = std::min(std::max<int>(old & kLevel, rule.neutral) + rule.hit, static_cast<int>(rule.top));
  return static_cast<std::uint8_t>(level | (level == rule.top ? kMarked : old & kMarked));
}

std::uint8_t unconfirmed(const EvidenceRule &rule, std::uint8_t old) {
  if (old & kMarked || old <= rule.neutral) return old;
  return static_cast<std::uint8_t>(std::max<int>(old - rule.miss, rule.neutral));
}

void add_ends(CellBox &box, std::ptrdiff_t row, std::ptrdiff_t col, const std::uint8_t *changed, std::ptrdiff_t count) {
  const bool is_empty = box.row == box.row_end;  // what lies within the box makes it no larger
  const std::ptrdiff_t west = is_empty ? count : box.col - col, east = is_empty ? 0 : box.col_end - col;
  std::ptrdiff_t first = 0, end = count;
  while (first < west && changed[first] == 0) ++first;
  while (end > east && changed[end - 1] == 0) --end;
  box.add(row, col + first, col + end);
}

// Draw a scan, and add what beams passed to the evidence of a grid, square by square; returns where that made a
// difference.
TRUNDLE_INLINE CellBox clear_squares(const EvidenceRule &rule, Picture &picture, const std::vector<Beam> &beams,
                                     const std::vector<Mark> &marks, std::uint8_t *evidence, std::ptrdiff_t rows,
                                     std::ptrdiff_t cols) {
  CellBox box;
  picture.look_at(evidence, rows, cols);
  picture.draw(beams, marks);
  const CellBox part = picture.inside(rows, cols);
  std::vector<std::uint8_t> changed(static_cast<std::size_t>(picture.cols));
  for (std::ptrdiff_t s = 0; s < picture.square_rows; ++s) {
    const std::uint8_t *drawn_in = picture.drawn.data() + s * picture.square_cols;
    const std::ptrdiff_t row_end = std::min(part.row_end, (s + 1) * kSquare);
    for (std::ptrdiff_t from = 0, to = 0; from < picture.square_cols; from = to) {
      for (to = from; to < picture.square_cols && drawn_in[to]; ++to) {
      }
      if (to == from) {
        ++to;
        continue;
      }
      const std::ptrdiff_t first = std::max(part.col, from * kSquare), end = std::min(part.col_end, to * kSquare);
      for (std::ptrdiff_t r = std::max(part.row, s * kSquare); r < row_end; ++r) {
        const std::uint8_t *drawn = picture.pixels.data() + r * picture.cols + first;
        const std::ptrdiff_t at_row = picture.row + r, at_col = picture.col + first;
        if (clear_cells(rule, drawn, evidence + at_row * cols + at_col, changed.data(), end - first)) {
          add_ends(box, at_row, at_col, changed.data(), end - first);
        }
      }
    }
  }
  return box;
}

#ifdef TRUNDLE_AVX2
TRUNDLE_TARGET("avx2") CellBox clear_avx2(const EvidenceRule &rule, Picture &picture, const std::vector<Beam> &beams,
                                          const std::vector<Mark> &marks, std::uint8_t *evidence, std::ptrdiff_t rows,
                                          std::ptrdiff_t cols) {
  return clear_squares(rule, picture, beams, marks, evidence, rows, cols);
}
#endif

CellBox clear_passed(const EvidenceRule &rule, Picture &picture, const std::vector<Beam> &beams,
                     const std::vector<Mark> &marks, std::uint8_t *evidence, std::ptrdiff_t rows, std::ptrdiff_t cols) {
#ifdef TRUNDLE_AVX2
  if (__builtin_cpu_supports("avx2")) return clear_avx2(rule, picture, beams, marks, evidence, rows, cols);
#endif
  return clear_squares(rule, picture, beams, marks, evidence, rows, cols);
}

// Add what a picture shows in a cell, if that is `kind`, and take it off the picture: each cell counts once.
void add_once(std::uint8_t kind, const EvidenceRule &rule, Picture &picture, std::ptrdiff_t r, std::ptrdiff_t c,
              std::uint8_t *evidence, std::ptrdiff_t rows, std::ptrdiff_t cols, CellBox &box) {
  if (r < 0 || c < 0 || r >= rows || c >= cols) return;
  std::uint8_t &cell = evidence[r * cols + c], &pixel = picture.at(r, c);
  const std::uint8_t old = cell, now = kind == kHit ? raised(rule, old) : unconfirmed(rule, old);
  if (now == old || pixel != kind) return;  // most walls are marked already
  pixel = 0;
  cell = now;
  if (matters(old, now)) box.add(r, c, c + 1);
}

}  // namespace

Rectangle mark_scan(Evidence evidence, HitPoints points, HitTimes times, std::int64_t row, std::int64_t col,
                    double resolution, In<double, 2> poses, In<double, 1> angles, In<double, 1> ranges,
                    In<double, 2> outline, In<double, 1> limits, bool infinite_is_free, std::int64_t hit,
                    std::int64_t miss, double time) {
  check_shapes(evidence, points);
  check_place(row, col, resolution);
  const EvidenceRule rule(hit, miss);
  const bool timed = times.size() > 0;
  if (timed) check_times(evidence, times);
  if (ranges.size() != angles.size()) throw std::invalid_argument("a scan needs as many ranges as angles");
  if (poses.shape(1) != 3 || (poses.shape(0) != 1 && poses.shape(0) != angles.size())) {
    throw std::invalid_argument("a scan needs one pose of its sensor, or one for each beam: x, y, yaw");
  }
  if (outline.shape(1) != 2) throw std::invalid_argument("an outline has corners x, y");
  if (limits.size() != 6) throw std::invalid_argument("a scan has six limits");
  const double *l = limits.data();
  for (int i = 0; i < 6; ++i) {
    if (!(l[i] >= 0.0)) throw std::invalid_argument("the limits of a scan must be 0 or more");
  }
  const Limits limit{l[0], l[1], l[2], l[3], l[4], l[5]};
  const double reach = std::min(std::max(limit.raytrace_max, limit.obstacle_max), limit.range_max) / resolution;
  if (!(reach <= kMostReach)) throw std::invalid_argument("the beams reach over too many cells");
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!(std::abs(poses.data()[i]) / resolution <= kFarthest)) throw std::invalid_argument("a sensor is too far away");
  }
  const auto rows = static_cast<std::ptrdiff_t>(evidence.shape(0)), cols = static_cast<std::ptrdiff_t>(evidence.shape(1));
  const Sensor sensor{poses.data(), outline.data(), poses.shape(0) == 1 ? std::size_t{0} : std::size_t{3}, outline.shape(0)};

  nb::gil_scoped_release release;
  const std::vector<Beam> beams = read_beams(sensor, angles, ranges, limit, infinite_is_free, static_cast<double>(row),
                                             static_cast<double>(col), resolution);
  Bounds bounds;
  for (const Beam &beam : beams) {
    if (beam.clears) bounds.add(beam.x0, beam.y0), bounds.add(beam.x1, beam.y1);
    if (beam.marks) bounds.add(beam.hit_x, beam.hit_y);
  }
  const bool is_beside = bounds.high_x < -3.0 || bounds.high_y < -3.0 || bounds.low_x > static_cast<double>(cols) + 3.0 ||
                         bounds.low_y > static_cast<double>(rows) + 3.0;
  if (beams.empty() || is_beside) return CellBox().as_rectangle();
  Picture picture(bounds);
  std::vector<Mark> marks;
  marks.reserve(beams.size());
  for (const Beam &beam : beams) {
    if (beam.marks) marks.push_back(Mark::of(beam));
  }
  for (const Mark &mark : marks) {
    if (mark.row < 0 || mark.col < 0 || mark.row >= rows || mark.col >= cols) continue;
    const std::ptrdiff_t cell = mark.row * cols + mark.col;
    if (timed) times.data()[cell] = time;
    if (evidence.data()[cell] & kMarked) continue;
    points.data()[2 * cell] = mark.x, points.data()[2 * cell + 1] = mark.y;
  }
  CellBox box = clear_passed(rule, picture, beams, marks, evidence.data(), rows, cols);
  for (const Mark &mark : marks) {
    add_once(kHit, rule, picture, mark.row, mark.col, evidence.data(), rows, cols, box);
    add_once(kBehind, rule, picture, mark.behind_row, mark.behind_col, evidence.data(), rows, cols, box);
  }
  return box.as_rectangle();
}

}  // namespace trundle
