// `CrowdState`: places, goals, and one period after the other.
#include "crowds/walk.hpp"

#include "shared/bearing.hpp"

namespace trundle::crowds {

namespace {

constexpr double kPi = 3.14159265358979323846;

// Members start at least this far from the robot [m], beside both radii, so that nobody touches it before it can brake.
constexpr double kClearOfRobot = 2.0;
// Random places that are tried for one member, and placings of a whole crowd that are tried: the first members may leave
// no room for the last. A placing that ends below 80 % of them, less 5, is not repeated: others would fail as well.
constexpr int kTries = 400, kPlacings = 20;
constexpr double kNearlyAll = 0.8, kAFew = 5.0;
constexpr double kLeastWalk = 4.0;     // [m] to the next place, where there is one so far away
constexpr double kLeastRetreat = 1.5;  // [m] the same for one who is stuck
constexpr int kRetreats = 12;          // places that one who is stuck looks at
constexpr double kBlocking = 0.5;      // [m]; those who are nearer than this block it
constexpr double kThere = 0.4;         // [m]; one this near to its goal is there, or nearer than its radius if larger
constexpr double kStuckS = 2.0;        // one that gets nowhere for so long goes elsewhere
constexpr double kSomewhere = 0.5;     // [m]; by speed, those who are pushed to and fro in a jam never count as stuck
constexpr double kSwing = 0.2;         // bodies that are farther from the robot's circle do not swing into it [m]
constexpr double kTurn = 4.0, kSteer = 1.2;  // how fast those who step aside, and those who steer, turn [rad/s]

double distance_of(Vec a, Vec b) { return length_of({a.x - b.x, a.y - b.y}); }

// To (−π, π].
double wrapped(double angle) {
  double rest = std::fmod(kPi - angle, 2.0 * kPi);  // exact by IEEE 754
  if (rest < 0.0) rest += 2.0 * kPi;
  return kPi - rest;
}

}  // namespace

std::int64_t CrowdState::reset(const CrowdModel &model, const std::uint64_t *words, const Robot &robot,
                               const double *movers, StepMemory &memory) {
  const std::size_t count = model.members.size();
  draws_.clear();
  for (std::size_t crowd = 0; crowd < model.floors.size(); ++crowd) draws_.emplace_back(words + 4 * crowd);
  from_.assign(count, Planar{});
  to_ = from_;
  goals_.assign(count, Vec{});
  routes_.assign(count, Route());
  waits_.assign(count, 0.0);
  const double nowhere = std::numeric_limits<double>::infinity();
  was_at_.assign(count, Vec{nowhere, nowhere});
  preferred_.assign(count, 0.0);
  index_ = 0;
  std::size_t first = 0;
  for (std::size_t crowd = 0; crowd < model.ends.size(); ++crowd) {
    const std::size_t end = model.ends[crowd];
    for (std::size_t i = first; i < end; ++i) {
      preferred_[i] = draws_[crowd].uniform(model.members[i].top * 0.7, model.members[i].top);
    }
    std::size_t placed = first;
    for (int placing = 0; placing < kPlacings; ++placing) {
      placed = first;
      while (placed < end && place(model, placed, robot, movers)) ++placed;
      if (placed == end) break;
      if (static_cast<double>(placed - first) < kNearlyAll * static_cast<double>(end - first) - kAFew) break;
    }
    if (placed < end) return static_cast<std::int64_t>(placed);
    first = end;
  }
  next(model, &robot, movers, memory);
  return -1;
}

// Put one at a random place that is clear of those before it, and draw where it goes; whether there is one.
bool CrowdState::place(const CrowdModel &model, std::size_t number, const Robot &robot, const double *movers) {
  const Member &member = model.members[number];
  const Floor &floor = *model.floors[member.crowd];
  Draws &draws = draws_[member.crowd];
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Vec p = floor.middle_of(floor.free[draws.whole(static_cast<std::uint32_t>(floor.free.size()))]);
    bool clear = distance_of(p, {robot.x, robot.y}) - robot.radius - member.radius > kClearOfRobot;
    for (std::size_t i = 0; clear && i < number; ++i) {
      clear = distance_of(from_[i].at, p) - model.members[i].radius - member.radius > 0.1;
    }
    for (std::size_t i = 0; clear && i < model.mover_radii.size(); ++i) {
      clear = distance_of({movers[4 * i], movers[4 * i + 1]}, p) > member.radius + model.mover_radii[i];
    }
    if (!clear) continue;
    from_[number].at = p;
    from_[number].yaw = draws.uniform(-kPi, kPi);
    go_to(floor, number, far_cell(floor, draws, p), {});
    return true;
  }
  return false;
}

// A free cell at least as far away as a walk, if one is found soon.
std::int32_t CrowdState::far_cell(const Floor &floor, Draws &draws, Vec here) {
  const auto draw = [&] { return floor.free[draws.whole(static_cast<std::uint32_t>(floor.free.size()))]; };
  std::int32_t cell = draw();
  for (int i = 0; i < 8 && distance_of(floor.middle_of(cell), here) < kLeastWalk; ++i) cell = draw();
  return cell;
}

void CrowdState::go_to(const Floor &floor, std::size_t number, std::int32_t cell, std::vector<Disc> discs) {
  goals_[number] = floor.middle_of(cell);
  routes_[number] = Route();
  routes_[number].goal = cell;
  routes_[number].discs = std::move(discs);
}

// Draw where one who is stuck goes: where it gets without passing those next to it, if there is any. Those are others
// and, for one who sees it, the robot: two who wait for each other would stand there for ever.
void CrowdState::back_out(const CrowdModel &model, std::size_t number, const Robot *robot, StepMemory &memory) {
  const Member &member = model.members[number];
  const Floor &floor = *model.floors[member.crowd];
  Draws &draws = draws_[member.crowd];
  const Vec here = from_[number].at;
  std::vector<Disc> discs;
  const auto add = [&](Vec other, double least) {
    const double apart = distance_of(other, here);
    if (!(apart < least + kBlocking && apart > 0.0)) return;
    discs.push_back({other.x, other.y, std::min(least, apart - floor.resolution)});
  };
  for (std::size_t i = 0; i < from_.size(); ++i) add(from_[i].at, model.members[i].radius + member.radius);
  if (robot != nullptr) add({robot->x, robot->y}, member.radius + robot->radius + kMargin);
  if (discs.empty()) {
    go_to(floor, number, far_cell(floor, draws, here), {});
    return;
  }
  floor.fill_field(floor.cell_of(here), discs, memory.map);
  std::int32_t chosen = -1;
  for (int i = 0; i < kRetreats; ++i) {
    const std::int32_t cell = floor.free[draws.whole(static_cast<std::uint32_t>(floor.free.size()))];
    const bool far = distance_of(floor.middle_of(cell), here) >= kLeastRetreat;
    if (chosen < 0 && far && std::isfinite(memory.map.field[static_cast<std::size_t>(cell)])) chosen = cell;
  }
  if (chosen >= 0) go_to(floor, number, chosen, std::move(discs));
}

void CrowdState::choose_goals(const CrowdModel &model, const Robot *robot, StepMemory &memory) {
  for (std::size_t i = 0; i < from_.size(); ++i) {
    const Member &member = model.members[i];
    const bool moved = distance_of(from_[i].at, was_at_[i]) >= kSomewhere;
    if (moved) was_at_[i] = from_[i].at;
    waits_[i] = moved ? std::min(waits_[i], 0.0) : waits_[i] + kPeriod;
    const bool there = distance_of(goals_[i], from_[i].at) < std::max(kThere, member.radius);
    if (!there && !(waits_[i] > kStuckS)) continue;
    const Floor &floor = *model.floors[member.crowd];
    Draws &draws = draws_[member.crowd];
    if (there) {
      go_to(floor, i, far_cell(floor, draws, from_[i].at), {});
    } else {
      back_out(model, i, member.sees ? robot : nullptr, memory);
    }
    // Two who block each other do not both try again at the same time, and those who steer turn first.
    waits_[i] = -draws.uniform(0.0, kStuckS) - (member.steers ? kPi / kSteer : 0.0);
  }
}

// The state a period later, into `to_`; its velocities are those of the period between.
void CrowdState::next(const CrowdModel &model, const Robot *robot, const double *movers, StepMemory &memory) {
  const std::size_t count = from_.size();
  choose_goals(model, robot, memory);
  std::vector<Moving> &others = memory.others;
  others.clear();
  for (std::size_t i = 0; i < count; ++i) {
    others.push_back({from_[i].at, index_ == 0 ? Vec{0.0, 0.0} : from_[i].velocity, model.members[i].radius});
  }
  for (std::size_t i = 0; i < model.mover_radii.size(); ++i) {
    const double *m = movers + 4 * i;
    others.push_back({{m[0], m[1]}, {m[2], m[3]}, model.mover_radii[i]});
  }
  memory.reached.resize(count);
  memory.turned.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Member &member = model.members[i];
    const Floor &floor = *model.floors[member.crowd];
    const Vec p = from_[i].at, velocity = others[i].velocity, ahead = floor.ahead(p, routes_[i], memory.map);
    Vec direction{ahead.x - p.x, ahead.y - p.y}, away;
    const double length = std::max(length_of(direction), 1e-9);
    direction = {direction.x / length, direction.y / length};
    const double distance = floor.push(p, away);
    Vec force = border_force(distance, away, member.radius);
    force.x += (preferred_[i] * direction.x - velocity.x) / kTau;
    force.y += (preferred_[i] * direction.y - velocity.y) / kTau;
    Vec sum{0.0, 0.0};
    for (const Moving &other : others) {
      const Vec pushed = repulsion(p, member.radius, direction, other);
      sum.x += pushed.x, sum.y += pushed.y;
    }
    force.x += sum.x, force.y += sum.y;
    const Robot *seen = member.sees ? robot : nullptr;
    if (seen != nullptr) {
      const Moving driving{{seen->x, seen->y}, {seen->vx, seen->vy}, seen->radius};
      const Vec pushed = repulsion(p, member.radius, direction, driving);
      force.x += pushed.x, force.y += pushed.y;
    }
    Vec wanted{velocity.x + force.x * kPeriod, velocity.y + force.y * kPeriod};
    const double share = std::min(1.0, member.top / std::max(length_of(wanted), 1e-9));
    wanted = steer(member, from_[i], {wanted.x * share, wanted.y * share}, seen, memory.turned[i]);
    if (seen != nullptr) wanted = give_way(p, wanted, member.radius, *seen, kPeriod);
    // Off solids: along one axis where not along both, or nowhere.
    Vec reached{p.x + wanted.x * kPeriod, p.y + wanted.y * kPeriod};
    if (!floor.is_free(reached)) {
      const Vec along_x{reached.x, p.y}, along_y{p.x, reached.y};
      reached = floor.is_free(along_x) ? along_x : floor.is_free(along_y) ? along_y : p;
    }
    memory.reached[i] = reached;
  }
  keep_apart(model, memory);
  for (std::size_t i = 0; i < count; ++i) {
    const Member &member = model.members[i];
    const Planar &from = from_[i];
    Vec reached = memory.reached[i];
    const bool allowed = model.floors[member.crowd]->is_free(reached) &&
                         !(robot != nullptr && member.sees && enters_path(from.at, reached, member.radius, *robot));
    if (!allowed) reached = from.at;
    to_[i] = {reached, memory.turned[i],
              {(reached.x - from.at.x) / kPeriod, (reached.y - from.at.y) / kPeriod},
              (memory.turned[i] - from.yaw) / kPeriod};
  }
}

// The velocity of one who may drive where it faces, and its new yaw (not wrapped). Those who see the robot do not turn
// their body into it.
Vec CrowdState::steer(const Member &member, const Planar &from, Vec wanted, const Robot *robot, double &turned) const {
  const double speed = length_of(wanted), most = (member.steers ? kSteer : kTurn) * kPeriod;
  const double off = speed < 0.02 ? 0.0 : wrapped(bearing_of(wanted.y, wanted.x) - from.yaw);
  turned = from.yaw + std::clamp(off, -most, most);
  if (!member.steers) return wanted;
  if (robot != nullptr && turned != from.yaw &&
      distance_of(from.at, {robot->x, robot->y}) < member.radius + robot->radius + kSwing &&
      swings_into(from.at, from.yaw, turned, member.outline, *robot)) {
    turned = from.yaw;
  }
  const double ahead = speed * std::max(0.0, batch::sin_cos(off).cos);
  const SinCos turn = batch::sin_cos(turned);
  return {ahead * turn.cos, ahead * turn.sin};
}

// Where members get without overlapping others: past the one in the way, or nowhere.
void CrowdState::keep_apart(const CrowdModel &model, StepMemory &memory) const {
  const std::size_t count = from_.size(), all = memory.others.size();
  const std::vector<Moving> &others = memory.others;
  std::vector<Vec> &reached = memory.reached, &changed = memory.slid;
  for (int round = 0; round < 3; ++round) {
    bool any = false;
    changed = reached;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec p = from_[i].at;
      bool stopped = false;
      double nearest = std::numeric_limits<double>::infinity();
      std::size_t blocker = 0;
      for (std::size_t k = 0; k < all; ++k) {
        if (k == i) continue;
        const double least = model.members[i].radius + others[k].radius, now = distance_of(p, others[k].at);
        const auto overlaps = [&](double then) { return then < least && then < now - 1e-12; };
        if (!overlaps(distance_of(reached[i], others[k].at)) &&
            !(k < count && overlaps(distance_of(reached[i], reached[k])))) {
          continue;
        }
        stopped = true;
        if (now - least < nearest) nearest = now - least, blocker = k;
      }
      if (!stopped) continue;
      any = true;
      if (round > 0) {  // who still approaches someone stays
        changed[i] = p;
        continue;
      }
      const Vec offset{p.x - others[blocker].at.x, p.y - others[blocker].at.y};
      const double length = std::max(length_of(offset), 1e-9);
      const Vec away{offset.x / length, offset.y / length};
      const double inward = std::min(0.0, (reached[i].x - p.x) * away.x + (reached[i].y - p.y) * away.y);
      changed[i] = {reached[i].x - inward * away.x, reached[i].y - inward * away.y};
    }
    if (!any) break;
    reached.swap(changed);
  }
}

}  // namespace trundle::crowds
