// Marking and clearing by one scan: first the cells that its beams pass and meet are drawn into a small picture of the
// scan, then the picture is added to the evidence. So each cell counts once per scan, and a cell that was hit is not
// cleared by another beam of the same scan.
//
// A beam is drawn as in Bresenham's algorithm: one cell for each step along its longer axis, the one that it passes at
// the middle of the step. The cell in which it ends is not passed.
#include <cmath>
#include <limits>

#include "layers/evidence.hpp"

namespace trundle {

namespace {

constexpr std::uint8_t kPassed = 1, kHit = 2;
constexpr double kMostReach = 1e5;                       // cells
constexpr double kMostPixels = 268435456.0;              // 16384 x 16384
constexpr double kOne = 4294967296.0;                    // of a number with 32 binary places
constexpr double kSubcells = 256.0;

struct Limits {
  double range_min, range_max, obstacle_min, obstacle_max, raytrace_min, raytrace_max;
};

// From (x0, y0) to (x1, y1), in cells of the grid. A hit lies at (hit_x, hit_y).
struct Beam {
  double x0, y0, x1, y1, hit_x, hit_y;
  bool clears, marks;
};

std::int64_t to_fixed(double value) { return static_cast<std::int64_t>(std::floor(value * kOne + 0.5)); }

bool is_inside(const double *corners, std::size_t count, double x, double y) {
  for (std::size_t i = 0; i < count; ++i) {
    const double *a = corners + 2 * i, *b = corners + 2 * ((i + 1) % count);
    if ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) < 0.0) return false;
  }
  return count > 0;
}

// The picture of a scan: cells [row, row + rows) x [col, col + cols) of the grid.
struct Picture {
  std::ptrdiff_t row, col, rows, cols;
  std::vector<std::uint8_t> pixels;

  // Cells that a beam passes on its way along x; for one along y with x and y swapped and the strides swapped.
  static void pass(std::uint8_t *pixels, double x0, double y0, double x1, double y1, std::ptrdiff_t along,
                   std::ptrdiff_t across) {
    const auto first = static_cast<std::ptrdiff_t>(std::floor(x0)), last = static_cast<std::ptrdiff_t>(std::floor(x1));
    const double slope = (y1 - y0) / (x1 - x0);
    const std::ptrdiff_t step = last > first ? 1 : -1;
    const std::int64_t rise = to_fixed(step * slope);
    std::int64_t y = to_fixed(y0 + (static_cast<double>(first) + 0.5 - x0) * slope);
    std::uint8_t *out = pixels + first * along;
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
      if (x1 != x0) pass(pixels.data(), x0, y0, x1, y1, 1, cols);
    } else {
      pass(pixels.data(), y0, x0, y1, x1, cols, 1);
    }
  }
};

// What a scan does to a row of cells; returns whether it changed a cell that matters.
bool add_row(const EvidenceRule &rule, const std::uint8_t *__restrict drawn, std::uint8_t *__restrict evidence,
             std::uint8_t *__restrict changed, std::ptrdiff_t count) {
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
    const std::uint8_t passed_or_old = pixel == kPassed ? if_passed : old;
    const std::uint8_t now = pixel == kHit ? if_hit : passed_or_old;
    // Seen is a level of 1 or more, surely free a level of 1: both change only where one of the levels is 0 or 1.
    const std::uint8_t now_level = now & kLevel;
    const std::uint8_t old_kind = level < 2 ? level : std::uint8_t{2}, new_kind = now_level < 2 ? now_level : std::uint8_t{2};
    const auto differs = static_cast<std::uint8_t>(((old ^ now) & kMarked) | (old_kind ^ new_kind));
    evidence[i] = now;
    changed[i] = differs;
    any |= differs;
  }
  return any != 0;
}

void add_ends(CellBox &box, std::ptrdiff_t row, std::ptrdiff_t col, const std::uint8_t *changed, std::ptrdiff_t count) {
  std::ptrdiff_t first = 0, end = count;
  while (changed[first] == 0) ++first;
  while (changed[end - 1] == 0) --end;
  box.add(row, col + first, col + end);
}

}  // namespace

Rectangle mark_scan(Evidence evidence, HitPoints points, HitTimes times, std::int64_t row, std::int64_t col,
                    double resolution, In<double, 2> poses, In<double, 1> angles, In<double, 1> ranges,
                    In<double, 2> outline, In<double, 1> limits, bool infinite_is_free, std::int64_t hit,
                    std::int64_t miss, double time) {
  check_shapes(evidence, points);
  check_place(row, col, resolution);
  const EvidenceRule rule(hit, miss);
  const auto rows = static_cast<std::ptrdiff_t>(evidence.shape(0)), cols = static_cast<std::ptrdiff_t>(evidence.shape(1));
  const bool timed = times.size() > 0;
  if (timed && (times.shape(0) != evidence.shape(0) || times.shape(1) != evidence.shape(1))) {
    throw std::invalid_argument("the times of the evidence need its shape");
  }
  const std::size_t count = angles.size();
  if (ranges.size() != count) throw std::invalid_argument("a scan needs as many ranges as angles");
  if (poses.shape(1) != 3 || (poses.shape(0) != 1 && poses.shape(0) != count)) {
    throw std::invalid_argument("a scan needs one pose of its sensor, or one for each beam: x, y, yaw");
  }
  if (outline.shape(1) != 2) throw std::invalid_argument("an outline has corners x, y");
  if (limits.size() != 6) throw std::invalid_argument("a scan has six limits");
  const double *l = limits.data();
  const Limits limit{l[0], l[1], l[2], l[3], l[4], l[5]};
  for (int i = 0; i < 6; ++i) {
    if (!(l[i] >= 0.0)) throw std::invalid_argument("the limits of a scan must be 0 or more");
  }
  const double reach = std::min(std::max(limit.raytrace_max, limit.obstacle_max), limit.range_max) / resolution;
  if (!(reach <= kMostReach)) {
    throw std::invalid_argument("the beams reach over too many cells");
  }
  const std::size_t stride = poses.shape(0) == 1 ? 0 : 3;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!(std::abs(poses.data()[i]) / resolution <= kFarthest)) throw std::invalid_argument("a sensor is too far away");
  }

  CellBox box;
  nb::gil_scoped_release release;
  std::vector<Beam> beams;
  beams.reserve(count);
  double low_x = kFarthest * 4.0, low_y = low_x, high_x = -low_x, high_y = -low_x;
  for (std::size_t i = 0; i < count; ++i) {
    const double range = ranges.data()[i], angle = angles.data()[i];
    const bool endless = range == std::numeric_limits<double>::infinity();
    if (!std::isfinite(angle) || std::abs(angle) > 1e6 || (endless ? !infinite_is_free : !(range >= limit.range_min && range <= limit.range_max))) {
      continue;
    }
    if (!endless && is_inside(outline.data(), outline.shape(0), range * std::cos(angle), range * std::sin(angle))) continue;
    const double *pose = poses.data() + i * stride;
    const double dx = std::cos(pose[2] + angle), dy = std::sin(pose[2] + angle);
    const double x = pose[0] / resolution - static_cast<double>(col), y = pose[1] / resolution - static_cast<double>(row);
    const double start = std::min(limit.raytrace_min / resolution, kMostReach);
    const double end = std::min(endless ? limit.range_max : range, limit.raytrace_max) / resolution;
    const bool marks = !endless && range >= limit.obstacle_min && range <= limit.obstacle_max;
    const double far = marks ? range / resolution : 0.0;
    const Beam beam{x + start * dx, y + start * dy, x + end * dx, y + end * dy, x + far * dx, y + far * dy,
                    end > start, marks};
    if (beam.clears) {
      low_x = std::min({low_x, beam.x0, beam.x1});
      low_y = std::min({low_y, beam.y0, beam.y1});
      high_x = std::max({high_x, beam.x0, beam.x1});
      high_y = std::max({high_y, beam.y0, beam.y1});
    }
    if (marks) {
      low_x = std::min(low_x, beam.hit_x);
      low_y = std::min(low_y, beam.hit_y);
      high_x = std::max(high_x, beam.hit_x);
      high_y = std::max(high_y, beam.hit_y);
    }
    if (beam.clears || marks) beams.push_back(beam);
  }
  // A row or column more on each side: the middle of a beam's first step may lie before its start.
  const bool is_beside = high_x < -1.0 || high_y < -1.0 || low_x > cols + 1.0 || low_y > rows + 1.0;
  if (beams.empty() || is_beside) return box.as_rectangle();
  Picture picture{static_cast<std::ptrdiff_t>(std::floor(low_y)) - 1, static_cast<std::ptrdiff_t>(std::floor(low_x)) - 1,
                  static_cast<std::ptrdiff_t>(std::floor(high_y) - std::floor(low_y)) + 3,
                  static_cast<std::ptrdiff_t>(std::floor(high_x) - std::floor(low_x)) + 3,
                  {}};
  if (static_cast<double>(picture.rows) * static_cast<double>(picture.cols) > kMostPixels) {
    throw std::invalid_argument("the beams reach over too many cells");
  }
  picture.pixels.resize(static_cast<std::size_t>(picture.rows * picture.cols));
  for (const Beam &beam : beams) {
    if (beam.clears) picture.draw(beam);
  }
  for (const Beam &beam : beams) {
    if (!beam.marks) continue;
    const double x = std::floor(beam.hit_x), y = std::floor(beam.hit_y);
    const auto r = static_cast<std::ptrdiff_t>(y), c = static_cast<std::ptrdiff_t>(x);
    picture.pixels[(r - picture.row) * picture.cols + (c - picture.col)] = kHit;
    if (r < 0 || c < 0 || r >= rows || c >= cols) continue;
    const std::ptrdiff_t cell = r * cols + c;
    if (timed) times.data()[cell] = time;
    if (evidence.data()[cell] & kMarked) continue;
    points.data()[2 * cell] = static_cast<std::uint8_t>((beam.hit_x - x) * kSubcells);
    points.data()[2 * cell + 1] = static_cast<std::uint8_t>((beam.hit_y - y) * kSubcells);
  }

  const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, picture.col), end = std::min(cols, picture.col + picture.cols);
  if (first >= end) return box.as_rectangle();
  std::vector<std::uint8_t> changed(static_cast<std::size_t>(end - first));
  for (std::ptrdiff_t r = std::max<std::ptrdiff_t>(0, picture.row); r < std::min(rows, picture.row + picture.rows); ++r) {
    const std::uint8_t *drawn = picture.pixels.data() + (r - picture.row) * picture.cols + (first - picture.col);
    if (add_row(rule, drawn, evidence.data() + r * cols + first, changed.data(), end - first)) {
      add_ends(box, r, first, changed.data(), end - first);
    }
  }
  return box.as_rectangle();
}

Rectangle unmark_before(Evidence evidence, HitTimes times, double before, std::int64_t hit, std::int64_t miss) {
  if (times.shape(0) != evidence.shape(0) || times.shape(1) != evidence.shape(1)) {
    throw std::invalid_argument("the times of the evidence need its shape");
  }
  const EvidenceRule rule(hit, miss);
  const auto rows = static_cast<std::ptrdiff_t>(evidence.shape(0)), cols = static_cast<std::ptrdiff_t>(evidence.shape(1));
  CellBox box;
  nb::gil_scoped_release release;
  for (std::ptrdiff_t r = 0; r < rows; ++r) {
    std::uint8_t *cells = evidence.data() + r * cols;
    std::uint8_t any = 0;
    for (std::ptrdiff_t c = 0; c < cols; ++c) any |= cells[c];
    if (!(any & kMarked)) continue;
    for (std::ptrdiff_t c = 0; c < cols; ++c) {
      if (!(cells[c] & kMarked) || !(times.data()[r * cols + c] < before)) continue;
      cells[c] = rule.neutral;
      box.add(r, c, c + 1);
    }
  }
  return box.as_rectangle();
}

Rectangle unmark_within(Evidence evidence, HitPoints points, std::int64_t row, std::int64_t col, double resolution,
                        In<double, 2> outline, std::int64_t hit, std::int64_t miss) {
  check_shapes(evidence, points);
  check_place(row, col, resolution);
  const EvidenceRule rule(hit, miss);
  if (outline.shape(1) != 2 || outline.shape(0) < 3) throw std::invalid_argument("an outline needs 3 corners x, y");
  const auto rows = static_cast<std::ptrdiff_t>(evidence.shape(0)), cols = static_cast<std::ptrdiff_t>(evidence.shape(1));
  CellBox box;
  nb::gil_scoped_release release;
  std::vector<double> corners(2 * outline.shape(0));
  double low[2] = {kFarthest * 4.0, kFarthest * 4.0}, high[2] = {-low[0], -low[1]};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = outline.data()[i] / resolution - static_cast<double>(i % 2 == 0 ? col : row);
    if (!(std::abs(corners[i]) <= kFarthest * 2.0)) throw std::invalid_argument("an outline is too far away");
    low[i % 2] = std::min(low[i % 2], corners[i]);
    high[i % 2] = std::max(high[i % 2], corners[i]);
  }
  const auto begin = [](double value) { return std::max<std::ptrdiff_t>(0, static_cast<std::ptrdiff_t>(std::floor(value))); };
  const std::ptrdiff_t row_end = std::min(rows, static_cast<std::ptrdiff_t>(std::floor(high[1])) + 1);
  const std::ptrdiff_t col_end = std::min(cols, static_cast<std::ptrdiff_t>(std::floor(high[0])) + 1);
  for (std::ptrdiff_t r = begin(low[1]); r < row_end; ++r) {
    for (std::ptrdiff_t c = begin(low[0]); c < col_end; ++c) {
      std::uint8_t &cell = evidence.data()[r * cols + c];
      const std::uint8_t *point = points.data() + 2 * (r * cols + c);
      const bool marked = (cell & kMarked) != 0;
      const double x = static_cast<double>(c) + (marked ? (point[0] + 0.5) / kSubcells : 0.5);
      const double y = static_cast<double>(r) + (marked ? (point[1] + 0.5) / kSubcells : 0.5);
      if (!(marked || cell == 0) || !is_inside(corners.data(), corners.size() / 2, x, y)) continue;
      cell = rule.neutral;
      box.add(r, c, c + 1);
    }
  }
  return box.as_rectangle();
}

}  // namespace trundle
