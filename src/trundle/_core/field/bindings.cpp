// Cost to go from every cell of a grid to the nearest of some goals: the exact shortest paths over the whole map.
#include "field/eikonal.hpp"
#include "field/tiled_field.hpp"
#include "shared/arrays.hpp"
#include "shared/call_limits.hpp"

namespace trundle {

// The goals of a field, and the limits of its computation.
struct Task {
  In<std::int64_t, 2> goals;
  int threads;
  SearchLimits limits;
};

// The costs to go in `out`; `fits` is whether the numbers hold them.
template <typename Number, typename Cost>
static SearchStatus solve(const Grid<Cost> &grid, const Task &task, float *out, bool &fits) {
  TiledField<Cost, Number> field(grid, out, task.limits);
  for (std::size_t k = 0; k < task.goals.shape(0); ++k) field.add_goal(task.goals(k, 0), task.goals(k, 1));
  const SearchStatus status = field.solve(task.threads);
  fits = field.fits();
  return status;
}

// A `SearchStatus` and, where it is found, the field.
template <typename Cost>
static nb::tuple cost_field(In<Cost, 2> costs, In<std::int64_t, 2> goals, int connectivity, int threads,
                            std::optional<double> seconds, const Flag &cancel) {
  const auto rows = static_cast<std::int64_t>(costs.shape(0)), cols = static_cast<std::int64_t>(costs.shape(1));
  if (goals.shape(1) != 2) throw nb::value_error("goals need shape (N, 2): row, col");
  if (connectivity != 4 && connectivity != 8) throw nb::value_error("connectivity is 4 or 8");
  if (threads < 1 || threads > 1024) throw nb::value_error("threads must be from 1 to 1024");
  for (std::size_t k = 0; k < goals.shape(0); ++k) {
    const std::int64_t row = goals(k, 0), col = goals(k, 1);
    if (row < 0 || row >= rows || col < 0 || col >= cols) throw nb::index_error("a goal lies outside the grid");
    if (costs(row, col) == kWall<Cost>) throw nb::value_error("a goal lies in a wall");
  }
  const CallLimits limits(seconds, cancel);
  const Task task{goals, threads, limits};
  auto out = allocate<float>(static_cast<std::size_t>(rows * cols));
  SearchStatus status;
  {
    nb::gil_scoped_release release;
    const Grid<Cost> grid{costs.data(), rows, cols, connectivity == 8};
    bool fits = true;
    if constexpr (std::is_floating_point_v<Cost>) {
      status = solve<double>(grid, task, out.get(), fits);
    } else {
      status = solve<std::uint32_t>(grid, task, out.get(), fits);
      if (!fits) status = solve<std::uint64_t>(grid, task, out.get(), fits);
    }
  }
  limits.rethrow();
  const int code = static_cast<int>(status);
  if (status != SearchStatus::kFound) return nb::make_tuple(code, nb::none());
  float *field = out.release();
  nb::capsule owner(field, [](void *p) noexcept { std::free(p); });
  return nb::make_tuple(code, nb::ndarray<nb::numpy, float>(field, {costs.shape(0), costs.shape(1)}, owner));
}

}  // namespace trundle

void bind_field(nanobind::module_ &m) {
  namespace nb = nanobind;
  const auto bind = [&m](auto function) {
    m.def("cost_field", function, nb::arg("costs").noconvert(), nb::arg("goals").noconvert(),
          nb::arg("connectivity"), nb::arg("threads"), nb::arg("seconds").none(), nb::arg("cancel").none());
  };
  bind(&trundle::cost_field<std::uint8_t>);
  bind(&trundle::cost_field<std::uint16_t>);
  bind(&trundle::cost_field<float>);
  m.def("eikonal_field", &trundle::eikonal_field, nb::arg("classes").noconvert(), nb::arg("costs").noconvert(),
        nb::arg("seeds").noconvert(), nb::arg("values").noconvert(), nb::arg("row"), nb::arg("col"), nb::arg("beyond"));
}
