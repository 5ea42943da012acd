// Rasters of triangle meshes: their surface in a height band, and what they enclose.
//
// A mesh is closed when each edge is used as often in one direction as in the other. Then the section at a height is
// made of closed loops, and a point is inside where these wind around it more often counter-clockwise than clockwise.
// A cell that the surface in the band does not reach into is inside or outside as a whole, so its centre decides.
#include "raster/kernels.hpp"
#include "raster/mesh.hpp"

namespace trundle {

namespace {

constexpr std::int64_t kBandCells = std::int64_t{1} << 22;  // As many winding numbers are held at once.

constexpr std::size_t kFewFaces = 50'000;  // Of so few the order does not matter.

// Faces that reach into heights from low to high, those over one tile of the grid after those over another: a large
// mesh whose faces come in no order would fetch other cells from memory for each of them.
std::vector<std::int32_t> order_by_place(const Placed &placed, std::size_t count, double low, double high, const Raster &raster) {
  constexpr std::int64_t kTileRows = 64, kTileCols = 1024;
  const std::int64_t across = raster.cols() / kTileCols + 1, tiles = across * (raster.rows() / kTileRows + 1);
  std::vector<std::int32_t> tile_of(count, -1), order;
  std::vector<std::size_t> starts(static_cast<std::size_t>(tiles) + 1, 0);
  std::array<Point3, 3> face;
  for (std::size_t i = 0; i < count; ++i) {
    if (i + 16 < count) placed.fetch_corners(i + 16);
    if (!placed.place(i, low, high, face)) continue;
    const Reach nearest{0.0, false};
    const std::int64_t tile = nearest.first(face[0].y, raster.rows()) / kTileRows * across +
                              nearest.first(face[0].x, raster.cols()) / kTileCols;
    tile_of[i] = static_cast<std::int32_t>(tile);
    ++starts[static_cast<std::size_t>(tile) + 1];
  }
  for (std::size_t i = 1; i < starts.size(); ++i) starts[i] += starts[i - 1];
  order.resize(starts.back());
  for (std::size_t i = 0; i < count; ++i)
    if (tile_of[i] >= 0) order[starts[static_cast<std::size_t>(tile_of[i])]++] = static_cast<std::int32_t>(i);
  return order;
}

// The part of a triangle between two heights, seen from above.
struct Piece {
  std::array<Point2, 5> corners;
  std::size_t count = 0;

  Piece(const std::array<Point3, 3> &face, double low, double high) {
    const double least = std::min({face[0].z, face[1].z, face[2].z}), most = std::max({face[0].z, face[1].z, face[2].z});
    if (least >= low && most <= high) {
      for (const Point3 &corner : face) corners[count++] = {corner.x, corner.y};
      return;
    }
    // Along each edge: its start if that is kept, then the heights that it passes, in the order that it passes them.
    for (std::size_t i = 0; i < 3; ++i) {
      const Point3 &a = face[i], &b = face[i == 2 ? 0 : i + 1];
      if (a.z >= low && a.z <= high) corners[count++] = {a.x, a.y};
      const bool rises = a.z < b.z;
      for (const double height : {rises ? low : high, rises ? high : low})
        if (rises ? (a.z < height && height < b.z) : (b.z < height && height < a.z)) corners[count++] = cut(a, b, height);
    }
  }
};

struct Segment {
  Point2 from, to;
};

// The section's loops: an edge is cut from its lower end to its upper one, so that both of its faces get one point.
void add_section(const std::array<Point3, 3> &face, double height, std::vector<Segment> &section) {
  const std::array<bool, 3> above = {face[0].z >= height, face[1].z >= height, face[2].z >= height};
  if (above[0] == above[1] && above[1] == above[2]) return;
  Segment segment{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = i == 2 ? 0 : i + 1;
    if (above[i] == above[next]) continue;
    // Counter-clockwise from outside, the section runs from the edge that falls to the edge that rises.
    if (above[i]) segment.from = cut(face[next], face[i], height);
    else segment.to = cut(face[i], face[next], height);
  }
  section.push_back(segment);
}

// Mark the cells around whose centre the section winds counter-clockwise.
void fill_section(Raster &raster, const std::vector<Segment> &section) {
  const Reach centres{0.0, true};
  const auto first_row = [&](double y) { return centres.first(y, raster.rows()); };
  std::int64_t first = raster.rows(), end = 0, first_col = raster.cols(), end_col = 0;
  for (const Segment &s : section) {
    first = std::min(first, first_row(std::min(s.from.y, s.to.y)));
    end = std::max(end, first_row(std::max(s.from.y, s.to.y)));
    first_col = std::min(first_col, centres.first(std::min(s.from.x, s.to.x), raster.cols()));
    end_col = std::max(end_col, centres.first(std::max(s.from.x, s.to.x), raster.cols()));
  }
  if (first >= end || first_col >= end_col) return;
  const std::int64_t width = end_col - first_col + 1, step = std::max<std::int64_t>(1, kBandCells / width);
  std::vector<std::int32_t> turns;
  std::vector<std::uint8_t> open;  // Rows that have a cell to fill: what a row of occupied cells encloses is of no account.
  for (std::int64_t low = first; low < end; low += step) {
    const std::int64_t high = std::min(end, low + step);
    open.resize(static_cast<std::size_t>(high - low));
    for (std::int64_t row = low; row < high; ++row)
      open[static_cast<std::size_t>(row - low)] = !raster.is_row_full(row, first_col, end_col);
    turns.assign(static_cast<std::size_t>((high - low) * width), 0);
    for (const Segment &s : section) {
      const bool rises = s.to.y > s.from.y;
      const Point2 &a = rises ? s.from : s.to, &b = rises ? s.to : s.from;
      const std::int64_t row_end = std::min(high, first_row(b.y));
      std::int64_t row = std::max(low, first_row(a.y));
      if (row >= row_end) continue;
      const double slope = (b.x - a.x) / (b.y - a.y);
      for (; row < row_end; ++row) {
        if (!open[static_cast<std::size_t>(row - low)]) continue;
        const double x = a.x + (static_cast<double>(row) + 0.5 - a.y) * slope;
        const std::int64_t col = std::clamp(centres.first(x, raster.cols()), first_col, end_col);
        turns[static_cast<std::size_t>((row - low) * width + col - first_col)] += rises ? -1 : 1;
      }
    }
    for (std::int64_t row = low; row < high; ++row) {
      if (!open[static_cast<std::size_t>(row - low)]) continue;
      const std::int32_t *turn = turns.data() + (row - low) * width;
      std::int32_t winding = 0;
      for (std::int64_t col = first_col; col < end_col; ++col) {
        winding += *turn++;
        if (winding > 0) raster.cell(row, col) = kOccupied;
      }
    }
  }
}

}  // namespace

nb::tuple raster_mesh(Cells cells, Vertices vertices, Faces faces, In<double, 2> transform, double low, double high,
                      double resolution, double depth, bool centre, bool fill) {
  check_mesh(vertices, faces, transform);
  Raster raster(cells, resolution, depth, centre);
  std::vector<std::int32_t> between;
  bool closed = false, there = false;
  {
    nb::gil_scoped_release released;
    closed = fill && is_closed(vertices, faces);
    // Where all faces look inward, as in a room, they are walls without thickness.
    const bool solid = closed && enclosed(vertices, faces) > 0.0;
    const Placed placed(vertices, faces, transform, resolution);
    // A centre between two faces, seen from above, is inside: no depth is asked of each face.
    const Reach reach = !solid ? raster.surface() : centre ? Reach{kTouch / resolution, true} : raster.solid();
    std::vector<Segment> section;
    const double height = 0.5 * (low + high);
    const auto add = [&](std::size_t index) {
      std::array<Point3, 3> face;
      if (!placed.place(index, low, high, face)) return;
      const Piece piece(face, low, high);
      const bool whole = raster.add_polygon(piece.corners.data(), piece.count, reach);
      if (!whole && solid && !centre) between.push_back(static_cast<std::int32_t>(index));
      if (closed) add_section(face, height, section);
      there = true;
    };
    if (faces.shape(0) < kFewFaces) {
      for (std::size_t i = 0; i < faces.shape(0); ++i) add(i);
    } else {
      const std::vector<std::int32_t> order = order_by_place(placed, faces.shape(0), low, high, raster);
      for (std::size_t i = 0; i < order.size(); ++i) {
        if (i + 32 < order.size()) placed.fetch_face(static_cast<std::size_t>(order[i + 32]));
        if (i + 16 < order.size()) placed.fetch_corners(static_cast<std::size_t>(order[i + 16]));
        add(static_cast<std::size_t>(order[i]));
      }
    }
    fill_section(raster, section);
  }
  const std::size_t count = between.size();
  return nb::make_tuple(closed, there, to_numpy(std::move(between), {count}));
}

void raster_thin_faces(Cells cells, Vertices vertices, Faces faces, In<double, 2> transform, double low, double high,
                       double resolution, double depth) {
  check_mesh(vertices, faces, transform);
  Raster raster(cells, resolution, depth, false);
  nb::gil_scoped_release released;
  const Placed placed(vertices, faces, transform, resolution);
  const Reach &reach = raster.solid();
  std::array<Point3, 3> face;
  const auto mark = [&](std::int64_t behind_row, std::int64_t behind_col, std::int64_t row, std::int64_t col) {
    if (std::min(behind_row, row) < 0 || std::max(behind_row, row) >= raster.rows()) return;
    if (std::min(behind_col, col) < 0 || std::max(behind_col, col) >= raster.cols()) return;
    if (raster.cell(behind_row, behind_col) == kOccupied) return;
    raster.cell(behind_row, behind_col) = kPending;
    if (raster.cell(row, col) != kOccupied) raster.cell(row, col) = kPending;
  };
  for (std::size_t i = 0; i < faces.shape(0); ++i) {
    if (!placed.place(i, low, high, face)) continue;
    const Piece piece(face, low, high);
    const Box2 box = Box2::around(piece.corners.data(), piece.count);
    const Point3 u{face[1].x - face[0].x, face[1].y - face[0].y, face[1].z - face[0].z};
    const Point3 v{face[2].x - face[0].x, face[2].y - face[0].y, face[2].z - face[0].z};
    const double normal_x = u.y * v.z - u.z * v.y, normal_y = u.z * v.x - u.x * v.z;
    if (raster.trace(piece.corners.data(), piece.count, box, reach)) {
      for (std::int64_t row = raster.first_row(); row < raster.end_row(); ++row) {
        const double left = raster.left(row), right = raster.right(row);
        if (!(left <= right) || std::ceil(right - reach.depth) > std::floor(left + reach.depth)) continue;
        if (!(std::abs(left) < 4e9)) continue;
        const auto line = static_cast<std::int64_t>(std::llround(left));
        mark(row, normal_x > 0.0 ? line - 1 : line, row, normal_x > 0.0 ? line : line - 1);
      }
      continue;
    }
    const double left = box.low.x, right = box.high.x, y = box.low.y;
    if (!(std::abs(y) < 4e9)) continue;
    const auto line = static_cast<std::int64_t>(std::llround(y));
    const bool needle = reach.first(left, raster.cols()) >= reach.end(right, raster.cols());
    const Reach &across = needle ? raster.surface() : reach;
    const std::int64_t end = across.end(right, raster.cols());
    for (std::int64_t col = across.first(left, raster.cols()); col < end; ++col)
      mark(normal_y > 0.0 ? line - 1 : line, col, normal_y > 0.0 ? line : line - 1, col);
  }
}

}  // namespace trundle
