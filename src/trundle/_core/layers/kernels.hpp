// What lidars see, gathered in a grid of evidence, and put into the cells of a map. evidence.hpp says what a byte means.
#pragma once

#include <tuple>

#include "shared/arrays.hpp"

namespace trundle {

// Arrays that a kernel changes in place.
using Evidence = nb::ndarray<std::uint8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using HitPoints = nb::ndarray<std::uint8_t, nb::ndim<3>, nb::c_contig, nb::device::cpu>;
using HitTimes = nb::ndarray<double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// First row, row after the last, first column, column after the last; all 0 if nothing changed.
using Rectangle = std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t>;

// Add a scan to the evidence, and return the rectangle in which a cell became marked, unmarked, seen or surely free.
// `points` keeps where in a cell the hit was that marked it, in 256ths of a cell: shape (rows, cols, 2) = x, y. `times`
// keeps when a cell was hit last, and may be empty. Cell (0, 0) has its corner at (col, row) · resolution. `poses` of the
// sensor: one, or one for each beam. `outline` is the robot's body in the sensor's frame, counter-clockwise; beams that
// end in it are ignored. `limits`: range_min, range_max, obstacle_min, obstacle_max, raytrace_min, raytrace_max, in the
// unit of the resolution.
Rectangle mark_scan(Evidence evidence, HitPoints points, HitTimes times, std::int64_t row, std::int64_t col,
                    double resolution, In<double, 2> poses, In<double, 1> angles, In<double, 1> ranges,
                    In<double, 2> outline, In<double, 1> limits, bool infinite_is_free, std::int64_t hit,
                    std::int64_t miss, double time);

// Unmark cells that were hit last before a time.
Rectangle unmark_before(Evidence evidence, HitTimes times, double before, std::int64_t hit, std::int64_t miss);

// Unmark what lies within a convex outline, counter-clockwise, and count its cells as seen.
Rectangle unmark_within(Evidence evidence, HitPoints points, std::int64_t row, std::int64_t col, double resolution,
                        In<double, 2> outline, std::int64_t hit, std::int64_t miss);

// Put the evidence into a part of a map: unknown cells (-1) that were seen become free, then the cells of all marks
// become occupied, except where `kept` is not 0. With `clear_occupied`, occupied cells that are surely free become free.
// (x, y, yaw) is the pose of the part's lower left corner in the frame of the evidence.
void paint_marks(Evidence evidence, HitPoints points, std::int64_t row, std::int64_t col, double resolution, Cells cells,
                 In<std::uint8_t, 2> kept, double x, double y, double yaw, double cell_size, bool clear_occupied);

// The same in a window of a map (rows and columns, as of a `Rectangle`), again from what the map is without the evidence,
// `base`. Returns the rectangle of `cells` that changed. (x, y, yaw) is the pose of the window's lower left corner.
Rectangle repaint_marks(Evidence evidence, HitPoints points, std::int64_t row, std::int64_t col, double resolution,
                        Cells cells, In<std::int8_t, 2> base, In<std::uint8_t, 2> kept, const Rectangle &window, double x,
                        double y, double yaw, double cell_size, bool clear_occupied);

}  // namespace trundle
