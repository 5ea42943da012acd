// Rasters of triangle meshes over a floor that is not level: the band of heights follows the floor.
//
// In each cell the floor is a plane, and the least and the most that it differs from that plane. What counts is the
// height above the plane, which is linear over a face, so the corners of the face's part in the cell decide: over a
// plane ramp that is exact, and over a bent floor nothing in the band is missed. All x and y in here are in cells,
// heights in metres.
#include "raster/floor_plane.hpp"
#include "raster/kernels.hpp"
#include "raster/mesh.hpp"

namespace trundle {

namespace {

// A convex part of a face. Four cuts leave at most 7 corners, and 13 where rounding makes it less than convex.
struct Part {
  std::array<Point3, 16> corners;
  std::size_t count = 0;

  // The part within [low, high] along x or y.
  Part within(double Point3::*axis, double low, double high) const {
    return beyond(axis, low, 1.0).beyond(axis, high, -1.0);
  }
  Box2 box() const {
    Box2 box{{corners[0].x, corners[0].y}, {corners[0].x, corners[0].y}};
    for (std::size_t i = 1; i < count; ++i) {
      box.low = {std::min(box.low.x, corners[i].x), std::min(box.low.y, corners[i].y)};
      box.high = {std::max(box.high.x, corners[i].x), std::max(box.high.y, corners[i].y)};
    }
    return box;
  }

 private:
  Part beyond(double Point3::*axis, double limit, double side) const {
    Part kept;
    for (std::size_t i = 0; i < count; ++i) {
      const Point3 &a = corners[i], &b = corners[i + 1 == count ? 0 : i + 1];
      const double from = side * (a.*axis - limit), to = side * (b.*axis - limit);
      if (from >= 0.0) kept.corners[kept.count++] = a;
      if ((from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0)) {
        const double share = from / (from - to);
        Point3 cut{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.z + share * (b.z - a.z)};
        cut.*axis = limit;
        kept.corners[kept.count++] = cut;
      }
    }
    return kept;
  }
};

// The least and the most height of a part [m].
struct Heights {
  double least = std::numeric_limits<double>::infinity(), most = -least;

  explicit Heights(const Part &part) {
    for (std::size_t i = 0; i < part.count; ++i) {
      least = std::min(least, part.corners[i].z);
      most = std::max(most, part.corners[i].z);
    }
  }
};

// Cells, the floor below them, and the band above it.
class FloorRaster {
 public:
  FloorRaster(Cells &cells, const Planes &planes, double low, double high, double resolution, double depth, bool centre)
      : raster_(cells, resolution, depth, centre), planes_(planes.data()), low_(low), high_(high) {
    if (planes.shape(0) != cells.shape(0) || planes.shape(1) != cells.shape(1) || planes.shape(2) != kPlane)
      throw std::invalid_argument("planes need shape (rows, cols, 6)");
  }

  // Look at the cells under a mesh, and one around them, alone. Of many small meshes each must be cheap.
  void look_under(const Placed &placed, std::size_t count) {
    constexpr double kAll = std::numeric_limits<double>::infinity();
    Box2 box{{kAll, kAll}, {-kAll, -kAll}};
    std::array<Point3, 3> face;
    for (std::size_t i = 0; i < count; ++i) {
      if (!placed.place(i, -kAll, kAll, face)) continue;
      for (const Point3 &corner : face) {
        box.low = {std::min(box.low.x, corner.x), std::min(box.low.y, corner.y)};
        box.high = {std::max(box.high.x, corner.x), std::max(box.high.y, corner.y)};
      }
    }
    const Reach nearest{0.0, false};
    first_row = nearest.first(box.low.y - 1.0, raster_.rows());
    end_row = nearest.end(box.high.y + 1.0, raster_.rows());
    first_col = nearest.first(box.low.x - 1.0, raster_.cols());
    end_col = nearest.end(box.high.x + 1.0, raster_.cols());
    for (std::int64_t row = first_row; row < end_row; ++row)
      for (std::int64_t col = first_col; col < end_col; ++col) {
        const double *p = plane(row, col);
        const double swing = 0.5 * (std::abs(p[1]) + std::abs(p[2]));
        if (!std::isfinite(p[0])) continue;
        lowest_ = std::min(lowest_, p[0] - swing + p[3]);
        highest_ = std::max(highest_, p[0] + swing + p[4]);
      }
  }
  bool sees_floor() const { return lowest_ <= highest_; }

  std::int64_t first_row = 0, end_row = 0, first_col = 0, end_col = 0;

  Raster &raster() { return raster_; }
  const double *plane(std::int64_t row, std::int64_t col) const {
    return planes_ + static_cast<std::size_t>(row * raster_.cols() + col) * kPlane;
  }
  // Height halfway up the band above a cell's centre.
  double middle(std::int64_t row, std::int64_t col) const { return plane(row, col)[0] + 0.5 * (low_ + high_); }

  bool may_touch(const Part &part) const {
    const Heights heights(part);
    return heights.most >= lowest_ + low_ && heights.least <= highest_ + high_ && raster_.near(part.box());
  }

  // Whether a part over a cell reaches into the band there; never where the floor is unknown.
  bool in_band(const Part &part, std::int64_t row, std::int64_t col) const {
    const double *p = plane(row, col);
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = 0; i < part.count; ++i) {
      const Point3 &at = part.corners[i];
      const double above = at.z - p[0] - p[1] * (at.x - static_cast<double>(col) - 0.5) - p[2] * (at.y - static_cast<double>(row) - 0.5);
      least = std::min(least, above);
      most = std::max(most, above);
    }
    return most >= low_ + p[3] && least <= high_ + p[4];
  }

  // Whether all of a part over a cell is out of the band, or in it, by its heights alone.
  bool is_out(const Heights &part, std::int64_t row, std::int64_t col) const {
    const double *p = plane(row, col), swing = 0.5 * (std::abs(p[1]) + std::abs(p[2]));
    return !(part.most >= p[0] - swing + low_ + p[3] && part.least <= p[0] + swing + high_ + p[4]);
  }
  bool is_in(const Heights &part, std::int64_t row, std::int64_t col) const {
    const double *p = plane(row, col), swing = 0.5 * (std::abs(p[1]) + std::abs(p[2]));
    return part.least >= p[0] + swing + low_ + p[3] && part.most <= p[0] - swing + high_ + p[4];
  }

  // Visit the cells in which a part reaches into the band, in y as `up` and in x as `across` says, with the part's
  // strip in their row; false where a row that the part reaches into, or all of it, has no cell.
  template <typename Visit>
  bool visit(const Part &part, const Reach &up, const Reach &across, const Visit &mark) const {
    const Box2 box = part.box();
    const std::int64_t first = up.first(box.low.y, raster_.rows()), end = up.end(box.high.y, raster_.rows());
    bool whole = first < end;
    for (std::int64_t row = first; row < end; ++row) {
      const Part strip = part.within(&Point3::y, static_cast<double>(row) + up.strip_low(), static_cast<double>(row) + up.strip_high());
      if (strip.count == 0) continue;
      const Box2 here = strip.box();
      const std::int64_t first_col = across.first(here.low.x, raster_.cols()), end_col = across.end(here.high.x, raster_.cols());
      whole &= first_col < end_col;
      const Heights heights(strip);
      for (std::int64_t col = first_col; col < end_col; ++col) {
        if (is_out(heights, row, col)) continue;
        // A convex strip reaches into all of its columns, so where all of it is in the band it need not be cut.
        if (is_in(heights, row, col) || in_band(strip.within(&Point3::x, static_cast<double>(col) + across.strip_low(),
                                                             static_cast<double>(col) + across.strip_high()),
                                                row, col))
          mark(row, col, strip);
      }
    }
    return whole;
  }

 private:
  Raster raster_;
  const double *planes_;
  double low_, high_;
  double lowest_ = std::numeric_limits<double>::infinity(), highest_ = -std::numeric_limits<double>::infinity();
};

// How often the faces above the middle of the band wind around the centres of the cells under a mesh.
class Winding {
 public:
  explicit Winding(FloorRaster &floor)
      : floor_(floor), cols_(floor.end_col - floor.first_col),
        turns_(static_cast<std::size_t>((floor.end_row - floor.first_row) * cols_), 0) {}

  void add(const std::array<Point3, 3> &face) {
    const std::int64_t rows = floor_.raster().rows(), cols = floor_.raster().cols();
    const std::int64_t first = centres_.first(std::min({face[0].y, face[1].y, face[2].y}), rows);
    const std::int64_t end = centres_.first(std::max({face[0].y, face[1].y, face[2].y}), rows);
    for (std::int64_t row = first; row < end; ++row) {
      Point3 rising{}, falling{};  // Where the face's edges pass the row's centre line.
      for (std::size_t i = 0; i < 3; ++i) {
        const Point3 &a = face[i], &b = face[i == 2 ? 0 : i + 1];
        const bool rises = b.y > a.y;
        const Point3 &low = rises ? a : b, &high = rises ? b : a;
        if (row < centres_.first(low.y, rows) || row >= centres_.first(high.y, rows)) continue;
        const double share = (static_cast<double>(row) + 0.5 - low.y) / (high.y - low.y);
        (rises ? rising : falling) = {low.x + share * (high.x - low.x), 0.0, low.z + share * (high.z - low.z)};
      }
      const bool up = falling.x < rising.x;
      const Point3 &left = up ? falling : rising, &right = up ? rising : falling;
      const double slope = right.x > left.x ? (right.z - left.z) / (right.x - left.x) : 0.0;
      const std::int64_t end_col = centres_.first(right.x, cols);
      for (std::int64_t col = centres_.first(left.x, cols); col < end_col; ++col) {
        const double height = left.z + (static_cast<double>(col) + 0.5 - left.x) * slope;
        if (height > floor_.middle(row, col)) turn(row, col) += up ? 1 : -1;
      }
    }
  }

  void fill() {
    Raster &raster = floor_.raster();
    for (std::int64_t row = floor_.first_row; row < floor_.end_row; ++row)
      for (std::int64_t col = floor_.first_col; col < floor_.end_col; ++col)
        if (turn(row, col) > 0) raster.cell(row, col) = kOccupied;
  }

 private:
  std::int32_t &turn(std::int64_t row, std::int64_t col) {
    return turns_[static_cast<std::size_t>((row - floor_.first_row) * cols_ + col - floor_.first_col)];
  }

  static constexpr Reach centres_{0.0, true};
  FloorRaster &floor_;
  std::int64_t cols_;
  std::vector<std::int32_t> turns_;
};

bool place_face(const Placed &placed, std::size_t index, std::array<Point3, 3> &face, Part &part) {
  constexpr double kAll = std::numeric_limits<double>::infinity();
  if (!placed.place(index, -kAll, kAll, face)) return false;
  part.count = 3;
  std::copy(face.begin(), face.end(), part.corners.begin());
  return true;
}

}  // namespace

nb::tuple raster_mesh_over_floor(Cells cells, Planes planes, Vertices vertices, Faces faces, In<double, 2> transform,
                                 double low, double high, double resolution, double depth, bool centre) {
  check_mesh(vertices, faces, transform);
  FloorRaster floor(cells, planes, low, high, resolution, depth, centre);
  std::vector<std::int32_t> between;
  bool closed = false, there = false;
  {
    nb::gil_scoped_release released;
    Raster &raster = floor.raster();
    closed = is_closed(vertices, faces);
    const bool solid = closed && enclosed(vertices, faces) > 0.0;
    const Placed placed(vertices, faces, transform, resolution);
    const Reach reach = !solid ? raster.surface() : centre ? Reach{kTouch / resolution, true} : raster.solid();
    floor.look_under(placed, faces.shape(0));
    Winding winding(floor);
    std::array<Point3, 3> face;
    Part part;
    for (std::size_t i = 0; floor.sees_floor() && i < faces.shape(0); ++i) {
      if (!place_face(placed, i, face, part) || !raster.near(part.box())) continue;
      if (closed) winding.add(face);
      if (!floor.may_touch(part)) continue;
      const bool whole = floor.visit(part, reach, reach, [&](std::int64_t row, std::int64_t col, const Part &) {
        raster.cell(row, col) = kOccupied;
        there = true;
      });
      if (!whole && solid && !centre) between.push_back(static_cast<std::int32_t>(i));
    }
    if (closed) winding.fill();
  }
  const std::size_t count = between.size();
  return nb::make_tuple(closed, there, to_numpy(std::move(between), {count}));
}

void raster_thin_faces_over_floor(Cells cells, Planes planes, Vertices vertices, Faces faces, In<double, 2> transform,
                                  double low, double high, double resolution, double depth) {
  check_mesh(vertices, faces, transform);
  FloorRaster floor(cells, planes, low, high, resolution, depth, false);
  nb::gil_scoped_release released;
  Raster &raster = floor.raster();
  const Placed placed(vertices, faces, transform, resolution);
  floor.look_under(placed, faces.shape(0));
  const Reach &solid = raster.solid();
  const auto flat = [&](double from, double to) { return std::ceil(to - solid.depth) <= std::floor(from + solid.depth); };
  std::array<Point3, 3> face;
  Part part;
  for (std::size_t i = 0; i < faces.shape(0); ++i) {
    if (!place_face(placed, i, face, part) || !floor.may_touch(part)) continue;
    const Point3 u{face[1].x - face[0].x, face[1].y - face[0].y, face[1].z - face[0].z};
    const Point3 v{face[2].x - face[0].x, face[2].y - face[0].y, face[2].z - face[0].z};
    const double normal_x = u.y * v.z - u.z * v.y, normal_y = u.z * v.x - u.x * v.z;
    const Box2 box = part.box();
    const bool along_x = flat(box.low.y, box.high.y);
    // Along itself a face must reach into a cell: beyond its ends there is nothing behind it.
    const bool needle = along_x && solid.first(box.low.x, raster.cols()) >= solid.end(box.high.x, raster.cols());
    const Reach &up = along_x ? raster.surface() : solid, &across = along_x && !needle ? solid : raster.surface();
    floor.visit(part, up, across, [&](std::int64_t row, std::int64_t col, const Part &strip) {
      std::int64_t behind_row = row, behind_col = col;  // Only the cells in front of the face look behind it.
      if (along_x) {
        const auto line = static_cast<std::int64_t>(std::llround(box.low.y));
        if (row != (normal_y > 0.0 ? line : line - 1)) return;
        behind_row = normal_y > 0.0 ? line - 1 : line;
      } else {
        const Box2 here = strip.box();
        if (!flat(here.low.x, here.high.x)) return;
        const auto line = static_cast<std::int64_t>(std::llround(here.low.x));
        if (col != (normal_x > 0.0 ? line : line - 1)) return;
        behind_col = normal_x > 0.0 ? line - 1 : line;
      }
      if (behind_row < 0 || behind_row >= raster.rows() || behind_col < 0 || behind_col >= raster.cols()) return;
      if (raster.cell(behind_row, behind_col) == kOccupied) return;
      raster.cell(behind_row, behind_col) = kPending;
      if (raster.cell(row, col) != kOccupied) raster.cell(row, col) = kPending;
    });
  }
}

}  // namespace trundle
