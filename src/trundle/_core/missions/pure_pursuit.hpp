// Regulated pure pursuit, as `trundle.control.regulated_pure_pursuit` has it: the same commands for the same poses.
#pragma once

#include "missions/path_sections.hpp"
#include "missions/stop_check.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace trundle::missions {

// Of `PursuitSettings`, in its order; `desired_speed` is infinite without one.
struct PursuitSettings {
  double desired_speed, lookahead, min_lookahead, sharp, rotate_speed, min_radius, min_speed, cost_scaling_dist,
      approach_dist, min_approach_speed, approach_deceleration, drive_off_acceleration, padding;
};

class PurePursuit {
 public:
  PurePursuit(const SpeedLimits &limits, double track_width, const Outline &footprint, const Outline &padded,
              const PursuitSettings &settings)
      : limits_(limits), half_track_(track_width / 2.0), footprint_(footprint), outline_(padded), settings_(settings),
        check_(limits_, footprint_) {}

  void set_path(const double *poses, const bool *backward, std::size_t count) {
    vertices_ = path_vertices(poses, backward, count);
    sections_.clear();
    is_laid_out_ = is_done_ = false;
    turn_.reset();
    last_ = 0.0;
  }

  // Whether a stop check met what it cannot judge.
  bool is_beyond() const { return check_.is_beyond; }

  // The command for the next control period; none where every one would cause a contact.
  std::optional<Twist> compute(const Ground &ground, const Pose &pose, const Twist &twist, double dt) {
    const std::optional<Twist> command = choose(ground, pose, twist, dt);
    last_ = command ? command->v : 0.0;
    return command;
  }

 private:
  static constexpr double kSimulationStep = 0.05, kTurnDone = 0.02, kSectionDone = 0.01, kSectionMissed = 0.02;
  static constexpr double kLead = 0.2, kLeastShare = 0.25;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  struct Turn {
    double remaining, yaw;
  };

  std::optional<Twist> choose(const Ground &ground, const Pose &pose, const Twist &twist, double dt) {
    if (!is_done_ && !is_laid_out_) lay_out(ground, pose);
    if (!is_done_) finish_what_is_done(pose);
    if (is_done_) return Twist{0.0, 0.0};
    commands_.clear();
    if (turn_) commands_.push_back({0.0, turn_speed(turn_->remaining)});
    else pursue(ground, pose);
    for (const Twist &wanted : commands_) {
      const Twist command = limit(wanted, twist, dt);
      for (const double factor : {1.0, 0.5, 0.25}) {
        const Twist slower{factor * command.v, factor * command.w};
        if (is_clear(ground, pose, twist, slower, dt)) return slower;
      }
    }
    return std::nullopt;
  }

  // Laying out ------------------------------------------------------------------------------------------------------

  void lay_out(const Ground &ground, const Pose &pose) {
    is_laid_out_ = true;
    index_ = 0, s_ = 0.0, turn_.reset();
    outlines_.clear();
    if (vertices_.size() == 1) {
      const Vertex &at = vertices_[0];
      outlines_.push_back(pad(ground, {turn_by({at.x, at.y, pose.yaw}, at.turn)}));
      begin_turn(at.turn, pose);
      is_done_ = !turn_;
      return;
    }
    std::vector<bool> stops;
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      stops.push_back(std::abs(vertices_[i].turn) > settings_.sharp || changes_direction(vertices_, i));
    }
    stops.back() = true;
    sections_ = cut_sections(vertices_, stops);
    for (auto bend = choose_lookaheads(ground, stops, pose); bend; bend = choose_lookaheads(ground, stops, pose)) {
      stops[*bend] = true;
      sections_ = cut_sections(vertices_, stops);
    }
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      std::vector<Motion> driven = sections_[i].motions();
      if (i == 0) driven.push_back(turn_by(driven[0].first, -vertices_[0].turn));
      outlines_.push_back(pad(ground, driven));
    }
    if (stops[0]) begin_turn(vertices_[0].turn, pose);
  }

  // The padded outline; where the path passes closer to something, padded by half of its clearance there.
  Outline pad(const Ground &ground, const std::vector<Motion> &motions) {
    touching_.begin_sweeps(ground, outline_);
    double room = kInfinity;
    for (const Motion &motion : motions) {
      if (is_far(ground, motion) || !touching_.sweep_touches(motion.first, motion.last)) continue;
      room = std::min(room, least_room(ground, motion));
    }
    if (room == kInfinity || room == 0.0) return outline_;
    return footprint_.padded(std::min(0.5 * room, settings_.padding));
  }

  bool is_far(const Ground &ground, const Motion &motion) const {
    const double dx = motion.last.x - motion.first.x, dy = motion.last.y - motion.first.y;
    const double turn = std::abs(motion.last.yaw - motion.first.yaw);
    return ground.is_surely_free(motion.first, outline_, std::hypot(dx, dy) + 0.01 * outline_.radius() + 0.005, turn);
  }

  double least_room(const Ground &ground, const Motion &motion) {
    const Pose &first = motion.first, &last = motion.last;
    const double away = length(first.x - last.x, first.y - last.y), turn = std::abs(last.yaw - first.yaw);
    const double steps = std::ceil(std::max(away / 0.005, turn / (0.5 * kDegree)));
    const auto pieces = static_cast<int>(std::min(std::max(1.0, steps), 1e7));
    const double change[3] = {last.x - first.x, last.y - first.y, last.yaw - first.yaw};
    const double from[3] = {first.x, first.y, first.yaw};
    // As `np.linspace` rounds: where one of the steps is 0, it multiplies by shares.
    const double parts = pieces;
    const bool by_shares = change[0] / parts == 0.0 || change[1] / parts == 0.0 || change[2] / parts == 0.0;
    double least = kInfinity;
    for (int i = 0; i <= pieces; ++i) {
      double at[3];
      for (int k = 0; k < 3; ++k) {
        at[k] = (by_shares ? i / parts * change[k] : i * (change[k] / parts)) + from[k];
      }
      const Pose pose = i == pieces ? last : Pose{at[0], at[1], at[2]};
      least = std::min(least, touching_.clearance(ground, footprint_, pose, 2.0));
    }
    return least;
  }

  // Sets the lookahead of each section; where the short one collides too, returns the nearest bend that is no stop yet.
  std::optional<std::size_t> choose_lookaheads(const Ground &ground, const std::vector<bool> &stops, const Pose &pose) {
    lookaheads_.clear();
    std::size_t first = 0;
    for (const Section &section : sections_) {
      const std::size_t last = first + section.points.size() - 1;
      lookaheads_.push_back(settings_.lookahead);
      bool has_bends = false;
      for (std::size_t i = first; i < last; ++i) has_bends = has_bends || !stops[i];
      if (has_bends) {
        const double yaw = first > 0 || stops[0] ? section.headings[0] : travel_yaw(section, pose.yaw);
        double missed = 0.0;
        std::optional<double> touched = pursue_ideally(ground, section, yaw, settings_.lookahead, missed);
        if (touched || missed > kSectionMissed) {
          lookaheads_.back() = settings_.min_lookahead;
          touched = pursue_ideally(ground, section, yaw, settings_.min_lookahead, missed);
        }
        if (touched) return nearest_bend(stops, section, first, last, *touched);
      }
      first = last;
    }
    return std::nullopt;
  }

  // Arc length at which an ideal pursuit first collides; and by how much it misses the end.
  std::optional<double> pursue_ideally(const Ground &ground, const Section &section, double yaw, double lookahead,
                                       double &missed) {
    Pose at{section.points[0].x, section.points[0].y, yaw};
    double s = 0.0;
    std::optional<double> touched;
    bool has_driven = false;
    const int most = static_cast<int>(1.5 * section.length / kSimulationStep) + 1;
    for (int i = 0; i < most && !(section.length - s <= kSectionDone); ++i) {
      double bearing;
      const double bend = curvature(section, at, s, lookahead, bearing);
      at = integrate_twist(at, 1.0, bend, kSimulationStep);
      s = section.project(at.x, at.y, s, 2.0 * kSimulationStep);
      has_driven = true;
      const Pose stands{at.x, at.y, travel_yaw(section, at.yaw)};
      if (!touched && !ground.is_surely_free(stands, outline_, 0.0, 0.0) && touching_.collides(ground, outline_, stands)) {
        touched = s;
      }
    }
    const Place &end = section.points.back();
    const double heading = section.headings.back();
    missed = has_driven ? std::abs((at.y - end.y) * std::cos(heading) - (at.x - end.x) * std::sin(heading)) : 0.0;
    return touched;
  }

  static std::size_t nearest_bend(const std::vector<bool> &stops, const Section &section, std::size_t first,
                                  std::size_t last, double s) {
    std::size_t nearest = first;
    double least = kInfinity;
    for (std::size_t bend = first; bend < last; ++bend) {
      const double off = std::abs(section.starts[bend - first] - s);
      if (!stops[bend] && off < least) least = off, nearest = bend;
    }
    return nearest;
  }

  // Following -------------------------------------------------------------------------------------------------------

  void finish_what_is_done(const Pose &pose) {
    if (turn_) {
      turn_->remaining -= wrap_angle(pose.yaw - turn_->yaw);
      turn_->yaw = pose.yaw;
      if (std::abs(turn_->remaining) > kTurnDone) return;
      turn_.reset();
      if (index_ >= sections_.size()) {
        is_done_ = true;
        return;
      }
    }
    const Section &section = sections_[index_];
    s_ = section.project(pose.x, pose.y, s_, settings_.lookahead);
    if (section.length - s_ > kSectionDone) return;
    ++index_, s_ = 0.0;
    begin_turn(section.end_turn + wrap_angle(section.headings.back() - travel_yaw(section, pose.yaw)), pose);
    if (!turn_ && index_ >= sections_.size()) is_done_ = true;
  }

  void begin_turn(double turn, const Pose &pose) {
    turn_.reset();
    if (std::abs(turn) > kTurnDone) turn_ = Turn{turn, pose.yaw};
  }

  double turn_speed(double remaining) const {
    const double fastest = std::min(settings_.rotate_speed, limits_.turning);
    const double braking =
        std::sqrt(2.0 * settings_.approach_deceleration * limits_.angular_acceleration * std::abs(remaining));
    return std::copysign(std::max(std::min(fastest, braking), std::min(0.05, fastest)), remaining);
  }

  void pursue(const Ground &ground, const Pose &pose) {
    const Section &section = sections_[index_];
    const Pose travels{pose.x, pose.y, travel_yaw(section, pose.yaw)};
    double bearing, other;
    const double bend = curvature(section, travels, s_, lookaheads_[index_], bearing);
    const double rotate = std::min(settings_.rotate_speed, limits_.turning);
    const Twist back{0.0, std::copysign(std::min(rotate, std::max(0.1, 2.0 * std::abs(bearing))), bearing)};
    if (std::abs(bearing) > settings_.sharp) {
      commands_ = {back, {0.0, -back.w}};
      return;
    }
    const double speed = regulated_speed(ground, bend, section, pose);
    const double tight = curvature(section, travels, s_, settings_.min_lookahead, other);
    const double slow = std::min(std::min(speed, settings_.min_speed), fastest_in_curve(tight));
    const double sign = section.backward ? -1.0 : 1.0;
    commands_ = {{sign * speed, speed * bend}, {sign * slow, slow * tight}};
    if (std::abs(bearing) > kTurnDone) commands_.push_back(back);
  }

  static double curvature(const Section &section, const Pose &pose, double s, double lookahead, double &bearing) {
    const Place carrot = section.point_at(s + lookahead);
    const double dx = carrot.x - pose.x, dy = carrot.y - pose.y;
    const double cos = std::cos(pose.yaw), sin = std::sin(pose.yaw);
    const double ahead = cos * dx + sin * dy, left = cos * dy - sin * dx;
    bearing = std::atan2(left, ahead);
    return 2.0 * left / std::max(dx * dx + dy * dy, 1e-6);
  }

  double fastest_in_curve(double bend) const {
    return std::abs(bend) > 1e-9 ? limits_.turning / std::abs(bend) : kInfinity;
  }

  double regulated_speed(const Ground &ground, double bend, const Section &section, const Pose &pose) const {
    const double fastest = section.backward ? limits_.reverse : limits_.forward;
    const double wanted = std::min(settings_.desired_speed, fastest);
    double regulated = wanted;
    const double radius = 1.0 / std::max(std::abs(bend), 1e-9);
    if (radius < settings_.min_radius) regulated = std::min(regulated, wanted * radius / settings_.min_radius);
    const double distance = distance_to_obstacle(ground, pose);
    if (distance < settings_.cost_scaling_dist) {
      regulated = std::min(regulated, wanted * distance / settings_.cost_scaling_dist);
    }
    regulated = std::max(regulated, std::min(wanted, settings_.min_speed));
    const double remaining = std::max(section.length - s_, 0.0);
    double approach = std::sqrt(2.0 * settings_.approach_deceleration * limits_.acceleration * remaining);
    if (index_ + 1 == sections_.size() && remaining < settings_.approach_dist) {
      approach = std::min(approach, wanted * remaining / settings_.approach_dist);
    }
    approach = std::max(approach, std::min(wanted, settings_.min_approach_speed));
    return std::min(std::min(regulated, approach), fastest_in_curve(bend));
  }

  static double distance_to_obstacle(const Ground &ground, const Pose &pose) {
    const int cost = ground.cost_under(pose.x, pose.y);
    if (cost == 0) return kInfinity;
    if (cost >= 253) return 0.0;
    return ground.inflation.inscribed_radius - std::log(cost / 252.0) / ground.inflation.scaling_factor;
  }

  // As `DrivingOff.limit`.
  Twist limit(const Twist &command, const Twist &twist, double dt) const {
    const double forward = command.v >= 0.0 ? 1.0 : -1.0;
    const double wanted = std::abs(command.v), moving = std::max(0.0, forward * twist.v);
    const double most = moving + settings_.drive_off_acceleration * kLead;
    const double base = std::min(std::max(moving, forward * last_), most);
    const double step = settings_.drive_off_acceleration * dt;
    const double slowest = base + kLeastShare * step;
    if (wanted <= slowest) return command;
    const double turned =
        std::max(std::abs(1.0 * command.w - twist.w), std::abs(slowest / wanted * command.w - twist.w));
    const double across = half_track_ * std::min(turned, limits_.angular_acceleration * dt);
    const double share = std::min(1.0, std::max(slowest, base + step - across) / wanted);
    return {share * command.v, share * command.w};
  }

  bool is_clear(const Ground &ground, const Pose &pose, const Twist &twist, const Twist &command, double dt) {
    const double fastest = std::max(limits_.forward, std::abs(twist.v));
    const double stop = fastest * (std::max(0.1, dt) + fastest / (2.0 * limits_.acceleration));
    const bool covers = ground.inflation.radius >= footprint_.radius() + settings_.padding + stop;
    if (covers && ground.cost_under(pose.x, pose.y) == 0) return true;
    const std::size_t turned = turn_ && index_ > 0 ? index_ - 1 : index_;
    return check_.can_stop(ground, pose, twist, command, dt, outlines_[turned]);
  }

  static double travel_yaw(const Section &section, double yaw) { return section.backward ? yaw + kPi : yaw; }

  SpeedLimits limits_;
  double half_track_;
  Outline footprint_, outline_;
  PursuitSettings settings_;
  StopCheck check_;
  Touching touching_;
  std::vector<Vertex> vertices_;
  std::vector<Section> sections_;
  std::vector<double> lookaheads_;
  std::vector<Outline> outlines_;
  std::vector<Twist> commands_;
  std::optional<Turn> turn_;
  std::size_t index_ = 0;
  double s_ = 0.0, last_ = 0.0;
  bool is_laid_out_ = false, is_done_ = true;
};

}  // namespace trundle::missions
