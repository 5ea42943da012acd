// A* on a grid whose cells have a weight each, with whole numbers and a bucket queue.
//
// A step between neighbours costs (weight a + weight b) · length, with 70 for a straight and 99 for a diagonal length
// (99/70 = √2 to 5e-5), so that a path costs the same in both directions. Diagonals need both cells beside them.
// The queue is Dial's (1969), its buckets as wide as the cheapest step and read last in, first out. Within a bucket the
// order is not exact; a cell that is reached more cheaply later is opened again, and the search ends once the goal's
// bucket is empty, so the result is the optimum all the same.
#include "grid/kernels.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <new>

namespace trundle {

namespace {

constexpr int kStraight = 70;
constexpr int kDiagonal = 99;

struct Grid {
  const std::uint8_t *costs;
  const std::uint16_t *weights;  // by cost, 256 entries, 0 where a cell is blocked
  std::int64_t rows, cols;
  int connectivity;
  std::uint32_t weight(std::int64_t index) const { return weights[costs[index]]; }
};

struct Cell {
  std::int32_t row, col;
};

// In this order a neighbour k < 4 is straight, and a diagonal k lies between the straight ones k - 4 and k - 3.
constexpr int kRow[8] = {0, 1, 0, -1, 1, 1, -1, -1};
constexpr int kCol[8] = {1, 0, -1, 0, 1, -1, -1, 1};

// The neighbours whose best path may lead through a cell that was reached by a step k: those behind it and beside it are
// reached more cheaply from the cell before, whatever the weights are. The last row is for the start.
constexpr int kOnward[9][8] = {{0, 1, 3, 4, 7, -1},    {0, 1, 2, 4, 5, -1}, {1, 2, 3, 5, 6, -1},
                               {0, 2, 3, 6, 7, -1},    {0, 1, 4, 5, 7, -1}, {1, 2, 4, 5, 6, -1},
                               {2, 3, 5, 6, 7, -1},    {0, 3, 4, 6, 7, -1}, {0, 1, 2, 3, 4, 5, 6, 7}};
constexpr int kFromNowhere = 8;

// Weights of the eight neighbours: 0 where one is blocked, outside, or behind a corner.
inline void neighbours(const Grid &grid, Cell cell, std::int64_t index, std::uint32_t (&weights)[8]) {
  const bool up = cell.row + 1 < grid.rows, down = cell.row > 0;
  const bool right = cell.col + 1 < grid.cols, left = cell.col > 0;
  weights[0] = right ? grid.weight(index + 1) : 0;
  weights[1] = up ? grid.weight(index + grid.cols) : 0;
  weights[2] = left ? grid.weight(index - 1) : 0;
  weights[3] = down ? grid.weight(index - grid.cols) : 0;
  if (grid.connectivity == 4) {
    weights[4] = weights[5] = weights[6] = weights[7] = 0;
    return;
  }
  weights[4] = weights[0] && weights[1] ? grid.weight(index + grid.cols + 1) : 0;
  weights[5] = weights[1] && weights[2] ? grid.weight(index + grid.cols - 1) : 0;
  weights[6] = weights[2] && weights[3] ? grid.weight(index - grid.cols - 1) : 0;
  weights[7] = weights[3] && weights[0] ? grid.weight(index - grid.cols + 1) : 0;
}

// Memory that reads as 0 and costs nothing until it is touched.
template <typename T>
struct Zeroed {
  T *data;
  explicit Zeroed(std::size_t count) : data(static_cast<T *>(std::calloc(count, sizeof(T)))) {
    if (data == nullptr) throw std::bad_alloc();
  }
  ~Zeroed() { std::free(data); }
  Zeroed(const Zeroed &) = delete;
  Zeroed &operator=(const Zeroed &) = delete;
};

enum class Status { kFound, kNone, kOverflow, kStopped };

template <typename Cost>
class Search {
 public:
  Search(const Grid &grid, Cell start, Cell goal)
      : grid_(grid), start_(start), goal_(goal), reached_(static_cast<std::size_t>(grid.rows * grid.cols)) {
    lowest_ = std::numeric_limits<std::uint16_t>::max();
    for (int cost = 0; cost < 256; ++cost) {
      if (grid.weights[cost] > 0) lowest_ = std::min<std::uint32_t>(lowest_, grid.weights[cost]);
      highest_ = std::max<std::uint32_t>(highest_, grid.weights[cost]);
    }
    while ((2u * lowest_ * kStraight) >> (shift_ + 1)) ++shift_;
    std::size_t span = ((2u * highest_ * kDiagonal + 2u * lowest_ * kDiagonal) >> shift_) + 2, size = 4;
    while (size < span) size *= 2;
    buckets_.resize(size);
    for (int k = 0; k < 8; ++k) offset_[k] = kRow[k] * grid.cols + kCol[k];
  }

  Status run(const SearchLimits &limits) {
    std::uint64_t expanded = 0;
    const std::uint64_t room = std::numeric_limits<Cost>::max() / 2;
    const std::uint64_t first = estimate(start_);
    if (first >= room) return Status::kOverflow;
    const std::int64_t target = index(goal_);
    push(first, {0, start_, kFromNowhere});
    reached_.data[index(start_)] = 1;
    for (std::uint64_t bucket = first >> shift_; open_count_ > 0; ++bucket) {
      const Cost found = reached_.data[target];
      if (found != 0 && bucket > ((found - 1) >> shift_)) break;
      auto &entries = buckets_[bucket & (buckets_.size() - 1)];
      while (!entries.empty()) {
        const Entry entry = entries.back();
        entries.pop_back();
        --open_count_;
        if (++expanded % 4096 == 0 && limits.check() != SearchStatus::kFound) return Status::kStopped;
        if (!expand(entry, target, room)) return Status::kOverflow;
      }
    }
    return reached_.data[target] != 0 ? Status::kFound : Status::kNone;
  }

  Cost cost() const { return reached_.data[index(goal_)] - 1; }

  // Cells from start to goal; among paths of equal cost one that goes straight on where it can.
  std::vector<std::int32_t> path() const {
    std::vector<std::int32_t> cells;
    Cell cell = goal_;
    int last = 0;
    while (true) {
      cells.push_back(cell.col);  // col before row: the reversal below turns both round
      cells.push_back(cell.row);
      const std::int64_t here = index(cell);
      const Cost reached = reached_.data[here];
      if (reached == 1) break;
      const std::uint32_t own = grid_.weight(here);
      std::uint32_t weights[8];
      neighbours(grid_, cell, here, weights);
      for (int n = 0; n < 8; ++n) {
        const int k = (last + n) & 7;
        const std::int64_t before = here + kRow[k] * grid_.cols + kCol[k];
        if (weights[k] == 0) continue;
        const Cost other = reached_.data[before];
        if (other != 0 && other + step(own, weights[k], k) == reached) {
          cell = {cell.row + kRow[k], cell.col + kCol[k]};
          last = k;
          break;
        }
      }
    }
    std::reverse(cells.begin(), cells.end());
    return cells;
  }

 private:
  struct Entry {
    Cost reached;
    Cell cell;
    std::int32_t from;  // the step that led here
  };

  std::int64_t index(Cell cell) const { return cell.row * grid_.cols + cell.col; }

  static Cost step(std::uint32_t a, std::uint32_t b, int k) { return (a + b) * (k < 4 ? kStraight : kDiagonal); }

  // The least that the rest of the path can cost: octile or Manhattan distance at the smallest weight.
  std::uint64_t estimate(Cell cell) const {
    const std::uint64_t across = std::abs(cell.col - goal_.col), along = std::abs(cell.row - goal_.row);
    if (grid_.connectivity == 4) return 2u * lowest_ * kStraight * (across + along);
    const std::uint64_t longer = std::max(across, along), shorter = std::min(across, along);
    return 2u * lowest_ * (kStraight * (longer - shorter) + kDiagonal * shorter);
  }

  void push(std::uint64_t total, const Entry &entry) {
    buckets_[(total >> shift_) & (buckets_.size() - 1)].push_back(entry);
    ++open_count_;
  }

  bool expand(const Entry &entry, std::int64_t target, std::uint64_t room) {
    const std::int64_t here = index(entry.cell);
    if (reached_.data[here] != entry.reached + 1) return true;  // reached more cheaply since
    const std::uint32_t own = grid_.weight(here);
    std::uint32_t weights[8];
    neighbours(grid_, entry.cell, here, weights);
    const int *onward = kOnward[entry.from];
    for (int n = 0; n < 8 && onward[n] >= 0; ++n) {
      const int k = onward[n];
      if (weights[k] == 0) continue;
      const Cost reached = entry.reached + step(own, weights[k], k);
      const std::int64_t there = here + offset_[k];
      Cost &known = reached_.data[there];
      if (known != 0 && known <= reached + 1) continue;
      const Cell cell{entry.cell.row + kRow[k], entry.cell.col + kCol[k]};
      const std::uint64_t total = reached + estimate(cell);
      if (total >= room) return false;
      const Cost found = reached_.data[target];
      if (found != 0 && total >= found && there != target) continue;
      known = reached + 1;
      push(total, {reached, cell, k});
    }
    return true;
  }

  const Grid grid_;
  const Cell start_, goal_;
  Zeroed<Cost> reached_;  // cost from the start plus 1, or 0
  std::vector<std::vector<Entry>> buckets_;
  std::size_t open_count_ = 0;
  std::uint32_t lowest_ = 0, highest_ = 0;
  int shift_ = 0;
  std::int64_t offset_[8];
};

struct Answer {
  std::vector<std::int32_t> cells;
  double cost = 0.0;
};

template <typename Cost>
Status solve(const Grid &grid, Cell start, Cell goal, const SearchLimits &limits, Answer &answer) {
  Search<Cost> search(grid, start, goal);
  const Status status = search.run(limits);
  if (status == Status::kFound) {
    answer.cells = search.path();
    answer.cost = static_cast<double>(search.cost()) / (2.0 * kStraight);
  }
  if (status == Status::kStopped) answer.cost = std::numeric_limits<double>::quiet_NaN();
  return status;
}

}  // namespace

nb::tuple grid_search(In<std::uint8_t, 2> costs, In<std::uint16_t, 1> weights, std::pair<int, int> start,
                      std::pair<int, int> goal, int connectivity, std::optional<double> seconds, const Flag &cancel) {
  const auto rows = static_cast<std::int64_t>(costs.shape(0)), cols = static_cast<std::int64_t>(costs.shape(1));
  if (weights.size() != 256) throw nb::value_error("the weights need one entry for each of the 256 costs");
  if (connectivity != 4 && connectivity != 8) throw nb::value_error("connectivity is 4 or 8");
  for (const auto &cell : {start, goal}) {
    if (cell.first < 0 || cell.first >= rows || cell.second < 0 || cell.second >= cols) {
      throw nb::index_error("start or goal lies outside the grid");
    }
  }
  Answer answer;
  const CallLimits limits(seconds, cancel);
  {
    nb::gil_scoped_release release;
    const Grid grid{costs.data(), weights.data(), rows, cols, connectivity};
    const Cell from{start.first, start.second}, to{goal.first, goal.second};
    const bool open = grid.weight(from.row * cols + from.col) > 0 && grid.weight(to.row * cols + to.col) > 0;
    if (open && solve<std::uint32_t>(grid, from, to, limits, answer) == Status::kOverflow) {
      solve<std::uint64_t>(grid, from, to, limits, answer);
    }
  }
  limits.rethrow();
  const std::size_t count = answer.cells.size() / 2;
  return nb::make_tuple(to_numpy(std::move(answer.cells), {count, 2}), answer.cost);
}

}  // namespace trundle
