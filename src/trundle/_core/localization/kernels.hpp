// Localisation on a map: its distance field, particles, scan matching, agreement and global search.
// All poses and points are in the grid's own frame [m]: the lower-left corner of cell (0, 0) is its origin, no yaw.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

using Floats = nb::ndarray<nb::numpy, double>;
using Field = nb::ndarray<nb::numpy, float>;
// Numbers that a kernel changes in place.
using Table = nb::ndarray<float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// Signed distances [m] of the cells' centres from the border of what is occupied, negative inside, plus `shift`, within
// ±`limit`; of the cells' squares, exactly.
Field distance_field(In<std::uint8_t, 2> occupied, double resolution, double shift, double limit);

// The field at points and its slopes along x and y, shape (N, 3), bilinear between the centres of cells; outside of
// them `limit`, without a slope.
Floats field_at(In<float, 2> field, double resolution, double limit, In<double, 2> points);

// Where up to `most` beams of a scan ended, and where they began, each shape (K, 2): those with a range from `shortest`
// to below `longest`, evenly many over them from `offset` (0 to 1) of a step on, except those that end on the robot's
// body. `mount` is the sensor's pose in base_link, `poses` (2, 3) those of base_link at the first and at the last beam,
// `body` (M, 3) the normals of the body's sides in base_link and how far it reaches along them.
nb::tuple pick_beams(In<double, 1> ranges, In<double, 1> angles, In<double, 1> mount, In<double, 2> poses,
                     In<double, 2> body, double shortest, double longest, std::int64_t most, double offset);

// The field's values where points (N, 2), seen from a pose, are expected, (N,). `counts` and `means` are of patches of
// surface of `edge` [m]: how often points were seen at each, and at which distance on average. `settings`: beyond which
// distance a point is no part of the map, from which difference to `offset` on the mean counts, within which it comes to
// count in full, which part of it is believed, and after how many scans half of that.
Floats expect_surfaces(In<float, 2> field, double resolution, double limit, In<double, 2> points, In<double, 1> pose,
                       In<float, 2> counts, In<float, 2> means, double edge, double offset, In<double, 1> settings);

// Take points seen from a pose into the patches, where they are nearer to the surface than `deepest`: of each patch the
// last one. The means are of about the last `most` scans.
void learn_surfaces(In<float, 2> field, double resolution, double limit, In<double, 2> points, In<double, 1> pose,
                    Table counts, Table means, double edge, double deepest, double most);

// Particles (x, y, yaw) after a motion (turn, distance, turn) with the noise of Nav2's differential model, `alphas`
// being alpha1 to alpha4, and a least noise (x and y [m], yaw [rad]).
Floats move_particles(In<double, 2> particles, In<double, 1> motion, In<double, 1> alphas, In<double, 1> least,
                      std::uint64_t seed);

// Sums of a table's values where points, seen from each particle, lie; `outside` where that is off the table.
Floats weigh_particles(In<float, 2> table, double resolution, double outside, In<double, 2> particles,
                       In<double, 2> points);

// The mean of the particles within a distance and an angle of the heaviest one, shape (3,).
Floats peak_particle(In<double, 2> particles, In<double, 1> weights, double metres, double radians);

// Systematic resampling by weights; how many are drawn follows from the bins (Fox 2001), `bins` being their size (x and
// y [m], yaw [rad]) and `bound` (least, most, error, quantile).
Floats resample_particles(In<double, 2> particles, In<double, 1> weights, In<double, 1> bins, In<double, 1> bound,
                          std::uint64_t seed);

// Poses where points lie best on surfaces of a field, near priors with covariances (K, 3, 3): Gauss-Newton with robust
// weights. `targets` (K, N) are the field's values where the surface of each point is, 0 where the map is right.
// `settings` are first width, last width and noise [m], most beams that count as information, iterations. Returns poses
// (K, 3), their covariances (K, 3, 3), and (K, 6): the sum of the beams' weights, their rms distance from the targets [m], the sum of weights for targets of 0,
// iterations, the mean distance [m], and which share of a common distance's information is independent of the pose.
nb::tuple match_scan(In<float, 2> field, double resolution, double limit, In<double, 2> points, In<double, 2> targets,
                     In<double, 2> starts, In<double, 2> priors, In<double, 3> covariances, In<double, 1> settings);

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
