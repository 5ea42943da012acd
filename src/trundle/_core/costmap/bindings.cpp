// Names and arguments of these kernels in Python; kernels.hpp says what they do.
#include "costmap/kernels.hpp"

void bind_costmap(nanobind::module_ &m) {
  using namespace trundle;
  using nanobind::arg;
  m.def("inflate", &inflate, arg("occupancy").noconvert(), arg("table").noconvert());
  m.def("footprint_collides", &footprint_collides, arg("costs").noconvert(), arg("resolution"), arg("origin_x"),
        arg("origin_y"), arg("origin_yaw"), arg("outline").noconvert(), arg("poses").noconvert());
  m.def("footprint_sweep", &footprint_sweep, arg("costs").noconvert(), arg("resolution"), arg("origin_x"),
        arg("origin_y"), arg("origin_yaw"), arg("outline").noconvert(), arg("first").noconvert(),
        arg("last").noconvert());
  m.def("footprint_clearance", &footprint_clearance, arg("costs").noconvert(), arg("resolution"), arg("origin_x"),
        arg("origin_y"), arg("origin_yaw"), arg("outline").noconvert(), arg("poses").noconvert(), arg("cap"));
}
