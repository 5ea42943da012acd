// Marks that disappear without a beam through them: those that grew old, and those under the robot.
#include <cmath>

#include "layers/evidence.hpp"

namespace trundle {

Rectangle unmark_before(Evidence evidence, HitTimes times, double before, std::int64_t hit, std::int64_t miss) {
  check_times(evidence, times);
  const EvidenceRule rule(hit, miss);
  const auto rows = static_cast<std::ptrdiff_t>(evidence.shape(0)), cols = static_cast<std::ptrdiff_t>(evidence.shape(1));
  CellBox box;
  nb::gil_scoped_release release;
  for (std::ptrdiff_t r = 0; r < rows; ++r) {
    std::uint8_t *cells = evidence.data() + r * cols;
    std::uint8_t any = 0;
    for (std::ptrdiff_t c = 0; c < cols; ++c) any |= cells[c];
    if (!(any & kMarked)) continue;
    for (std::ptrdiff_t c = 0; c < cols; ++c) {
      if (!(cells[c] & kMarked) || !(times.data()[r * cols + c] < before)) continue;
      cells[c] = rule.neutral;
      box.add(r, c, c + 1);
    }
  }
  return box.as_rectangle();
}

Rectangle unmark_within(Evidence evidence, HitPoints points, std::int64_t row, std::int64_t col, double resolution,
                        In<double, 2> outline, std::int64_t hit, std::int64_t miss) {
  check_shapes(evidence, points);
  check_place(row, col, resolution);
  const EvidenceRule rule(hit, miss);
  if (outline.shape(1) != 2 || outline.shape(0) < 3) throw std::invalid_argument("an outline needs 3 corners x, y");
  const auto rows = static_cast<std::ptrdiff_t>(evidence.shape(0)), cols = static_cast<std::ptrdiff_t>(evidence.shape(1));
  CellBox box;
  nb::gil_scoped_release release;
  std::vector<double> corners(2 * outline.shape(0));
  double low[2] = {kFarthest * 4.0, kFarthest * 4.0}, high[2] = {-low[0], -low[1]};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = outline.data()[i] / resolution - static_cast<double>(i % 2 == 0 ? col : row);
    if (!(std::abs(corners[i]) <= kFarthest * 2.0)) throw std::invalid_argument("an outline is too far away");
    low[i % 2] = std::min(low[i % 2], corners[i]);
    high[i % 2] = std::max(high[i % 2], corners[i]);
  }
  const auto begin = [](double value) { return std::max<std::ptrdiff_t>(0, static_cast<std::ptrdiff_t>(std::floor(value))); };
  const std::ptrdiff_t row_end = std::min(rows, static_cast<std::ptrdiff_t>(std::floor(high[1])) + 1);
  const std::ptrdiff_t col_end = std::min(cols, static_cast<std::ptrdiff_t>(std::floor(high[0])) + 1);
  for (std::ptrdiff_t r = begin(low[1]); r < row_end; ++r) {
    for (std::ptrdiff_t c = begin(low[0]); c < col_end; ++c) {
      std::uint8_t &cell = evidence.data()[r * cols + c];
      const std::uint8_t *point = points.data() + 2 * (r * cols + c);
      const bool marked = (cell & kMarked) != 0;
      const double x = static_cast<double>(c) + (marked ? (point[0] + 0.5) / kSubcells : 0.5);
      const double y = static_cast<double>(r) + (marked ? (point[1] + 0.5) / kSubcells : 0.5);
      if (!(marked || cell == 0) || !is_inside(corners.data(), corners.size() / 2, x, y)) continue;
      cell = rule.neutral;
      box.add(r, c, c + 1);
    }
  }
  return box.as_rectangle();
}

}  // namespace trundle
