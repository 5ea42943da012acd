// Rays of planar lidars.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

// Distances in cells from (x, y), in cell units, to the first blocked cell along each angle, or infinity.
nb::ndarray<nb::numpy, double> cast_grid_rays(In<std::uint8_t, 2> blocked, double x, double y, In<double, 1> angles,
                                              double reach);

// The same distances, bit for bit, for the grid whose `chebyshev_field` this is.
nb::ndarray<nb::numpy, double> cast_jumping_rays(In<std::uint8_t, 2> field, double x, double y, In<double, 1> angles,
                                                 double reach);

// Chebyshev distance in cells of each cell from the nearest blocked one, 0 for those and at most 255.
nb::ndarray<nb::numpy, std::uint8_t> chebyshev_field(In<std::uint8_t, 2> blocked);

// Distances from (x, y) along `count` rays at `first + i * step` to the nearest segment (x0, y0, x1, y1) or disc
// (x, y, radius), infinity where there is none within `reach`. From inside a disc the rays meet its rim.
nb::ndarray<nb::numpy, double> cast_outline_rays(In<double, 2> segments, In<double, 2> discs, double x, double y,
                                                 double first, double step, std::int64_t count, double reach);

// Ranges of a lidar from the distances along its beams: infinity beyond `range_max`, otherwise with an error of `deviation`
// times the noise, within the lidar's ranges. The noise has a number for each beam, or none.
nb::ndarray<nb::numpy, double> measure_ranges(In<double, 1> distances, In<double, 1> noise, double deviation,
                                              double range_min, double range_max);

// What has moved since an earlier scan of the same lidar, `seconds` ago, both of what they hit in the order of the beams:
// a velocity for each point (0 for what stands), whether there is any, and (x, y, vx, vy) of points that have moved in.
// `sensor` is a pose (x, y, yaw); `angles` of its beams are ascending, in its frame, and `through` is how far each of
// them saw.
nb::tuple find_moved(In<double, 2> points, In<double, 1> sensor, In<double, 1> angles, In<double, 1> through,
                     In<double, 2> earlier, In<double, 1> earlier_sensor, In<double, 1> earlier_angles,
                     In<double, 1> earlier_through, double seconds);

// Indices of hits that no beam beside them and not the scan before has seen: those of dust and rain. Poses of the sensors
// are rows x, y, yaw in one frame, one or one for each beam; without a scan before, its ranges are empty.
nb::ndarray<nb::numpy, std::int64_t> find_lone_hits(In<double, 1> ranges, In<double, 1> angles, In<double, 2> sensor,
                                                    In<double, 1> earlier_ranges, In<double, 1> earlier_angles,
                                                    In<double, 2> earlier_sensor, double range_min, double range_max);

// What a scan shows, without its lone hits: its hits in the frame of the base's pose, but for those within the body, in
// the order of the beams; the angles of the beams, ascending; and how far each of them and those beside it saw, minus
// infinity beside one that measured nothing. Poses are x, y, yaw: of the sensor in the base, of the base, and of the
// sensor in the frame of the base's pose, now and at the scan before, whose arrays may be empty. The body is the normal of
// each of its sides and how far it reaches along it.
nb::tuple place_scan(In<double, 1> ranges, In<double, 1> angles, In<double, 1> mount, In<double, 1> base,
                     In<double, 2> body, double range_min, double range_max, In<double, 1> sensor,
                     In<double, 1> earlier_ranges, In<double, 1> earlier_angles, In<double, 1> earlier_sensor);

// Points within `reach` of a pose (x, y, yaw) and their velocities, seen from it, both rows x, y. Each is continued at its
// velocity for `seconds`, and counts farther away by what it drives in `horizon`; without velocities all of them stand.
nb::tuple points_around(In<double, 2> points, In<double, 2> velocities, In<double, 1> pose, double seconds, double reach,
                        double horizon);

// For each pose (x, y, yaw) the `rank`-th least distance of a point from a convex outline there, infinity with fewer
// points: negative inside, and at a corner a little short. Points that move, and those in the box round the outlines at
// all poses, wider by a padding, count; they are where they are at the times, or stand without these. `sides` are the
// normal of each edge and how far the outline reaches along it.
nb::ndarray<nb::numpy, double> outline_clearances(In<double, 2> points, In<double, 2> velocities, In<double, 2> poses,
                                                  In<double, 1> times, In<double, 2> outline, In<double, 2> sides,
                                                  double padding, std::int64_t rank);

}  // namespace trundle
