// Marking and clearing by one scan: first the cells that its beams pass and meet are drawn into a small picture of the
// scan, then the picture is added to the evidence. So each cell counts once per scan, and a cell that was hit is not
// cleared by another beam of the same scan.
//
// A beam is drawn as in Bresenham's algorithm: one cell for each step along its longer axis, the one that it passes at
// the middle of the step. The cell in which it ends is not passed. The cell behind that one loses what hits it had
// gathered on the way to a mark: a range that is too long now and then does not thicken a wall on its far side, where no
// beam clears.
#include <cmath>
#include <cstring>
#include <limits>

#include "layers/evidence.hpp"
#include "shared/directions.hpp"
#include "shared/registers.hpp"

namespace trundle {

namespace {

constexpr std::uint8_t kBehind = 1, kPassed = 2, kHit = 3;
constexpr std::ptrdiff_t kBlock = 64;        // cells
constexpr double kMostReach = 1e5;           // cells
constexpr double kMostPixels = 268435456.0;  // 16384 x 16384
constexpr std::size_t kMostSpare = 4'000'000;  // pixels
constexpr double kMostAngle = 1e6;
constexpr double kOne = 4294967296.0;  // of a number with 32 binary places

struct Limits {
  double range_min, range_max, obstacle_min, obstacle_max, raytrace_min, raytrace_max;
};

// The poses x, y, yaw of the sensor, one or one for each beam, and the robot's outline in its frame.
struct Sensor {
  const double *poses, *corners;
  std::size_t stride, corner_count;
};

// Clears from (x0, y0) to (x1, y1) and marks (hit_x, hit_y), in cells of the grid; (dx, dy) is its direction.
struct Beam {
  double x0, y0, x1, y1, hit_x, hit_y, dx, dy;
  bool clears, marks;
};

struct Bounds {
  double low_x = kFarthest * 4.0, low_y = low_x, high_x = -low_x, high_y = -low_x;

  void add(double x, double y) {
    low_x = std::min(low_x, x);
    low_y = std::min(low_y, y);
    high_x = std::max(high_x, x);
    high_y = std::max(high_y, y);
  }
};

std::int64_t to_fixed(double value) { return static_cast<std::int64_t>(std::floor(value * kOne + 0.5)); }

// The picture of a scan: cells [row, row + rows) x [col, col + cols) of the grid.
struct Picture {
  std::ptrdiff_t row, col, rows, cols;
  std::vector<std::uint8_t> pixels;

  // Two rows and columns more on each side: the middle of a beam's first step may lie before its start, and what is
  // behind a hit a cell further on.
  explicit Picture(const Bounds &bounds)
      : row(static_cast<std::ptrdiff_t>(std::floor(bounds.low_y)) - 2),
        col(static_cast<std::ptrdiff_t>(std::floor(bounds.low_x)) - 2),
        rows(static_cast<std::ptrdiff_t>(std::floor(bounds.high_y)) + 3 - row),
        cols(static_cast<std::ptrdiff_t>(std::floor(bounds.high_x)) + 3 - col) {
    if (static_cast<double>(rows) * static_cast<double>(cols) > kMostPixels) {
      throw std::invalid_argument("the beams reach over too many cells");
    }
    pixels.swap(spare());
    pixels.assign(static_cast<std::size_t>(rows * cols), 0);
  }
  Picture(const Picture &) = delete;
  Picture &operator=(const Picture &) = delete;
  ~Picture() {
    if (pixels.size() <= kMostSpare) pixels.swap(spare());
  }

  // Memory of the thread's last picture: the system would take back and clear so much each time.
  static std::vector<std::uint8_t> &spare() {
    static thread_local std::vector<std::uint8_t> memory;
    return memory;
  }

  std::uint8_t &at(double x, double y) {
    const auto r = static_cast<std::ptrdiff_t>(std::floor(y)) - row, c = static_cast<std::ptrdiff_t>(std::floor(x)) - col;
    return pixels[static_cast<std::size_t>(r * cols + c)];
  }

  // Cells that a beam passes on its way along x; for one along y with x and y swapped.
  template <bool kSwapped>
  void pass(double x0, double y0, double x1, double y1) {
    const std::ptrdiff_t along = kSwapped ? cols : 1, across = kSwapped ? 1 : cols;
    const auto first = static_cast<std::ptrdiff_t>(std::floor(x0)), last = static_cast<std::ptrdiff_t>(std::floor(x1));
    const double slope = (y1 - y0) / (x1 - x0);
    const std::ptrdiff_t step = last > first ? 1 : -1;
    const std::int64_t rise = to_fixed(step * slope);
    std::int64_t y = to_fixed(y0 + (static_cast<double>(first) + 0.5 - x0) * slope);
    std::uint8_t *out = pixels.data() + first * along;
    for (std::ptrdiff_t n = step * (last - first); n > 0; --n) {
      out[(y >> 32) * across] = kPassed;
      y += rise;
      out += step * along;
    }
  }

  void draw(const Beam &beam) {
    const double x0 = beam.x0 - static_cast<double>(col), y0 = beam.y0 - static_cast<double>(row);
    const double x1 = beam.x1 - static_cast<double>(col), y1 = beam.y1 - static_cast<double>(row);
    if (std::abs(x1 - x0) >= std::abs(y1 - y0)) {
      if (x1 != x0) pass<false>(x0, y0, x1, y1);
    } else {
      pass<true>(y0, x0, y1, x1);
    }
  }

  void draw(const std::vector<Beam> &beams) {
    for (const Beam &beam : beams) {
      if (beam.marks) at(beam.hit_x + beam.dx, beam.hit_y + beam.dy) = kBehind;
    }
    for (const Beam &beam : beams) {
      if (beam.clears) draw(beam);
    }
    for (const Beam &beam : beams) {
      if (beam.marks) at(beam.hit_x, beam.hit_y) = kHit;
    }
  }
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

// What a scan does to some cells of a row; returns whether it changed one that matters.
TRUNDLE_INLINE std::uint8_t add_cells(const EvidenceRule &rule, const std::uint8_t *__restrict drawn,
                                      std::uint8_t *__restrict evidence, std::uint8_t *__restrict changed,
                                      std::ptrdiff_t count) {
  const std::uint8_t hit = rule.hit, miss = rule.miss, neutral = rule.neutral, top = rule.top;
  std::uint8_t any = 0;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::uint8_t pixel = drawn[i], old = evidence[i];
    const std::uint8_t level = old & kLevel, marked = old & kMarked;
    const std::uint8_t above = level > neutral ? level : neutral;
    const auto raised = static_cast<std::uint8_t>(above + hit);
    const std::uint8_t up = raised < top ? raised : top;
    const std::uint8_t from = level == 0 ? neutral : level;
    const auto lowered = static_cast<std::uint8_t>(from > miss ? from - miss : 1);
    const std::uint8_t up_mark = up == top ? kMarked : marked, down_mark = lowered <= neutral ? std::uint8_t{0} : marked;
    const auto if_hit = static_cast<std::uint8_t>(up | up_mark), if_passed = static_cast<std::uint8_t>(lowered | down_mark);
    const auto unconfirmed = static_cast<std::uint8_t>(lowered > neutral ? lowered : neutral);
    const std::uint8_t if_behind = marked == 0 && level > neutral ? unconfirmed : old;
    const std::uint8_t behind_or_old = pixel == kBehind ? if_behind : old;
    const std::uint8_t passed_or_other = pixel == kPassed ? if_passed : behind_or_old;
    const std::uint8_t now = pixel == kHit ? if_hit : passed_or_other;
    // Seen is a level of 1 or more, surely free a level of 1: both change only where one of the levels is 0 or 1.
    const std::uint8_t now_level = now & kLevel;
    const std::uint8_t old_kind = level < 2 ? level : std::uint8_t{2}, new_kind = now_level < 2 ? now_level : std::uint8_t{2};
    const auto differs = static_cast<std::uint8_t>(((old ^ now) & kMarked) | (old_kind ^ new_kind));
    evidence[i] = now;
    changed[i] = differs;
    any |= differs;
  }
  return any;
}

// Whether a block has only cells that no beam passed, or that are surely free already: nothing changes there.
TRUNDLE_INLINE bool stays(const std::uint8_t *drawn, const std::uint8_t *evidence) {
  std::uint8_t any = 0;
  for (std::ptrdiff_t i = 0; i < kBlock; ++i) {
    const std::uint8_t passed = drawn[i] ^ kPassed, free = evidence[i] ^ 1;
    any |= drawn[i] == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(passed | free);
  }
  return any == 0;
}

// What a scan does to a row of cells, block by block: most lie between two beams, or in space that is known to be free.
TRUNDLE_INLINE bool add_row(const EvidenceRule &rule, const std::uint8_t *drawn, std::uint8_t *evidence,
                            std::uint8_t *changed, std::ptrdiff_t count) {
  std::uint8_t any = 0;
  std::ptrdiff_t i = 0;
  for (; i + kBlock <= count; i += kBlock) {
    if (stays(drawn + i, evidence + i)) {
      std::memset(changed + i, 0, kBlock);
    } else {
      any |= add_cells(rule, drawn + i, evidence + i, changed + i, kBlock);
    }
  }
  any |= add_cells(rule, drawn + i, evidence + i, changed + i, count - i);
  return any != 0;
}

void add_ends(CellBox &box, std::ptrdiff_t row, std::ptrdiff_t col, const std::uint8_t *changed, std::ptrdiff_t count) {
  const bool is_empty = box.row == box.row_end;  // what lies within the box makes it no larger
  const std::ptrdiff_t west = is_empty ? count : box.col - col, east = is_empty ? 0 : box.col_end - col;
  std::ptrdiff_t first = 0, end = count;
  while (first < west && changed[first] == 0) ++first;
  while (end > east && changed[end - 1] == 0) --end;
  box.add(row, col + first, col + end);
}

// Add a picture to the evidence of a grid; returns where that made a difference.
TRUNDLE_INLINE CellBox add_all_rows(const EvidenceRule &rule, const Picture &picture, std::uint8_t *evidence,
                                    std::ptrdiff_t rows, std::ptrdiff_t cols) {
  CellBox box;
  const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, picture.col), end = std::min(cols, picture.col + picture.cols);
  if (first >= end) return box;
  std::vector<std::uint8_t> changed(static_cast<std::size_t>(end - first));
  const std::ptrdiff_t row_end = std::min(rows, picture.row + picture.rows);
  for (std::ptrdiff_t r = std::max<std::ptrdiff_t>(0, picture.row); r < row_end; ++r) {
    const std::uint8_t *drawn = picture.pixels.data() + (r - picture.row) * picture.cols + (first - picture.col);
    if (add_row(rule, drawn, evidence + r * cols + first, changed.data(), end - first)) {
      add_ends(box, r, first, changed.data(), end - first);
    }
  }
  return box;
}

#ifdef TRUNDLE_AVX2
TRUNDLE_TARGET("avx2") CellBox add_picture_avx2(const EvidenceRule &rule, const Picture &picture, std::uint8_t *evidence,
                                                std::ptrdiff_t rows, std::ptrdiff_t cols) {
  return add_all_rows(rule, picture, evidence, rows, cols);
}
#endif

CellBox add_picture(const EvidenceRule &rule, const Picture &picture, std::uint8_t *evidence, std::ptrdiff_t rows,
                    std::ptrdiff_t cols) {
#ifdef TRUNDLE_AVX2
  if (__builtin_cpu_supports("avx2")) return add_picture_avx2(rule, picture, evidence, rows, cols);
#endif
  return add_all_rows(rule, picture, evidence, rows, cols);
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
  picture.draw(beams);
  for (const Beam &beam : beams) {
    const double x = std::floor(beam.hit_x), y = std::floor(beam.hit_y);
    if (!beam.marks || !(x >= 0.0 && y >= 0.0 && x < static_cast<double>(cols) && y < static_cast<double>(rows))) continue;
    const std::ptrdiff_t cell = static_cast<std::ptrdiff_t>(y) * cols + static_cast<std::ptrdiff_t>(x);
    if (timed) times.data()[cell] = time;
    if (evidence.data()[cell] & kMarked) continue;
    points.data()[2 * cell] = static_cast<std::uint8_t>((beam.hit_x - x) * kSubcells);
    points.data()[2 * cell + 1] = static_cast<std::uint8_t>((beam.hit_y - y) * kSubcells);
  }
  return add_picture(rule, picture, evidence.data(), rows, cols).as_rectangle();
}

}  // namespace trundle
