// A* over the cells of a binary grid, for maps so cluttered that jumps are short, and for 4-connected paths.
//
// The queue is Dial's (1969), its buckets narrower than the cheapest step and read last in, first out. Within a bucket
// the order is not exact; a cell that is reached more cheaply later is opened again. Of paths with the same steps in
// another order only the one with the diagonal steps first (4-connected: the vertical ones) is followed, as in jump
// point search.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

#include "grid/bit_grid.hpp"
#include "shared/grid_steps.hpp"

namespace trundle {

// Which steps each cell allows, a bit for each direction.
class StepMasks {
 public:
  explicit StepMasks(const BitGrid &rows)
      : cols_(rows.cols()), masks_(static_cast<std::size_t>(rows.rows() * rows.cols()), 0) {
    fill(rows, 0, rows.rows());
  }

  // Computes the masks of rows [first, end) again.
  void fill(const BitGrid &rows, std::int64_t first, std::int64_t end) {
    for (std::int64_t row = std::max<std::int64_t>(first, 1); row < std::min(end, rows.rows() - 1); ++row) {
      Bits before, own = free_bits(rows, row, 0);
      for (std::size_t w = 0; w < rows.words(); ++w) {
        const Bits after = w + 1 < rows.words() ? free_bits(rows, row, w + 1) : Bits{};
        const std::uint64_t east = own.mid >> 1 | after.mid << 63, west = own.mid << 1 | before.mid >> 63;
        std::uint64_t planes[8] = {own.mid & east, 0, own.mid & own.high, 0, own.mid & west, 0, own.mid & own.low, 0};
        planes[1] = planes[0] & planes[2] & (own.high >> 1 | after.high << 63);
        planes[3] = planes[2] & planes[4] & (own.high << 1 | before.high >> 63);
        planes[5] = planes[4] & planes[6] & (own.low << 1 | before.low >> 63);
        planes[7] = planes[6] & planes[0] & (own.low >> 1 | after.low << 63);
        put(planes, row, static_cast<std::int64_t>(w) * 64);
        before = own, own = after;
      }
    }
  }

  std::int64_t cols() const { return cols_; }
  std::size_t size() const { return masks_.size(); }
  std::uint8_t operator[](std::size_t index) const { return masks_[index]; }

 private:
  // Free cells of a row and the two beside it.
  struct Bits {
    std::uint64_t low = 0, mid = 0, high = 0;
  };
  static Bits free_bits(const BitGrid &rows, std::int64_t row, std::size_t w) {
    return {~rows.word(row - 1, w), ~rows.word(row, w), ~rows.word(row + 1, w)};
  }

  // From a word of 64 cells for each direction to a byte of directions for each cell.
  void put(const std::uint64_t (&planes)[8], std::int64_t row, std::int64_t col) {
    for (int shift = 0; shift < 64 && col < cols_; shift += 8, col += 8) {
      std::uint64_t square = 0;
      for (int k = 0; k < 8; ++k) square |= (planes[k] >> shift & 0xff) << (8 * k);
      for (const auto &[distance, mask] : {std::pair{7, 0x00aa00aa00aa00aaULL}, std::pair{14, 0x0000cccc0000ccccULL},
                                           std::pair{28, 0x00000000f0f0f0f0ULL}}) {
        const std::uint64_t change = (square ^ square >> distance) & mask;
        square ^= change ^ change << distance;
      }
      std::uint8_t *target = masks_.data() + row * cols_ + col;
      for (std::int64_t i = 0; i < std::min<std::int64_t>(8, cols_ - col); ++i) {
        target[i] = static_cast<std::uint8_t>(square >> (8 * i));
      }
    }
  }

  std::int64_t cols_;
  std::vector<std::uint8_t> masks_;
};

// By the direction of arrival and the mask of a cell: the steps worth taking. A step that leads no farther than a path
// past the cell is not, unless that path is blocked.
inline std::array<std::array<std::uint8_t, 256>, 9> onward_steps(int connectivity) {
  std::array<std::array<std::uint8_t, 256>, 9> table{};
  const auto bit = [](int direction) { return 1u << (direction & 7); };
  for (int arrival = 0; arrival < 9; ++arrival) {
    for (unsigned mask = 0; mask < 256; ++mask) {
      const bool all_sides = connectivity == 8 ? arrival % 2 == 1 : arrival % 4 == 2;
      unsigned onward = bit(arrival);
      if (arrival == kFromNowhere) {
        onward = 0xff;
      } else if (all_sides) {
        onward |= bit(arrival - 1) | bit(arrival + 1) | (connectivity == 4 ? bit(arrival - 2) | bit(arrival + 2) : 0);
      } else {
        if ((mask & bit(arrival + 2)) && !(mask & bit(arrival + 3))) onward |= bit(arrival + 1) | bit(arrival + 2);
        if ((mask & bit(arrival - 2)) && !(mask & bit(arrival - 3))) onward |= bit(arrival - 1) | bit(arrival - 2);
      }
      table[static_cast<std::size_t>(arrival)][mask] =
          static_cast<std::uint8_t>(onward & mask & (connectivity == 4 ? 0x55u : 0xffu));
    }
  }
  return table;
}

// A search's cost of every cell, cleared at once: the number of the search above 48 bits, and below them what the
// cost from the start leaves of 2⁴⁸ - 1. So more is newer or cheaper, and memory that was never written is neither.
class CellCosts {
 public:
  CellCosts() = default;
  ~CellCosts() { std::free(data_); }
  CellCosts(const CellCosts &) = delete;
  CellCosts &operator=(const CellCosts &) = delete;

  // Begins a search on a map of `cells` cells.
  void begin(std::size_t cells) {
    if (cells != cells_) {
      std::free(std::exchange(data_, nullptr));
      cells_ = 0, search_ = 0;
      data_ = static_cast<std::uint64_t *>(std::calloc(cells, sizeof(std::uint64_t)));
      if (data_ == nullptr) throw std::bad_alloc();
      cells_ = cells;
    }
    if (++search_ == 1 << 16) {
      std::fill(data_, data_ + cells_, 0);
      search_ = 1;
    }
  }
  std::uint64_t known_as(std::uint64_t cost) const { return search_ << 48 | (kMost - cost); }
  std::uint64_t &operator[](std::size_t index) { return data_[index]; }
  std::size_t bytes() const { return cells_ * sizeof(std::uint64_t); }

 private:
  static constexpr std::uint64_t kMost = (std::uint64_t{1} << 48) - 1;
  std::uint64_t *data_ = nullptr;
  std::size_t cells_ = 0;
  std::uint64_t search_ = 0;
};

struct BucketEntry {
  std::uint64_t known;  // as the cell had it when this was put in
  GridCell cell;
  std::int32_t arrival;
};

// Memory of one bucket search, kept for the next.
struct BucketMemory {
  std::size_t bytes() const {
    std::size_t sum = costs.bytes();
    for (const auto &bucket : buckets) sum += bucket.capacity() * sizeof(BucketEntry);
    return sum;
  }

  CellCosts costs;
  std::array<std::vector<BucketEntry>, 8> buckets;
};

// Start and goal are free and joined. The path is the octile or Manhattan optimum.
inline GridPath bucket_search(const StepMasks &masks, int connectivity, GridCell start, GridCell goal,
                             const SearchLimits &limits, BucketMemory &memory) {
  static const std::array<std::array<std::array<std::uint8_t, 256>, 9>, 2> kOnward{onward_steps(4), onward_steps(8)};
  const auto &onward = kOnward[connectivity == 8];
  constexpr int kShift = 12;  // a step costs at least 5741, and changes the total by 2 · 8119 at most: 4 buckets
  constexpr std::uint32_t kPoll = 4096;
  const std::int64_t cols = masks.cols();
  const auto index = [cols](GridCell cell) { return static_cast<std::size_t>(cell.row * cols + cell.col); };
  const auto estimate = [&](GridCell cell) {
    const std::int64_t rows_left = cell.row - goal.row, cols_left = cell.col - goal.col;
    return connectivity == 8 ? octile_cost(rows_left, cols_left) : manhattan_cost(rows_left, cols_left);
  };
  GridPath path;
  CellCosts &costs = memory.costs;
  costs.begin(masks.size());
  for (auto &bucket : memory.buckets) bucket.clear();
  const std::uint64_t first = costs.known_as(0);
  costs[index(start)] = first;
  std::uint64_t best = start == goal ? 0 : ~std::uint64_t{0};
  const std::uint64_t least = estimate(start);
  memory.buckets[(least >> kShift) & 7].push_back({first, start, kFromNowhere});
  std::uint32_t expansions = 0;
  std::size_t waiting = 1;
  for (std::uint64_t bucket = least >> kShift; waiting > 0 && bucket <= best >> kShift; ++bucket) {
    auto &entries = memory.buckets[bucket & 7];
    while (!entries.empty()) {
      if (expansions++ % kPoll == 0) {
        path.status = limits.check();
        if (path.status != SearchStatus::kFound) return path;
      }
      const BucketEntry entry = entries.back();
      entries.pop_back();
      --waiting;
      const std::size_t here = index(entry.cell);
      if (costs[here] != entry.known) continue;  // reached more cheaply since
      const std::uint64_t reached = first - entry.known;
      for (unsigned left = onward[static_cast<std::size_t>(entry.arrival)][masks[here]]; left != 0; left &= left - 1) {
        const int k = __builtin_ctz(left);
        const GridCell cell{entry.cell.row + kStepRow[k], entry.cell.col + kStepCol[k]};
        const std::uint64_t step = k % 2 == 0 ? kStraightCost : kDiagonalCost, known = entry.known - step;
        std::uint64_t &before = costs[index(cell)];
        if (before >= known) continue;
        const std::uint64_t total = reached + step + estimate(cell);
        if (total >= best) continue;
        before = known;
        if (cell == goal) {
          best = total;
        } else {
          memory.buckets[(total >> kShift) & 7].push_back({known, cell, k});
          ++waiting;
        }
      }
    }
  }
  path.status = best == ~std::uint64_t{0} ? SearchStatus::kUnreachable : SearchStatus::kFound;
  if (path.status != SearchStatus::kFound) return path;
  path.add(goal);
  GridCell cell = goal;
  for (int last = 0; !(cell == start);) {  // backwards, straight on where that is as good
    const std::size_t here = index(cell);
    const unsigned mask = masks[here] & (connectivity == 4 ? 0x55u : 0xffu);
    for (int n = 0; n < 8; ++n) {
      const int k = (last + n) & 7;
      const GridCell before{cell.row + kStepRow[k], cell.col + kStepCol[k]};
      if (!(mask >> k & 1)) continue;
      if (costs[index(before)] == costs[here] + (k % 2 == 0 ? kStraightCost : kDiagonalCost)) {
        cell = before, last = k;
        break;
      }
    }
    path.add(cell);
  }
  std::reverse(path.corners.begin(), path.corners.end());
  return path;
}

}  // namespace trundle
