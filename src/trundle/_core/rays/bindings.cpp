// Names and arguments of these kernels in Python; kernels.hpp says what they do.
#include "rays/kernels.hpp"

void bind_rays(nanobind::module_ &m) {
  using namespace trundle;
  using nanobind::arg;
  m.def("cast_grid_rays", &cast_grid_rays, arg("blocked"), arg("x"), arg("y"), arg("angles"), arg("reach"));
  m.def("cast_jumping_rays", &cast_jumping_rays, arg("field"), arg("x"), arg("y"), arg("angles"), arg("reach"));
  m.def("chebyshev_field", &chebyshev_field, arg("blocked"));
  m.def("cast_outline_rays", &cast_outline_rays, arg("segments"), arg("discs"), arg("x"), arg("y"), arg("first"),
        arg("step"), arg("count"), arg("reach"));
  m.def("find_moved", &find_moved, arg("points"), arg("sensor"), arg("angles"), arg("through"), arg("earlier"),
        arg("earlier_sensor"), arg("earlier_angles"), arg("earlier_through"), arg("seconds"));
  m.def("find_lone_hits", &find_lone_hits, arg("ranges"), arg("angles"), arg("sensor"), arg("earlier_ranges"),
        arg("earlier_angles"), arg("earlier_sensor"), arg("range_min"), arg("range_max"));
  m.def("measure_ranges", &measure_ranges, arg("distances"), arg("noise"), arg("deviation"), arg("range_min"),
        arg("range_max"));
  m.def("place_scan", &place_scan, arg("ranges"), arg("angles"), arg("mount"), arg("base"), arg("body"),
        arg("range_min"), arg("range_max"), arg("sensor"), arg("earlier_ranges"), arg("earlier_angles"),
        arg("earlier_sensor"));
  m.def("points_around", &points_around, arg("points"), arg("velocities"), arg("pose"), arg("seconds"), arg("reach"),
        arg("horizon"));
  m.def("outline_clearances", &outline_clearances, arg("points"), arg("velocities"), arg("poses"), arg("times"),
        arg("outline"), arg("sides"), arg("padding"), arg("rank"));
}
