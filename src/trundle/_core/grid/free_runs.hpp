// Which free cells can be reached from each other, by the runs of free cells in the rows of a `BitGrid`.
//
// A diagonal step needs both cells beside it, so 4- and 8-connected cells have the same components.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "grid/bit_grid.hpp"
#include "shared/grid_steps.hpp"

namespace trundle {

// Call `found(begin, end)` for every run of free cells of a row, from left to right.
template <typename Found>
void for_each_run(const BitGrid &grid, std::int64_t row, Found &&found) {
  bool open = false;
  std::int32_t begin = 0;
  for (std::size_t w = 0; w < grid.words(); ++w) {
    std::uint64_t rest = open ? grid.word(row, w) : ~grid.word(row, w);  // bits of what ends the run, or the gap
    const auto base = static_cast<std::int32_t>(w * 64);
    while (rest != 0) {
      const int bit = __builtin_ctzll(rest);
      if (open) {
        found(begin, base + bit);
      } else {
        begin = base + bit;
      }
      open = !open;
      rest = ~rest & (~std::uint64_t{0} << bit);
    }
  }
}

// Rows and columns [first, end) of a grid.
struct Window {
  std::int64_t row, row_end, col, col_end;
  Window grown() const { return {row - 1, row_end + 1, col - 1, col_end + 1}; }
  std::int64_t cols() const { return col_end - col; }
  std::size_t area() const { return static_cast<std::size_t>((row_end - row) * cols()); }
  bool holds(std::int64_t r, std::int64_t c) const { return r >= row && r < row_end && c >= col && c < col_end; }
};

// Which free cells of a window are joined within it: for each cell, row by row, the first of its part; and for a blocked
// one, or outside the grid, `kNoPart`.
constexpr std::uint32_t kNoPart = ~std::uint32_t{0};

inline std::vector<std::uint32_t> parts_of(const BitGrid &grid, const Window &window) {
  std::vector<std::uint32_t> parts(window.area(), kNoPart);
  const auto root = [&](std::uint32_t cell) {
    while (parts[cell] != cell) cell = parts[cell] = parts[parts[cell]];
    return cell;
  };
  const auto cols = static_cast<std::uint32_t>(window.cols());
  std::uint32_t cell = 0;
  for (std::int64_t row = window.row; row < window.row_end; ++row) {
    for (std::int64_t col = window.col; col < window.col_end; ++col, ++cell) {
      if (grid.blocked(static_cast<std::int32_t>(row), static_cast<std::int32_t>(col))) continue;
      parts[cell] = cell;
      if (col > window.col && parts[cell - 1] != kNoPart) parts[cell] = root(cell - 1);
      if (row == window.row || parts[cell - cols] == kNoPart) continue;
      const std::uint32_t a = root(cell), b = root(cell - cols);
      parts[std::max(a, b)] = std::min(a, b);
    }
  }
  for (cell = 0; cell < parts.size(); ++cell) {
    if (parts[cell] != kNoPart) parts[cell] = parts[parts[cell]];
  }
  return parts;
}

class FreeRuns {
 public:
  // Labels the rows of a grid anew: runs that touch between rows are joined (union-find, the smaller index wins).
  void label(const BitGrid &grid) {
    rows_.assign(1, 0);
    rows_.reserve(static_cast<std::size_t>(grid.rows()) + 1);
    begins_.clear();
    labels_.clear();
    std::vector<std::int32_t> ends, ends_before;
    std::size_t before = 0;  // the first run of the row before
    for (std::int64_t row = 0; row < grid.rows(); ++row) {
      const std::size_t first = begins_.size();
      std::size_t above = before;
      ends.clear();
      for_each_run(grid, row, [&](std::int32_t begin, std::int32_t end) {
        if (begins_.size() >= 0xfffffffeu) throw std::length_error("too many runs of free cells");
        const auto own = static_cast<std::uint32_t>(begins_.size());
        begins_.push_back(begin);
        labels_.push_back(own);
        ends.push_back(end);
        while (above < first && ends_before[above - before] <= begin) ++above;
        for (std::size_t i = above; i < first && begins_[i] < end; ++i) join(static_cast<std::uint32_t>(i), own);
      });
      before = first;
      ends.swap(ends_before);
      rows_.push_back(begins_.size());
    }
    components_ = 0;
    for (std::size_t i = 0; i < labels_.size(); ++i) {
      labels_[i] = labels_[i] == i ? static_cast<std::uint32_t>(components_++) : labels_[labels_[i]];
    }
  }

  // Takes over what changed in a rectangle of the grid, if that has parted and joined nothing, and says whether it could.
  // `before` are the parts of the rectangle grown by one cell, before the change: if the cells around it that were joined
  // there still are, the rest of the map need not be looked at.
  bool patch(const BitGrid &grid, const Window &changed, const std::vector<std::uint32_t> &before) {
    const Window around = changed.grown();
    const std::vector<std::uint32_t> after = parts_of(grid, around);
    std::vector<std::uint32_t> successors(after.size(), kNoPart), labels(after.size(), kNoPart);
    std::size_t cell = 0;
    for (std::int64_t row = around.row; row < around.row_end; ++row) {
      for (std::int64_t col = around.col; col < around.col_end; ++col, ++cell) {
        if (after[cell] == kNoPart || changed.holds(row, col)) continue;
        const std::uint32_t label = at(static_cast<std::int32_t>(row), static_cast<std::int32_t>(col));
        std::uint32_t &successor = successors[before[cell]], &known = labels[after[cell]];
        if (successor == kNoPart) successor = after[cell];
        if (known == kNoPart) known = label;
        if (successor != after[cell] || known != label) return false;
      }
    }
    cell = 0;
    for (std::int64_t row = around.row; row < around.row_end; ++row) {
      for (std::int64_t col = around.col; col < around.col_end; ++col, ++cell) {
        if (before[cell] != kNoPart && successors[before[cell]] == kNoPart) return false;  // a component within is gone
        if (after[cell] != kNoPart && labels[after[cell]] == kNoPart) return false;        // and here is a new one
      }
    }
    replace_rows(grid, changed, [&](std::int64_t row, std::int64_t col) {
      return labels[after[static_cast<std::size_t>((row - around.row) * around.cols() + col - around.col)]];
    });
    return true;
  }

  // The component of a free cell.
  std::uint32_t at(std::int32_t row, std::int32_t col) const {
    const auto first = begins_.begin() + static_cast<std::ptrdiff_t>(rows_[static_cast<std::size_t>(row)]);
    const auto end = begins_.begin() + static_cast<std::ptrdiff_t>(rows_[static_cast<std::size_t>(row) + 1]);
    return labels_[static_cast<std::size_t>(std::upper_bound(first, end, col) - begins_.begin()) - 1];
  }

  // The free cell with the least straight distance to one inside, at most `reach`, of a component if it is given; of those
  // that are as near the one of the lowest row, then column.
  std::optional<GridCell> nearest(const BitGrid &grid, GridCell to, const std::uint32_t *label, double reach) const {
    constexpr std::int64_t kFurthest = std::int64_t{1} << 62;
    std::optional<GridCell> best;
    std::int64_t room = reach < 2e9 ? static_cast<std::int64_t>(reach * reach + 1e-6) : kFurthest;  // squared
    const auto consider = [&](std::int64_t row, std::int32_t col) {
      const std::int64_t up = row - to.row, across = std::int64_t{col} - to.col, distance = up * up + across * across;
      if (distance > room) return;
      const auto r = static_cast<std::int32_t>(row);
      if (best && distance == room && (r != best->row ? r > best->row : col > best->col)) return;
      best = {r, col}, room = distance;
    };
    for (std::int64_t up = 0; up * up <= room && (to.row >= up || to.row + up < grid.rows()); ++up) {
      for (const std::int64_t row : {to.row - up, to.row + up}) {
        if (row < 0 || row >= grid.rows()) continue;
        const auto within = [&](std::int64_t across) { return up * up + across * across <= room; };
        const std::size_t first = rows_[static_cast<std::size_t>(row)], end = rows_[static_cast<std::size_t>(row) + 1];
        const auto begins = begins_.begin();
        const auto after = static_cast<std::size_t>(
            std::upper_bound(begins + static_cast<std::ptrdiff_t>(first), begins + static_cast<std::ptrdiff_t>(end), to.col) -
            begins);
        const auto is_one = [&](std::size_t run) { return label == nullptr || labels_[run] == *label; };
        for (std::size_t run = after; run < end && within(begins_[run] - to.col); ++run) {
          if (!is_one(run)) continue;
          consider(row, begins_[run]);
          break;
        }
        for (std::size_t run = after; run-- > first;) {
          if (run + 1 < after && !within(to.col - begins_[run + 1])) break;
          if (!is_one(run)) continue;
          consider(row, std::min(to.col, grid.run_end(row, begins_[run]) - 1));
          break;
        }
      }
    }
    return best;
  }

  std::int64_t components() const { return components_; }

  std::size_t bytes() const {
    return rows_.capacity() * sizeof(std::size_t) + begins_.capacity() * sizeof(std::int32_t) +
           labels_.capacity() * sizeof(std::uint32_t);
  }

 private:
  // The runs of changed rows anew; `label(row, col)` is for cells of the rectangle.
  template <typename Label>
  void replace_rows(const BitGrid &grid, const Window &changed, Label &&label) {
    std::vector<std::int32_t> begins;
    std::vector<std::uint32_t> labels;
    const auto first = static_cast<std::size_t>(changed.row), end = static_cast<std::size_t>(changed.row_end);
    std::vector<std::size_t> counts;
    for (std::int64_t row = changed.row; row < changed.row_end; ++row) {
      for_each_run(grid, row, [&](std::int32_t run, std::int32_t run_end) {
        begins.push_back(run);
        const std::int64_t inside = std::max<std::int64_t>(run, changed.col);
        const bool touches = inside < std::min<std::int64_t>(run_end, changed.col_end);
        labels.push_back(touches ? label(row, inside) : at(static_cast<std::int32_t>(row), run));
      });
      counts.push_back(begins.size());
    }
    const std::size_t old_begin = rows_[first], old_end = rows_[end];
    const auto splice = [&](auto &all, const auto &fresh) {
      const std::size_t kept = std::min(old_end - old_begin, fresh.size());
      const auto from = all.begin() + static_cast<std::ptrdiff_t>(old_begin);
      const auto middle = fresh.begin() + static_cast<std::ptrdiff_t>(kept);
      std::copy(fresh.begin(), middle, from);
      if (middle != fresh.end()) {
        all.insert(from + static_cast<std::ptrdiff_t>(kept), middle, fresh.end());
      } else {
        all.erase(from + static_cast<std::ptrdiff_t>(kept), all.begin() + static_cast<std::ptrdiff_t>(old_end));
      }
    };
    splice(begins_, begins);
    splice(labels_, labels);
    for (std::size_t i = 0; i < counts.size(); ++i) rows_[first + i + 1] = old_begin + counts[i];
    const std::size_t new_end = rows_[end];
    if (new_end == old_end) return;
    for (std::size_t row = end + 1; row < rows_.size(); ++row) rows_[row] = rows_[row] + new_end - old_end;
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

  std::vector<std::size_t> rows_;       // where the runs of each row begin, and the end of the last
  std::vector<std::int32_t> begins_;    // their first columns
  std::int64_t components_ = 0;
  std::vector<std::uint32_t> labels_;  // their components; while labelling, a run of the same component
};

}  // namespace trundle
