// The Python module `trundle._core._kernels`. Each kernel file declares its functions in a `bind_*` of its own.
#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_binary_grid(nb::module_ &m);
void bind_components(nb::module_ &m);
void bind_cost_field(nb::module_ &m);
void bind_footprint(nb::module_ &m);
void bind_grid_search(nb::module_ &m);
void bind_grid_rays(nb::module_ &m);
void bind_hybrid_astar(nb::module_ &m);
void bind_inflation(nb::module_ &m);
void bind_flood(nb::module_ &m);
void bind_floor_planes(nb::module_ &m);
void bind_line_of_sight(nb::module_ &m);
void bind_least_cost(nb::module_ &m);
void bind_outline_rays(nb::module_ &m);
void bind_png_filter(nb::module_ &m);
void bind_raster(nb::module_ &m);
void bind_raster_cylinder(nb::module_ &m);
void bind_raster_floor(nb::module_ &m);
void bind_raster_mesh(nb::module_ &m);
void bind_shortest_curves(nb::module_ &m);
void bind_smoothing(nb::module_ &m);
void bind_zbuffer(nb::module_ &m);

NB_MODULE(_kernels, m) {
  m.doc() = "Kernels of trundle: arrays in, arrays out.";
  bind_binary_grid(m);
  bind_components(m);
  bind_cost_field(m);
  bind_footprint(m);
  bind_grid_search(m);
  bind_grid_rays(m);
  bind_hybrid_astar(m);
  bind_inflation(m);
  bind_flood(m);
  bind_floor_planes(m);
  bind_line_of_sight(m);
  bind_least_cost(m);
  bind_outline_rays(m);
  bind_png_filter(m);
  bind_raster(m);
  bind_raster_cylinder(m);
  bind_raster_floor(m);
  bind_raster_mesh(m);
  bind_shortest_curves(m);
  bind_smoothing(m);
  bind_zbuffer(m);
}
