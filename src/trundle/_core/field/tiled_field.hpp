// A cost field tile by tile, by one thread or several.
//
// A tile is taken from the open list, settled with what its neighbours offer, and offers them its new costs, until
// no tile is open (tile_queue.hpp, tile.hpp). Costs only fall, and the result is the one smallest fixed point of all
// steps, whatever the order: the same for any number of threads.
//
// The cells along the edges of a settled tile are kept: they are its neighbours' frames. All of its numbers are kept
// for a while. Where those are lost, the tile is settled again from its frame when that changes.
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
class TiledField {
 public:
  TiledField(const Grid<Cost> &grid, float *out, const SearchLimits &limits)
      : grid_(grid),
        limits_(limits),
        tile_rows_((grid.rows + kTile - 1) / kTile),
        tile_cols_((grid.cols + kTile - 1) / kTile),
        settle_(choose_settle<Cost, Number>()),
        out_(out),
        queue_(tile_rows_, tile_cols_),
        edges_(allocate<Edges<Number>>(static_cast<std::size_t>(tile_rows_ * tile_cols_))),
        slot_rows_(std::min(tile_rows_, kSlots)),
        slot_cols_(std::min(tile_cols_, kSlots)),
        slots_(static_cast<std::size_t>(slot_rows_ * slot_cols_)),
        kept_(allocate<Numbers>(slots_.size())) {
    unreached_.clear();
  }

  void add_goal(std::int64_t row, std::int64_t col) {
    const std::int64_t tile = row / kTile * tile_cols_ + col / kTile;
    goals_.push_back({tile, static_cast<std::int32_t>(row % kTile * kTile + col % kTile)});
    queue_.offer(tile, kLow, 0);
  }

  // Found, or why it was stopped. Then, and where the numbers do not fit, the result is of no use.
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

  // Whether the numbers hold every cost.
  bool fits() const { return fits_; }

 private:
  static constexpr Number kFar = Scale<Number>::kFar;

  struct Goal {
    std::int64_t tile;
    std::int32_t cell;
    bool operator<(const Goal &other) const { return tile < other.tile; }
  };

  // Where the numbers of a tile's cells are kept until it is taken again: by position, so that those of a wavefront
  // find room.
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

  // All threads run the same task, this one too; what one throws is thrown here.
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
    } catch (const std::system_error &) {  // no more threads to be had: fewer do the work
    }
    guarded();
    for (auto &other : others) other.join();
    if (failure) std::rethrow_exception(failure);
  }

  void settle_tiles() {
    try {
      settle_while_any_is_open();
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      failed_ = true;
      freed_.notify_all();
      throw;
    }
  }

  void settle_while_any_is_open() {
    const auto work = std::make_unique<Workspace<Cost, Number>>();
    std::unique_lock<std::mutex> lock(mutex_);
    while (status_ == SearchStatus::kFound && fits_ && !failed_) {
      const std::int64_t index = queue_.take();
      if (index < 0) {
        if (!queue_.any_busy()) break;
        freed_.wait(lock);
        continue;
      }
      const std::size_t slot = slot_of(index);
      const bool keep = !slots_[slot].busy;
      begin(index, keep ? kept_[slot].value : work->value, work->tile);
      if (keep) slots_[slot] = {index, true};
      lock.unlock();
      settle_({grid_, index / tile_cols_ * kTile, index % tile_cols_ * kTile}, out_, *work);
      const SearchStatus left = limits_.check();
      lock.lock();
      if (keep) slots_[slot].busy = false;
      if (left != SearchStatus::kFound) status_ = left;
      if (!all_fit(work->largest)) fits_ = false;
      queue_.settle(index, work->tile.offers);
      freed_.notify_all();
    }
    freed_.notify_all();
  }

  // Hands a tile what it needs to be settled.
  void begin(std::int64_t index, Number (*value)[kTile], Tile<Cost, Number> &tile) {
    const Slot &slot = slots_[slot_of(index)];
    tile.value = value;
    tile.is_kept = !slot.busy && slot.tile == index;
    tile.offering = queue_.take_offering(index);
    tile.edges = &edges_[index];
    for (int side = 0; side < kSides; ++side) {
      const std::int64_t other = queue_.neighbour(index, side);
      tile.neighbours[side] = other >= 0 && queue_.is_settled(other) ? &edges_[other] : &unreached_;
    }
    tile.goals.clear();
    if (tile.is_kept) return;
    auto goal = std::lower_bound(goals_.begin(), goals_.end(), Goal{index, 0});
    for (; goal != goals_.end() && goal->tile == index; ++goal) tile.goals.push_back(goal->cell);
  }

  // Tiles of a row of tiles that are not reached.
  void fill_unreached(std::int64_t row) {
    for (std::int64_t col = 0; col < tile_cols_; ++col) {
      if (queue_.is_settled(row * tile_cols_ + col)) continue;
      const std::int64_t x = col * kTile, wide = std::min<std::int64_t>(kTile, grid_.cols - x);
      for (std::int64_t y = row * kTile; y < std::min(row * kTile + kTile, grid_.rows); ++y) {
        std::fill_n(out_ + y * grid_.cols + x, wide, std::numeric_limits<float>::infinity());
      }
    }
  }

  const Grid<Cost> grid_;
  const SearchLimits limits_;
  const std::int64_t tile_rows_, tile_cols_;
  void (*const settle_)(const TileView<Cost> &, float *, Workspace<Cost, Number> &);
  float *const out_;
  TileQueue<Number> queue_;
  std::unique_ptr<Edges<Number>[], Freed> edges_;
  Edges<Number> unreached_;  // those of tiles not settled yet, and beyond the map
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
