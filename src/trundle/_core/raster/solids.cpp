// Rasters of convex solids, each cut to a height band first, so that it counts by what lies in the band, seen from
// above.
#include "raster/kernels.hpp"
#include "raster/raster.hpp"
#include "shared/hull.hpp"

#include <array>

namespace trundle {

// Corners of a box or another hexahedron: bit 0 of the index is its x side, bit 1 its y side, bit 2 its z side.
static void slice_hexahedron(const double *xyz, double low, double high, double scale, std::vector<Point2> &points) {
  std::array<Point3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) corners[i] = {xyz[3 * i] * scale, xyz[3 * i + 1] * scale, xyz[3 * i + 2]};
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

void raster_hexahedra(Cells cells, In<double, 3> corners, double low, double high, double resolution, double depth,
                      bool centre) {
  if (corners.shape(1) != 8 || corners.shape(2) != 3) throw std::invalid_argument("corners need shape (N, 8, 3)");
  Raster raster(cells, resolution, depth, centre);
  nb::gil_scoped_release released;
  std::vector<Point2> points, hull;
  for (std::size_t i = 0; i < corners.shape(0); ++i) {
    slice_hexahedron(corners.data() + 24 * i, low, high, 1.0 / resolution, points);
    if (points.empty()) continue;
    convex_hull(points, hull);
    raster.add_solid(hull.data(), hull.size());
  }
}

void raster_discs(Cells cells, In<double, 2> discs, double resolution, double depth, bool centre) {
  if (discs.shape(1) != 3) throw std::invalid_argument("discs need shape (N, 3): x, y, radius");
  Raster raster(cells, resolution, depth, centre);
  nb::gil_scoped_release released;
  const double scale = 1.0 / resolution;
  for (std::size_t i = 0; i < discs.shape(0); ++i) {
    const double *disc = discs.data() + 3 * i;
    raster.add_disc({disc[0] * scale, disc[1] * scale}, disc[2] * scale);
  }
}

}  // namespace trundle
