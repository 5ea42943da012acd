// Queries to a `BinaryGrid`: whether they can be asked, where they begin and end, and many of them in several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "grid/binary_grid.hpp"
#include "shared/arrays.hpp"

namespace trundle {

using CellArray = In<std::int64_t, 2>;

inline GridCell cell_of(std::int64_t row, std::int64_t col) {
  return {static_cast<std::int32_t>(row), static_cast<std::int32_t>(col)};
}

// Statuses of `find_path` besides those of `SearchStatus`: why the start is refused; one more for the goal.
constexpr int kBlocked = -2, kOutside = -4, kNoCell = -6;

inline int refusal(const BinaryGrid &grid, const std::int64_t (&ends)[4]) {
  for (int end = 0; end < 2; ++end) {
    const std::int64_t row = ends[2 * end], col = ends[2 * end + 1];
    if (!grid.inside(row, col)) return kOutside + end;
    if (grid.blocked(cell_of(row, col))) return kBlocked + end;
  }
  return 0;
}

inline void check_point_sides(const BinaryGrid &grid) {
  constexpr std::int64_t kLongest = std::int64_t{1} << 29;  // half cells have 32 bits, and so have their differences
  if (std::max(grid.rows(), grid.cols()) > kLongest) throw nb::value_error("a side has more than 2^29 cells");
}

struct Ends {
  GridCell start{0, 0}, goal{0, 0};
  int refusal = 0;
  bool partial = false;  // whether the goal is only the cell nearest to it that can be reached
};

// A blocked start becomes the nearest free cell in reach. A blocked goal becomes the nearest cell in reach that can be
// reached, or else that is free. With `partial` a goal that cannot be reached becomes the nearest cell that can.
inline Ends settle(const BinaryGrid &grid, const std::int64_t (&ends)[4], double start_reach, double goal_reach,
                   bool partial) {
  constexpr double kAnywhere = 1e18;
  Ends out;
  for (int end = 0; end < 2; ++end) {
    if (!grid.inside(ends[2 * end], ends[2 * end + 1])) {
      out.refusal = kOutside + end;
      return out;
    }
  }
  out.start = cell_of(ends[0], ends[1]), out.goal = cell_of(ends[2], ends[3]);
  const GridCell goal = out.goal;
  if (grid.blocked(out.start)) {
    const auto cell = grid.nearest(out.start, nullptr, start_reach);
    if (!cell) {
      out.refusal = kBlocked;
      return out;
    }
    out.start = *cell;
  }
  if (grid.blocked(goal)) {
    auto cell = grid.nearest(goal, &out.start, goal_reach);
    if (!cell) cell = grid.nearest(goal, nullptr, goal_reach);
    if (!cell && !partial) {
      out.refusal = kBlocked + 1;
      return out;
    }
    if (cell) out.goal = *cell;
  }
  if (partial && !grid.joined(out.start, out.goal)) {
    out.goal = grid.nearest(goal, &out.start, kAnywhere).value_or(out.start);
    out.partial = true;
  }
  return out;
}

inline std::size_t same_count(const CellArray &starts, const CellArray &goals) {
  if (goals.shape(0) != starts.shape(0) || starts.shape(1) != 2 || goals.shape(1) != 2) {
    throw nb::value_error("starts and goals need the same shape (N, 2)");
  }
  return starts.shape(0);
}

// The first query that cannot be asked, or -1, and why.
inline std::pair<std::int64_t, int> first_refusal(const BinaryGrid &grid, const CellArray &starts,
                                                  const CellArray &goals) {
  nb::gil_scoped_release released;
  for (std::size_t i = 0; i < starts.shape(0); ++i) {
    const int status = refusal(grid, {starts(i, 0), starts(i, 1), goals(i, 0), goals(i, 1)});
    if (status != 0) return {static_cast<std::int64_t>(i), status};
  }
  return {-1, 0};
}

// `find(i)` for all queries, in several threads of which this is one; what one throws is thrown here.
template <typename Path, typename Find>
std::vector<Path> find_all(std::size_t count, int threads, Find find) {
  if (threads < 1 || threads > 1024) throw std::invalid_argument("threads must be from 1 to 1024");
  std::vector<Path> paths(count);
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failing;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) paths[i] = find(i);
    } catch (...) {
      std::lock_guard lock(failing);
      failure = std::current_exception();
      next = count;
    }
  };
  std::vector<std::thread> others;
  const std::size_t most = std::min<std::size_t>(static_cast<std::size_t>(threads), count);
  try {
    while (others.size() + 1 < most) others.emplace_back(work);
  } catch (const std::system_error &) {  // no more threads to be had: fewer do the work
  }
  work();
  for (std::thread &other : others) other.join();
  if (failure) std::rethrow_exception(failure);
  return paths;
}

}  // namespace trundle
