// Evenly spaced rays against segments and discs in the plane: each of them is tried only by the rays that can meet it.
#include "rays/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "shared/bearing.hpp"
#include "shared/registers.hpp"

namespace trundle {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTurn = 6.283185307179586476925286766559;
constexpr double kSure = 1e-9;   // share by which two squares differ, whatever their rounding
constexpr double kSlack = 1e-9;  // [rad]: a ray through a corner must not slip between the two edges that meet there

// `std::fmod` and `std::remainder` of a turn, which are exact, and so is the difference of numbers that are this close.
double fmod_of_turn(double angle) {
  if (std::abs(angle) < kTurn) return angle;
  return std::abs(angle) <= 2.0 * kTurn ? angle - std::copysign(kTurn, angle) : std::fmod(angle, kTurn);
}

double remainder_of_turn(double angle) {
  if (std::abs(angle) <= 0.5 * kTurn) return angle;
  return std::abs(angle) <= kTurn ? angle - std::copysign(kTurn, angle) : std::remainder(angle, kTurn);
}

// Call `visit(from, end)` for the rays whose angle lies in [low, low + width], modulo a full turn.
template <typename Visit>
TRUNDLE_INLINE void rays_within(double first, double step, std::ptrdiff_t count, double low, double width, Visit visit) {
  double offset = fmod_of_turn(low - kSlack - first);
  if (offset < 0.0) offset += kTurn;
  const double span = width + 2.0 * kSlack;
  // The rays cover one turn at most: the interval as it is, and where it began before the first ray.
  for (const double begin : {offset, offset - kTurn}) {
    // Rays so near to each other that their numbers would not fit lie all before or all behind.
    const auto whole = [count](double ray) {
      return static_cast<std::ptrdiff_t>(std::clamp(ray, -1.0, static_cast<double>(count)));
    };
    const std::ptrdiff_t from = std::max<std::ptrdiff_t>(0, whole(std::ceil(begin / step)));
    const std::ptrdiff_t to = std::min(count - 1, whole(std::floor((begin + span) / step)));
    if (from <= to) visit(from, to + 1);
  }
}

// The distances of some rays to a line (ux, uy) past (ax, ay), where those are nearer. Without a branch, as compilers
// vectorise that; a ray along the line has no number, or an infinite one.
TRUNDLE_INLINE void meet_line(const double *__restrict cosines, const double *__restrict sines, double *__restrict out,
                              std::ptrdiff_t from, std::ptrdiff_t end, double ux, double uy, double apart) {
  for (std::ptrdiff_t i = from; i < end; ++i) {
    const double distance = apart / (cosines[i] * uy - sines[i] * ux), before = out[i];
    const double nearer = distance < before ? distance : before;
    out[i] = distance >= 0.0 ? nearer : before;
  }
}

// Into one element of `out` for each ray, which hold infinity.
TRUNDLE_INLINE void cast_all(const In<double, 2> &segments, const In<double, 2> &discs, double x, double y, double first,
                             double step, double reach, std::vector<double> &out) {
  const std::size_t rays = out.size();
  const auto count = static_cast<std::ptrdiff_t>(rays);
  std::vector<double> cosines(rays), sines(rays);
  for (std::size_t i = 0; i < rays; ++i) {
    const double angle = first + static_cast<double>(i) * step;
    cosines[i] = std::cos(angle);
    sines[i] = std::sin(angle);
  }
  const double farthest = reach * reach;
  for (std::size_t k = 0; k < segments.shape(0); ++k) {
    const double ax = segments(k, 0) - x, ay = segments(k, 1) - y, bx = segments(k, 2) - x, by = segments(k, 3) - y;
    const double ux = bx - ax, uy = by - ay, square = ux * ux + uy * uy;
    if (!(square > 0.0)) continue;
    const double along = std::min(1.0, std::max(0.0, -(ax * ux + ay * uy) / square));
    const double nx = ax + along * ux, ny = ay + along * uy;
    const double near = nx * nx + ny * ny;
    if (near > farthest * (1.0 + kSure)) continue;
    if (!(near < farthest * (1.0 - kSure)) && !(std::hypot(nx, ny) <= reach)) continue;  // which is exact, and slow
    const double start = bearing_of(ay, ax);
    double width = remainder_of_turn(bearing_of(by, bx) - start);
    double low = width < 0.0 ? start + width : start;
    width = std::abs(width);
    if (near < 1e-18) low = first, width = kTurn;  // on the segment: no angles to go by
    rays_within(first, step, count, low, width, TRUNDLE_LAMBDA(std::ptrdiff_t from, std::ptrdiff_t end) {
      meet_line(cosines.data(), sines.data(), out.data(), from, end, ux, uy, ax * uy - ay * ux);
    });
  }
  for (std::size_t k = 0; k < discs.shape(0); ++k) {
    const double cx = discs(k, 0) - x, cy = discs(k, 1) - y, radius = discs(k, 2), away = std::hypot(cx, cy);
    if (!(away - radius <= reach)) continue;
    const bool inside = away <= radius;
    const double half = inside ? kTurn / 2.0 : std::asin(std::min(1.0, radius / away));
    rays_within(first, step, count, std::atan2(cy, cx) - half, 2.0 * half, [&](std::ptrdiff_t from, std::ptrdiff_t end) {
      for (std::ptrdiff_t i = from; i < end; ++i) {
        const double along = cosines[i] * cx + sines[i] * cy;
        const double root = along * along - (away * away - radius * radius);
        if (root < 0.0) continue;
        const double distance = inside ? along + std::sqrt(root) : along - std::sqrt(root);
        if (distance >= 0.0 && distance < out[i]) out[i] = distance;
      }
    });
  }
  for (double &distance : out)
    if (distance > reach) distance = kInfinity;
}

#ifdef TRUNDLE_AVX2
TRUNDLE_TARGET("avx2") void cast_avx2(const In<double, 2> &segments, const In<double, 2> &discs, double x, double y,
                                      double first, double step, double reach, std::vector<double> &out) {
  cast_all(segments, discs, x, y, first, step, reach, out);
}
#endif

void cast(const In<double, 2> &segments, const In<double, 2> &discs, double x, double y, double first, double step,
          double reach, std::vector<double> &out) {
#ifdef TRUNDLE_AVX2
  if (__builtin_cpu_supports("avx2")) return cast_avx2(segments, discs, x, y, first, step, reach, out);
#endif
  cast_all(segments, discs, x, y, first, step, reach, out);
}

}  // namespace

nb::ndarray<nb::numpy, double> cast_outline_rays(In<double, 2> segments, In<double, 2> discs, double x, double y,
                                                 double first, double step, std::int64_t count, double reach) {
  if (segments.shape(1) != 4) throw std::invalid_argument("segments need shape (N, 4)");
  if (discs.shape(1) != 3) throw std::invalid_argument("discs need shape (N, 3)");
  if (count < 1 || count > 1'000'000) throw std::invalid_argument("count must be 1 to 1,000,000 rays");
  if (!(step > 0.0) || !(step * static_cast<double>(count - 1) <= kTurn * (1.0 + 1e-9)))
    throw std::invalid_argument("the rays must be spaced evenly over one turn at most");
  if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(first) || !std::isfinite(reach) || reach < 0.0)
    throw std::invalid_argument("the origin, the first angle and the reach must be finite");
  const auto rays = static_cast<std::size_t>(count);
  std::vector<double> out(rays, kInfinity);
  {
    nb::gil_scoped_release released;
    cast(segments, discs, x, y, first, step, reach, out);
  }
  return to_numpy(std::move(out), {rays});
}

}  // namespace trundle
