// A wavefront of costs over a grid whose cells have a weight each: what it costs to get from its sources to the other
// cells, in any direction.
//
// Idea: fast marching (Tsitsiklis 1995, Sethian 1996), with tiles of 8 × 8 cells in place of cells. The open list holds
// tiles that a lower cost has reached from outside. The first of them is settled: sweeps lower its cells' costs until
// none falls, given the cells around it (tile_sweeper.hpp). What that lowers in the neighbouring tiles is offered to
// them, and puts them on the open list. A tile is settled again whenever a neighbour offers it less than it has.
//
// Invariants: costs only fall, and each comes from a source over steps and triangles. A tile is on the open list, or deferred, as long as
// something that was offered to it has not been swept through it. So a cell's cost is final once no rank on the open
// list is below it, given ranks that never fall along a path.
//
// The caller ranks tiles: by cost, or by cost plus a bound on what is left, as A* does. A rank of infinity defers a
// tile. Tiles are made ready, with the weights of their cells, when the wavefront comes next to them; their memory is
// kept for the next wavefront.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "cost/tile_sweeper.hpp"
#include "shared/grid_steps.hpp"
#include "shared/open_list.hpp"
#include "shared/zeroed_table.hpp"

namespace trundle {

template <typename Real>
class Wavefront {
  using Sweeper = TileSweeper<Real>;

 public:
  static constexpr Real kFar = Sweeper::kFar;  // cost of a cell that is not reached; weight of one that is closed
  static constexpr std::int64_t kSide = Sweeper::kSide, kCells = kSide * kSide;

  // Forgets everything. Open cells weigh `least_weight` or more for a length of one cell. Without `interpolate` paths
  // lead from centre to centre alone, straight or diagonally, and touch no corner of a closed cell.
  void begin(std::int64_t rows, std::int64_t cols, Real least_weight, bool interpolate = true) {
    interpolate_ = interpolate;
    stride_ = (cols + kSide - 1) / kSide + 2;  // with a frame of closed tiles
    const auto count = static_cast<std::size_t>(((rows + kSide - 1) / kSide + 2) * stride_);
    tiles_.fit(count);
    states_.fit(count);
    if (++stamp_ == 0) states_.clear(), stamp_ = 1;  // after 2^32 wavefronts
    sweeper_.least_gain = least_weight / 1024;
    open_.clear();
    deferred_.clear();
    settled_ = 0;
  }

  bool interpolates() const { return interpolate_; }
  std::uint64_t settled() const { return settled_; }  // cells, as often as they were
  std::size_t bytes() const {
    return tiles_.bytes() + states_.bytes() + open_.bytes() + deferred_.capacity() * sizeof(std::int64_t);
  }

  // Whether cost and weight of a cell may be read: of those that are reached, and of the cells around these.
  bool is_ready(std::int64_t row, std::int64_t col) { return states_[tile_of(row, col)].stamp == stamp_; }
  Real cost(std::int64_t row, std::int64_t col) { return tiles_[tile_of(row, col)].cost[index_in_tile(row, col)]; }
  Real weight(std::int64_t row, std::int64_t col) {
    return tiles_[tile_of(row, col)].quarter[index_in_tile(row, col)] * 4;
  }
  Real cost_or_far(std::int64_t row, std::int64_t col) { return is_ready(row, col) ? cost(row, col) : kFar; }

  // Makes a cell's tile ready. `load(row, col, quarters)` writes quarters of the weights of the 8 × 8 cells from (row,
  // col) on, row by row; some or all of them may lie outside the grid.
  template <typename Load>
  void make_ready(std::int64_t row, std::int64_t col, const Load &load) {
    make_tile_ready(static_cast<std::int64_t>(tile_of(row, col)), load);
  }

  // Makes a cell, which is ready, a source.
  template <typename Rank>
  void seed(std::int64_t row, std::int64_t col, Real cost, const Rank &rank) {
    Real &known = tiles_[tile_of(row, col)].cost[index_in_tile(row, col)];
    if (!(cost < known)) return;
    known = cost;
    offer(static_cast<std::int64_t>(tile_of(row, col)), cost, Sweeper::kAll, rank);
  }

  // Settles tiles by rank until none is open or `done(rank)` is true, asked with the least rank on the open list.
  // `rank(row, col, cost)` is that of the tile from (row, col) on where `cost` is the least offered to it.
  // Returns found, or why `limits` stopped it.
  template <typename Load, typename Rank, typename Done>
  SearchStatus propagate(const Load &load, const Rank &rank, const Done &done, const SearchLimits &limits) {
    while (!open_.empty()) {
      const Entry first = open_.top();
      const bool is_stale = first.rank != states_[static_cast<std::size_t>(first.tile)].rank;  // settled, or ranked lower
      if (!is_stale) {
        if (done(first.rank)) return SearchStatus::kFound;
        if (settled_ % (64 * kCells) == 0) {
          const SearchStatus status = limits.check();
          if (status != SearchStatus::kFound) return status;
        }
      }
      open_.pop();
      if (!is_stale) settle(first.tile, load, rank);
    }
    return SearchStatus::kFound;
  }

  bool has_deferred() const { return !deferred_.empty(); }

  // Ranks the deferred tiles again.
  template <typename Rank>
  void retry_deferred(const Rank &rank) {
    std::vector<std::int64_t> deferred;
    deferred.swap(deferred_);
    for (const std::int64_t tile : deferred) {
      Real &offered = states_[static_cast<std::size_t>(tile)].offered;
      const Real cost = offered;
      offered = kFar;
      offer(tile, cost, 0, rank);
    }
  }

 private:
  struct Tile {
    Real cost[kCells], quarter[kCells];  // of the weight
  };
  struct State {
    std::uint32_t stamp;   // of the wavefront that the tile is ready for
    std::uint32_t sweeps;  // directions in which what was offered has to be swept
    Real rank;             // on the open list; far where it is not there
    Real offered;          // least cost that came from outside since the tile was settled
  };
  struct Entry {
    Real rank;
    std::int64_t tile;
    bool operator<(const Entry &other) const { return rank > other.rank; }  // the least comes first
  };

  // Neighbours of a tile, and the directions in which costs sweep on from here into each.
  enum Side { kSouth, kNorth, kWest, kEast, kSouthWest, kSouthEast, kNorthWest, kNorthEast, kSides };
  static constexpr int kRowStep[kSides] = {-1, 1, 0, 0, -1, -1, 1, 1}, kColStep[kSides] = {0, 0, -1, 1, -1, 1, -1, 1};
  static constexpr unsigned kOnward[kSides] = {Sweeper::kDown,
                                               Sweeper::kUp,
                                               Sweeper::kLeft,
                                               Sweeper::kRight,
                                               Sweeper::kDown | Sweeper::kLeft,
                                               Sweeper::kDown | Sweeper::kRight,
                                               Sweeper::kUp | Sweeper::kLeft,
                                               Sweeper::kUp | Sweeper::kRight};

  std::size_t tile_of(std::int64_t row, std::int64_t col) const {
    return static_cast<std::size_t>(((row >> 3) + 1) * stride_ + (col >> 3) + 1);
  }
  static std::size_t index_in_tile(std::int64_t row, std::int64_t col) {
    return static_cast<std::size_t>((row & 7) * kSide + (col & 7));
  }
  std::int64_t first_row(std::int64_t tile) const { return (tile / stride_ - 1) * kSide; }
  std::int64_t first_col(std::int64_t tile) const { return (tile % stride_ - 1) * kSide; }

  template <typename Load>
  void make_tile_ready(std::int64_t tile, const Load &load) {
    State &state = states_[static_cast<std::size_t>(tile)];
    if (state.stamp == stamp_) return;
    state = {stamp_, 0, kFar, kFar};
    Tile &cells = tiles_[static_cast<std::size_t>(tile)];
    std::fill_n(cells.cost, kCells, kFar);
    load(first_row(tile), first_col(tile), cells.quarter);
  }

  // A cell of a tile costs `cost` from outside, from where `sweeps` carry it on: the tile goes on the open list, or up
  // in it.
  template <typename Rank>
  void offer(std::int64_t tile, Real cost, unsigned sweeps, const Rank &rank) {
    State &state = states_[static_cast<std::size_t>(tile)];
    if (!(cost < kFar)) return;
    state.sweeps |= sweeps;
    if (!(cost < state.offered)) return;
    const bool is_first = state.offered == kFar;
    state.offered = cost;
    const Real new_rank = rank(first_row(tile), first_col(tile), cost);
    if (new_rank < state.rank) {
      state.rank = new_rank;
      open_.push({new_rank, tile});
    } else if (is_first && !(new_rank < kFar)) {
      deferred_.push_back(tile);
    }
  }

  // Sweeps what was offered to a tile through it, and offers the neighbours what comes of it.
  template <typename Load, typename Rank>
  void settle(std::int64_t tile, const Load &load, const Rank &rank) {
    settled_ += kCells;
    std::int64_t around[kSides];
    const Tile *neighbours[kSides];
    for (int side = 0; side < kSides; ++side) {
      around[side] = tile + kRowStep[side] * stride_ + kColStep[side];
      make_tile_ready(around[side], load);
      neighbours[side] = &tiles_[static_cast<std::size_t>(around[side])];
    }
    Tile &own = tiles_[static_cast<std::size_t>(tile)];
    copy_with_frame(own, neighbours, &Tile::cost, sweeper_.by_rows.cost, sweeper_.by_cols.cost);
    copy_with_frame(own, neighbours, &Tile::quarter, sweeper_.by_rows.quarter, sweeper_.by_cols.quarter);
    Sweeper::transpose(sweeper_.by_rows.quarter, sweeper_.by_cols.quarter);

    State &state = states_[static_cast<std::size_t>(tile)];
    const unsigned sweeps = state.sweeps;
    state.sweeps = 0, state.rank = state.offered = kFar;
    Real offers[kSides];
    if (!interpolate_) {
      sweep<false, true>(sweeps, offers);
    } else if (sweeper_.has_walls()) {
      sweep<true, true>(sweeps, offers);
    } else {
      sweep<true, false>(sweeps, offers);
    }
    for (int row = 0; row < kSide; ++row) {
      std::memcpy(own.cost + kSide * row, &sweeper_.by_rows.cost[row + 1][Sweeper::kFirst], kSide * sizeof(Real));
    }
    for (int side = 0; side < kSides; ++side) offer(around[side], offers[side], kOnward[side], rank);
  }

  template <bool kInterpolate, bool kWalls>
  __attribute__((noinline)) void sweep(unsigned sweeps, Real *offers) {
    sweeper_.template settle<kInterpolate, kWalls>(sweeps);
    offers[kSouth] = sweeper_.template offer_to_row<kInterpolate, kWalls, -1>(sweeper_.by_rows);
    offers[kNorth] = sweeper_.template offer_to_row<kInterpolate, kWalls, 1>(sweeper_.by_rows);
    offers[kWest] = sweeper_.template offer_to_row<kInterpolate, kWalls, -1>(sweeper_.by_cols);
    offers[kEast] = sweeper_.template offer_to_row<kInterpolate, kWalls, 1>(sweeper_.by_cols);
    for (int side = kSouthWest; side < kSides; ++side) {
      offers[side] = sweeper_.template offer_to_corner<kInterpolate>(kRowStep[side], kColStep[side]);
    }
  }

  // A tile's cells and the frame of its neighbours' cells around them, row by row; and column by column the frame
  // alone.
  static void copy_with_frame(const Tile &own, const Tile *const *neighbours, Real (Tile::*part)[kCells],
                              typename Sweeper::Rows &by_rows, typename Sweeper::Rows &by_cols) {
    constexpr int kFirst = Sweeper::kFirst, kBeyond = Sweeper::kFirst + kSide, kTop = kSide + 1;
    constexpr std::size_t kRow = kSide * sizeof(Real), kLastRow = kCells - kSide;
    const auto cells_of = [&](Side side) -> const Real * { return neighbours[side]->*part; };
    for (int row = 0; row < kSide; ++row) std::memcpy(&by_rows[row + 1][kFirst], own.*part + kSide * row, kRow);
    std::memcpy(&by_rows[0][kFirst], cells_of(kSouth) + kLastRow, kRow);
    std::memcpy(&by_rows[kTop][kFirst], cells_of(kNorth), kRow);
    for (int k = 0; k < kSide; ++k) {
      by_rows[k + 1][kFirst - 1] = by_cols[0][kFirst + k] = cells_of(kWest)[kSide * k + kSide - 1];
      by_rows[k + 1][kBeyond] = by_cols[kTop][kFirst + k] = cells_of(kEast)[kSide * k];
      by_cols[k + 1][kFirst - 1] = cells_of(kSouth)[kLastRow + static_cast<std::size_t>(k)];
      by_cols[k + 1][kBeyond] = cells_of(kNorth)[k];
    }
    by_rows[0][kFirst - 1] = by_cols[0][kFirst - 1] = cells_of(kSouthWest)[kCells - 1];
    by_rows[0][kBeyond] = by_cols[kTop][kFirst - 1] = cells_of(kSouthEast)[kLastRow];
    by_rows[kTop][kFirst - 1] = by_cols[0][kBeyond] = cells_of(kNorthWest)[kSide - 1];
    by_rows[kTop][kBeyond] = by_cols[kTop][kBeyond] = cells_of(kNorthEast)[0];
  }

  ZeroedTable<Tile> tiles_;
  ZeroedTable<State> states_;
  Sweeper sweeper_{};
  std::uint32_t stamp_ = 0;
  bool interpolate_ = true;
  OpenList<Entry> open_;  // with stale entries
  std::vector<std::int64_t> deferred_;
  std::int64_t stride_ = 0;  // tiles from one row of tiles to the next
  std::uint64_t settled_ = 0;
};

}  // namespace trundle
