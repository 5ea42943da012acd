// Flood fill, 4-connected, row span by row span: which unknown cells of a map can be reached.
#include "arrays.hpp"

#include <stdexcept>

namespace trundle {

using Cells = nb::ndarray<std::int8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

static constexpr std::int8_t kUnknown = -1, kFree = 0, kVisited = 1;

// Turn the `from` cells around `start` into `to`; return how many.
static std::int64_t flood(std::int8_t *cells, std::int64_t rows, std::int64_t cols, std::int64_t start,
                          std::int8_t from, std::int8_t to, std::vector<std::int64_t> &stack) {
  std::int64_t count = 0;
  stack.assign(1, start);
  while (!stack.empty()) {
    const std::int64_t index = stack.back();
    stack.pop_back();
    if (cells[index] != from) continue;
    const std::int64_t row = index / cols, begin = row * cols, end = begin + cols;
    std::int64_t left = index, right = index + 1;
    while (left > begin && cells[left - 1] == from) --left;
    while (right < end && cells[right] == from) ++right;
    for (std::int64_t i = left; i < right; ++i) cells[i] = to;
    count += right - left;
    for (const std::int64_t step : {-cols, cols}) {
      if (row + (step > 0 ? 1 : -1) < 0 || row + (step > 0 ? 1 : -1) >= rows) continue;
      bool inside = false;
      for (std::int64_t i = left + step; i < right + step; ++i) {
        const bool open = cells[i] == from;
        if (open && !inside) stack.push_back(i);
        inside = open;
      }
    }
  }
  return count;
}

// Unknown cells that are joined to a seed become free; return how many.
static std::int64_t flood_free(Cells cells, In<std::int64_t, 2> seeds) {
  const auto rows = static_cast<std::int64_t>(cells.shape(0)), cols = static_cast<std::int64_t>(cells.shape(1));
  if (seeds.shape(1) != 2) throw std::invalid_argument("seeds need shape (N, 2): row, col");
  for (std::size_t i = 0; i < seeds.shape(0); ++i)
    if (seeds(i, 0) < 0 || seeds(i, 0) >= rows || seeds(i, 1) < 0 || seeds(i, 1) >= cols)
      throw std::invalid_argument("a seed lies outside the grid");
  nb::gil_scoped_release released;
  std::vector<std::int64_t> stack;
  std::int64_t count = 0;
  for (std::size_t i = 0; i < seeds.shape(0); ++i)
    count += flood(cells.data(), rows, cols, seeds(i, 0) * cols + seeds(i, 1), kUnknown, kFree, stack);
  return count;
}

// The largest area of unknown cells becomes free; return how many, 0 where there is none.
static std::int64_t flood_largest(Cells cells) {
  const auto rows = static_cast<std::int64_t>(cells.shape(0)), cols = static_cast<std::int64_t>(cells.shape(1));
  nb::gil_scoped_release released;
  std::int8_t *data = cells.data();
  std::vector<std::int64_t> stack;
  std::int64_t largest = 0, seed = 0;
  for (std::int64_t i = 0; i < rows * cols; ++i) {
    if (data[i] != kUnknown) continue;
    const std::int64_t count = flood(data, rows, cols, i, kUnknown, kVisited, stack);
    if (count > largest) {
      largest = count;
      seed = i;
    }
  }
  if (largest > 0) flood(data, rows, cols, seed, kVisited, kFree, stack);
  for (std::int64_t i = 0; i < rows * cols; ++i)
    if (data[i] == kVisited) data[i] = kUnknown;
  return largest;
}

}  // namespace trundle

void bind_flood(nanobind::module_ &m) {
  m.def("flood_free", &trundle::flood_free, nanobind::arg("cells"), nanobind::arg("seeds"));
  m.def("flood_largest", &trundle::flood_largest, nanobind::arg("cells"));
}
