// Marking and clearing by one scan: first the cells that its beams pass and meet are drawn into a small picture of the
// scan, then the picture is added to the evidence. So each cell counts once per scan, and a cell that was hit is not
// cleared by another beam of the same scan.
//
// Near the sensor many beams pass each cell. A beam between two others that are a cell apart at most passes no cell but
// theirs, and is drawn only from where they part or end: every other beam, then every other one of those that are left.
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

// Cells of a picture that a beam passes: from the one at `first`, step by step, each `y >> 32` rows or columns across.
struct Line {
  std::ptrdiff_t first = 0, step = 0, across = 0, count = 0;
  std::int64_t y = 0, rise = 0;
};

// The first steps of a line on which it passes no cell but those of the lines beside it. What they differ by is linear.
std::ptrdiff_t shared_steps(const Line &left, const Line &line, const Line &right) {
  constexpr std::int64_t kCell = std::int64_t{1} << 32;
  const auto is_alike = [&](const Line &one) { return one.first == line.first && one.step == line.step && one.across == line.across; };
  if (!is_alike(left) || !is_alike(right)) return 0;
  const std::int64_t sign = right.rise < left.rise ? -1 : 1;
  const std::int64_t past_left = sign * (line.y - left.y), past_line = sign * (right.y - line.y);
  const std::int64_t left_grows = sign * (line.rise - left.rise), line_grows = sign * (right.rise - line.rise);
  const std::int64_t wide = past_left + past_line, grows = left_grows + line_grows;
  std::ptrdiff_t count = std::min({left.count, line.count, right.count});
  if (grows > 0) count = std::min(count, static_cast<std::ptrdiff_t>(static_cast<double>(kCell - wide) / static_cast<double>(grows)));
  if (count < 1 || past_left < 0 || past_line < 0 || wide + (count - 1) * grows > kCell) return 0;
  return past_left + (count - 1) * left_grows >= 0 && past_line + (count - 1) * line_grows >= 0 ? count : 0;
}

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

  // The cells that a beam passes on its way along x; for one along y with x and y swapped.
  template <bool kSwapped>
  Line line_along(double x0, double y0, double x1, double y1) const {
    const std::ptrdiff_t along = kSwapped ? cols : 1, across = kSwapped ? 1 : cols;
    const auto first = static_cast<std::ptrdiff_t>(std::floor(x0)), last = static_cast<std::ptrdiff_t>(std::floor(x1));
    const double slope = (y1 - y0) / (x1 - x0);
    const std::ptrdiff_t step = last > first ? 1 : -1;
    return {first * along, step * along, across, step * (last - first),
            to_fixed(y0 + (static_cast<double>(first) + 0.5 - x0) * slope), to_fixed(step * slope)};
  }

  Line line_of(const Beam &beam) const {
    const double x0 = beam.x0 - static_cast<double>(col), y0 = beam.y0 - static_cast<double>(row);
    const double x1 = beam.x1 - static_cast<double>(col), y1 = beam.y1 - static_cast<double>(row);
    if (!(std::abs(x1 - x0) >= std::abs(y1 - y0))) return line_along<true>(y0, x0, y1, x1);
    return x1 != x0 ? line_along<false>(x0, y0, x1, y1) : Line{};
  }

  void draw(const Line &line, std::ptrdiff_t from) {
    const std::ptrdiff_t step = line.step, across = line.across;
    const std::int64_t rise = line.rise;
    std::int64_t y = line.y + from * rise;
    std::uint8_t *out = pixels.data() + line.first + from * step;
    for (std::ptrdiff_t n = line.count - from; n > 0; --n) {
      out[(y >> 32) * across] = kPassed;
      y += rise;
      out += step;
    }
  }

  void draw(const std::vector<Beam> &beams) {
    std::vector<Line> lines;
    lines.reserve(beams.size());
    for (const Beam &beam : beams) {
      if (beam.marks) at(beam.hit_x + beam.dx, beam.hit_y + beam.dy) = kBehind;
      if (beam.clears) lines.push_back(line_of(beam));
    }
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::size_t apart = i & (~i + 1);  // of the next beams that are drawn whatever this one is
      const bool is_between = i > 0 && i + apart < lines.size();
      draw(lines[i], is_between ? shared_steps(lines[i - apart], lines[i], lines[i + apart]) : 0);
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

// Whether a block has only cells that no beam passed, or that are surely free already: nothing is cleared there.
TRUNDLE_INLINE bool stays(const std::uint8_t *drawn, const std::uint8_t *evidence) {
  std::uint8_t any = 0;
  for (std::ptrdiff_t i = 0; i < kBlock; ++i) {
    const std::uint8_t not_free = evidence[i] ^ 1, passed = drawn[i] == kPassed ? 255 : 0;
    any |= static_cast<std::uint8_t>(passed & not_free);
  }
  return any == 0;
}

// What the beams that pass do to a row of cells, block by block: most lie between two beams, or in space that is known to be free.
TRUNDLE_INLINE bool clear_row(const EvidenceRule &rule, const std::uint8_t *drawn, std::uint8_t *evidence,
                            std::uint8_t *changed, std::ptrdiff_t count) {
  std::uint8_t any = 0;
  std::ptrdiff_t i = 0;
  for (; i + kBlock <= count; i += kBlock) {
    if (stays(drawn + i, evidence + i)) {
      std::memset(changed + i, 0, kBlock);
    } else {
      any |= clear_cells(rule, drawn + i, evidence + i, changed + i, kBlock);
    }
  }
  any |= clear_cells(rule, drawn + i, evidence + i, changed + i, count - i);
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

// Add what a picture shows as passed to the evidence of a grid; returns where that made a difference.
TRUNDLE_INLINE CellBox clear_all_rows(const EvidenceRule &rule, const Picture &picture, std::uint8_t *evidence,
                                    std::ptrdiff_t rows, std::ptrdiff_t cols) {
  CellBox box;
  const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, picture.col), end = std::min(cols, picture.col + picture.cols);
  if (first >= end) return box;
  std::vector<std::uint8_t> changed(static_cast<std::size_t>(end - first));
  const std::ptrdiff_t row_end = std::min(rows, picture.row + picture.rows);
  for (std::ptrdiff_t r = std::max<std::ptrdiff_t>(0, picture.row); r < row_end; ++r) {
    const std::uint8_t *drawn = picture.pixels.data() + (r - picture.row) * picture.cols + (first - picture.col);
    if (clear_row(rule, drawn, evidence + r * cols + first, changed.data(), end - first)) {
      add_ends(box, r, first, changed.data(), end - first);
    }
  }
  return box;
}

#ifdef TRUNDLE_AVX2
TRUNDLE_TARGET("avx2") CellBox clear_passed_avx2(const EvidenceRule &rule, const Picture &picture, std::uint8_t *evidence,
                                                std::ptrdiff_t rows, std::ptrdiff_t cols) {
  return clear_all_rows(rule, picture, evidence, rows, cols);
}
#endif

CellBox clear_passed(const EvidenceRule &rule, const Picture &picture, std::uint8_t *evidence, std::ptrdiff_t rows,
                    std::ptrdiff_t cols) {
#ifdef TRUNDLE_AVX2
  if (__builtin_cpu_supports("avx2")) return clear_passed_avx2(rule, picture, evidence, rows, cols);
#endif
  return clear_all_rows(rule, picture, evidence, rows, cols);
}

// Add what a picture shows at a point, if that is `kind`, and take it off the picture: each cell counts once.
void add_once(std::uint8_t kind, const EvidenceRule &rule, Picture &picture, double x, double y, std::uint8_t *evidence,
              std::ptrdiff_t rows, std::ptrdiff_t cols, CellBox &box) {
  std::uint8_t &pixel = picture.at(x, y);
  if (pixel != kind) return;
  pixel = 0;
  const auto r = static_cast<std::ptrdiff_t>(std::floor(y)), c = static_cast<std::ptrdiff_t>(std::floor(x));
  if (r < 0 || c < 0 || r >= rows || c >= cols) return;
  std::uint8_t &cell = evidence[r * cols + c];
  const std::uint8_t old = cell;
  cell = kind == kHit ? raised(rule, old) : unconfirmed(rule, old);
  if (matters(old, cell)) box.add(r, c, c + 1);
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
  CellBox box = clear_passed(rule, picture, evidence.data(), rows, cols);
  for (const Beam &beam : beams) {
    if (!beam.marks) continue;
    add_once(kHit, rule, picture, beam.hit_x, beam.hit_y, evidence.data(), rows, cols, box);
    add_once(kBehind, rule, picture, beam.hit_x + beam.dx, beam.hit_y + beam.dy, evidence.data(), rows, cols, box);
  }
  return box.as_rectangle();
}

}  // namespace trundle
