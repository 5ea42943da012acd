// Steps on a grid: their directions, and what they cost in whole numbers.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <thread>
#include <vector>

namespace trundle {

struct GridCell {
  std::int32_t row, col;
  bool operator==(const GridCell &other) const { return row == other.row && col == other.col; }
  std::uint64_t key() const {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(row)) << 32 | static_cast<std::uint32_t>(col);
  }
};

// 8119 / 5741 = √2 to 1e-8. Costs have 48 bits or more: no path on a map of 2³² cells costs that much.
constexpr std::uint64_t kStraightCost = 5741, kDiagonalCost = 8119;

// Directions by growing angle: E, NE, N, NW, W, SW, S, SE, with rows growing to the north. Even ones are straight.
constexpr int kStepRow[8] = {0, 1, 1, 1, 0, -1, -1, -1};
constexpr int kStepCol[8] = {1, 1, 0, -1, -1, -1, 0, 1};
constexpr int kFromNowhere = 8;

inline std::uint64_t octile_cost(std::int64_t rows, std::int64_t cols) {
  const auto a = static_cast<std::uint64_t>(std::abs(rows)), b = static_cast<std::uint64_t>(std::abs(cols));
  return a < b ? (b - a) * kStraightCost + a * kDiagonalCost : (a - b) * kStraightCost + b * kDiagonalCost;
}

// The least that a path between two cells costs on a map without obstacles.
inline std::uint64_t octile_cost(GridCell a, GridCell b) { return octile_cost(a.row - b.row, a.col - b.col); }

inline std::uint64_t manhattan_cost(std::int64_t rows, std::int64_t cols) {
  return static_cast<std::uint64_t>(std::abs(rows) + std::abs(cols)) * kStraightCost;
}

enum class SearchStatus { kFound, kUnreachable, kTimeout, kCancelled };

// A question that the thread which made this asks now and then while it searches; once it is true, it stays so for all.
class Interrupt {
 public:
  explicit Interrupt(bool (*ask)()) : ask_(ask) {}
  Interrupt(const Interrupt &) = delete;
  Interrupt &operator=(const Interrupt &) = delete;

  bool happened() const { return happened_.load(std::memory_order_relaxed); }
  bool look() {
    if (happened()) return true;
    if (std::this_thread::get_id() != thread_) return false;
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return false;
    const bool first = next_ == std::chrono::steady_clock::time_point();
    next_ = now + std::chrono::milliseconds(50);
    if (!first && ask_()) happened_.store(true, std::memory_order_relaxed);
    return happened();
  }

 private:
  bool (*ask_)();
  std::thread::id thread_ = std::this_thread::get_id();
  std::chrono::steady_clock::time_point next_;
  std::atomic<bool> happened_{false};
};

// When a search gives up: at a deadline, when another thread sets a byte, or at an interrupt.
struct SearchLimits {
  std::optional<std::chrono::steady_clock::time_point> deadline;
  const std::uint8_t *cancel = nullptr;
  Interrupt *interrupt = nullptr;

  // Found while the search may go on, or why it has to stop.
  SearchStatus check() const {
    if (cancel != nullptr && __atomic_load_n(cancel, __ATOMIC_RELAXED) != 0) return SearchStatus::kCancelled;
    if (interrupt != nullptr && interrupt->look()) return SearchStatus::kCancelled;
    if (deadline && std::chrono::steady_clock::now() >= *deadline) return SearchStatus::kTimeout;
    return SearchStatus::kFound;
  }
};

// A path by the cells at which it turns, with its ends.
struct GridPath {
  SearchStatus status = SearchStatus::kUnreachable;
  std::vector<GridCell> corners;
  std::uint64_t straight = 0, diagonal = 0;  // steps

  // Adds the next cell of a path whose parts are straight or diagonal lines; parts in one line are merged.
  void add(GridCell cell) {
    if (!corners.empty()) {
      const GridCell last = corners.back();
      const std::int64_t rows = std::abs(cell.row - last.row), cols = std::abs(cell.col - last.col);
      (rows != 0 && cols != 0 ? diagonal : straight) += static_cast<std::uint64_t>(std::max(rows, cols));
      if (corners.size() > 1 && in_line(corners[corners.size() - 2], last, cell)) corners.pop_back();
    }
    corners.push_back(cell);
  }

 private:
  static int sign(std::int32_t value) { return (value > 0) - (value < 0); }
  static bool in_line(GridCell a, GridCell b, GridCell c) {
    return sign(b.row - a.row) == sign(c.row - b.row) && sign(b.col - a.col) == sign(c.col - b.col);
  }
};

}  // namespace trundle
