// Rasters of triangle meshes: their surface in a height band, and what they enclose.
//
// A mesh is closed when each edge is used as often in one direction as in the other. Then the section at a height is
// made of closed loops, and a point is inside where these wind around it more often counter-clockwise than clockwise.
// A cell that the surface in the band does not reach into is inside or outside as a whole, so its centre decides.
#include "raster.hpp"

#include <array>

namespace trundle {

namespace {

constexpr std::int8_t kPending = 99;  // Touched by a face without thickness; occupied in the end.
constexpr std::int64_t kBandCells = std::int64_t{1} << 22;  // As many winding numbers are held at once.

constexpr std::size_t kFewFaces = 50'000;  // Of so few the order does not matter.

void prefetch(const void *address) {
#if defined(__GNUC__)
  __builtin_prefetch(address);
#else
  (void)address;
#endif
}

std::uint64_t mix(std::uint64_t value) {  // The finaliser of splitmix64 (Steele, Lea and Flood 2014).
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
  return value ^ (value >> 31);
}

// A double's bits, so folded that round numbers do not end in zeros; -0 is 0.
std::uint64_t folded(double value) {
  value += 0.0;
  std::uint64_t word;
  std::memcpy(&word, &value, sizeof word);
  return word ^ (word >> 32);
}

using Vertices = In<double, 2>;
using Faces = In<std::int32_t, 2>;

void check_mesh(const Vertices &vertices, const Faces &faces, const In<double, 2> &transform) {
  if (vertices.shape(1) != 3 || faces.shape(1) != 3) throw std::invalid_argument("vertices and faces need shape (N, 3)");
  if (transform.shape(0) != 3 || transform.shape(1) != 4) throw std::invalid_argument("a transform needs shape (3, 4)");
  const std::int32_t *corner = faces.data();
  bool inside = true;
  for (std::size_t i = 0; i < faces.size(); ++i)
    inside &= corner[i] >= 0 && static_cast<std::size_t>(corner[i]) < vertices.shape(0);
  if (!inside) throw std::invalid_argument("a face names a vertex that is not there");
}

// Whether each edge runs as often one way as the other, told by a sum over the edges of a hash that changes its sign with
// the direction: it is zero for a closed mesh, and for another one by a chance of about 2^-63. Corners are one where their
// coordinates are, so that a mesh with a vertex for each corner is closed too.
bool is_closed(const Vertices &vertices, const Faces &faces) {
  std::vector<std::uint64_t> words(vertices.shape(0));
  const double *at = vertices.data();
  for (std::size_t i = 0; i < words.size(); ++i, at += 3)
    words[i] = mix(folded(at[0]) * 0x9e3779b97f4a7c15ULL + folded(at[1]) * 0xc2b2ae3d27d4eb4fULL +
                   folded(at[2]) * 0x165667b19e3779f9ULL);
  const auto turned = [](std::uint64_t word) { return word << 27 | word >> 37; };
  std::uint64_t sum = 0;
  const std::int32_t *face = faces.data();
  for (std::size_t i = 0; i < faces.shape(0); ++i, face += 3) {
    const std::uint64_t a = words[static_cast<std::size_t>(face[0])], b = words[static_cast<std::size_t>(face[1])],
                        c = words[static_cast<std::size_t>(face[2])];
    const std::uint64_t a_turned = turned(a), b_turned = turned(b), c_turned = turned(c);
    sum += a * b_turned - b * a_turned + b * c_turned - c * b_turned + c * a_turned - a * c_turned;
  }
  return sum == 0;
}

// Six times the volume that a closed mesh encloses, negative where its faces look inward.
double enclosed(const Vertices &vertices, const Faces &faces) {
  const double *from = vertices.data();
  const auto corner = [&](std::int32_t index) {
    const double *v = from + 3 * static_cast<std::size_t>(index);
    return Point3{v[0] - from[0], v[1] - from[1], v[2] - from[2]};
  };
  double volume = 0.0;
  const std::int32_t *face = faces.data();
  for (std::size_t i = 0; i < faces.shape(0); ++i, face += 3) {
    const Point3 a = corner(face[0]), b = corner(face[1]), c = corner(face[2]);
    volume += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  }
  return volume;
}

// The faces of a mesh, x and y in cells, z in metres; the same corner always comes out bit for bit the same.
class Placed {
 public:
  Placed(const Vertices &vertices, const Faces &faces, const In<double, 2> &transform, double resolution)
      : vertices_(vertices.data()), faces_(faces.data()) {
    for (std::size_t i = 0; i < 12; ++i) matrix_[i] = transform.data()[i] / (i < 8 ? resolution : 1.0);
  }

  // Ask for the memory of a face that will be placed soon, first for its indices, then for its corners.
  void fetch_face(std::size_t index) const { prefetch(faces_ + 3 * index); }
  void fetch_corners(std::size_t index) const {
    for (std::size_t j = 0; j < 3; ++j) prefetch(vertices_ + 3 * static_cast<std::size_t>(faces_[3 * index + j]));
  }

  // Place a face that reaches into heights from low to high; false for another one.
  bool place(std::size_t index, double low, double high, std::array<Point3, 3> &corners) const {
    const std::int32_t *face = faces_ + 3 * index;
    std::array<const double *, 3> v;
    const double *m = matrix_.data();
    for (std::size_t j = 0; j < 3; ++j) {
      v[j] = vertices_ + 3 * static_cast<std::size_t>(face[j]);
      corners[j].z = m[8] * v[j][0] + m[9] * v[j][1] + m[10] * v[j][2] + m[11];
    }
    if (corners[0].z < low && corners[1].z < low && corners[2].z < low) return false;
    if (corners[0].z > high && corners[1].z > high && corners[2].z > high) return false;
    for (std::size_t j = 0; j < 3; ++j) {
      corners[j].x = m[0] * v[j][0] + m[1] * v[j][1] + m[2] * v[j][2] + m[3];
      corners[j].y = m[4] * v[j][0] + m[5] * v[j][1] + m[6] * v[j][2] + m[7];
    }
    return true;
  }

 private:
  const double *vertices_;
  const std::int32_t *faces_;
  std::array<double, 12> matrix_;
};

// Faces that reach into heights from low to high, those over one tile of the grid after those over another: a large mesh
// whose faces come in no order would fetch other cells from memory for each of them.
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
  for (std::int64_t low = first; low < end; low += step) {
    const std::int64_t high = std::min(end, low + step);
    turns.assign(static_cast<std::size_t>((high - low) * width), 0);
    for (const Segment &s : section) {
      const bool rises = s.to.y > s.from.y;
      const Point2 &a = rises ? s.from : s.to, &b = rises ? s.to : s.from;
      const std::int64_t row_end = std::min(high, first_row(b.y));
      std::int64_t row = std::max(low, first_row(a.y));
      if (row >= row_end) continue;
      const double slope = (b.x - a.x) / (b.y - a.y);
      for (; row < row_end; ++row) {
        const double x = a.x + (static_cast<double>(row) + 0.5 - a.y) * slope;
        const std::int64_t col = std::clamp(centres.first(x, raster.cols()), first_col, end_col);
        turns[static_cast<std::size_t>((row - low) * width + col - first_col)] += rises ? -1 : 1;
      }
    }
    for (std::int64_t row = low; row < high; ++row) {
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

// Returns whether the mesh is closed, whether any of it lies in the band over the grid, and the faces of a closed mesh
// that lie between two cells somewhere, for `raster_thin_faces`.
static nb::tuple raster_mesh(Cells cells, Vertices vertices, Faces faces, In<double, 2> transform, double low, double high,
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

// Faces of a closed mesh that lie between two cells with no solid behind them: walls without thickness. Both cells become
// 99 where the one behind is not occupied (100).
static void raster_thin_faces(Cells cells, Vertices vertices, Faces faces, In<double, 2> transform, double low, double high,
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

void bind_raster_mesh(nanobind::module_ &m) {
  using nanobind::arg;
  m.def("raster_mesh", &trundle::raster_mesh, arg("cells"), arg("vertices"), arg("faces"), arg("transform"), arg("low"),
        arg("high"), arg("resolution"), arg("depth"), arg("centre"), arg("fill"));
  m.def("raster_thin_faces", &trundle::raster_thin_faces, arg("cells"), arg("vertices"), arg("faces"), arg("transform"),
        arg("low"), arg("high"), arg("resolution"), arg("depth"));
}
