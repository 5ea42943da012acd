// Names and arguments of these kernels in Python; kernels.hpp says what they do.
#include "images/kernels.hpp"

void bind_images(nanobind::module_ &m) {
  using namespace trundle;
  using nanobind::arg;
  m.def("png_unfilter", &png_unfilter, arg("lines"), arg("step"));
  m.def("draw_triangles", &draw_triangles, arg("triangles"), arg("width"), arg("height"), arg("scale"), arg("near"),
        arg("perspective"));
}
