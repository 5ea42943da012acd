// Names and arguments of these kernels in Python; batch.hpp says what they do.
#include "batch/batch.hpp"

void bind_batch(nanobind::module_ &m) {
  using namespace trundle;
  using nanobind::arg;
  nb::class_<BatchCrowds>(m, "BatchCrowds")
      .def(nb::init<std::vector<std::shared_ptr<const crowds::CrowdModel>>, In<std::int64_t, 1>, In<std::int64_t, 1>,
                    std::vector<In<double, 3>>, std::size_t>(),
           arg("models"), arg("firsts"), arg("of_recording"), arg("movers"), arg("count"))
      .def("place", &BatchCrowds::place, arg("rows"), arg("recordings"), arg("poses"), arg("radius"), arg("words"),
           arg("threads"))
      .def("members", &BatchCrowds::members, arg("robot"), arg("time"));
  nb::class_<Batch>(m, "Batch")
      .def(nb::init<In<std::uint8_t, 1>, In<std::int64_t, 2>, In<double, 2>, double, In<double, 2>, In<double, 1>,
                    In<double, 2>, In<std::int64_t, 1>, In<double, 1>, In<double, 2>, In<std::int64_t, 1>,
                    In<double, 1>, In<double, 3>, In<std::int64_t, 1>, double>(),
           arg("fields"), arg("shapes"), arg("frames"), arg("resolution"), arg("outline"), arg("limits"),
           arg("lidars"), arg("beams"), arg("angles"), arg("corners"), arg("corner_counts"), arg("radii"),
           arg("tracks"), arg("recordings"), arg("period"))
      .def("drive", &Batch::drive, arg("poses").noconvert(), arg("motions").noconvert(), arg("wheels").noconvert(),
           arg("lengths").noconvert(), arg("steps").noconvert(), arg("contacts").noconvert(), arg("commands"),
           arg("places"), arg("active"), arg("substeps"), arg("threads"), arg("crowds").none() = nb::none())
      .def("scan", &Batch::scan<float>, arg("ranges").noconvert(), arg("poses"), arg("steps"), arg("places"),
           arg("active"), arg("errors"), arg("keys"), arg("threads"), arg("crowds").none() = nb::none())
      .def("scan", &Batch::scan<double>, arg("ranges").noconvert(), arg("poses"), arg("steps"), arg("places"),
           arg("active"), arg("errors"), arg("keys"), arg("threads"), arg("crowds").none() = nb::none());
}
