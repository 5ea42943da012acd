// `BinaryGrid` as Python sees it: shortest paths between cells of a map of blocked and free cells.
#include "grid/binary_grid.hpp"
#include "grid/kernels.hpp"
#include "grid/queries.hpp"
#include "shared/arrays.hpp"
#include "shared/call_limits.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace trundle {

namespace {

using Bytes = nb::ndarray<const std::uint8_t, nb::ndim<2>, nb::device::cpu>;  // any strides

ByteView view_of(const Bytes &array) {
  return {array.data(), static_cast<std::int64_t>(array.shape(0)), static_cast<std::int64_t>(array.shape(1)),
          array.stride(0), array.stride(1)};
}

// Two whole numbers from a Python sequence; numbers of more than 64 bits become some that lie outside.
bool read_cell(nb::handle sequence, std::int64_t *cell) {
  if (!PySequence_Check(sequence.ptr()) || PySequence_Size(sequence.ptr()) != 2) {
    PyErr_Clear();
    return false;
  }
  for (Py_ssize_t i = 0; i < 2; ++i) {
    const nb::object item = nb::steal(PySequence_GetItem(sequence.ptr(), i));
    const nb::object whole = item.is_valid() ? nb::steal(PyNumber_Index(item.ptr())) : nb::object();
    if (!whole.is_valid()) {
      PyErr_Clear();
      return false;
    }
    int overflow = 0;
    cell[i] = PyLong_AsLongLongAndOverflow(whole.ptr(), &overflow);
  }
  return true;
}

}  // namespace

static std::unique_ptr<BinaryGrid> make_grid(Bytes blocked, int connectivity, const std::string &method) {
  constexpr std::pair<const char *, Method> kMethods[] = {
      {"auto", Method::kAuto}, {"jps", Method::kJump}, {"astar", Method::kBucket}};
  const auto known = std::find_if(std::begin(kMethods), std::end(kMethods), [&](auto &m) { return method == m.first; });
  if (known == std::end(kMethods)) throw nb::value_error("no such method");
  if (connectivity != 4 && connectivity != 8) throw nb::value_error("connectivity is 4 or 8");
  const ByteView view = view_of(blocked);
  if (view.rows == 0 || view.cols == 0) throw nb::value_error("the map has no cells");
  if (view.rows > 0x7ffffff0 || view.cols > 0x7ffffff0 || (view.rows + 2) * (view.cols + 2) >= 0xffffffffLL) {
    throw nb::value_error("the map has more than 2^32 cells");
  }
  nb::gil_scoped_release released;
  return std::make_unique<BinaryGrid>(view, connectivity, known->second);
}

// Status, straight and diagonal steps, and the corners as bytes of int32: (row, col), (row, col), …
static nb::tuple find_path(const BinaryGrid &grid, nb::handle start, nb::handle goal, std::optional<double> seconds,
                           const Flag &cancel) {
  std::int64_t ends[4];
  int status = 0;
  for (int end = 0; end < 2 && status == 0; ++end) {
    if (!read_cell(end == 0 ? start : goal, ends + 2 * end)) status = kNoCell + end;
  }
  const CallLimits limits(seconds, cancel);
  GridPath path;
  if (status == 0) {
    nb::gil_scoped_release released;
    status = refusal(grid, ends);
    if (status == 0) path = grid.find(cell_of(ends[0], ends[1]), cell_of(ends[2], ends[3]), limits);
  }
  if (status != 0) return nb::make_tuple(status, 0, 0, nb::bytes("", 0));
  limits.rethrow();
  static_assert(sizeof(GridCell) == 2 * sizeof(std::int32_t), "corners are handed over as they lie");
  return nb::make_tuple(static_cast<int>(path.status), path.straight, path.diagonal,
                        nb::bytes(path.corners.data(), path.corners.size() * sizeof(GridCell)));
}

// Status, length in cells, and the points as bytes of int32: (column, row), …, in half cells from the map's corner.
static nb::tuple find_point_path(const BinaryGrid &grid, nb::handle start, nb::handle goal,
                                 std::optional<double> seconds, const Flag &cancel) {
  check_point_sides(grid);
  std::int64_t ends[4];
  int status = 0;
  for (int end = 0; end < 2 && status == 0; ++end) {
    if (!read_cell(end == 0 ? start : goal, ends + 2 * end)) status = kNoCell + end;
  }
  const CallLimits limits(seconds, cancel);
  PointPath path;
  double length = 0.0;
  if (status == 0) {
    nb::gil_scoped_release released;
    status = refusal(grid, ends);
    if (status == 0) {
      path = grid.find_point(cell_of(ends[0], ends[1]), cell_of(ends[2], ends[3]), limits);
      length = path.length();
    }
  }
  if (status != 0) return nb::make_tuple(status, 0.0, nb::bytes("", 0));
  limits.rethrow();
  static_assert(sizeof(HalfCell) == 2 * sizeof(std::int32_t), "points are handed over as they lie");
  return nb::make_tuple(static_cast<int>(path.status), length,
                        nb::bytes(path.points.data(), path.points.size() * sizeof(HalfCell)));
}

// Where each of many queries really begins and ends, by the rules of `settle`. First the index of the first query that
// cannot be asked, or -1, and its status as of `find_path`; then starts, goals, and whether the goal is only the nearest
// cell that can be reached.
static nb::tuple settle_ends(const BinaryGrid &grid, CellArray starts, CellArray goals, double start_reach,
                             double goal_reach, bool partial) {
  const std::size_t count = same_count(starts, goals);
  if (!(start_reach >= 0.0 && goal_reach >= 0.0)) throw nb::value_error("tolerances must be 0 or more");
  std::vector<std::int64_t> from(2 * count), to(2 * count);
  std::vector<std::uint8_t> nearly(count);
  std::int64_t wrong = -1;
  int refused = 0;
  {
    nb::gil_scoped_release released;
    for (std::size_t i = 0; i < count && wrong < 0; ++i) {
      const Ends ends = settle(grid, {starts(i, 0), starts(i, 1), goals(i, 0), goals(i, 1)}, start_reach, goal_reach, partial);
      if (ends.refusal != 0) wrong = static_cast<std::int64_t>(i), refused = ends.refusal;
      from[2 * i] = ends.start.row, from[2 * i + 1] = ends.start.col;
      to[2 * i] = ends.goal.row, to[2 * i + 1] = ends.goal.col;
      nearly[i] = ends.partial;
    }
  }
  return nb::make_tuple(wrong, refused, to_numpy(std::move(from), {count, 2}), to_numpy(std::move(to), {count, 2}),
                        to_numpy(std::move(nearly), {count}));
}

// Many paths at once. First the index of the first query that cannot be asked, or -1, and its status as of `find_path`;
// then status, straight and diagonal steps and the end of its corners for each query, and the corners of all.
static nb::tuple find_paths(const BinaryGrid &grid, CellArray starts, CellArray goals, int threads,
                            std::optional<double> seconds, const Flag &cancel) {
  const std::size_t count = same_count(starts, goals);
  const auto [wrong, refused] = first_refusal(grid, starts, goals);
  if (wrong >= 0) return nb::make_tuple(wrong, refused);
  std::vector<std::uint8_t> statuses(count);
  std::vector<std::int64_t> steps(2 * count), ends(count);
  std::vector<std::int32_t> corners;
  const CallLimits limits(seconds, cancel);
  {
    nb::gil_scoped_release released;
    const auto paths = find_all<GridPath>(count, threads, [&](std::size_t i) {
      return grid.find(cell_of(starts(i, 0), starts(i, 1)), cell_of(goals(i, 0), goals(i, 1)), limits);
    });
    std::size_t total = 0;
    for (const GridPath &path : paths) total += path.corners.size();
    corners.reserve(2 * total);
    for (std::size_t i = 0; i < count; ++i) {
      statuses[i] = static_cast<std::uint8_t>(paths[i].status);
      steps[2 * i] = static_cast<std::int64_t>(paths[i].straight);
      steps[2 * i + 1] = static_cast<std::int64_t>(paths[i].diagonal);
      for (const GridCell cell : paths[i].corners) corners.insert(corners.end(), {cell.row, cell.col});
      ends[i] = static_cast<std::int64_t>(corners.size() / 2);
    }
  }
  limits.rethrow();
  const std::size_t total = corners.size() / 2;
  return nb::make_tuple(-1, 0, to_numpy(std::move(statuses), {count}), to_numpy(std::move(steps), {count, 2}),
                        to_numpy(std::move(ends), {count}), to_numpy(std::move(corners), {total, 2}));
}

// The same for any-angle paths: status, length in cells and the end of its points for each query, and all points.
static nb::tuple find_point_paths(const BinaryGrid &grid, CellArray starts, CellArray goals, int threads,
                                  std::optional<double> seconds, const Flag &cancel) {
  const std::size_t count = same_count(starts, goals);
  check_point_sides(grid);
  const auto [wrong, refused] = first_refusal(grid, starts, goals);
  if (wrong >= 0) return nb::make_tuple(wrong, refused);
  std::vector<std::uint8_t> statuses(count);
  std::vector<double> lengths(count);
  std::vector<std::int64_t> ends(count);
  std::vector<std::int32_t> points;
  const CallLimits limits(seconds, cancel);
  {
    nb::gil_scoped_release released;
    const auto paths = find_all<PointPath>(count, threads, [&](std::size_t i) {
      return grid.find_point(cell_of(starts(i, 0), starts(i, 1)), cell_of(goals(i, 0), goals(i, 1)), limits);
    });
    for (std::size_t i = 0; i < count; ++i) {
      statuses[i] = static_cast<std::uint8_t>(paths[i].status);
      lengths[i] = paths[i].length();
      for (const HalfCell at : paths[i].points) points.insert(points.end(), {at.x, at.y});
      ends[i] = static_cast<std::int64_t>(points.size() / 2);
    }
  }
  limits.rethrow();
  const std::size_t total = points.size() / 2;
  return nb::make_tuple(-1, 0, to_numpy(std::move(statuses), {count}), to_numpy(std::move(lengths), {count}),
                        to_numpy(std::move(ends), {count}), to_numpy(std::move(points), {total, 2}));
}

// Every cell of a path, from its corners (row, col), shape (N, 2).
static auto walk_corners(In<std::int32_t, 2> corners) {
  std::vector<std::int32_t> cells;
  if (corners.shape(1) != 2) throw nb::value_error("corners need shape (N, 2)");
  for (std::size_t i = 0; i < corners.shape(0); ++i) {
    const std::int32_t row = corners(i, 0), col = corners(i, 1);
    if (i == 0) {
      cells.insert(cells.end(), {row, col});
      continue;
    }
    std::int64_t r = corners(i - 1, 0), c = corners(i - 1, 1);
    const std::int64_t rows = row - r, cols = col - c, steps = std::max(std::abs(rows), std::abs(cols));
    if (rows != 0 && cols != 0 && std::abs(rows) != std::abs(cols)) throw nb::value_error("a line is neither straight nor diagonal");
    for (std::int64_t step = 0; step < steps; ++step) {
      r += (rows > 0) - (rows < 0), c += (cols > 0) - (cols < 0);
      cells.insert(cells.end(), {static_cast<std::int32_t>(r), static_cast<std::int32_t>(c)});
    }
  }
  const std::size_t count = cells.size() / 2;
  return to_numpy(std::move(cells), {count, 2});
}

static void update(BinaryGrid &grid, std::int64_t row, std::int64_t col, Bytes values) {
  const ByteView view = view_of(values);
  if (row < 0 || col < 0 || row > grid.rows() - view.rows || col > grid.cols() - view.cols) {
    throw nb::value_error("the rectangle lies outside the map");
  }
  nb::gil_scoped_release released;
  grid.update(row, col, view);
}

static const char *method_name(const BinaryGrid &grid) {
  return grid.method() == Method::kBucket ? "astar" : "jps";
}

}  // namespace trundle

void bind_grid(nanobind::module_ &m) {
  namespace nb = nanobind;
  using Unlocked = nb::call_guard<nb::gil_scoped_release>;
  nb::class_<trundle::BinaryGrid>(m, "BinaryGrid")
      .def(nb::new_(&trundle::make_grid), nb::arg("blocked").noconvert(), nb::arg("connectivity"), nb::arg("method"))
      .def("find_path", &trundle::find_path, nb::arg("start").none(), nb::arg("goal").none(), nb::arg("seconds").none(),
           nb::arg("cancel").none())
      .def("find_point_path", &trundle::find_point_path, nb::arg("start").none(), nb::arg("goal").none(),
           nb::arg("seconds").none(), nb::arg("cancel").none())
      .def("find_paths", &trundle::find_paths, nb::arg("starts").noconvert(), nb::arg("goals").noconvert(),
           nb::arg("threads"), nb::arg("seconds").none(), nb::arg("cancel").none())
      .def("find_point_paths", &trundle::find_point_paths, nb::arg("starts").noconvert(), nb::arg("goals").noconvert(),
           nb::arg("threads"), nb::arg("seconds").none(), nb::arg("cancel").none())
      .def("settle_ends", &trundle::settle_ends, nb::arg("starts").noconvert(), nb::arg("goals").noconvert(),
           nb::arg("start_reach"), nb::arg("goal_reach"), nb::arg("partial"))
      .def("update", &trundle::update, nb::arg("row"), nb::arg("col"), nb::arg("values").noconvert())
      .def_prop_ro("method", &trundle::method_name, Unlocked())
      .def_prop_ro("clutter", &trundle::BinaryGrid::clutter, Unlocked())
      .def_prop_ro("bytes", &trundle::BinaryGrid::bytes, Unlocked());
  m.def("walk_corners", &trundle::walk_corners, nb::arg("corners").noconvert());
  m.def("grid_search", &trundle::grid_search, nb::arg("costs").noconvert(), nb::arg("weights").noconvert(),
        nb::arg("start"), nb::arg("goal"), nb::arg("connectivity") = 8,
        nb::arg("seconds") = nb::none(), nb::arg("cancel") = nb::none());
}
