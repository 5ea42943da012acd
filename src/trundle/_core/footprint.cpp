// A convex footprint at many poses against the blocked cells of a costmap: does it touch, and how far away are they.
//
// Everything is in grid units: cell (row, col) is the square [col, col + 1] × [row, row + 1].
#include "arrays.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace trundle {

namespace {

constexpr std::uint8_t kLethal = 254;
constexpr double kTouch = 1e-9;  // metres; contact shallower than this is none
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Point {
  double x, y;
};

struct Costs {
  const std::uint8_t *data;
  std::ptrdiff_t rows, cols;
  bool blocked(std::ptrdiff_t r, std::ptrdiff_t c) const { return data[r * cols + c] >= kLethal; }
};

// Where the grid lies in the map frame.
struct Frame {
  double x, y, yaw, cos, sin, resolution;
};

struct Box {
  double min_x, min_y, max_x, max_y;
};

// The outline at a pose of the map frame, in grid units.
void place(const Frame &frame, const double *outline, std::size_t corners, const double *pose, std::vector<Point> &out) {
  const double dx = pose[0] - frame.x, dy = pose[1] - frame.y;
  const double px = frame.cos * dx + frame.sin * dy, py = frame.cos * dy - frame.sin * dx;
  const double cos = std::cos(pose[2] - frame.yaw), sin = std::sin(pose[2] - frame.yaw);
  out.resize(corners);
  for (std::size_t i = 0; i < corners; ++i) {
    const double x = outline[2 * i], y = outline[2 * i + 1];
    out[i] = {(px + cos * x - sin * y) / frame.resolution, (py + sin * x + cos * y) / frame.resolution};
  }
}

Box bounds(const std::vector<Point> &polygon) {
  Box box{kInfinity, kInfinity, -kInfinity, -kInfinity};
  for (const Point &p : polygon) {
    box.min_x = std::min(box.min_x, p.x);
    box.max_x = std::max(box.max_x, p.x);
    box.min_y = std::min(box.min_y, p.y);
    box.max_y = std::max(box.max_y, p.y);
  }
  return box;
}

bool is_inside(const Costs &costs, const Box &box, double touch) {
  return box.min_x >= -touch && box.min_y >= -touch && box.max_x <= static_cast<double>(costs.cols) + touch &&
         box.max_y <= static_cast<double>(costs.rows) + touch;
}

// From where to where a polygon reaches in each row of cells.
struct Spans {
  std::vector<double> left, right;

  void clear(std::size_t rows) {
    left.assign(rows, kInfinity);
    right.assign(rows, -kInfinity);
  }

  void add(std::ptrdiff_t row, double x, double other) {
    left[row] = std::min(left[row], std::min(x, other));
    right[row] = std::max(right[row], std::max(x, other));
  }
};

// The part of a convex polygon in the strip of one row of cells is convex, so it meets exactly the cells that its
// x extent there meets.
bool touches_cells(const Costs &costs, const std::vector<Point> &polygon, const Box &box, double touch, Spans &spans) {
  const auto first_row = std::max<std::ptrdiff_t>(0, static_cast<std::ptrdiff_t>(std::floor(box.min_y + touch)));
  const auto last_row =
      std::min<std::ptrdiff_t>(costs.rows, static_cast<std::ptrdiff_t>(std::ceil(box.max_y - touch))) - 1;
  if (last_row < first_row) return false;
  spans.clear(static_cast<std::size_t>(last_row - first_row + 1));
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    Point a = polygon[j], b = polygon[i];
    if (a.y > b.y) std::swap(a, b);
    const double slope = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0;
    const auto first = std::max(first_row, static_cast<std::ptrdiff_t>(std::floor(a.y)));
    const auto last = std::min(last_row, static_cast<std::ptrdiff_t>(std::floor(b.y)));
    for (std::ptrdiff_t row = first; row <= last; ++row) {
      const double low = static_cast<double>(row), high = low + 1.0;
      spans.add(row - first_row, a.y < low ? a.x + (low - a.y) * slope : a.x,
                b.y > high ? a.x + (high - a.y) * slope : b.x);
    }
  }
  for (std::ptrdiff_t row = first_row; row <= last_row; ++row) {
    const double left = spans.left[row - first_row], right = spans.right[row - first_row];
    const auto first = std::max<std::ptrdiff_t>(0, static_cast<std::ptrdiff_t>(std::floor(left + touch)));
    const auto last = std::min<std::ptrdiff_t>(costs.cols, static_cast<std::ptrdiff_t>(std::ceil(right - touch))) - 1;
    const std::uint8_t *cells = costs.data + row * costs.cols;
    std::uint8_t highest = 0;
    for (std::ptrdiff_t col = first; col <= last; ++col) highest = std::max(highest, cells[col]);
    if (highest >= kLethal) return true;
  }
  return false;
}

double square(double value) { return value * value; }

// Squared distance from a point to a segment.
double to_segment(double x, double y, const Point &a, const Point &b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double t = std::clamp(((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return square(a.x + t * dx - x) + square(a.y + t * dy - y);
}

// Squared distance between a convex polygon and a cell that do not overlap: it is taken at a corner of one of them.
double to_cell(const std::vector<Point> &polygon, double col, double row) {
  double best = kInfinity;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point &p = polygon[i];
    const double dx = std::max({col - p.x, p.x - (col + 1.0), 0.0});
    const double dy = std::max({row - p.y, p.y - (row + 1.0), 0.0});
    best = std::min(best, dx * dx + dy * dy);
    for (int corner = 0; corner < 4; ++corner) {
      best = std::min(best, to_segment(col + (corner & 1), row + (corner >> 1), polygon[j], p));
    }
  }
  return best;
}

// The first blocked column from `col` up to `last` of a row, or more than `last`; it looks at eight cells at a time.
std::ptrdiff_t next_blocked(const std::uint8_t *cells, std::ptrdiff_t col, std::ptrdiff_t last) {
  constexpr std::uint64_t kOnes = 0x0101010101010101, kTops = 0x8080808080808080;
  for (; col + 7 <= last; col += 8) {
    std::uint64_t eight;
    std::memcpy(&eight, cells + col, 8);
    // 254 and 255 are the bytes that are all ones but for the last bit; those turn to 0 here.
    const std::uint64_t zeros = ~eight & ~kOnes;
    if (((zeros - kOnes) & ~zeros & kTops) != 0) break;
  }
  while (col <= last && cells[col] < kLethal) ++col;
  return col;
}

// Distance to the nearest blocked cell or to the map's edge, at most `cap`, of a polygon that touches nothing.
double nearest(const Costs &costs, const std::vector<Point> &polygon, const Box &box, double cap) {
  double best = std::min({cap, box.min_x, box.min_y, static_cast<double>(costs.cols) - box.max_x,
                          static_cast<double>(costs.rows) - box.max_y});
  best = std::max(best, 0.0);
  double searched = 0.0;
  for (double window = std::min(best, 4.0); searched < best; window = std::min(best, 2.0 * window)) {
    const auto first_row = static_cast<std::ptrdiff_t>(std::floor(std::max(0.0, box.min_y - window)));
    const auto first_col = static_cast<std::ptrdiff_t>(std::floor(std::max(0.0, box.min_x - window)));
    const auto last_row = std::min(costs.rows, static_cast<std::ptrdiff_t>(std::ceil(box.max_y + window))) - 1;
    const auto last_col = std::min(costs.cols, static_cast<std::ptrdiff_t>(std::ceil(box.max_x + window))) - 1;
    double best_squared = best * best;
    for (std::ptrdiff_t r = first_row; r <= last_row; ++r) {
      const double dy = std::max({static_cast<double>(r) - box.max_y, box.min_y - static_cast<double>(r + 1), 0.0});
      if (dy * dy >= best_squared) continue;
      const std::uint8_t *cells = costs.data + r * costs.cols;
      for (auto c = next_blocked(cells, first_col, last_col); c <= last_col; c = next_blocked(cells, c + 1, last_col)) {
        const double dx = std::max({static_cast<double>(c) - box.max_x, box.min_x - static_cast<double>(c + 1), 0.0});
        if (dx * dx + dy * dy >= best_squared) continue;
        // A cell with blocked cells on all four sides is behind one of them.
        if (r > 0 && r + 1 < costs.rows && c > 0 && c + 1 < costs.cols && costs.blocked(r - 1, c) &&
            costs.blocked(r + 1, c) && costs.blocked(r, c - 1) && costs.blocked(r, c + 1)) {
          continue;
        }
        best_squared = std::min(best_squared, to_cell(polygon, static_cast<double>(c), static_cast<double>(r)));
      }
    }
    best = std::min(best, std::sqrt(best_squared));
    searched = window;
  }
  return best;
}

// Whether the footprint at a pose touches something; it is placed in `polygon` and `box` for that.
bool collides(const Costs &costs, const Frame &frame, const In<double, 2> &outline, const double *pose,
              std::vector<Point> &polygon, Box &box, Spans &spans) {
  if (!(std::isfinite(pose[0]) && std::isfinite(pose[1]) && std::isfinite(pose[2]))) return true;
  place(frame, outline.data(), outline.shape(0), pose, polygon);
  box = bounds(polygon);
  const double touch = kTouch / frame.resolution;
  return !is_inside(costs, box, touch) || touches_cells(costs, polygon, box, touch, spans);
}

Frame make_frame(double resolution, double x, double y, double yaw) {
  return {x, y, yaw, std::cos(yaw), std::sin(yaw), resolution};
}

void check_shapes(const In<double, 2> &outline, const In<double, 2> &poses) {
  if (outline.shape(1) != 2 || outline.shape(0) < 3) throw nb::value_error("the outline needs shape (N, 2) with N >= 3");
  if (poses.shape(1) != 3) throw nb::value_error("the poses need shape (N, 3)");
}

}  // namespace

static nb::ndarray<nb::numpy, bool> footprint_collides(In<std::uint8_t, 2> cells, double resolution, double origin_x,
                                                       double origin_y, double origin_yaw, In<double, 2> outline,
                                                       In<double, 2> poses) {
  check_shapes(outline, poses);
  const std::size_t count = poses.shape(0);
  auto hits = std::make_unique<bool[]>(count);
  {
    nb::gil_scoped_release release;
    const Costs costs{cells.data(), static_cast<std::ptrdiff_t>(cells.shape(0)),
                      static_cast<std::ptrdiff_t>(cells.shape(1))};
    const Frame frame = make_frame(resolution, origin_x, origin_y, origin_yaw);
    std::vector<Point> polygon;
    Box box{};
    Spans spans;
    for (std::size_t i = 0; i < count; ++i) {
      hits[i] = collides(costs, frame, outline, poses.data() + 3 * i, polygon, box, spans);
    }
  }
  bool *data = hits.release();
  nb::capsule owner(data, [](void *p) noexcept { delete[] static_cast<bool *>(p); });
  return nb::ndarray<nb::numpy, bool>(data, {count}, owner);
}

static nb::ndarray<nb::numpy, double> footprint_clearance(In<std::uint8_t, 2> cells, double resolution,
                                                          double origin_x, double origin_y, double origin_yaw,
                                                          In<double, 2> outline, In<double, 2> poses, double cap) {
  check_shapes(outline, poses);
  const std::size_t count = poses.shape(0);
  std::vector<double> distances(count);
  {
    nb::gil_scoped_release release;
    const Costs costs{cells.data(), static_cast<std::ptrdiff_t>(cells.shape(0)),
                      static_cast<std::ptrdiff_t>(cells.shape(1))};
    const Frame frame = make_frame(resolution, origin_x, origin_y, origin_yaw);
    std::vector<Point> polygon;
    Box box{};
    Spans spans;
    for (std::size_t i = 0; i < count; ++i) {
      const bool hit = collides(costs, frame, outline, poses.data() + 3 * i, polygon, box, spans);
      distances[i] = hit ? 0.0 : std::min(cap, resolution * nearest(costs, polygon, box, cap / resolution));
    }
  }
  return to_numpy(std::move(distances), {count});
}

}  // namespace trundle

void bind_footprint(nanobind::module_ &m) {
  namespace nb = nanobind;
  m.def("footprint_collides", &trundle::footprint_collides, nb::arg("costs").noconvert(), nb::arg("resolution"),
        nb::arg("origin_x"), nb::arg("origin_y"), nb::arg("origin_yaw"), nb::arg("outline").noconvert(),
        nb::arg("poses").noconvert());
  m.def("footprint_clearance", &trundle::footprint_clearance, nb::arg("costs").noconvert(), nb::arg("resolution"),
        nb::arg("origin_x"), nb::arg("origin_y"), nb::arg("origin_yaw"), nb::arg("outline").noconvert(),
        nb::arg("poses").noconvert(), nb::arg("cap"));
}
