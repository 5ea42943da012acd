// A cost field tile by tile: which one is settled next, and by which thread.
//
// Each neighbour that could gain by a settled tile waits for its turn, the one that gains the least cost first, as in
// Dijkstra's algorithm but with a tile for a cell. Tiles that do not touch are settled at the same time. The result
// is the one smallest fixed point, whatever the order. Of a settled tile the cells along its edges are kept, which
// are its neighbours' frames; what lies within is found again from its own frame where that changes.
#pragma once

#include "field_rows.hpp"
#include "grid_steps.hpp"
#include "map_memory.hpp"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <queue>
#include <system_error>
#include <thread>
#include <vector>

namespace trundle {

template <typename Cost, typename Number>
class Field {
 public:
  Field(const Grid<Cost> &grid, float *out, const Patience &patience)
      : grid_(grid),
        patience_(patience),
        tile_rows_((grid.rows + kTile - 1) / kTile),
        tile_cols_((grid.cols + kTile - 1) / kTile),
        settle_(choose_settle<Cost, Number>()),
        out_(out),
        states_(static_cast<std::size_t>(tile_rows_ * tile_cols_)),
        edges_(static_cast<std::size_t>(tile_rows_ * tile_cols_)),
        slot_rows_(std::min(tile_rows_, kSlots)),
        slot_cols_(std::min(tile_cols_, kSlots)),
        slots_(static_cast<std::size_t>(slot_rows_ * slot_cols_)),
        kept_(allocate<Number>(slots_.size() * kTile * kTile)) {}

  void add_goal(std::int64_t row, std::int64_t col) {
    const std::int64_t tile = row / kTile * tile_cols_ + col / kTile;
    goals_.push_back({tile, static_cast<std::int32_t>(row % kTile * kTile + col % kTile)});
    states_[tile].has_goal = true;
    wait(tile, 0);
  }

  // Whether it came to the end. What is in the result else, or where the numbers did not fit, is of no use.
  SearchStatus solve(int threads) {
    std::sort(goals_.begin(), goals_.end());
    threads = static_cast<int>(std::min<std::int64_t>(threads, tile_rows_ * tile_cols_));
    run(threads, [this] { settle_tiles(); });
    if (status_ == SearchStatus::kFound && fits_) {
      std::atomic<std::int64_t> next{0};
      run(threads, [&] {
        for (std::int64_t row = next++; row < tile_rows_; row = next++) fill_unreached(row);
      });
    }
    return status_;
  }

  // Whether every way was small enough for the numbers.
  bool fits() const { return fits_; }

 private:
  static constexpr Number kFar = Scale<Number>::kFar;

  struct State {
    Number waiting = kFar;  // the least cost that a neighbour brings; kFar where none waits
    bool has_goal = false, busy = false, settled = false;
  };

  struct Edges {
    Number low[kTile], high[kTile], left[kTile], right[kTile];
    Edges() {
      for (Number *side : {low, high, left, right}) std::fill_n(side, kTile, kFar);
    }
  };

  struct Goal {
    std::int64_t tile;
    std::int32_t cell;
    bool operator<(const Goal &other) const { return tile < other.tile; }
  };

  // Where the numbers of a tile's cells are kept for its next turn: by place, so that those of a front find room.
  struct Slot {
    std::int64_t tile = -1;
    bool busy = false;
  };
  static constexpr std::int64_t kSlots = 32;  // along each side of the map

  std::size_t slot_of(std::int64_t tile) const {
    return static_cast<std::size_t>(tile / tile_cols_ % slot_rows_ * slot_cols_ + tile % tile_cols_ % slot_cols_);
  }

  using Waiting = std::pair<Number, std::int64_t>;

  // Whether one more step of the largest kind from any cell would still count as reachable.
  static bool all_fit(Number largest) {
    if constexpr (std::is_integral_v<Number>) {
      constexpr Number step = 2 * Scale<Number>::kDiagonal * static_cast<Number>(std::numeric_limits<Cost>::max());
      return largest < kFar - step;
    } else {
      return true;
    }
  }

  // All threads do the same work, this one too; what one throws is thrown here.
  template <typename Task>
  static void run(int threads, Task task) {
    std::exception_ptr failure;
    std::mutex guard;
    const auto guarded = [&] {
      try {
        task();
      } catch (...) {
        const std::lock_guard<std::mutex> lock(guard);
        failure = std::current_exception();
      }
    };
    std::vector<std::thread> others;
    try {
      for (int n = 1; n < threads; ++n) others.emplace_back(guarded);
    } catch (const std::system_error &) {  // no more to be had: those that there are do the work
    }
    guarded();
    for (auto &other : others) other.join();
    if (failure) std::rethrow_exception(failure);
  }

  void wait(std::int64_t tile, Number cost) {
    if (cost >= states_[tile].waiting && states_[tile].waiting != kFar) return;
    states_[tile].waiting = cost;
    queue_.push({cost, tile});
  }

  void settle_tiles() {
    try {
      settle_while_any_waits();
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      failed_ = true;
      freed_.notify_all();
      throw;
    }
  }

  void settle_while_any_waits() {
    const auto work = std::make_unique<Work<Cost, Number>>();
    std::unique_lock<std::mutex> lock(mutex_);
    while (status_ == SearchStatus::kFound && fits_ && !failed_) {
      const std::int64_t index = take();
      if (index < 0) {
        if (busy_ == 0) break;
        freed_.wait(lock);
        continue;
      }
      Slot &slot = slots_[slot_of(index)];
      const bool keep = begin(index, slot, *work);
      const std::int64_t likely = queue_.empty() ? index : queue_.top().second;
      lock.unlock();
      fetch_ahead(likely);
      settle_tile(index, *work);
      const SearchStatus left = patience_.left();
      lock.lock();
      --busy_;
      states_[index].busy = false;
      if (keep) slot.busy = false;
      if (left != SearchStatus::kFound) status_ = left;
      if (!all_fit(work->largest)) fits_ = false;
      tell_neighbours(index, work->gains);
      freed_.notify_all();
    }
    freed_.notify_all();
  }

  // Take a tile's turn; whether its slot is free to keep its numbers in.
  bool begin(std::int64_t index, Slot &slot, Work<Cost, Number> &work) {
    ++busy_;
    states_[index].busy = states_[index].settled = true;
    const bool keep = !slot.busy;
    work.kept = keep ? kept_.get() + (&slot - slots_.data()) * kTile * kTile : nullptr;
    work.known = keep && slot.tile == index;
    if (keep) slot = {index, true};
    return keep;
  }

  void tell_neighbours(std::int64_t index, const typename Tile<Number>::Gains &gains) {
    const auto tell = [&](std::int64_t tile, Number cost) {
      if (cost < kFar) wait(tile, cost);
    };
    tell(index - tile_cols_, gains.low);
    tell(index + tile_cols_, gains.high);
    tell(index - 1, gains.left);
    tell(index + 1, gains.right);
    for (int corner = 0; corner < 4; ++corner) {
      tell(index + (corner < 2 ? -tile_cols_ : tile_cols_) + (corner % 2 == 0 ? -1 : 1), gains.corner[corner]);
    }
  }

  // The next tile whose neighbours are all at rest, or −1.
  std::int64_t take() {
    std::vector<Waiting> held;
    std::int64_t found = -1;
    while (!queue_.empty() && found < 0) {
      const Waiting first = queue_.top();
      queue_.pop();
      if (states_[first.second].waiting != first.first) continue;  // it had its turn since, or waits for less
      if (busy_ > 0 && beside_busy(first.second)) {
        held.push_back(first);
      } else {
        found = first.second;
        states_[found].waiting = kFar;
      }
    }
    for (const auto &one : held) queue_.push(one);
    return found;
  }

  bool beside_busy(std::int64_t tile) const {
    const std::int64_t row = tile / tile_cols_, col = tile % tile_cols_;
    for (std::int64_t r = std::max<std::int64_t>(row - 1, 0); r <= std::min(row + 1, tile_rows_ - 1); ++r) {
      for (std::int64_t c = std::max<std::int64_t>(col - 1, 0); c <= std::min(col + 1, tile_cols_ - 1); ++c) {
        if (states_[r * tile_cols_ + c].busy) return true;
      }
    }
    return false;
  }

  void settle_tile(std::int64_t index, Work<Cost, Number> &work) {
    const std::int64_t row = index / tile_cols_, col = index % tile_cols_;
    load_frame(row, col, work.tile);
    work.goals.clear();
    if (states_[index].has_goal && !work.known) {
      auto goal = std::lower_bound(goals_.begin(), goals_.end(), Goal{index, 0});
      for (; goal != goals_.end() && goal->tile == index; ++goal) work.goals.push_back(goal->cell);
    }
    settle_({grid_, row * kTile, col * kTile, out_}, work);
    Edges &own = edges_[index];
    std::copy_n(work.tile.upright.value[1], kTile, own.low);
    std::copy_n(work.tile.upright.value[kTile], kTile, own.high);
    std::copy_n(work.tile.turned.value[1], kTile, own.left);
    std::copy_n(work.tile.turned.value[kTile], kTile, own.right);
  }

  void load_frame(std::int64_t row, std::int64_t col, Tile<Number> &tile) const {
    static const Edges kNone;
    const auto edges = [&](std::int64_t r, std::int64_t c) -> const Edges & {
      return r >= 0 && r < tile_rows_ && c >= 0 && c < tile_cols_ ? edges_[r * tile_cols_ + c] : kNone;
    };
    std::copy_n(edges(row - 1, col).high, kTile, tile.upright.value[0]);
    std::copy_n(edges(row + 1, col).low, kTile, tile.upright.value[kTile + 1]);
    std::copy_n(edges(row, col - 1).right, kTile, tile.turned.value[0]);
    std::copy_n(edges(row, col + 1).left, kTile, tile.turned.value[kTile + 1]);
    tile.corner_value[0] = edges(row - 1, col - 1).high[kTile - 1];
    tile.corner_value[1] = edges(row - 1, col + 1).high[0];
    tile.corner_value[2] = edges(row + 1, col - 1).low[kTile - 1];
    tile.corner_value[3] = edges(row + 1, col + 1).low[0];
  }

  // A tile's rows lie far apart: ask for those of the next one while this one is settled.
  void fetch_ahead(std::int64_t index) const {
    const std::int64_t y = index / tile_cols_ * kTile, x = index % tile_cols_ * kTile;
    const std::int64_t last = std::min(x + kTile, grid_.cols - 1);
    for (std::int64_t r = std::max<std::int64_t>(y - 1, 0); r < std::min(y + kTile + 1, grid_.rows); ++r) {
      __builtin_prefetch(grid_.costs + r * grid_.cols + x);
      __builtin_prefetch(grid_.costs + r * grid_.cols + last);
      __builtin_prefetch(out_ + r * grid_.cols + x, 1);
      __builtin_prefetch(out_ + r * grid_.cols + x + 16, 1);
    }
  }

  // Tiles of a row of them that no way reaches.
  void fill_unreached(std::int64_t row) {
    for (std::int64_t col = 0; col < tile_cols_; ++col) {
      if (states_[row * tile_cols_ + col].settled) continue;
      const std::int64_t x = col * kTile, wide = std::min<std::int64_t>(kTile, grid_.cols - x);
      for (std::int64_t y = row * kTile; y < std::min(row * kTile + kTile, grid_.rows); ++y) {
        std::fill_n(out_ + y * grid_.cols + x, wide, std::numeric_limits<float>::infinity());
      }
    }
  }

  const Grid<Cost> grid_;
  const Patience patience_;
  const std::int64_t tile_rows_, tile_cols_;
  void (*const settle_)(const Place<Cost> &, Work<Cost, Number> &);
  float *const out_;
  std::vector<State> states_;
  std::vector<Edges> edges_;
  std::vector<Goal> goals_;
  const std::int64_t slot_rows_, slot_cols_;
  std::vector<Slot> slots_;
  std::unique_ptr<Number[], Freed> kept_;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<Waiting>> queue_;
  std::mutex mutex_;
  std::condition_variable freed_;
  int busy_ = 0;
  bool fits_ = true, failed_ = false;
  SearchStatus status_ = SearchStatus::kFound;
};

}  // namespace trundle
