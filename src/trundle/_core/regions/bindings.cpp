// Names and arguments of these kernels in Python; kernels.hpp says what they do.
#include "regions/kernels.hpp"

void bind_regions(nanobind::module_ &m) {
  using namespace trundle;
  using nanobind::arg;
  m.def("label_components", &label_components, arg("mask"), arg("diagonal"));
  m.def("mark_gaps", &mark_gaps, arg("blocked"), arg("limit"));
  m.def("flood_free", &flood_free, arg("cells"), arg("seeds"));
  m.def("flood_largest", &flood_largest, arg("cells"));
}
