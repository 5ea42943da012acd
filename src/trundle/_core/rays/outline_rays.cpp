// Evenly spaced rays against segments and discs in the plane: each of them is tried only by the rays that can meet it.
#include "rays/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "shared/bearing.hpp"
#include "shared/registers.hpp"
#include "shared/sine_cosine.hpp"

namespace trundle {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTurn = 6.283185307179586476925286766559;
constexpr double kSure = 1e-9;   // share by which two squares differ, whatever their rounding
constexpr double kSlack = 1e-9;  // [rad]: a ray through a corner must not slip between the two edges that meet there

// So many shapes at a time: what is known of them stays in the nearest memory, and compilers vectorise loops over them.
constexpr std::size_t kTogether = 64;

// Arcs of directions, [low, low + width], and the rays whose angle lies in them, modulo a full turn. The rays cover one
// turn at most: those of the arc as it is, and of where it began before the first ray, are [from, end) in 0 and 1.
struct Arcs {
  double low[kTogether], width[kTogether];
  std::int32_t from[2][kTogether], end[2][kTogether];
};

// `std::fmod` of a turn, which is exact, and so is the difference of numbers that are this close.
double fmod_of_turn(double angle) {
  if (std::abs(angle) < kTurn) return angle;
  return std::abs(angle) <= 2.0 * kTurn ? angle - std::copysign(kTurn, angle) : std::fmod(angle, kTurn);
}

TRUNDLE_INLINE void find_rays(Arcs &arcs, std::size_t arc_count, double first, double step, std::ptrdiff_t count) {
  double begin[kTogether];
  for (std::size_t i = 0; i < arc_count; ++i) {
    const double offset = fmod_of_turn(arcs.low[i] - kSlack - first);
    begin[i] = offset < 0.0 ? offset + kTurn : offset;
  }
  // Rays so near to each other that their numbers would not fit lie all before or all behind.
  const double most = static_cast<double>(count);
  for (int turn = 0; turn < 2; ++turn) {
    const double earlier = turn == 0 ? 0.0 : kTurn;
    for (std::size_t i = 0; i < arc_count; ++i) {
      const double at = begin[i] - earlier, low = std::ceil(at / step);
      const double high = std::floor((at + (arcs.width[i] + 2.0 * kSlack)) / step);
      const double from = low < 0.0 ? 0.0 : low, to = high < -1.0 ? -1.0 : high;
      arcs.from[turn][i] = static_cast<std::int32_t>(from > most ? most : from);
      arcs.end[turn][i] = static_cast<std::int32_t>(to > most - 1.0 ? most : to + 1.0);
    }
  }
}

// Call `visit(shape, from, end)` for the rays of each arc.
template <typename Visit>
TRUNDLE_INLINE void visit_rays(const Arcs &arcs, std::size_t arc_count, Visit visit) {
  for (std::size_t i = 0; i < arc_count; ++i) {
    for (int turn = 0; turn < 2; ++turn) {
      if (arcs.from[turn][i] < arcs.end[turn][i]) visit(i, arcs.from[turn][i], arcs.end[turn][i]);
    }
  }
}

// Segments that rays may meet, from the origin of the rays.
struct Edges {
  double ax[kTogether], ay[kTogether], bx[kTogether], by[kTogether];
  bool is_touched[kTogether];  // by the origin: no angles to go by
  std::size_t count = 0;

  // Take segments from the `k`-th on until there is no room; returns the first that is not taken.
  TRUNDLE_INLINE std::size_t take(const double *segments, std::size_t k, std::size_t end, double x, double y, double reach) {
    const double farthest = reach * reach;
    for (count = 0; k < end && count < kTogether; ++k) {
      const double *s = segments + 4 * k;
      const double from_x = s[0] - x, from_y = s[1] - y, to_x = s[2] - x, to_y = s[3] - y;
      const double ux = to_x - from_x, uy = to_y - from_y, square = ux * ux + uy * uy;
      if (!(square > 0.0)) continue;
      const double along = std::min(1.0, std::max(0.0, -(from_x * ux + from_y * uy) / square));
      const double nx = from_x + along * ux, ny = from_y + along * uy;
      const double near = nx * nx + ny * ny;
      if (near > farthest * (1.0 + kSure)) continue;
      if (!(near < farthest * (1.0 - kSure)) && !(std::hypot(nx, ny) <= reach)) continue;  // which is exact, and slow
      ax[count] = from_x, ay[count] = from_y, bx[count] = to_x, by[count] = to_y;
      is_touched[count++] = near < 1e-18;
    }
    return k;
  }

  // The arcs that they fill as seen from the origin.
  TRUNDLE_INLINE void find_arcs(double first, Arcs &arcs) const {
    double start[kTogether], last[kTogether];
    bool usual = true;
    for (std::size_t i = 0; i < count; ++i) usual &= is_usual(ay[i], ax[i]) && is_usual(by[i], bx[i]);
    for (std::size_t i = 0; i < count; ++i) start[i] = bearing_of_usual(ay[i], ax[i]);
    for (std::size_t i = 0; i < count; ++i) last[i] = bearing_of_usual(by[i], bx[i]);
    for (std::size_t i = 0; i < count && !usual; ++i) {
      start[i] = bearing_of(ay[i], ax[i]), last[i] = bearing_of(by[i], bx[i]);
    }
    for (std::size_t i = 0; i < count; ++i) {  // two bearings are a turn apart at most: the difference is exact
      const double apart = last[i] - start[i];
      const double width = std::abs(apart) <= 0.5 * kTurn ? apart : apart - std::copysign(kTurn, apart);
      arcs.low[i] = width < 0.0 ? start[i] + width : start[i];
      arcs.width[i] = std::abs(width);
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (is_touched[i]) arcs.low[i] = first, arcs.width[i] = kTurn;
    }
  }
};

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
  const double from = std::abs(first) <= kMostUsualAngle ? first : std::remainder(first, kTurn);
  for (std::size_t i = 0; i < rays; ++i) {
    const SinCos direction = sin_cos_of_usual(from + static_cast<double>(static_cast<std::int32_t>(i)) * step);
    cosines[i] = direction.cos;
    sines[i] = direction.sin;
  }
  Arcs arcs;
  Edges edges;
  for (std::size_t k = 0; k < segments.shape(0);) {
    k = edges.take(segments.data(), k, segments.shape(0), x, y, reach);
    edges.find_arcs(first, arcs);
    find_rays(arcs, edges.count, first, step, count);
    visit_rays(arcs, edges.count, TRUNDLE_LAMBDA(std::size_t i, std::ptrdiff_t from, std::ptrdiff_t end) {
      const double ax = edges.ax[i], ay = edges.ay[i], ux = edges.bx[i] - ax, uy = edges.by[i] - ay;
      meet_line(cosines.data(), sines.data(), out.data(), from, end, ux, uy, ax * uy - ay * ux);
    });
  }
  struct Round {
    double x, y, radius, away;
  } rounds[kTogether];
  for (std::size_t k = 0; k < discs.shape(0);) {
    std::size_t taken = 0;
    for (; k < discs.shape(0) && taken < kTogether; ++k) {
      const double cx = discs(k, 0) - x, cy = discs(k, 1) - y, radius = discs(k, 2), away = std::hypot(cx, cy);
      if (!(away - radius <= reach)) continue;
      const double half = away <= radius ? kTurn / 2.0 : std::asin(std::min(1.0, radius / away));
      arcs.low[taken] = std::atan2(cy, cx) - half, arcs.width[taken] = 2.0 * half;
      rounds[taken++] = {cx, cy, radius, away};
    }
    find_rays(arcs, taken, first, step, count);
    visit_rays(arcs, taken, [&](std::size_t k, std::ptrdiff_t from, std::ptrdiff_t end) {
      const auto [cx, cy, radius, away] = rounds[k];
      const bool inside = away <= radius;
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
