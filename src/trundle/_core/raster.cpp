// Conservative rasters of convex shapes: a cell is marked when a shape reaches into it by more than `depth` in x and
// in y. A shape is cut to a height band first, so that it counts by what lies in the band, seen from above.
//
// For each row of cells the shape is clipped to the row's strip; the clipped shape is convex, so it touches exactly the
// columns between its smallest and largest x. This is exact: no cell is missed and none is added.
#include "arrays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace trundle {

using Cells = nb::ndarray<std::int8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

namespace {

constexpr std::int8_t kOccupied = 100;
// An edge that rises by less [m] is level: its slope would overflow.
constexpr double kLevel = 1e-12;

struct Point2 {
  double x, y;
};

struct Point3 {
  double x, y, z;
};

// A whole number in [-1, limit] from any double, NaN and infinity included.
std::int64_t to_index(double value, std::int64_t limit) {
  if (!(value > -1.0)) return -1;
  return value > static_cast<double>(limit) ? limit : static_cast<std::int64_t>(value);
}

// Marks spans of a grid whose cell (0, 0) has its lower-left corner at (0, 0).
class Raster {
 public:
  Raster(std::int8_t *cells, std::size_t rows, std::size_t cols, double resolution, double depth, bool centre)
      : cells_(cells), rows_(static_cast<std::int64_t>(rows)), cols_(static_cast<std::int64_t>(cols)),
        resolution_(resolution), depth_(depth), centre_(centre) {}

  // The corners of a convex polygon in order; one point or a segment will do.
  void add_polygon(const Point2 *corners, std::size_t count) {
    if (count == 0) return;
    double low = corners[0].y, high = corners[0].y;
    for (std::size_t i = 1; i < count; ++i) {
      low = std::min(low, corners[i].y);
      high = std::max(high, corners[i].y);
    }
    const std::int64_t first = first_index(low, rows_), last = last_index(high, rows_);
    if (first > last) return;
    const std::size_t spanned = static_cast<std::size_t>(last - first + 1);
    left_.assign(spanned, std::numeric_limits<double>::infinity());
    right_.assign(spanned, -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < count; ++i) add_edge(corners[i], corners[i + 1 == count ? 0 : i + 1], first, last);
    for (std::size_t i = 0; i < spanned; ++i) mark(first + static_cast<std::int64_t>(i), left_[i], right_[i]);
  }

  void add_disc(Point2 middle, double radius) {
    const std::int64_t first = first_index(middle.y - radius, rows_), last = last_index(middle.y + radius, rows_);
    const double reach = centre_ ? radius - depth_ : radius;
    for (std::int64_t row = first; row <= last; ++row) {
      const double off = std::max({strip_low(row) - middle.y, middle.y - strip_high(row), 0.0});
      if (!(off < reach)) continue;
      const double half = std::sqrt((reach - off) * (reach + off)) + (centre_ ? depth_ : 0.0);
      mark(row, middle.x - half, middle.x + half);
    }
  }

 private:
  double strip_low(std::int64_t row) const {
    return centre_ ? (static_cast<double>(row) + 0.5) * resolution_ : static_cast<double>(row) * resolution_ + depth_;
  }
  double strip_high(std::int64_t row) const {
    return centre_ ? strip_low(row) : static_cast<double>(row + 1) * resolution_ - depth_;
  }
  // First and last row or column that [low, high] reaches into, kept inside the grid.
  std::int64_t first_index(double low, std::int64_t limit) const {
    const double at = (low + depth_) / resolution_;
    return std::max<std::int64_t>(0, to_index(centre_ ? std::floor(at - 0.5) + 1.0 : std::floor(at), limit));
  }
  std::int64_t last_index(double high, std::int64_t limit) const {
    const double at = (high - depth_) / resolution_;
    return std::min(limit - 1, to_index(std::ceil(centre_ ? at - 0.5 : at) - 1.0, limit));
  }

  void add_edge(Point2 a, Point2 b, std::int64_t first, std::int64_t last) {
    if (a.y > b.y) std::swap(a, b);
    const double rise = b.y - a.y;
    const bool level = rise < kLevel;
    const double slope = level ? 0.0 : (b.x - a.x) / rise;
    // One row more on each side than needed, so that rounding loses none; the clipping below decides.
    const std::int64_t from = std::max(first, to_index(std::floor(a.y / resolution_) - 1.0, rows_));
    const std::int64_t to = std::min(last, to_index(std::floor(b.y / resolution_) + 1.0, rows_));
    for (std::int64_t row = from; row <= to; ++row) {
      const double low = std::max(a.y, strip_low(row)), high = std::min(b.y, strip_high(row));
      if (low > high) continue;
      const double x_low = a.x + (low - a.y) * slope;
      const double x_high = level ? b.x : a.x + (high - a.y) * slope;
      double &left = left_[static_cast<std::size_t>(row - first)], &right = right_[static_cast<std::size_t>(row - first)];
      left = std::min({left, x_low, x_high});
      right = std::max({right, x_low, x_high});
    }
  }

  void mark(std::int64_t row, double left, double right) {
    if (!(left <= right)) return;
    const std::int64_t first = first_index(left, cols_), last = last_index(right, cols_);
    if (first > last) return;
    std::memset(cells_ + row * cols_ + first, kOccupied, static_cast<std::size_t>(last - first + 1));
  }

  std::int8_t *cells_;
  std::int64_t rows_, cols_;
  double resolution_, depth_;
  bool centre_;
  std::vector<double> left_, right_;
};

}  // namespace

// Convex hull (Andrew's monotone chain); sorts `points`, counter-clockwise result in `hull`.
static void convex_hull(std::vector<Point2> &points, std::vector<Point2> &hull) {
  std::sort(points.begin(), points.end(),
            [](const Point2 &a, const Point2 &b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  hull.clear();
  const auto turns_left = [](const Point2 &o, const Point2 &a, const Point2 &b) {
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x) > 0.0;
  };
  const auto extend = [&](const Point2 &point, std::size_t floor) {
    while (hull.size() >= floor + 2 && !turns_left(hull[hull.size() - 2], hull.back(), point)) hull.pop_back();
    hull.push_back(point);
  };
  for (const Point2 &point : points) extend(point, 0);
  const std::size_t floor = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) extend(points[i], floor);
  if (hull.size() > 1) hull.pop_back();
}

static Point2 cut(const Point3 &a, const Point3 &b, double height) {
  const double share = (height - a.z) / (b.z - a.z);
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

// Corners of a box or another hexahedron: bit 0 of the index is its x side, bit 1 its y side, bit 2 its z side.
static void slice_hexahedron(const double *xyz, double low, double high, std::vector<Point2> &points) {
  std::array<Point3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) corners[i] = {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]};
  points.clear();
  for (std::size_t i = 0; i < 8; ++i) {
    const Point3 &a = corners[i];
    if (a.z >= low && a.z <= high) points.push_back({a.x, a.y});
    for (std::size_t bit = 1; bit < 8; bit <<= 1) {
      if (i & bit) continue;
      const Point3 &b = corners[i | bit];
      for (const double height : {low, high})
        if ((a.z < height) != (b.z < height)) points.push_back(cut(a, b, height));
    }
  }
}

// The part of a polygon in space above (or below) a height, in order.
static void clip_height(const std::vector<Point3> &in, double height, double sign, std::vector<Point3> &out) {
  out.clear();
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Point3 &a = in[i], &b = in[i + 1 == in.size() ? 0 : i + 1];
    const bool keep_a = sign * (a.z - height) >= 0.0, keep_b = sign * (b.z - height) >= 0.0;
    if (keep_a) out.push_back(a);
    if (keep_a != keep_b) {
      const Point2 at = cut(a, b, height);
      out.push_back({at.x, at.y, height});
    }
  }
}

static Raster make_raster(Cells &cells, double resolution, double depth, bool centre) {
  if (!(resolution > 0.0 && 2.0 * depth < resolution)) throw std::invalid_argument("a raster needs a resolution above twice the depth");
  return Raster(cells.data(), cells.shape(0), cells.shape(1), resolution, depth, centre);
}

static void raster_hexahedra(Cells cells, In<double, 3> corners, double low, double high, double resolution, double depth,
                             bool centre) {
  if (corners.shape(1) != 8 || corners.shape(2) != 3) throw std::invalid_argument("corners need shape (N, 8, 3)");
  Raster raster = make_raster(cells, resolution, depth, centre);
  nb::gil_scoped_release released;
  std::vector<Point2> points, hull;
  for (std::size_t i = 0; i < corners.shape(0); ++i) {
    slice_hexahedron(corners.data() + 24 * i, low, high, points);
    if (points.empty()) continue;
    convex_hull(points, hull);
    raster.add_polygon(hull.data(), hull.size());
  }
}

static void raster_hulls(Cells cells, In<double, 2> points, In<std::int64_t, 1> starts, double resolution, double depth,
                         bool centre) {
  const auto total = static_cast<std::int64_t>(points.shape(0));
  if (points.shape(1) != 2) throw std::invalid_argument("points need shape (N, 2)");
  for (std::size_t i = 0; i < starts.shape(0); ++i)
    if (starts.data()[i] < (i ? starts.data()[i - 1] : 0) || starts.data()[i] > total)
      throw std::invalid_argument("starts must rise from 0 to the number of points");
  Raster raster = make_raster(cells, resolution, depth, centre);
  nb::gil_scoped_release released;
  std::vector<Point2> group, hull;
  for (std::size_t i = 0; i + 1 < starts.shape(0); ++i) {
    group.clear();
    for (std::int64_t j = starts.data()[i]; j < starts.data()[i + 1]; ++j)
      group.push_back({points.data()[2 * j], points.data()[2 * j + 1]});
    if (group.empty()) continue;
    convex_hull(group, hull);
    raster.add_polygon(hull.data(), hull.size());
  }
}

static void raster_discs(Cells cells, In<double, 2> discs, double resolution, double depth, bool centre) {
  if (discs.shape(1) != 3) throw std::invalid_argument("discs need shape (N, 3): x, y, radius");
  Raster raster = make_raster(cells, resolution, depth, centre);
  nb::gil_scoped_release released;
  for (std::size_t i = 0; i < discs.shape(0); ++i) {
    const double *disc = discs.data() + 3 * i;
    raster.add_disc({disc[0], disc[1]}, disc[2]);
  }
}

static void raster_triangles(Cells cells, In<double, 2> vertices, In<std::int32_t, 2> faces, double low, double high,
                             double resolution, double depth) {
  if (vertices.shape(1) != 3 || faces.shape(1) != 3) throw std::invalid_argument("vertices and faces need shape (N, 3)");
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (faces.data()[i] < 0 || static_cast<std::size_t>(faces.data()[i]) >= vertices.shape(0))
      throw std::invalid_argument("a face names a vertex that is not there");
  Raster raster = make_raster(cells, resolution, depth, false);
  nb::gil_scoped_release released;
  std::vector<Point3> triangle, above, inside;
  std::vector<Point2> polygon;
  for (std::size_t i = 0; i < faces.shape(0); ++i) {
    triangle.clear();
    for (std::size_t j = 0; j < 3; ++j) {
      const double *v = vertices.data() + 3 * static_cast<std::size_t>(faces.data()[3 * i + j]);
      triangle.push_back({v[0], v[1], v[2]});
    }
    clip_height(triangle, low, 1.0, above);
    clip_height(above, high, -1.0, inside);
    polygon.clear();
    for (const Point3 &corner : inside) polygon.push_back({corner.x, corner.y});
    raster.add_polygon(polygon.data(), polygon.size());
  }
}

}  // namespace trundle

void bind_raster(nanobind::module_ &m) {
  using nanobind::arg;
  m.def("raster_hexahedra", &trundle::raster_hexahedra, arg("cells"), arg("corners"), arg("low"), arg("high"),
        arg("resolution"), arg("depth"), arg("centre"));
  m.def("raster_hulls", &trundle::raster_hulls, arg("cells"), arg("points"), arg("starts"), arg("resolution"),
        arg("depth"), arg("centre"));
  m.def("raster_discs", &trundle::raster_discs, arg("cells"), arg("discs"), arg("resolution"), arg("depth"),
        arg("centre"));
  m.def("raster_triangles", &trundle::raster_triangles, arg("cells"), arg("vertices"), arg("faces"), arg("low"),
        arg("high"), arg("resolution"), arg("depth"));
}
