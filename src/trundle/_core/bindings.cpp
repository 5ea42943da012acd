// The Python module `trundle._core._kernels`: the kernels of each folder are declared by its `bind_*`.
#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_batch(nb::module_ &m);
void bind_cost(nb::module_ &m);
void bind_costmap(nb::module_ &m);
void bind_crowds(nb::module_ &m);
void bind_curves(nb::module_ &m);
void bind_field(nb::module_ &m);
void bind_grid(nb::module_ &m);
void bind_hybrid(nb::module_ &m);
void bind_images(nb::module_ &m);
void bind_layers(nb::module_ &m);
void bind_localization(nb::module_ &m);
void bind_mapping(nb::module_ &m);
void bind_missions(nb::module_ &m);
void bind_mppi(nb::module_ &m);
void bind_raster(nb::module_ &m);
void bind_rays(nb::module_ &m);
void bind_regions(nb::module_ &m);
void bind_smoothing(nb::module_ &m);
void bind_tracking(nb::module_ &m);

NB_MODULE(_kernels, m) {
  m.doc() = "Kernels of trundle: arrays in, arrays out.";
  bind_batch(m);
  bind_cost(m);
  bind_costmap(m);
  bind_crowds(m);
  bind_curves(m);
  bind_field(m);
  bind_grid(m);
  bind_hybrid(m);
  bind_images(m);
  bind_layers(m);
  bind_localization(m);
  bind_mapping(m);
  bind_missions(m);
  bind_mppi(m);
  bind_raster(m);
  bind_rays(m);
  bind_regions(m);
  bind_smoothing(m);
  bind_tracking(m);
}
