// `SurfaceMap`: surfaces as scans saw them, which scans can be added to and taken from, and matched with.
//
// Cells hold sums of points and of their normals, in whole numbers, so that taking away is exact; one for each quarter of
// directions, so that the two sides of a thin wall stay apart. Between them the signed distance is that of an implicit
// moving least-squares surface (Kolluri 2008; Deschaud 2018, IMLS-SLAM): the mean over the cells near by of the distance
// along their normals. Cells come in tiles, which exist only where surfaces are.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "localization/checks.hpp"
#include "shared/arrays.hpp"

namespace trundle::mapping {

using localization::refuse_unless;

constexpr double kPi = 3.14159265358979323846;

class SurfaceMap {
 public:
  explicit SurfaceMap(double cell) : cell_(cell) {
    localization::check_resolution(cell);
  }

  void add(In<double, 2> points, In<double, 2> normals, In<double, 1> pose, int sign);
  nb::tuple match(In<double, 2> points, In<double, 2> normals, In<double, 2> starts, In<double, 1> prior,
                  In<double, 2> covariance, In<double, 1> settings) const;
  nb::tuple search(In<double, 2> points, In<double, 1> centre, In<double, 1> reach, In<double, 1> sigmas) const;
  nb::tuple table(double resolution) const;
  std::size_t memory() const { return tiles_.size() * sizeof(Tile); }

 private:
  static constexpr int kEdge = 16, kSides = 4, kReach = 2;
  static constexpr double kPerCell = 1000.0;  // units of the sums of points; those of normals are thousandths

  struct Cell {
    std::int32_t count = 0, x = 0, y = 0, nx = 0, ny = 0;
  };
  struct Tile {
    std::array<Cell, kEdge * kEdge * kSides> cells{};
    std::array<std::int32_t, kEdge * kEdge> near{};  // points in the cell and the eight round it
    std::array<std::int32_t, kEdge * kEdge> here{};
  };
  struct Value {
    double distance, nx, ny, weight;
  };

  static int side_of(double nx, double ny) {
    if (std::abs(nx) >= std::abs(ny)) return nx >= 0.0 ? 0 : 2;
    return ny >= 0.0 ? 1 : 3;
  }
  static std::int64_t floor_div(std::int64_t a) { return a >> 4; }

  // The tile of a cell, or null.
  const Tile *find(std::int64_t col, std::int64_t row) const {
    const std::int64_t x = floor_div(col) - left_, y = floor_div(row) - bottom_;
    if (x < 0 || y < 0 || x >= wide_ || y >= high_) return nullptr;
    const std::int32_t index = places_[static_cast<std::size_t>(y * wide_ + x)];
    return index < 0 ? nullptr : &tiles_[static_cast<std::size_t>(index)];
  }
  Tile &make(std::int64_t col, std::int64_t row);
  void grow(std::int64_t x, std::int64_t y);
  static std::size_t slot(std::int64_t col, std::int64_t row) {
    return static_cast<std::size_t>((row & 15) * kEdge + (col & 15));
  }
  Value value(double x, double y, double nx, double ny) const;

  double cell_;
  std::int64_t left_ = 0, bottom_ = 0, wide_ = 0, high_ = 0;  // of the tiles' places
  std::vector<std::int32_t> places_;
  std::vector<Tile> tiles_;
};

}  // namespace trundle::mapping
