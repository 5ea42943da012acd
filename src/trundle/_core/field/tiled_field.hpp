// A cost field tile by tile, by one thread or several.
//
// The result is the one smallest fixed point, whatever the order. Of a settled tile the cells along its edges are
// kept, which are its neighbours' frames, and for a while all of its numbers; where those are lost they are found
// again from its frame when that changes.
#pragma once

#include "field/result.hpp"
#include "field/tile_queue.hpp"
#include "shared/grid_steps.hpp"
#include "shared/map_memory.hpp"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

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
        turns_(tile_rows_, tile_cols_),
        edges_(allocate<Edges<Number>>(static_cast<std::size_t>(tile_rows_ * tile_cols_))),
        slot_rows_(std::min(tile_rows_, kSlots)),
        slot_cols_(std::min(tile_cols_, kSlots)),
        slots_(static_cast<std::size_t>(slot_rows_ * slot_cols_)),
        kept_(allocate<Numbers>(slots_.size())) {
    none_.clear();
  }

  void add_goal(std::int64_t row, std::int64_t col) {
    const std::int64_t tile = row / kTile * tile_cols_ + col / kTile;
    goals_.push_back({tile, static_cast<std::int32_t>(row % kTile * kTile + col % kTile)});
    turns_.wait(tile, kLow, 0);
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

  struct Numbers {
    alignas(64) Number value[kTile + 2][kTile];
  };

  std::size_t slot_of(std::int64_t tile) const {
    return static_cast<std::size_t>(tile / tile_cols_ % slot_rows_ * slot_cols_ + tile % tile_cols_ % slot_cols_);
  }

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
      const std::int64_t index = turns_.take();
      if (index < 0) {
        if (!turns_.any_busy()) break;
        freed_.wait(lock);
        continue;
      }
      const std::size_t slot = slot_of(index);
      const bool keep = !slots_[slot].busy;
      begin(index, keep ? kept_[slot].value : work->value, work->tile);
      if (keep) slots_[slot] = {index, true};
      lock.unlock();
      settle_({grid_, index / tile_cols_ * kTile, index % tile_cols_ * kTile}, out_, *work);
      const SearchStatus left = patience_.left();
      lock.lock();
      if (keep) slots_[slot].busy = false;
      if (left != SearchStatus::kFound) status_ = left;
      if (!all_fit(work->largest)) fits_ = false;
      turns_.end(index, work->tile.gain);
      freed_.notify_all();
    }
    freed_.notify_all();
  }

  // Hand a tile what it needs for its turn.
  void begin(std::int64_t index, Number (*value)[kTile], Tile<Cost, Number> &tile) {
    const Slot &slot = slots_[slot_of(index)];
    tile.value = value;
    tile.known = !slot.busy && slot.tile == index;
    tile.told = turns_.told(index);
    tile.edges = &edges_[index];
    for (int side = 0; side < kSides; ++side) {
      const std::int64_t other = turns_.beside(index, side);
      tile.beside[side] = other >= 0 && turns_.settled(other) ? &edges_[other] : &none_;
    }
    tile.goals.clear();
    if (tile.known) return;
    auto goal = std::lower_bound(goals_.begin(), goals_.end(), Goal{index, 0});
    for (; goal != goals_.end() && goal->tile == index; ++goal) tile.goals.push_back(goal->cell);
  }

  // Tiles of a row of them that no way reaches.
  void fill_unreached(std::int64_t row) {
    for (std::int64_t col = 0; col < tile_cols_; ++col) {
      if (turns_.settled(row * tile_cols_ + col)) continue;
      const std::int64_t x = col * kTile, wide = std::min<std::int64_t>(kTile, grid_.cols - x);
      for (std::int64_t y = row * kTile; y < std::min(row * kTile + kTile, grid_.rows); ++y) {
        std::fill_n(out_ + y * grid_.cols + x, wide, std::numeric_limits<float>::infinity());
      }
    }
  }

  const Grid<Cost> grid_;
  const Patience patience_;
  const std::int64_t tile_rows_, tile_cols_;
  void (*const settle_)(const Place<Cost> &, float *, Work<Cost, Number> &);
  float *const out_;
  Turns<Number> turns_;
  std::unique_ptr<Edges<Number>[], Freed> edges_;
  Edges<Number> none_;  // those of tiles that were not settled yet, and beyond the map
  std::vector<Goal> goals_;
  const std::int64_t slot_rows_, slot_cols_;
  std::vector<Slot> slots_;
  std::unique_ptr<Numbers[], Freed> kept_;
  std::mutex mutex_;
  std::condition_variable freed_;
  bool fits_ = true, failed_ = false;
  SearchStatus status_ = SearchStatus::kFound;
};

}  // namespace trundle
