// Cost to go from every cell of a grid to the nearest of some goals: the exact shortest paths over the whole map.
//
// The map is cut into tiles. A tile is settled by sweeps from its neighbours' edges (field_tile.hpp); then each neighbour
// that could gain by it waits for its own turn, the one that gains the least cost first, as in Dijkstra's algorithm but
// with a tile for a cell. Tiles that do not touch are settled at the same time. The result is the one smallest fixed
// point, whatever the order.
#include "arrays.hpp"
#include "field_rows.hpp"
#include "patience.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <queue>
#include <system_error>
#include <thread>
#include <utility>

namespace trundle {

namespace {

template <typename Cost, typename Number>
class Field {
 public:
  Field(const Grid<Cost> &grid, Number *values, const Patience &patience)
      : grid_(grid),
        patience_(patience),
        tile_rows_((grid.rows + kTile - 1) / kTile),
        tile_cols_((grid.cols + kTile - 1) / kTile),
        settle_(choose_settle<Cost, Number>()),
        values_(values),
        states_(static_cast<std::size_t>(tile_rows_ * tile_cols_)) {
    std::fill_n(values, grid.rows * grid.cols, kFar);
  }

  void add_goal(std::int64_t row, std::int64_t col) {
    const std::int64_t tile = row / kTile * tile_cols_ + col / kTile;
    values_[row * grid_.cols + col] = 0;
    states_[tile].has_goal = true;
    wait(tile, 0);
  }

  // Whether it came to the end.
  SearchStatus solve(int threads) {
    run(threads, [this] {
      try {
        settle_tiles();
      } catch (...) {  // the others wait for a tile that nobody settles any more
        {
          const std::lock_guard<std::mutex> lock(mutex_);
          status_ = SearchStatus::kCancelled;
        }
        freed_.notify_all();
        throw;
      }
    });
    return status_;
  }

  // The costs to go as the caller counts them, infinity where there is no way, in `out`, which may be where the values
  // are; false if they do not fit the numbers.
  bool write(float *out, int threads) const {
    std::atomic<std::int64_t> next{0};
    std::atomic<bool> fits{true};
    const auto write_row = choose_write<Number>();
    run(threads, [&] {
      for (std::int64_t row = next++; row < grid_.rows; row = next++) {
        if (!all_fit(write_row(values_ + row * grid_.cols, grid_.cols, out + row * grid_.cols))) fits = false;
      }
    });
    return fits;
  }

 private:
  static constexpr int kFirst = Tile<Number>::kFirst;
  static constexpr Number kFar = Scale<Number>::kFar;

  struct State {
    Number waiting = kFar;  // the least cost that a neighbour brings; kFar where none waits
    bool has_goal = false, busy = false;
  };

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
  template <typename Work>
  static void run(int threads, Work work) {
    std::exception_ptr failure;
    std::mutex guard;
    const auto guarded = [&] {
      try {
        work();
      } catch (...) {
        const std::lock_guard<std::mutex> lock(guard);
        failure = std::current_exception();
      }
    };
    std::vector<std::thread> others;
    try {
      for (int n = 1; n < threads; ++n) others.emplace_back(guarded);
    } catch (const std::system_error &) {  // no more threads to be had: those that run do the work
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
    const auto tile = std::make_unique<Tile<Number>>();
    std::vector<Waiting> gains;
    std::unique_lock<std::mutex> lock(mutex_);
    while (status_ == SearchStatus::kFound) {
      const std::int64_t index = take();
      if (index < 0) {
        if (busy_ == 0) break;
        freed_.wait(lock);
        continue;
      }
      ++busy_;
      states_[index].busy = true;
      const std::int64_t likely = queue_.empty() ? index : queue_.top().second;
      lock.unlock();
      fetch_ahead(likely);
      gains.clear();
      settle_tile(index, *tile, gains);
      const SearchStatus left = patience_.left();
      lock.lock();
      if (left != SearchStatus::kFound) status_ = left;
      states_[index].busy = false;
      --busy_;
      for (const auto &[cost, neighbour] : gains) wait(neighbour, cost);
      freed_.notify_all();
    }
    freed_.notify_all();
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

  void settle_tile(std::int64_t index, Tile<Number> &tile, std::vector<Waiting> &gains) {
    const std::int64_t row = index / tile_cols_, col = index % tile_cols_;
    load_values(row * kTile, col * kTile, tile);
    const bool has_goal = std::exchange(states_[index].has_goal, false);
    settle_(grid_, row * kTile, col * kTile, tile, has_goal);
    Number before[4][kTile];  // what stands along the edges: low, high, left, right
    load_edges(row * kTile, col * kTile, before);
    if (has_goal) std::fill_n(&before[0][0], 4 * kTile, kFar);  // a goal at an edge stands there already, and is news
    const auto edge = [&](std::int64_t dr, std::int64_t dc, const typename Tile<Number>::Plane &plane, int at,
                          int frame, const Number *old) {
      if (has_tile(row + dr, col + dc)) gain_edge(index + dr * tile_cols_ + dc, plane, at, frame, old, gains);
    };
    edge(-1, 0, tile.upright, 1, 0, before[0]);
    edge(1, 0, tile.upright, kTile, kTile + 1, before[1]);
    edge(0, -1, tile.turned, 1, 0, before[2]);
    edge(0, 1, tile.turned, kTile, kTile + 1, before[3]);
    for (const int dr : {-1, 1}) {
      for (const int dc : {-1, 1}) {
        if (!has_tile(row + dr, col + dc)) continue;
        gain_corner(index + dr * tile_cols_ + dc, dr, dc, tile.upright, before[dr < 0 ? 0 : 1], gains);
      }
    }
    store_values(row * kTile, col * kTile, tile);
  }

  bool has_tile(std::int64_t row, std::int64_t col) const {
    return row >= 0 && row < tile_rows_ && col >= 0 && col < tile_cols_;
  }

  // The least cost that the cells beyond an edge get from those of the edge that changed.
  static void gain_edge(std::int64_t neighbour, const typename Tile<Number>::Plane &plane, int at, int frame,
                        const Number *before, std::vector<Waiting> &gains) {
    const Number *value = plane.value[at] + kFirst, *beyond = plane.value[frame] + kFirst;
    const Number *straight = plane.straight[at] + kFirst, *straight_beyond = plane.straight[frame] + kFirst;
    const Number *diagonal = plane.diagonal[at] + kFirst, *diagonal_beyond = plane.diagonal[frame] + kFirst;
    Number least = kFar;
    for (int k = 0; k < kTile; ++k) {
      if (!(value[k] < before[k])) continue;
      const Number ahead = value[k] + straight[k] + straight_beyond[k];
      if (ahead < beyond[k]) least = std::min(least, ahead);
      for (int side = k > 0 ? k - 1 : k + 1; side <= k + 1 && side < kTile; side += 2) {
        const Number aside = value[k] + diagonal[k] + diagonal_beyond[side];
        if (aside < beyond[side]) least = std::min(least, aside);
      }
    }
    if (least < kFar) gains.push_back({least, neighbour});
  }

  static void gain_corner(std::int64_t neighbour, int dr, int dc, const typename Tile<Number>::Plane &plane,
                          const Number *before, std::vector<Waiting> &gains) {
    const int row = dr < 0 ? 1 : kTile, col = dc < 0 ? 0 : kTile - 1;
    const Number value = plane.value[row][kFirst + col];
    if (!(value < before[col])) return;
    const Number beyond = value + plane.diagonal[row][kFirst + col] + plane.diagonal[row + dr][kFirst + col + dc];
    if (beyond < plane.value[row + dr][kFirst + col + dc] && beyond < kFar) gains.push_back({beyond, neighbour});
  }

  // A tile's rows lie far apart: ask for those of the next one while this one is settled.
  void fetch_ahead(std::int64_t index) const {
    const std::int64_t y = index / tile_cols_ * kTile, x = index % tile_cols_ * kTile;
    const std::int64_t last = std::min(x + kTile, grid_.cols - 1);
    for (std::int64_t r = std::max<std::int64_t>(y - 1, 0); r < std::min(y + kTile + 1, grid_.rows); ++r) {
      __builtin_prefetch(grid_.costs + r * grid_.cols + x);
      __builtin_prefetch(grid_.costs + r * grid_.cols + last);
      for (std::int64_t c = x; c < last; c += 64 / static_cast<std::int64_t>(sizeof(Number))) {
        __builtin_prefetch(values_ + r * grid_.cols + c);
      }
    }
  }

  // Own cells and the frame; kFar outside the grid.
  void load_values(std::int64_t y, std::int64_t x, Tile<Number> &tile) const {
    for (int r = -1; r <= kTile; ++r) {
      Number *value = tile.upright.value[1 + r] + kFirst;
      if (y + r < 0 || y + r >= grid_.rows) {
        std::fill(value - 1, value + kTile + 1, kFar);
        continue;
      }
      const Number *from = values_ + (y + r) * grid_.cols + x;
      value[-1] = x > 0 ? from[-1] : kFar;
      value[kTile] = x + kTile < grid_.cols ? from[kTile] : kFar;
      if (x + kTile <= grid_.cols) {
        std::memcpy(value, from, sizeof(Number) * kTile);  // of a size known here, so without a call
      } else {
        std::fill(std::copy(from, from + (grid_.cols - x), value), value + kTile, kFar);
      }
    }
  }

  void store_values(std::int64_t y, std::int64_t x, const Tile<Number> &tile) {
    const auto wide = std::min<std::int64_t>(kTile, grid_.cols - x), high = std::min<std::int64_t>(kTile, grid_.rows - y);
    for (std::int64_t r = 0; r < high; ++r) {
      const Number *from = tile.upright.value[1 + r] + kFirst;
      Number *to = values_ + (y + r) * grid_.cols + x;
      if (wide == kTile) {
        std::memcpy(to, from, sizeof(Number) * kTile);
      } else {
        std::copy_n(from, wide, to);
      }
    }
  }

  void load_edges(std::int64_t y, std::int64_t x, Number (&edges)[4][kTile]) const {
    for (int k = 0; k < kTile; ++k) {
      edges[0][k] = at(y, x + k);
      edges[1][k] = at(y + kTile - 1, x + k);
      edges[2][k] = at(y + k, x);
      edges[3][k] = at(y + k, x + kTile - 1);
    }
  }

  Number at(std::int64_t y, std::int64_t x) const {
    return y < grid_.rows && x < grid_.cols ? values_[y * grid_.cols + x] : kFar;
  }

  const Grid<Cost> grid_;
  const Patience patience_;
  const std::int64_t tile_rows_, tile_cols_;
  void (*const settle_)(const Grid<Cost> &, std::int64_t, std::int64_t, Tile<Number> &, bool);
  Number *const values_;
  std::vector<State> states_;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<Waiting>> queue_;
  std::mutex mutex_;
  std::condition_variable freed_;
  int busy_ = 0;
  SearchStatus status_ = SearchStatus::kFound;
};

// What a field is computed for, and within which limits.
struct Task {
  In<std::int64_t, 2> goals;
  int threads;
  Patience patience;
};

// The costs to go in `out`, which may be where the values are; `fits` is whether the numbers hold them.
template <typename Cost, typename Number>
SearchStatus solve(const Grid<Cost> &grid, const Task &task, Number *values, float *out, bool &fits) {
  Field<Cost, Number> field(grid, values, task.patience);
  for (std::size_t k = 0; k < task.goals.shape(0); ++k) field.add_goal(task.goals(k, 0), task.goals(k, 1));
  const SearchStatus status = field.solve(task.threads);
  if (status == SearchStatus::kFound) fits = field.write(out, task.threads);
  return status;
}

template <typename Number, typename Cost>
SearchStatus solve_wide(const Grid<Cost> &grid, const Task &task, float *out) {
  const auto values = allocate<Number>(static_cast<std::size_t>(grid.rows * grid.cols));
  bool fits;
  return solve<Cost, Number>(grid, task, values.get(), out, fits);
}

}  // namespace

// A `SearchStatus` and, where it is found, the field.
template <typename Cost>
static nb::tuple cost_field(In<Cost, 2> costs, In<std::int64_t, 2> goals, int connectivity, int threads,
                            std::optional<double> seconds, const Flag &cancel) {
  const auto rows = static_cast<std::int64_t>(costs.shape(0)), cols = static_cast<std::int64_t>(costs.shape(1));
  if (goals.shape(1) != 2) throw nb::value_error("goals need shape (N, 2): row, col");
  if (connectivity != 4 && connectivity != 8) throw nb::value_error("connectivity is 4 or 8");
  if (threads < 1 || threads > 1024) throw nb::value_error("threads must be from 1 to 1024");
  for (std::size_t k = 0; k < goals.shape(0); ++k) {
    const std::int64_t row = goals(k, 0), col = goals(k, 1);
    if (row < 0 || row >= rows || col < 0 || col >= cols) throw nb::index_error("a goal lies outside the grid");
    if (is_wall(costs(row, col))) throw nb::value_error("a goal lies in a wall");
  }
  const Task task{goals, threads, patience_of(seconds, cancel)};
  auto out = allocate<float>(static_cast<std::size_t>(rows * cols));
  SearchStatus status;
  {
    nb::gil_scoped_release release;
    const Grid<Cost> grid{costs.data(), rows, cols, connectivity == 8};
    if constexpr (std::is_floating_point_v<Cost>) {
      status = solve_wide<double>(grid, task, out.get());
    } else {
      // Counted where the result will stand: both have 32 bits.
      auto *values = new (out.get()) std::uint32_t[static_cast<std::size_t>(rows * cols)];
      bool fits = true;
      status = solve<Cost, std::uint32_t>(grid, task, values, out.get(), fits);
      if (!fits) status = solve_wide<std::uint64_t>(grid, task, out.get());
    }
  }
  const int code = static_cast<int>(status);
  if (status != SearchStatus::kFound) return nb::make_tuple(code, nb::none());
  float *field = out.release();
  nb::capsule owner(field, [](void *p) noexcept { std::free(p); });
  return nb::make_tuple(code, nb::ndarray<nb::numpy, float>(field, {costs.shape(0), costs.shape(1)}, owner));
}

}  // namespace trundle

void bind_cost_field(nanobind::module_ &m) {
  namespace nb = nanobind;
  const auto bind = [&m](auto function) {
    m.def("cost_field", function, nb::arg("costs").noconvert(), nb::arg("goals").noconvert(),
          nb::arg("connectivity"), nb::arg("threads"), nb::arg("seconds").none(), nb::arg("cancel").none());
  };
  bind(&trundle::cost_field<std::uint8_t>);
  bind(&trundle::cost_field<std::uint16_t>);
  bind(&trundle::cost_field<float>);
}
