// Names and arguments of these kernels in Python; kernels.hpp and surface_map.hpp say what they do.
#include "mapping/kernels.hpp"
#include "mapping/surface_map.hpp"

void bind_mapping(nanobind::module_ &m) {
  using namespace trundle;
  using nanobind::arg;
  nb::class_<mapping::SurfaceMap>(m, "SurfaceMap")
      .def(nb::init<double>(), arg("cell"))
      .def("add", &mapping::SurfaceMap::add, arg("points").noconvert(), arg("normals").noconvert(),
           arg("pose").noconvert(), arg("sign"))
      .def("match", &mapping::SurfaceMap::match, arg("points").noconvert(), arg("normals").noconvert(),
           arg("starts").noconvert(), arg("prior").noconvert(), arg("covariance").noconvert(),
           arg("settings").noconvert())
      .def("search", &mapping::SurfaceMap::search, arg("points").noconvert(), arg("centre").noconvert(),
           arg("reach").noconvert(), arg("sigmas").noconvert())
      .def("table", &mapping::SurfaceMap::table, arg("resolution"))
      .def_prop_ro("memory", &mapping::SurfaceMap::memory);
  m.def("find_normals", &find_normals, arg("points").noconvert(), arg("sensors").noconvert(), arg("gap"), arg("least"));
  m.def("solve_graph", &solve_graph, arg("poses").noconvert(), arg("edges").noconvert(), arg("transforms").noconvert(),
        arg("information").noconvert(), arg("widths").noconvert(), arg("fixed").noconvert(), arg("iterations"));
  m.def("count_beams", &count_beams, arg("counts").noconvert(), arg("sensors").noconvert(), arg("points").noconvert(),
        arg("hits").noconvert(), arg("corner").noconvert(), arg("resolution"), arg("short_by"), arg("sign"));
  m.def("draw_cells", &draw_cells, arg("counts").noconvert(), arg("settings").noconvert());
}
