// The shortest curves of a car that drives forwards and backwards: Reeds and Shepp, "Optimal paths for a car that goes both forwards
// and backwards", Pacific Journal of Mathematics 145 (1990), section 8; numbers in brackets are its formulas.
//
// A word is solved for one of its forms, with its first arc to the left and forward. The others follow by its
// symmetries: driving backwards turns (x, y, phi) into (-x, y, -phi), a mirror into (x, -y, -phi), and driving the
// curve from its end to its start reverses the order of the pieces.
#pragma once

#include <initializer_list>

#include "curves/curves.hpp"

namespace trundle {

namespace reeds_shepp {

inline constexpr double kHalfPi = kPi / 2.0;
inline constexpr double kRounding = 1e-9;  // a length that is negative by no more than this is 0

struct Lengths {
  double t = 0.0, u = 0.0, v = 0.0;
};

struct Polar {
  double r, angle;
};

inline Polar polar(double x, double y) { return {std::hypot(x, y), std::atan2(y, x)}; }
inline bool forward(double length) { return length >= -kRounding; }
inline bool backward(double length) { return length <= kRounding; }

struct Goal {
  double x, y, phi, sin, cos;
  // The goal's circle on the same side as the first arc's, and on the other side, from the first arc's.
  double same_x() const { return x - sin; }
  double same_y() const { return y - 1.0 + cos; }
  double other_x() const { return x + sin; }
  double other_y() const { return y - 1.0 - cos; }
};

// L+ S+ L+ (8.1)
inline bool turn_straight_same(const Goal &goal, Lengths &out) {
  const Polar p = polar(goal.same_x(), goal.same_y());
  out = {p.angle, p.r, wrap(goal.phi - p.angle)};
  return forward(out.t) && forward(out.v);
}

// L+ S+ R+ (8.2)
inline bool turn_straight_other(const Goal &goal, Lengths &out) {
  const Polar p = polar(goal.other_x(), goal.other_y());
  if (p.r < 2.0) return false;
  const double u = std::sqrt(p.r * p.r - 4.0), t = wrap(p.angle + std::atan2(2.0, u));
  out = {t, u, wrap(t - goal.phi)};
  return forward(out.t) && forward(out.v);
}

// L+ R- L+ (8.3) and L+ R- L- (8.4): the last arc goes in either direction.
inline bool three_turns(const Goal &goal, Lengths &out) {
  const Polar p = polar(goal.same_x(), goal.same_y());
  if (p.r > 4.0) return false;
  const double u = -2.0 * std::asin(0.25 * p.r), t = wrap(p.angle + 0.5 * u + kPi);
  out = {t, u, wrap(goal.phi - t + u)};
  return forward(out.t) && backward(out.u);
}

// First and last arc of four whose middle ones are u and v (section 8.3 and 8.4 of the paper).
inline void outer_arcs(const Goal &goal, double u, double v, Lengths &out) {
  const double x = goal.other_x(), y = goal.other_y();
  const double delta = wrap(u - v);
  const double a = std::sin(u) - std::sin(delta), b = std::cos(u) - std::cos(delta) - 1.0;
  const double angle = std::atan2(y * a - x * b, x * a + y * b);
  const double test = 2.0 * (std::cos(delta) - std::cos(v) - std::cos(u)) + 3.0;
  out.t = test < 0.0 ? wrap(angle + kPi) : wrap(angle);
  out.v = wrap(out.t - u + v - goal.phi);
}

// L+ R+ L- R- (8.7), with middle arcs u and -u
inline bool four_turns_one_cusp(const Goal &goal, Lengths &out) {
  const double rho = 0.25 * (2.0 + std::hypot(goal.other_x(), goal.other_y()));
  if (rho > 1.0) return false;
  out.u = std::acos(rho);
  outer_arcs(goal, out.u, -out.u, out);
  return forward(out.t) && backward(out.v);
}

// L+ R- L- R+ (8.8), with middle arcs u and u
inline bool four_turns_two_cusps(const Goal &goal, Lengths &out) {
  const double x = goal.other_x(), y = goal.other_y(), rho = (20.0 - x * x - y * y) / 16.0;
  if (rho < 0.0 || rho > 1.0) return false;
  out.u = -std::acos(rho);
  outer_arcs(goal, out.u, out.u, out);
  return forward(out.t) && forward(out.v);
}

// L+ R-(pi/2) S- L- (8.9)
inline bool quarter_straight_same(const Goal &goal, Lengths &out) {
  const Polar p = polar(goal.same_x(), goal.same_y());
  if (p.r < 2.0) return false;
  const double r = std::sqrt(p.r * p.r - 4.0), t = wrap(p.angle + std::atan2(r, -2.0));
  out = {t, 2.0 - r, wrap(goal.phi - kHalfPi - t)};
  return forward(out.t) && backward(out.u) && backward(out.v);
}

// L+ R-(pi/2) S- R- (8.10)
inline bool quarter_straight_other(const Goal &goal, Lengths &out) {
  const Polar p = polar(-goal.other_y(), goal.other_x());
  if (p.r < 2.0) return false;
  out = {p.angle, 2.0 - p.r, wrap(p.angle + kHalfPi - goal.phi)};
  return forward(out.t) && backward(out.u) && backward(out.v);
}

// L+ R-(pi/2) S- L-(pi/2) R+ (8.11)
inline bool two_quarters(const Goal &goal, Lengths &out) {
  const double x = goal.other_x(), y = goal.other_y(), r = std::hypot(x, y);
  if (r < 2.0) return false;
  const double u = 4.0 - std::sqrt(r * r - 4.0);
  if (!backward(u)) return false;
  const double t = wrap(std::atan2((4.0 - u) * x - 2.0 * y, -2.0 * x + (u - 4.0) * y));
  out = {t, u, wrap(t - goal.phi)};
  return forward(out.t) && forward(out.v);
}

// How a curve is to be turned round and mirrored.
struct Form {
  int direction, side;
  bool reversed;
};

template <typename Visit>
void emit(const Form &form, std::initializer_list<CurvePiece> pieces, Visit &visit) {
  Curve curve;
  const int count = static_cast<int>(pieces.size());
  for (int i = 0; i < count; ++i) {
    const CurvePiece &piece = pieces.begin()[form.reversed ? count - 1 - i : i];
    curve.add(form.direction * piece.length, form.side * piece.steer);
  }
  visit(curve);
}

// The words that differ from themselves driven from the end.
template <typename Visit>
void one_way_words(const Goal &goal, const Form &form, Visit &visit) {
  Lengths s;
  if (three_turns(goal, s)) emit(form, {{s.t, 1}, {s.u, -1}, {s.v, 1}}, visit);
  if (quarter_straight_same(goal, s)) emit(form, {{s.t, 1}, {-kHalfPi, -1}, {s.u, 0}, {s.v, 1}}, visit);
  if (quarter_straight_other(goal, s)) emit(form, {{s.t, 1}, {-kHalfPi, -1}, {s.u, 0}, {s.v, -1}}, visit);
}

template <typename Visit>
void both_ways_words(const Goal &goal, const Form &form, Visit &visit) {
  Lengths s;
  if (turn_straight_same(goal, s)) emit(form, {{s.t, 1}, {s.u, 0}, {s.v, 1}}, visit);
  if (turn_straight_other(goal, s)) emit(form, {{s.t, 1}, {s.u, 0}, {s.v, -1}}, visit);
  if (four_turns_one_cusp(goal, s)) emit(form, {{s.t, 1}, {s.u, -1}, {-s.u, 1}, {s.v, -1}}, visit);
  if (four_turns_two_cusps(goal, s)) emit(form, {{s.t, 1}, {s.u, -1}, {s.u, 1}, {s.v, -1}}, visit);
  if (two_quarters(goal, s)) {
    emit(form, {{s.t, 1}, {-kHalfPi, -1}, {s.u, 0}, {-kHalfPi, 1}, {s.v, -1}}, visit);
  }
}

}  // namespace reeds_shepp

// Visits every curve of the paper's words that there is to (x, y, phi); the shortest of all curves is among them.
template <typename Visit>
void for_each_reeds_shepp(double x, double y, double phi, Visit &&visit) {
  using namespace reeds_shepp;
  const double sin = std::sin(phi), cos = std::cos(phi);
  const double back_x = x * cos + y * sin, back_y = x * sin - y * cos;
  for (const int direction : {1, -1}) {
    for (const int side : {1, -1}) {
      const double turn = direction * side;
      const Goal goal{direction * x, side * y, turn * phi, turn * sin, cos};
      both_ways_words(goal, {direction, side, false}, visit);
      one_way_words(goal, {direction, side, false}, visit);
      const Goal from_end{direction * back_x, side * back_y, turn * phi, turn * sin, cos};
      one_way_words(from_end, {direction, side, true}, visit);
    }
  }
}

}  // namespace trundle
