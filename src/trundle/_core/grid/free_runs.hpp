// The connected components of a grid's free cells, by runs: which cells can be reached from each other.
//
// Idea: a run is a row's cells between two blocked ones. Runs that touch between rows are joined by union-find, where
// the smaller index wins, so that a scan of the rows labels the whole map. A cell's component is that of its run, found
// by binary search among the first columns of the row's runs. As a diagonal step needs both cells beside it, 4- and
// 8-connected cells have the same components.
//
// A change in a window leaves the other components as they are if it joins and parts nothing. That shows in the window
// and the cells around it alone (`patch`); else the map is labelled again.
//
// Invariant: `begins_` and `labels_` hold the runs of all rows in order; those of row r begin at `rows_[r]`.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "grid/bit_grid.hpp"
#include "grid/window_parts.hpp"
#include "shared/grid_steps.hpp"

namespace trundle {

// Calls `found(begin, end)` for every run of free cells of a row, from left to right.
template <typename Found>
void for_each_run(const BitGrid &grid, std::int64_t row, Found &&found) {
  bool in_run = false;
  std::int32_t begin = 0;
  for (std::size_t w = 0; w < grid.words(); ++w) {
    std::uint64_t rest = in_run ? grid.word(row, w) : ~grid.word(row, w);  // bits of what ends the run, or the gap
    const auto base = static_cast<std::int32_t>(w * 64);
    while (rest != 0) {
      const int bit = __builtin_ctzll(rest);
      if (in_run) {
        found(begin, base + bit);
      } else {
        begin = base + bit;
      }
      in_run = !in_run;
      rest = ~rest & (~std::uint64_t{0} << bit);
    }
  }
}

class FreeRuns {
 public:
  // Labels the whole grid.
  void label(const BitGrid &grid) {
    rows_.assign(1, 0);
    rows_.reserve(static_cast<std::size_t>(grid.rows()) + 1);
    begins_.clear();
    labels_.clear();
    std::vector<std::int32_t> ends, ends_above;
    std::size_t first_above = 0;
    for (std::int64_t row = 0; row < grid.rows(); ++row) {
      const std::size_t first = begins_.size();
      std::size_t above = first_above;
      ends.clear();
      for_each_run(grid, row, [&](std::int32_t begin, std::int32_t end) {
        const std::uint32_t run = add_run(begin);
        ends.push_back(end);
        while (above < first && ends_above[above - first_above] <= begin) ++above;
        for (std::size_t i = above; i < first && begins_[i] < end; ++i) join(static_cast<std::uint32_t>(i), run);
      });
      first_above = first;
      ends.swap(ends_above);
      rows_.push_back(begins_.size());
    }
    number_components();
  }

  // Takes over a change in a window if that has joined and parted nothing, and says whether it has. `before` are the
  // parts of the window grown by one cell, before the change.
  bool patch(const BitGrid &grid, const Window &changed, const std::vector<std::uint32_t> &before) {
    const Window around = changed.grown();
    const std::vector<std::uint32_t> after = parts_of(grid, around);
    const std::optional<std::vector<std::uint32_t>> labels = labels_of_parts(changed, before, after);
    if (!labels) return false;
    replace_rows(grid, changed, [&](std::int64_t row, std::int64_t col) { return (*labels)[after[around.index(row, col)]]; });
    return true;
  }

  // The component of a free cell.
  std::uint32_t at(std::int32_t row, std::int32_t col) const { return labels_[run_after(row, col) - 1]; }

  // The free cell nearest to one inside, at most `reach` away, of a component if `label` is given. Of those that are as
  // near it is the one of the lowest row, then column.
  std::optional<GridCell> nearest(const BitGrid &grid, GridCell to, const std::uint32_t *label, double reach) const {
    NearestCell nearest(to, reach);
    for (std::int64_t rows = 0; nearest.has_room(rows, 0) && (to.row >= rows || to.row + rows < grid.rows()); ++rows) {
      for (const std::int64_t row : {to.row - rows, to.row + rows}) {
        if (row >= 0 && row < grid.rows()) search_row(grid, static_cast<std::int32_t>(row), label, nearest);
      }
    }
    return nearest.best;
  }

  std::int64_t components() const { return components_; }

  std::size_t bytes() const {
    return rows_.capacity() * sizeof(std::size_t) + begins_.capacity() * sizeof(std::int32_t) +
           labels_.capacity() * sizeof(std::uint32_t);
  }

 private:
  // The nearest of the cells that are offered.
  struct NearestCell {
    const GridCell to;
    std::int64_t room;  // squared distance that is not exceeded
    std::optional<GridCell> best;

    NearestCell(GridCell cell, double reach)
        : to(cell), room(reach < 2e9 ? static_cast<std::int64_t>(reach * reach + 1e-6) : std::int64_t{1} << 62) {}

    bool has_room(std::int64_t rows, std::int64_t cols) const { return rows * rows + cols * cols <= room; }

    void offer(GridCell cell) {
      const std::int64_t rows = std::int64_t{cell.row} - to.row, cols = std::int64_t{cell.col} - to.col;
      const std::int64_t distance = rows * rows + cols * cols;
      if (distance > room) return;
      const bool ties = best && distance == room;
      if (ties && (cell.row != best->row ? cell.row > best->row : cell.col > best->col)) return;
      best = cell, room = distance;
    }
  };

  std::uint32_t add_run(std::int32_t begin) {
    if (begins_.size() >= 0xfffffffeu) throw std::length_error("too many runs of free cells");
    const auto run = static_cast<std::uint32_t>(begins_.size());
    begins_.push_back(begin);
    labels_.push_back(run);
    return run;
  }

  std::uint32_t root(std::uint32_t run) {
    while (labels_[run] != run) {
      labels_[run] = labels_[labels_[run]];
      run = labels_[run];
    }
    return run;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    labels_[std::max(a, b)] = std::min(a, b);
  }

  // From roots to numbers of components, in order: a run's root comes before it.
  void number_components() {
    components_ = 0;
    for (std::size_t i = 0; i < labels_.size(); ++i) {
      labels_[i] = labels_[i] == i ? static_cast<std::uint32_t>(components_++) : labels_[labels_[i]];
    }
  }

  // The row's first run that begins after a column.
  std::size_t run_after(std::int32_t row, std::int32_t col) const {
    const auto first = begins_.begin() + static_cast<std::ptrdiff_t>(rows_[static_cast<std::size_t>(row)]);
    const auto end = begins_.begin() + static_cast<std::ptrdiff_t>(rows_[static_cast<std::size_t>(row) + 1]);
    return static_cast<std::size_t>(std::upper_bound(first, end, col) - begins_.begin());
  }

  // Offers the nearest cell of a row to both sides.
  void search_row(const BitGrid &grid, std::int32_t row, const std::uint32_t *label, NearestCell &nearest) const {
    const std::int32_t col = nearest.to.col;
    const std::int64_t rows = std::int64_t{row} - nearest.to.row;
    const std::size_t first = rows_[static_cast<std::size_t>(row)], end = rows_[static_cast<std::size_t>(row) + 1];
    const std::size_t after = run_after(row, col);
    const auto counts = [&](std::size_t run) { return label == nullptr || labels_[run] == *label; };
    for (std::size_t run = after; run < end && nearest.has_room(rows, begins_[run] - col); ++run) {
      if (!counts(run)) continue;
      nearest.offer({row, begins_[run]});
      break;
    }
    for (std::size_t run = after; run-- > first;) {
      // This run ends before the next one begins, which is too far away.
      if (run + 1 < after && !nearest.has_room(rows, col - begins_[run + 1])) break;
      if (!counts(run)) continue;
      nearest.offer({row, std::min(col, grid.run_end(row, begins_[run]) - 1)});
      break;
    }
  }

  // The component of each part that a window and the cells around it have after a change; none where the change has
  // joined or parted components. The cells around tell: they keep their components, and each part before must be one
  // part now.
  std::optional<std::vector<std::uint32_t>> labels_of_parts(const Window &changed, const std::vector<std::uint32_t> &before,
                                                            const std::vector<std::uint32_t> &after) const {
    const Window around = changed.grown();
    std::vector<std::uint32_t> successors(after.size(), kNoPart), labels(after.size(), kNoPart);
    std::size_t cell = 0;
    for (std::int64_t row = around.row; row < around.row_end; ++row) {
      for (std::int64_t col = around.col; col < around.col_end; ++col, ++cell) {
        if (after[cell] == kNoPart || changed.contains(row, col)) continue;
        const std::uint32_t label = at(static_cast<std::int32_t>(row), static_cast<std::int32_t>(col));
        std::uint32_t &successor = successors[before[cell]], &known = labels[after[cell]];
        if (successor == kNoPart) successor = after[cell];
        if (known == kNoPart) known = label;
        if (successor != after[cell] || known != label) return std::nullopt;
      }
    }
    for (cell = 0; cell < after.size(); ++cell) {
      if (before[cell] != kNoPart && successors[before[cell]] == kNoPart) return std::nullopt;  // a component is gone
      if (after[cell] != kNoPart && labels[after[cell]] == kNoPart) return std::nullopt;        // a new one has come
    }
    return labels;
  }

  // Finds the runs of changed rows again; `label(row, col)` gives the component of a cell in the window.
  template <typename Label>
  void replace_rows(const BitGrid &grid, const Window &changed, Label &&label) {
    std::vector<std::int32_t> begins;
    std::vector<std::uint32_t> labels;
    std::vector<std::size_t> counts;  // of runs up to the end of each row
    for (std::int64_t row = changed.row; row < changed.row_end; ++row) {
      for_each_run(grid, row, [&](std::int32_t begin, std::int32_t end) {
        begins.push_back(begin);
        const std::int64_t inside = std::max<std::int64_t>(begin, changed.col);
        const bool touches = inside < std::min<std::int64_t>(end, changed.col_end);
        labels.push_back(touches ? label(row, inside) : at(static_cast<std::int32_t>(row), begin));
      });
      counts.push_back(begins.size());
    }
    const auto first = static_cast<std::size_t>(changed.row), end = static_cast<std::size_t>(changed.row_end);
    const std::size_t old_begin = rows_[first], old_end = rows_[end];
    replace(begins_, old_begin, old_end, begins);
    replace(labels_, old_begin, old_end, labels);
    for (std::size_t i = 0; i < counts.size(); ++i) rows_[first + i + 1] = old_begin + counts[i];
    const std::size_t new_end = rows_[end];
    if (new_end == old_end) return;
    for (std::size_t row = end + 1; row < rows_.size(); ++row) rows_[row] = rows_[row] + new_end - old_end;
  }

  // Replaces elements [begin, end) of a vector by others, of which there may be more or fewer.
  template <typename T>
  static void replace(std::vector<T> &all, std::size_t begin, std::size_t end, const std::vector<T> &others) {
    const auto overlap = static_cast<std::ptrdiff_t>(std::min(end - begin, others.size()));
    const auto from = all.begin() + static_cast<std::ptrdiff_t>(begin), middle = from + overlap;
    std::copy(others.begin(), others.begin() + overlap, from);
    if (others.size() > end - begin) {
      all.insert(middle, others.begin() + overlap, others.end());
    } else {
      all.erase(middle, all.begin() + static_cast<std::ptrdiff_t>(end));
    }
  }

  std::vector<std::size_t> rows_;      // the first run of each row, and the number of all
  std::vector<std::int32_t> begins_;   // first columns
  std::vector<std::uint32_t> labels_;  // components; while labelling, a run of the same component
  std::int64_t components_ = 0;
};

}  // namespace trundle
