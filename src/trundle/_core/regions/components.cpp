// Connected components of a mask, and narrow gaps in it.
#include "regions/kernels.hpp"
#include "regions/runs.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace trundle {

namespace {

constexpr std::size_t kColumns = 5;  // cells, first row, end row, first column, end column

}  // namespace

nb::tuple label_components(In<std::uint8_t, 2> mask, bool diagonal) {
  const auto rows = static_cast<std::int64_t>(mask.shape(0)), cols = static_cast<std::int64_t>(mask.shape(1));
  std::vector<std::int32_t> labels;
  std::vector<std::int64_t> table;
  {
    nb::gil_scoped_release released;
    labels.assign(static_cast<std::size_t>(rows * cols), 0);
    const std::uint8_t *data = mask.data();
    std::vector<Run> runs;
    RunForest forest;
    const std::int64_t reach = diagonal ? 1 : 0;
    std::size_t before = 0;
    for (std::int64_t row = 0; row < rows; ++row) {
      const std::uint8_t *line = data + row * cols;
      const std::size_t first = runs.size();
      std::size_t above = 0;
      for (std::int64_t col = 0; col < cols;) {
        if (!line[col]) {
          ++col;
          continue;
        }
        const std::int64_t begin = col;
        while (col < cols && line[col]) ++col;
        const Run run{row, begin, col};
        forest.add(run, runs.data() + before, first - before, before, above, reach);
        runs.push_back(run);
      }
      before = first;
    }
    std::vector<std::int32_t> number(runs.size(), 0);
    std::int32_t count = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const std::int32_t root = forest.root(static_cast<std::int32_t>(i));
      const Run &run = runs[i];
      if (number[root] == 0) {
        number[root] = ++count;
        table.insert(table.end(), {0, run.row, run.row + 1, run.begin, run.end});
      }
      const std::int32_t own = number[root];
      std::int64_t *stats = table.data() + (own - 1) * kColumns;
      stats[0] += run.end - run.begin;
      stats[2] = run.row + 1;
      stats[3] = std::min(stats[3], run.begin);
      stats[4] = std::max(stats[4], run.end);
      std::fill(labels.begin() + run.row * cols + run.begin, labels.begin() + run.row * cols + run.end, own);
    }
  }
  const std::size_t count = table.size() / kColumns;
  return nb::make_tuple(to_numpy(std::move(labels), {mask.shape(0), mask.shape(1)}),
                        to_numpy(std::move(table), {count, kColumns}));
}

namespace {

// Runs of open cells along parallel lines of a grid, met cell by cell.
struct Lines {
  std::int64_t stride;   // from one cell of a line to the next
  std::int64_t longest;  // a run of more cells is not marked
  std::vector<std::int32_t> lengths;

  void end(std::size_t line, std::int64_t last, std::uint8_t *marks) {
    const std::int32_t length = lengths[line];
    lengths[line] = 0;
    if (length == 0 || length > longest) return;
    for (std::int64_t i = 0; i < length; ++i) marks[last - i * stride] = 1;
  }
};

}  // namespace

nb::ndarray<nb::numpy, std::uint8_t> mark_gaps(In<std::uint8_t, 2> blocked, double limit) {
  const auto rows = static_cast<std::int64_t>(blocked.shape(0)), cols = static_cast<std::int64_t>(blocked.shape(1));
  if (!(limit >= 0.0 && limit <= 1e6)) throw std::invalid_argument("limit must be from 0 to 1e6 cells");
  std::vector<std::uint8_t> marks;
  if (rows > 0 && cols > 0) {
    nb::gil_scoped_release released;
    marks.assign(static_cast<std::size_t>(rows * cols), 0);
    const std::uint8_t *data = blocked.data();
    const auto straight = static_cast<std::int64_t>(std::ceil(limit)) - 1;
    const auto slanted = static_cast<std::int64_t>(std::ceil(limit / std::sqrt(2.0))) - 1;
    const auto slants = static_cast<std::size_t>(rows + cols);
    Lines across{1, straight, std::vector<std::int32_t>(1, 0)};
    Lines down{cols, straight, std::vector<std::int32_t>(static_cast<std::size_t>(cols), 0)};
    Lines falling{cols + 1, slanted, std::vector<std::int32_t>(slants, 0)};
    Lines rising{cols - 1, slanted, std::vector<std::int32_t>(slants, 0)};
    for (std::int64_t row = 0; row < rows; ++row) {
      for (std::int64_t col = 0; col < cols; ++col) {
        const std::int64_t index = row * cols + col;
        const auto column = static_cast<std::size_t>(col);
        const auto fall = static_cast<std::size_t>(col - row + rows), rise = static_cast<std::size_t>(col + row);
        if (data[index]) {
          across.end(0, index - across.stride, marks.data());
          down.end(column, index - down.stride, marks.data());
          falling.end(fall, index - falling.stride, marks.data());
          rising.end(rise, index - rising.stride, marks.data());
          continue;
        }
        ++across.lengths[0];
        ++down.lengths[column];
        ++falling.lengths[fall];
        ++rising.lengths[rise];
        const bool bottom = row + 1 == rows;
        if (col + 1 == cols) across.end(0, index, marks.data());
        if (bottom) down.end(column, index, marks.data());
        if (bottom || col + 1 == cols) falling.end(fall, index, marks.data());
        if (bottom || col == 0) rising.end(rise, index, marks.data());
      }
    }
  }
  return to_numpy(std::move(marks), {blocked.shape(0), blocked.shape(1)});
}

}  // namespace trundle
