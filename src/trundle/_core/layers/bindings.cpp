// Names and arguments of these kernels in Python; kernels.hpp says what they do.
#include <nanobind/stl/tuple.h>

#include "layers/kernels.hpp"

void bind_layers(nanobind::module_ &m) {
  using namespace trundle;
  using nanobind::arg;
  m.def("mark_scan", &mark_scan, arg("evidence"), arg("points"), arg("times"), arg("row"), arg("col"),
        arg("resolution"), arg("poses"), arg("angles"), arg("ranges"), arg("outline"), arg("limits"),
        arg("infinite_is_free"), arg("hit"), arg("miss"), arg("time"));
  m.def("unmark_before", &unmark_before, arg("evidence"), arg("times"), arg("before"), arg("hit"), arg("miss"));
  m.def("unmark_within", &unmark_within, arg("evidence"), arg("points"), arg("row"), arg("col"), arg("resolution"),
        arg("outline"), arg("hit"), arg("miss"));
  m.def("paint_marks", &paint_marks, arg("evidence"), arg("points"), arg("row"), arg("col"), arg("resolution"),
        arg("cells"), arg("kept"), arg("x"), arg("y"), arg("yaw"), arg("cell_size"), arg("clear_occupied"));
  m.def("repaint_marks", &repaint_marks, arg("evidence"), arg("points"), arg("row"), arg("col"), arg("resolution"),
        arg("cells"), arg("base"), arg("kept"), arg("window"), arg("x"), arg("y"), arg("yaw"), arg("cell_size"),
        arg("clear_occupied"));
}
