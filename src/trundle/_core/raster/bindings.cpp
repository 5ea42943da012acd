// Names and arguments of these kernels in Python; kernels.hpp says what they do.
#include "raster/kernels.hpp"

void bind_raster(nanobind::module_ &m) {
  using namespace trundle;
  using nanobind::arg;
  m.def("raster_hexahedra", &raster_hexahedra, arg("cells"), arg("corners"), arg("low"), arg("high"), arg("resolution"),
        arg("depth"), arg("centre"));
  m.def("raster_discs", &raster_discs, arg("cells"), arg("discs"), arg("resolution"), arg("depth"), arg("centre"));
  m.def("raster_cylinders", &raster_cylinders, arg("cells"), arg("cylinders"), arg("low"), arg("high"),
        arg("resolution"), arg("depth"), arg("centre"));
  m.def("raster_mesh", &raster_mesh, arg("cells"), arg("vertices"), arg("faces"), arg("transform"), arg("low"),
        arg("high"), arg("resolution"), arg("depth"), arg("centre"), arg("fill"));
  m.def("raster_thin_faces", &raster_thin_faces, arg("cells"), arg("vertices"), arg("faces"), arg("transform"),
        arg("low"), arg("high"), arg("resolution"), arg("depth"));
  m.def("raster_mesh_over_floor", &raster_mesh_over_floor, arg("cells"), arg("planes"), arg("vertices"), arg("faces"),
        arg("transform"), arg("low"), arg("high"), arg("resolution"), arg("depth"), arg("centre"));
  m.def("raster_thin_faces_over_floor", &raster_thin_faces_over_floor, arg("cells"), arg("planes"), arg("vertices"),
        arg("faces"), arg("transform"), arg("low"), arg("high"), arg("resolution"), arg("depth"));
  m.def("floor_planes", &floor_planes, arg("heights"), arg("spacing"), arg("x"), arg("y"), arg("resolution"),
        arg("rows"), arg("cols"));
}
