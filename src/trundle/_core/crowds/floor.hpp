// Where the members of a crowd can be, and their paths to any place of it.
#pragma once

#include "batch/sine.hpp"
#include "field/tiled_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace trundle::crowds {

struct Vec {
  double x, y;
};

inline double length_of(Vec v) { return std::sqrt(v.x * v.x + v.y * v.y); }

struct Disc {
  double x, y, radius;
};

// Memory of a thread for whole maps.
struct MapMemory {
  std::vector<float> field;
  std::vector<std::uint8_t> costs;
};

// The path to a goal: for each cell in a window around it, which of the cells next to it is the next. Whoever leaves the
// window gets a new one. A byte holds two cells.
struct Route {
  std::int32_t goal = 0;
  std::vector<Disc> discs;  // that it leads around
  std::int32_t row = 0, col = 0, rows = 0, cols = 0;
  std::vector<std::uint8_t> steps;

  bool has(std::int32_t r, std::int32_t c) const {
    return r >= row && c >= col && r < row + rows && c < col + cols;
  }
  std::size_t index_of(std::int32_t r, std::int32_t c) const {
    return static_cast<std::size_t>(r - row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(c - col);
  }
  int step_from(std::int32_t r, std::int32_t c) const {
    const std::size_t index = index_of(r, c);
    return steps[index / 2] >> (index % 2 * 4) & 15;
  }
};

// The cell itself, and those around it.
inline constexpr int kAroundRow[9] = {0, -1, -1, -1, 0, 0, 1, 1, 1}, kAroundCol[9] = {0, -1, 0, 1, -1, 1, -1, 0, 1};

class Floor {
 public:
  static constexpr std::uint8_t kWall = 255;

  std::int32_t rows = 0, cols = 0;
  std::vector<std::uint8_t> costs;     // of a path through each cell; walls where a disc meets a solid
  std::vector<std::uint8_t> nearness;  // of solids, 255 in them and 0 from `reach` on
  std::vector<std::int32_t> free;      // cells, row by row
  double corner_x = 0.0, corner_y = 0.0, resolution = 1.0, reach = 1.0;
  int look = 1;  // how many cells ahead somebody goes for

  // The cell of a point, never one of the rim.
  std::int32_t cell_of(Vec p) const {
    const auto place = [this](double value, double corner, std::int32_t count) {
      return static_cast<std::int32_t>(
          std::clamp(batch::floor_of(std::clamp((value - corner) / resolution, -1e9, 1e9)), 1.0, count - 2.0));
    };
    return place(p.y, corner_y, rows) * cols + place(p.x, corner_x, cols);
  }
  Vec middle_of(std::int32_t cell) const {
    return {(cell % cols + 0.5) * resolution + corner_x, (cell / cols + 0.5) * resolution + corner_y};
  }
  bool is_free(Vec p) const { return costs[static_cast<std::size_t>(cell_of(p))] != kWall; }

  // The distance to the nearest solid if it is near, and the unit vector away from it.
  double push(Vec p, Vec &away) const {
    const auto at = static_cast<std::size_t>(cell_of(p)), row = static_cast<std::size_t>(cols);
    away = {static_cast<double>(nearness[at - 1]) - nearness[at + 1],
            static_cast<double>(nearness[at - row]) - nearness[at + row]};
    const double length = std::max(length_of(away), 1e-9);
    away = {away.x / length, away.y / length};
    return (1.0 - nearness[at] / 255.0) * reach;
  }

  // The point a little ahead on a route.
  Vec ahead(Vec p, Route &route, MapMemory &memory) const {
    std::int32_t cell = cell_of(p);
    for (int i = 0; i < look; ++i) {
      if (!route.has(cell / cols, cell % cols)) find(route, cell, memory);
      const int step = route.step_from(cell / cols, cell % cols);
      cell += kAroundRow[step] * cols + kAroundCol[step];
    }
    return middle_of(cell);
  }

  // The cost of the cheapest path from every cell to one, in `memory.field`; infinity where there is none.
  void fill_field(std::int32_t goal, const std::vector<Disc> &discs, MapMemory &memory) const {
    const std::uint8_t *through = costs.data();
    if (!discs.empty()) {
      memory.costs = costs;
      for (const Disc &disc : discs) block(disc, memory.costs);
      through = memory.costs.data();
    }
    memory.field.assign(costs.size(), std::numeric_limits<float>::infinity());
    if (through[goal] == kWall) return;
    const Grid<std::uint8_t> grid{through, rows, cols, true};
    if (!solve<std::uint32_t>(grid, goal, memory)) solve<std::uint64_t>(grid, goal, memory);
  }

 private:
  static constexpr std::int32_t kMargin = 40;  // cells around a path that its window has: who evades stays in it

  template <typename Number>
  bool solve(const Grid<std::uint8_t> &grid, std::int32_t goal, MapMemory &memory) const {
    TiledField<std::uint8_t, Number> field(grid, memory.field.data(), SearchLimits());
    field.add_goal(goal / cols, goal % cols);
    field.solve(1);
    return field.fits();
  }

  int best_step(const MapMemory &memory, std::int32_t row, std::int32_t col) const {
    const float *at = memory.field.data() + static_cast<std::ptrdiff_t>(row) * cols + col;
    int best = 0;
    float least = *at;
    for (int i = 1; i < 9; ++i) {
      const float cost = at[kAroundRow[i] * static_cast<std::ptrdiff_t>(cols) + kAroundCol[i]];
      if (cost < least) least = cost, best = i;
    }
    return best;
  }

  void find(Route &route, std::int32_t from, MapMemory &memory) const {
    fill_field(route.goal, route.discs, memory);
    std::int32_t row = from / cols, col = from % cols, low = row, high = row, left = col, right = col;
    for (int step = -1; step != 0;) {
      step = best_step(memory, row, col);
      row += kAroundRow[step], col += kAroundCol[step];
      low = std::min(low, row), high = std::max(high, row), left = std::min(left, col), right = std::max(right, col);
    }
    route.row = std::max(1, low - kMargin), route.col = std::max(1, left - kMargin);
    route.rows = std::min(rows - 2, high + kMargin) - route.row + 1;
    route.cols = std::min(cols - 2, right + kMargin) - route.col + 1;
    route.steps.assign((static_cast<std::size_t>(route.rows) * static_cast<std::size_t>(route.cols) + 1) / 2, 0);
    for (std::int32_t r = route.row; r < route.row + route.rows; ++r) {
      for (std::int32_t c = route.col; c < route.col + route.cols; ++c) {
        const std::size_t index = route.index_of(r, c);
        route.steps[index / 2] |= static_cast<std::uint8_t>(best_step(memory, r, c) << (index % 2 * 4));
      }
    }
  }

  // Block the cells whose middle is in a disc.
  void block(const Disc &disc, std::vector<std::uint8_t> &cells) const {
    const auto around = static_cast<std::int32_t>(std::ceil(disc.radius / resolution)) + 1;
    const std::int32_t at = cell_of({disc.x, disc.y}), row = at / cols, col = at % cols;
    for (std::int32_t r = std::max(0, row - around); r <= std::min(rows - 1, row + around); ++r) {
      for (std::int32_t c = std::max(0, col - around); c <= std::min(cols - 1, col + around); ++c) {
        const Vec middle = middle_of(r * cols + c);
        if (length_of({middle.x - disc.x, middle.y - disc.y}) < disc.radius) {
          cells[static_cast<std::size_t>(r * cols + c)] = kWall;
        }
      }
    }
  }
};

}  // namespace trundle::crowds
