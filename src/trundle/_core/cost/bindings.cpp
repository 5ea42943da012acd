// `LeastCost` as Python sees it: paths of least cost for one table of weights; and the kernels of straight lines.
#include "cost/kernels.hpp"
#include "cost/least_cost_path.hpp"
#include "shared/call_limits.hpp"
#include "shared/memory_pool.hpp"

#include <nanobind/stl/pair.h>

#include <utility>

namespace trundle {

class LeastCost {
 public:
  explicit LeastCost(In<double, 1> weights) {
    if (weights.size() != 256) throw nb::value_error("the weights need one entry for each of the 256 costs");
    for (int cost = 0; cost < 256; ++cost) {
      weights_[cost] = weights.data()[cost];
      if (!(weights_[cost] == 0.0 || (weights_[cost] >= 1e-3 && weights_[cost] <= 1e6))) {
        throw nb::value_error("a weight must be from 0.001 to 1e6, or 0 where a cell is blocked");
      }
    }
  }

  // From one cell to another, between points in them. Both directions give the same path.
  nb::tuple find(In<std::uint8_t, 2> costs, std::pair<int, int> start, std::pair<int, int> goal, In<double, 2> ends,
                 std::optional<double> seconds, const Flag &cancel) const {
    const lines::WeightedGrid grid{costs.data(), weights_, static_cast<std::int64_t>(costs.shape(0)),
                                   static_cast<std::int64_t>(costs.shape(1))};
    const std::vector<lines::Point> points = lines::read_points(ends);
    if (points.size() != 2) throw nb::value_error("the ends need shape (2, 2)");
    if (grid.rows > (1 << 30) || grid.cols > (1 << 30)) throw nb::value_error("the grid is too long");
    const End first = end_of(grid, start, points[0]), last = end_of(grid, goal, points[1]);
    const CallLimits limits(seconds, cancel);
    LeastCostPath path;
    {
      nb::gil_scoped_release release;
      if (grid.weight(first.cell.row, first.cell.col) > 0.0 && grid.weight(last.cell.row, last.cell.col) > 0.0) {
        std::unique_ptr<LeastCostMemory> memory = pool_.borrow();
        const bool reversed = last.order() < first.order();
        path = LeastCostSearch(grid, limits, *memory).find(reversed ? last : first, reversed ? first : last);
        if (reversed) std::reverse(path.line.begin(), path.line.end());
        pool_.give_back(std::move(memory));
      }
    }
    limits.rethrow();
    std::vector<double> flat;
    for (const lines::Point &point : path.line) flat.insert(flat.end(), {point.x, point.y});
    return nb::make_tuple(static_cast<int>(path.status), to_numpy(std::move(flat), {path.line.size(), 2}), path.cost);
  }

  // Memory that is kept for the next query.
  std::size_t bytes() const { return pool_.bytes(); }

 private:
  using End = LeastCostSearch::End;
  static constexpr double kInside = 1.0 - 1e-6;

  // A point that rounding put outside its cell is moved to the cell's edge.
  static End end_of(const lines::WeightedGrid &grid, std::pair<int, int> cell, lines::Point point) {
    const auto [row, col] = cell;
    if (row < 0 || row >= grid.rows || col < 0 || col >= grid.cols) {
      throw nb::index_error("start or goal lies outside the grid");
    }
    return {{row, col}, {std::clamp(point.x, double(col), col + kInside), std::clamp(point.y, double(row), row + kInside)}};
  }

  double weights_[256];
  mutable MemoryPool<LeastCostMemory> pool_;
};

}  // namespace trundle

void bind_cost(nanobind::module_ &m) {
  namespace nb = nanobind;
  nb::class_<trundle::LeastCost>(m, "LeastCost")
      .def(nb::init<trundle::In<double, 1>>(), nb::arg("weights").noconvert())
      .def("find", &trundle::LeastCost::find, nb::arg("costs").noconvert(), nb::arg("start"), nb::arg("goal"),
           nb::arg("ends").noconvert(), nb::arg("seconds") = nb::none(), nb::arg("cancel") = nb::none())
      .def_prop_ro("bytes", &trundle::LeastCost::bytes);
  m.def("line_costs", &trundle::line_costs, nb::arg("costs").noconvert(), nb::arg("weights").noconvert(),
        nb::arg("starts").noconvert(), nb::arg("ends").noconvert());
  m.def("shortcut", &trundle::shortcut, nb::arg("costs").noconvert(), nb::arg("weights").noconvert(),
        nb::arg("points").noconvert());
}
