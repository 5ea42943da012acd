// Rays that jump through a grid: a Chebyshev distance d of a cell says that the square of 2 d - 1 cells around it is free,
// so a ray goes on where it leaves that square. Sphere tracing (Hart 1996) with squares on cells.
//
// Where a ray crosses a line of the grid is computed from the line alone, so jumps and steps come to the same line with
// the same bits. `cast_jumping_ray` measures by those; `land_ray` by the sums of `walk_ray`, from one line to the next.
// At a corner a ray goes to the next row first.
#pragma once

#include "rays/cell_walk.hpp"

#include <type_traits>

namespace trundle {

// One coordinate of a ray: which lines of the grid it crosses, and when.
struct RayAxis {
  double start, along, inverse;
  std::ptrdiff_t step, ahead;

  RayAxis(double from, double direction)
      : start(from),
        along(direction),
        inverse(direction == 0.0 ? 1e300 : 1.0 / direction),
        step(direction < 0.0 ? -1 : 1),
        ahead(direction < 0.0 ? 0 : 1) {}

  // When it leaves a cell that it is in, and when it came into it.
  double leaves(std::ptrdiff_t cell) const { return (static_cast<double>(cell + ahead) - start) * inverse; }
  double enters(std::ptrdiff_t cell) const { return (static_cast<double>(cell + 1 - ahead) - start) * inverse; }

  // The cell at a distance, between two of them. `Ties`: whether a line at just that distance is crossed.
  template <bool Ties>
  std::ptrdiff_t cell_at(double distance, std::ptrdiff_t from, std::ptrdiff_t last) const {
    // Farther from a line than all that is rounded here, the cell is plain to see; but not of a ray that crossed a line
    // before it came into the grid.
    constexpr double kMargin = 1e-5;
    const double place = start + distance * along;
    const auto plain = static_cast<std::ptrdiff_t>(place);
    const double rest = place - static_cast<double>(plain);
    const bool between = step > 0 ? plain >= from && plain <= last : plain <= from && plain >= last;
    if (between && rest > kMargin && rest < 1.0 - kMargin) return plain;
    return cell_near_line<Ties>(place, distance, from, last);
  }

 private:
  template <bool Ties>
  std::ptrdiff_t cell_near_line(double place, double distance, std::ptrdiff_t from, std::ptrdiff_t last) const {
    const double guess = std::floor(place);
    const std::ptrdiff_t low = std::min(from, last), high = std::max(from, last);
    std::ptrdiff_t cell = guess <= static_cast<double>(low)    ? low
                          : guess >= static_cast<double>(high) ? high
                                                               : static_cast<std::ptrdiff_t>(guess);
    while (cell != last && (Ties ? leaves(cell) <= distance : leaves(cell) < distance)) cell += step;
    while (cell != from && !(Ties ? enters(cell) <= distance : enters(cell) < distance)) cell -= step;
    return cell;
  }
};

// Where jumps have led to.
struct Arrival {
  enum Kind : std::uint8_t { kNothing, kHit, kUnsure } kind;
  bool by_col;  // whether it came in from another column
  std::ptrdiff_t row, col;
  double distance;
};

// Jump from a cell, `distance` along the ray, to the first blocked one. `beside(axis, ties, distance, from, last, cell)`
// finds the cell of the coordinate whose line is not crossed; without one (false) the ray is unsure.
template <typename Beside>
inline Arrival jump_on(const CellBytes &field, const RayAxis &across, const RayAxis &up, std::ptrdiff_t row,
                       std::ptrdiff_t col, double distance, double reach, const Beside &beside) {
  bool by_col = false;
  while (true) {
    const std::ptrdiff_t free = field.at(row, col);
    if (free == 0) return {Arrival::kHit, by_col, row, col, distance};
    const std::ptrdiff_t last_col = col + across.step * (free - 1), last_row = row + up.step * (free - 1);
    const double at_col = across.leaves(last_col), at_row = up.leaves(last_row);
    by_col = at_col < at_row;
    distance = by_col ? at_col : at_row;
    if (distance > reach) return {Arrival::kNothing, by_col, row, col, distance};
    if (by_col) {
      if (!beside(up, std::true_type(), distance, row, last_row, row)) return {Arrival::kUnsure, true, row, col, distance};
      col = last_col + across.step;
    } else {
      if (!beside(across, std::false_type(), distance, col, last_col, col)) {
        return {Arrival::kUnsure, false, row, col, distance};
      }
      row = last_row + up.step;
    }
    if (!field.contains(row, col)) return {Arrival::kNothing, by_col, row, col, distance};
  }
}

// Distance in cells from (x, y), in cell units, along the unit vector (dx, dy) to the first blocked cell; infinity where
// there is none within `reach`. A ray that starts in a blocked cell reads 0.
inline double cast_jumping_ray(const CellBytes &field, double x, double y, double dx, double dy, double reach) {
  const RayAxis across(x, dx), up(y, dy);
  double distance = 0.0;
  std::ptrdiff_t col, row;
  const double width = static_cast<double>(field.cols), height = static_cast<double>(field.rows);
  if (x >= 0.0 && x < width && y >= 0.0 && y < height) {
    col = static_cast<std::ptrdiff_t>(x);
    row = static_cast<std::ptrdiff_t>(y);
  } else {
    double leave = reach;
    const double starts[2] = {x, y}, ends[2] = {width, height}, along[2] = {dx, dy};
    for (int axis = 0; axis < 2; ++axis) {
      if (along[axis] == 0.0) {
        if (starts[axis] < 0.0 || starts[axis] > ends[axis]) return kNoHit;
        continue;
      }
      const double first = -starts[axis] / along[axis], second = (ends[axis] - starts[axis]) / along[axis];
      distance = std::max(distance, std::min(first, second));
      leave = std::min(leave, std::max(first, second));
    }
    if (distance > leave) return kNoHit;
    // The entry of a ray from far away is rounded, and may lie outside.
    col = cell_at(x + distance * dx, field.cols);
    row = cell_at(y + distance * dy, field.rows);
  }
  const auto exactly = [](const RayAxis &axis, auto ties, double at, std::ptrdiff_t from, std::ptrdiff_t last,
                          std::ptrdiff_t &cell) {
    cell = axis.cell_at<ties()>(at, from, last);
    return true;
  };
  const Arrival arrival = jump_on(field, across, up, row, col, distance, reach, exactly);
  return arrival.kind == Arrival::kHit ? arrival.distance : kNoHit;
}

// The same cell and distance as a walk has. Its rounded sums may choose another cell where a jump ends very near to a
// corner: there the ray is unsure, and has to be walked.
struct Landing {
  Arrival::Kind kind = Arrival::kNothing;
  double first = 0.0, spacing = 0.0;  // of the lines that the ray crosses, ...
  std::ptrdiff_t more = 0;            // ... and how many spacings behind the first one lies the hit

  // The distance of the hit, rounded as a walk rounds it.
  double distance() const {
    double sum = first;
    for (std::ptrdiff_t i = 0; i < more; ++i) sum += spacing;
    return sum;
  }
};

// How far the sums of a walk through a grid may be off [cells]: each of at most `most` of them by half a unit in the last
// place, the spacing likewise, and the same for the numbers here; four times that.
inline double rounding_of_walk(const CellBytes &field, double reach) {
  const double size = static_cast<double>(field.rows + field.cols), most = std::min(reach, size) + 4.0;
  return 1e-15 * (most * most + size);
}

// Where the ray from (x, y) along the unit vector (dx, dy) ends in a field of Chebyshev distances, 0 for blocked cells.
inline Landing land_ray(const CellBytes &field, double x, double y, double dx, double dy, double reach, double rounding) {
  if (!(x > 0.0 && y > 0.0 && x < static_cast<double>(field.cols) && y < static_cast<double>(field.rows))) {
    return {Arrival::kUnsure, 0.0, 0.0, 0};
  }
  const std::ptrdiff_t start_col = static_cast<std::ptrdiff_t>(x), start_row = static_cast<std::ptrdiff_t>(y);
  const auto surely = [rounding](const RayAxis &axis, auto, double at, std::ptrdiff_t, std::ptrdiff_t,
                                 std::ptrdiff_t &cell) {
    const double place = axis.start + at * axis.along, floor = std::floor(place);
    cell = static_cast<std::ptrdiff_t>(floor);
    return place - floor > rounding && place - floor < 1.0 - rounding;
  };
  const Arrival arrival =
      jump_on(field, RayAxis(x, dx), RayAxis(y, dy), start_row, start_col, 0.0, reach + rounding, surely);
  const std::ptrdiff_t cols = std::abs(arrival.col - start_col), rows = std::abs(arrival.row - start_row);
  if (arrival.kind != Arrival::kHit || cols + rows == 0) return {arrival.kind, 0.0, 0.0, 0};
  const Crossings lines = arrival.by_col ? Crossings(x, start_col, dx) : Crossings(y, start_row, dy);
  return {Arrival::kHit, lines.first, lines.spacing, (arrival.by_col ? cols : rows) - 1};
}

}  // namespace trundle
