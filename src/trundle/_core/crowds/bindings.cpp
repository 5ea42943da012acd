// Names and arguments of these kernels in Python; arrays.hpp says what they do.
#include "crowds/arrays.hpp"

void bind_crowds(nanobind::module_ &m) {
  using namespace trundle;
  using namespace trundle::crowds;
  using nanobind::arg;
  nb::class_<Floor>(m, "CrowdFloor")
      .def(nb::new_(&make_floor), arg("costs"), arg("nearness"), arg("corner_x"), arg("corner_y"), arg("resolution"),
           arg("reach"), arg("look"));
  nb::class_<CrowdModel>(m, "CrowdModel")
      .def(nb::new_(&make_model), arg("floors"), arg("counts"), arg("members"), arg("corners"), arg("corner_counts"),
           arg("mover_radii"));
  nb::class_<CrowdRun>(m, "CrowdRun")
      .def(nb::init<std::shared_ptr<const CrowdModel>>(), arg("model"))
      .def("reset", &CrowdRun::reset, arg("words"), arg("robot"), arg("movers"))
      .def("step", &CrowdRun::step, arg("robot").none(), arg("movers"))
      .def("at", &CrowdRun::at, arg("time"))
      .def_prop_ro("index", &CrowdRun::index);
}
