// Which free cells can be reached from each other, by the runs of free cells in the rows of a `BitGrid`.
//
// A diagonal step needs both cells beside it, so 4- and 8-connected cells have the same components.
#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "bit_grid.hpp"

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

class FreeRuns {
 public:
  // Labels the rows of a grid anew: runs that touch between rows are joined (union-find, the smaller index wins).
  void label(const BitGrid &grid) {
    rows_.assign(1, 0);
    rows_.reserve(static_cast<std::size_t>(grid.rows()) + 1);
    begins_.clear();
    parents_.clear();
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
        parents_.push_back(own);
        ends.push_back(end);
        while (above < first && ends_before[above - before] <= begin) ++above;
        for (std::size_t i = above; i < first && begins_[i] < end; ++i) join(static_cast<std::uint32_t>(i), own);
      });
      before = first;
      ends.swap(ends_before);
      rows_.push_back(begins_.size());
    }
    components_ = 0;
    for (std::size_t i = 0; i < parents_.size(); ++i) {
      components_ += parents_[i] == i;
      parents_[i] = parents_[parents_[i]];
    }
  }

  // The component of a free cell.
  std::uint32_t at(std::int32_t row, std::int32_t col) const {
    const auto first = begins_.begin() + static_cast<std::ptrdiff_t>(rows_[static_cast<std::size_t>(row)]);
    const auto end = begins_.begin() + static_cast<std::ptrdiff_t>(rows_[static_cast<std::size_t>(row) + 1]);
    return parents_[static_cast<std::size_t>(std::upper_bound(first, end, col) - begins_.begin()) - 1];
  }

  std::int64_t components() const { return components_; }

  std::size_t bytes() const {
    return rows_.capacity() * sizeof(std::size_t) + begins_.capacity() * sizeof(std::int32_t) +
           parents_.capacity() * sizeof(std::uint32_t);
  }

 private:
  std::uint32_t root(std::uint32_t run) {
    while (parents_[run] != run) {
      parents_[run] = parents_[parents_[run]];
      run = parents_[run];
    }
    return run;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

  std::vector<std::size_t> rows_;       // where the runs of each row begin, and the end of the last
  std::vector<std::int32_t> begins_;    // their first columns
  std::int64_t components_ = 0;
  std::vector<std::uint32_t> parents_;  // after labelling, the first run of the component
};

}  // namespace trundle
