// What a drive is measured by: distances of points from a polyline, and of outlines from polygons; and how it would stop.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

// Distance of each point (N, 2) to the nearest place on a polyline with corners (M, 2), M ≥ 1.
nb::ndarray<nb::numpy, double> polyline_distances(In<double, 2> points, In<double, 2> corners);

// Distance of each convex outline (P, N, 2), counter-clockwise, to the nearest of convex polygons (Q, M, 2) of either
// sense, whose corners may be repeated or lie on one line; 0 where they overlap.
nb::ndarray<nb::numpy, double> outline_distances(In<double, 3> outlines, In<double, 3> polygons);

// Poses (K, 3) of a robot at (x, y, yaw) that moves at (v, w) while it drives a command for `dt` and then brakes to a
// stop, the first one included; parts of a step turn by `turn_step` at most.
nb::ndarray<nb::numpy, double> stopping_poses(double x, double y, double yaw, double v, double w, double goal_v,
                                              double goal_w, double forward, double reverse, double turning,
                                              double acceleration, double angular_acceleration, double dt,
                                              double turn_step);

}  // namespace trundle
