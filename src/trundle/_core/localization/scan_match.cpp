// Scan matching on a signed distance field: Gauss-Newton on the field's values at the ends of the beams (as in Kohlbrecher,
// von Stryk, Meyer and Klingauf 2011, with distances for occupancy), with a prior of the pose as information.
//
// Weights are those of Geman and McClure, (w² / (w² + r²))²: wide at first, so that a start some decimetres off is
// pulled in, and narrow at last, so that what is not on the map counts for nothing. Errors of beams repeat with the map;
// they count as information of at most so many beams together.
#include "localization/kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "localization/checks.hpp"
#include "localization/field_view.hpp"

namespace trundle {

using namespace localization;

namespace {

using Matrix = std::array<double, 9>;

constexpr double kPi = 3.14159265358979323846;

// Solve a symmetric positive definite system by Cholesky's decomposition; false where it is not definite.
bool solve(const Matrix &a, const std::array<double, 3> &b, std::array<double, 3> &x) {
  const double l00 = a[0];
  if (!(l00 > 0.0)) return false;
  const double s0 = std::sqrt(l00), l10 = a[3] / s0, l20 = a[6] / s0;
  const double d1 = a[4] - l10 * l10;
  if (!(d1 > 0.0)) return false;
  const double s1 = std::sqrt(d1), l21 = (a[7] - l20 * l10) / s1;
  const double d2 = a[8] - l20 * l20 - l21 * l21;
  if (!(d2 > 0.0)) return false;
  const double s2 = std::sqrt(d2);
  const double y0 = b[0] / s0, y1 = (b[1] - l10 * y0) / s1, y2 = (b[2] - l20 * y0 - l21 * y1) / s2;
  x[2] = y2 / s2;
  x[1] = (y1 - l21 * x[2]) / s1;
  x[0] = (y0 - l10 * x[1] - l20 * x[2]) / s0;
  return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
}

// The inverse of a symmetric positive definite matrix; false where it is not definite.
bool invert(const Matrix &a, Matrix &inverse) {
  for (int column = 0; column < 3; ++column) {
    std::array<double, 3> unit{}, x;
    unit[column] = 1.0;
    if (!solve(a, unit, x)) return false;
    for (int row = 0; row < 3; ++row) inverse[3 * row + column] = x[row];
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < row; ++column) {
      inverse[3 * row + column] = inverse[3 * column + row] = 0.5 * (inverse[3 * row + column] + inverse[3 * column + row]);
    }
  }
  return true;
}

struct Sums {
  Matrix hessian{};
  std::array<double, 3> gradient{};
  double weight = 0.0, raw_weight = 0.0, total = 0.0, squares = 0.0;
  std::array<double, 3> slopes{};
};

Sums add_beams(const FieldView &field, const double *points, std::size_t count, const double *targets, const double *pose,
               double width) {
  Sums sums;
  const double cos = std::cos(pose[2]), sin = std::sin(pose[2]), w2 = width * width;
  for (std::size_t i = 0; i < count; ++i) {
    const double px = cos * points[2 * i] - sin * points[2 * i + 1], py = sin * points[2 * i] + cos * points[2 * i + 1];
    Slope slope = field.at(pose[0] + px, pose[1] + py);
    const double raw2 = slope.value * slope.value, raw_share = w2 / (w2 + raw2);
    slope.value -= targets[i];
    const double share = w2 / (w2 + slope.value * slope.value), weight = share * share;
    const double jx = slope.x, jy = slope.y, jt = slope.y * px - slope.x * py;
    const double wx = weight * jx, wy = weight * jy, wt = weight * jt;
    sums.hessian[0] += wx * jx;
    sums.hessian[3] += wx * jy;
    sums.hessian[4] += wy * jy;
    sums.hessian[6] += wx * jt;
    sums.hessian[7] += wy * jt;
    sums.hessian[8] += wt * jt;
    sums.gradient[0] += wx * slope.value;
    sums.gradient[1] += wy * slope.value;
    sums.gradient[2] += wt * slope.value;
    sums.weight += weight;
    sums.slopes[0] += wx;
    sums.slopes[1] += wy;
    sums.slopes[2] += wt;
    sums.total += weight * slope.value;
    sums.raw_weight += raw_share * raw_share;
    sums.squares += weight * slope.value * slope.value;
  }
  sums.hessian[1] = sums.hessian[3];
  sums.hessian[2] = sums.hessian[6];
  sums.hessian[5] = sums.hessian[7];
  return sums;
}

}  // namespace

nb::tuple match_scan(In<float, 2> field, double resolution, double limit, In<double, 2> points, In<double, 2> targets,
                     In<double, 2> starts, In<double, 2> priors, In<double, 3> covariances, In<double, 1> settings) {
  check_resolution(resolution);
  check_points(points);
  check_poses(starts);
  check_poses(priors);
  const std::size_t count = starts.shape(0), beams = points.shape(0);
  refuse_unless(targets.shape(0) == count && targets.shape(1) == beams, "targets need shape (K, N)");
  refuse_far(targets.data(), targets.size(), "targets must be finite");
  refuse_unless(priors.shape(0) == count && covariances.shape(0) == count && covariances.shape(1) == 3 &&
                    covariances.shape(2) == 3,
                "each start needs a prior and its covariance, shape (K, 3, 3)");
  refuse_infinite(covariances.data(), covariances.size(), "the covariances must be finite");
  refuse_unless(settings.shape(0) == 5, "there are 5 settings: first width, last width, noise, most beams, iterations");
  const double *s = settings.data();
  for (int i = 0; i < 4; ++i) refuse_unless(s[i] >= 1e-4 && s[i] <= 1e6, "the settings must be from 0.0001 to a million");
  refuse_unless(s[4] >= 1.0 && s[4] <= 1000.0, "there must be from 1 to 1000 iterations");
  std::vector<double> poses(starts.data(), starts.data() + 3 * count), found(9 * count), told(6 * count);
  std::vector<Matrix> information(count);
  for (std::size_t k = 0; k < count; ++k) {
    Matrix covariance;
    std::copy_n(covariances.data() + 9 * k, 9, covariance.begin());
    refuse_unless(invert(covariance, information[k]), "the covariances must be positive definite");
  }
  {
    nb::gil_scoped_release release;
    const FieldView view{field.data(), static_cast<std::ptrdiff_t>(field.shape(0)),
                         static_cast<std::ptrdiff_t>(field.shape(1)), 1.0 / resolution, limit};
    const int iterations = static_cast<int>(s[4]);
    for (std::size_t k = 0; k < count; ++k) {
      double *pose = poses.data() + 3 * k;
      const double *prior = priors.data() + 3 * k, *known = information[k].data();
      double width = std::max(s[0], s[1]);
      int done = 0;
      Sums sums;
      Matrix total{};
      for (; done <= iterations; ++done) {
        sums = add_beams(view, points.data(), beams, targets.data() + beams * k, pose, width);
        const double scale = sums.weight > 0.0 ? std::min(1.0, s[3] / sums.weight) / (s[2] * s[2]) : 0.0;
        for (int i = 0; i < 9; ++i) total[i] = scale * sums.hessian[i] + known[i];
        if (done == iterations) break;
        const double off[3] = {pose[0] - prior[0], pose[1] - prior[1], std::remainder(pose[2] - prior[2], 2.0 * kPi)};
        std::array<double, 3> right{}, step{};
        for (int i = 0; i < 3; ++i) {
          right[i] = -scale * sums.gradient[i];
          for (int j = 0; j < 3; ++j) right[i] -= known[3 * i + j] * off[j];
        }
        if (!solve(total, right, step)) break;
        // A step is at most half a metre and half a radian: the field is known near the beams' ends only.
        const double most = std::max({std::abs(step[0]) / 0.5, std::abs(step[1]) / 0.5, std::abs(step[2]) / 0.5, 1.0});
        for (int i = 0; i < 3; ++i) pose[i] += step[i] / most;
        const bool small = std::abs(step[0]) < 1e-5 && std::abs(step[1]) < 1e-5 && std::abs(step[2]) < 1e-5;
        if (small && width <= s[1]) {
          ++done;
          break;
        }
        width = std::max(s[1], 0.5 * width);
      }
      pose[2] = std::remainder(pose[2], 2.0 * kPi);
      Matrix spread;
      if (!invert(total, spread)) std::copy_n(covariances.data() + 9 * k, 9, spread.begin());
      std::copy(spread.begin(), spread.end(), found.begin() + static_cast<std::ptrdiff_t>(9 * k));
      told[6 * k] = sums.weight;
      told[6 * k + 1] = sums.weight > 0.0 ? std::sqrt(sums.squares / sums.weight) : 0.0;
      told[6 * k + 2] = sums.raw_weight;
      told[6 * k + 3] = done;
      told[6 * k + 4] = sums.weight > 0.0 ? sums.total / sums.weight : 0.0;
      // What is left of the information of a distance that all surfaces share, when the pose is not known either.
      std::array<double, 3> taken{};
      const double scale = sums.weight > 0.0 ? std::min(1.0, s[3] / sums.weight) / (s[2] * s[2]) : 0.0;
      if (scale > 0.0 && solve(total, sums.slopes, taken)) {
        const double lost = sums.slopes[0] * taken[0] + sums.slopes[1] * taken[1] + sums.slopes[2] * taken[2];
        told[6 * k + 5] = std::clamp(1.0 - scale * lost / sums.weight, 0.0, 1.0);
      }
    }
  }
  return nb::make_tuple(to_numpy(std::move(poses), {count, 3}), to_numpy(std::move(found), {count, 3, 3}),
                        to_numpy(std::move(told), {count, 6}));
}

nb::ndarray<nb::numpy, std::uint8_t> judge_beams(In<float, 2> field, double resolution, In<double, 2> sensors,
                                                 In<double, 2> points, In<double, 2> poses, double tolerance,
                                                 double depth) {
  check_resolution(resolution);
  check_points(sensors);
  check_points(points);
  check_poses(poses);
  const std::size_t beams = points.shape(0), count = poses.shape(0);
  refuse_unless(sensors.shape(0) == beams, "each beam needs a sensor and a point");
  refuse_unless(tolerance > 0.0 && tolerance <= 1e6 && depth > 0.0 && depth <= 1e6,
                "tolerance and depth must be above 0");
  std::vector<std::uint8_t> out(beams * count);
  {
    nb::gil_scoped_release release;
    const FieldView view{field.data(), static_cast<std::ptrdiff_t>(field.shape(0)),
                         static_cast<std::ptrdiff_t>(field.shape(1)), 1.0 / resolution, 0.0};
    for (std::size_t k = 0; k < count; ++k) {
      const double *pose = poses.data() + 3 * k;
      const double cos = std::cos(pose[2]), sin = std::sin(pose[2]);
      for (std::size_t i = 0; i < beams; ++i) {
        const double *s = sensors.data() + 2 * i, *p = points.data() + 2 * i;
        const double x = pose[0] + cos * s[0] - sin * s[1], y = pose[1] + sin * s[0] + cos * s[1];
        double dx = cos * (p[0] - s[0]) - sin * (p[1] - s[1]), dy = sin * (p[0] - s[0]) + cos * (p[1] - s[1]);
        const double range = std::hypot(dx, dy);
        std::uint8_t &verdict = out[k * beams + i];
        if (range > 0.0) dx /= range, dy /= range;
        if (!view.known(x + range * dx, y + range * dy)) {
          verdict = 3;
          continue;
        }
        // From the sensor on by what is free at least (sphere tracing: Hart 1996), up to shortly before the end.
        bool through = false;
        for (double at = 0.0; at < range - depth;) {
          const double free = view.known(x + at * dx, y + at * dy) ? view.at(x + at * dx, y + at * dy).value : tolerance;
          if (free <= 0.0) {
            through = true;
            break;
          }
          at += std::max(free, 0.25 * resolution);
        }
        const double end = view.at(x + range * dx, y + range * dy).value;
        verdict = through || end < -depth ? 2 : end <= tolerance ? 0 : 1;
      }
    }
  }
  return to_numpy(std::move(out), {count, beams});
}

}  // namespace trundle
