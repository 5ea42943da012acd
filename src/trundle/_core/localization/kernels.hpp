// Localisation on a map: its distance field, particles, scan matching, agreement and global search.
// All poses and points are in the grid's own frame [m]: the lower-left corner of cell (0, 0) is its origin, no yaw.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

using Floats = nb::ndarray<nb::numpy, double>;
using Field = nb::ndarray<nb::numpy, float>;

// Signed distances [m] of the cells' centres from the border of what is occupied, negative inside, plus `shift`, within
// ±`limit`; of the cells' squares, exactly.
Field distance_field(In<std::uint8_t, 2> occupied, double resolution, double shift, double limit);

// The field at points and its slopes along x and y, shape (N, 3), bilinear between the centres of cells; outside of
// them `limit`, without a slope.
Floats field_at(In<float, 2> field, double resolution, double limit, In<double, 2> points);

// Particles (x, y, yaw) after a motion (turn, distance, turn) with the noise of Nav2's differential model, `alphas`
// being alpha1 to alpha4, and a least noise (x and y [m], yaw [rad]).
Floats move_particles(In<double, 2> particles, In<double, 1> motion, In<double, 1> alphas, In<double, 1> least,
                      std::uint64_t seed);

// Sums of a table's values where points, seen from each particle, lie; `outside` where that is off the table.
Floats weigh_particles(In<float, 2> table, double resolution, double outside, In<double, 2> particles,
                       In<double, 2> points);

// Systematic resampling by weights; how many are drawn follows from the bins (Fox 2001), `bins` being their size (x and
// y [m], yaw [rad]) and `bound` (least, most, error, quantile).
Floats resample_particles(In<double, 2> particles, In<double, 1> weights, In<double, 1> bins, In<double, 1> bound,
                          std::uint64_t seed);

// Poses where points lie best on surfaces of a field, near priors: Gauss-Newton with robust weights. `targets` (K, N) are
// the field's values where the surface of each point is, 0 where the map is right. `settings` are first width, last width
// and noise [m], most beams that count as information, iterations. Returns poses (K, 3), their information (K, 3, 3), and
// (K, 6): the sum of the beams' weights, their rms distance from the targets [m], the sum of weights for targets of 0,
// iterations, the mean distance [m], and which share of a common distance's information is independent of the pose.
nb::tuple match_scan(In<float, 2> field, double resolution, double limit, In<double, 2> points, In<double, 2> targets,
                     In<double, 2> starts, In<double, 2> priors, In<double, 3> information, In<double, 1> settings);

// How the beams from sensors (N, 2) to points (N, 2) fit the field from poses: for each pose and beam 0 where it ends on
// the surface, up to `tolerance` before it or `depth` behind it, 1 where it ends before it, 2 where it goes through it, 3 where the map does not tell.
nb::ndarray<nb::numpy, std::uint8_t> judge_beams(In<float, 2> field, double resolution, In<double, 2> sensors,
                                                 In<double, 2> points, In<double, 2> poses, double tolerance,
                                                 double depth);

// Poses within a window (least and most x, y, yaw) whose points' mean of a table is largest, branch and bound.
// `settings`: step of yaw, least score, share of the best score that another needs, how far apart two are (m, rad).
// Returns poses (K, 3) and scores (K,), best first, and whether the search was complete within `most_nodes`.
nb::tuple search_poses(In<std::uint8_t, 2> table, In<std::uint8_t, 2> allowed, double resolution,
                       In<double, 2> points, In<double, 1> window, In<double, 1> settings, std::int64_t most,
                       std::int64_t most_nodes);

}  // namespace trundle
