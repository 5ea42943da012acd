// Names and arguments of these kernels in Python; their headers say what they do.
#include "missions/driver.hpp"
#include "missions/measures.hpp"
#include "missions/period.hpp"

#include <nanobind/stl/unique_ptr.h>

void bind_missions(nanobind::module_ &m) {
  using namespace trundle;
  using nanobind::arg;
  nb::class_<MissionDriver>(m, "MissionDriver")
      .def(nb::init<In<std::uint8_t, 2>, In<std::uint8_t, 2>, double, In<double, 1>, In<double, 1>, In<double, 2>,
                    In<double, 2>, In<double, 1>, In<double, 1>, In<double, 1>, In<double, 1>>(),
           arg("costs"), arg("free"), arg("resolution"), arg("origin"), arg("inflation"), arg("outline"),
           arg("padded"), arg("limits"), arg("pursuit"), arg("goal"), arg("progress"))
      .def("drive", &MissionDriver::drive, arg("starts"), arg("goals"), arg("time_limits"), arg("paths"),
           arg("backward"), arg("path_ends"), arg("checks"), arg("along"), arg("check_ends"), arg("threads"))
      .def("begin", &MissionDriver::begin, arg("start"), arg("goal"), arg("time_limit"), arg("path"), arg("backward"),
           arg("check"), arg("along"), arg("patience"), nb::keep_alive<0, 1>());
  nb::class_<MissionRun>(m, "MissionRun")
      .def("decide", &MissionRun::decide)
      .def("look", &MissionRun::look)
      .def("take", &MissionRun::take, arg("v"), arg("w"))
      .def("move", &MissionRun::move, arg("v"), arg("w"))
      .def("result", &MissionRun::result);
  m.def("polyline_distances", &polyline_distances, arg("points"), arg("corners"));
  m.def("stopping_poses", &stopping_poses, arg("x"), arg("y"), arg("yaw"), arg("v"), arg("w"), arg("goal_v"),
        arg("goal_w"), arg("forward"), arg("reverse"), arg("turning"), arg("acceleration"), arg("angular_acceleration"),
        arg("dt"), arg("turn_step"));
  m.def("drive_period", &drive_period, arg("state"), arg("v"), arg("w"), arg("limits"), arg("steps"));
  m.def("outline_distances", &outline_distances, arg("outlines"), arg("polygons"));
}
