// Runs of cells in rows, joined where they touch those of the row before (union-find; the smaller index wins, so that a
// component goes by the first of its runs).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

namespace trundle {

struct Run {
  std::int64_t row, begin, end;
};

class RunForest {
 public:
  std::size_t size() const { return parent_.size(); }

  std::int32_t root(std::int32_t index) {
    while (parent_[index] != index) index = parent_[index] = parent_[parent_[index]];
    return index;
  }

  // Add a run below others, which have the indices from `first` on. They and those added to one row go from left to
  // right; `above` skips, from one call to the next, what ends before. With a reach of 1, corners that touch count too.
  std::int32_t add(const Run &run, const Run *others, std::size_t count, std::size_t first, std::size_t &above,
                   std::int64_t reach) {
    if (parent_.size() >= 0x7ffffffe) throw std::length_error("too many runs of cells");
    const auto own = static_cast<std::int32_t>(parent_.size());
    parent_.push_back(own);
    while (above < count && others[above].end + reach <= run.begin) ++above;
    for (std::size_t i = above; i < count && others[i].begin < run.end + reach; ++i) {
      const std::int32_t a = root(static_cast<std::int32_t>(first + i)), b = root(own);
      parent_[std::max(a, b)] = std::min(a, b);
    }
    return own;
  }

 private:
  std::vector<std::int32_t> parent_;
};

}  // namespace trundle
