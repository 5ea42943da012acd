// Names and arguments of these kernels in Python; kernels.hpp says what they do.
#include "localization/kernels.hpp"

void bind_localization(nanobind::module_ &m) {
  using namespace trundle;
  using nanobind::arg;
  m.def("distance_field", &distance_field, arg("occupied").noconvert(), arg("resolution"), arg("shift"), arg("limit"));
  m.def("field_at", &field_at, arg("field").noconvert(), arg("resolution"), arg("limit"), arg("points").noconvert());
  m.def("pick_beams", &pick_beams, arg("ranges").noconvert(), arg("angles").noconvert(), arg("mount").noconvert(),
        arg("poses").noconvert(), arg("body").noconvert(), arg("shortest"), arg("longest"), arg("most"), arg("offset"));
  m.def("expect_surfaces", &expect_surfaces, arg("field").noconvert(), arg("resolution"), arg("limit"),
        arg("points").noconvert(), arg("pose").noconvert(), arg("counts").noconvert(), arg("means").noconvert(),
        arg("edge"), arg("offset"), arg("settings").noconvert());
  m.def("learn_surfaces", &learn_surfaces, arg("field").noconvert(), arg("resolution"), arg("limit"),
        arg("points").noconvert(), arg("pose").noconvert(), arg("counts").noconvert(), arg("means").noconvert(),
        arg("edge"), arg("deepest"), arg("most"));
  m.def("move_particles", &move_particles, arg("particles").noconvert(), arg("motion").noconvert(),
        arg("alphas").noconvert(), arg("least").noconvert(), arg("seed"));
  m.def("weigh_particles", &weigh_particles, arg("table").noconvert(), arg("resolution"), arg("outside"),
        arg("particles").noconvert(), arg("points").noconvert());
  m.def("peak_particle", &peak_particle, arg("particles").noconvert(), arg("weights").noconvert(), arg("metres"),
        arg("radians"));
  m.def("resample_particles", &resample_particles, arg("particles").noconvert(), arg("weights").noconvert(),
        arg("bins").noconvert(), arg("bound").noconvert(), arg("seed"));
  m.def("match_scan", &match_scan, arg("field").noconvert(), arg("resolution"), arg("limit"),
        arg("points").noconvert(), arg("targets").noconvert(), arg("starts").noconvert(), arg("priors").noconvert(),
        arg("covariances").noconvert(), arg("settings").noconvert());
  m.def("judge_beams", &judge_beams, arg("field").noconvert(), arg("resolution"), arg("sensors").noconvert(),
        arg("points").noconvert(), arg("poses").noconvert(), arg("tolerance"), arg("depth"));
  m.def("search_poses", &search_poses, arg("table").noconvert(), arg("allowed").noconvert(), arg("resolution"),
        arg("points").noconvert(), arg("window").noconvert(), arg("settings").noconvert(), arg("most"),
        arg("most_nodes"));
}
