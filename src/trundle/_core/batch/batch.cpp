// `Batch`: its checks, and its loops over robots.
#include "batch/batch.hpp"

#include "shared/checks.hpp"

#include <cmath>

namespace trundle {

namespace {

using namespace batch;

constexpr double kFarthest = 1e12;  // robots may drive beyond where they can be put

Point unit_vector(double angle) {
  const SinCos turn = sin_cos(angle);
  return {turn.cos, turn.sin};
}

bool is_convex(const std::vector<Point> &polygon) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()], &c = polygon[(i + 2) % polygon.size()];
    if (!((b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x) > 0.0)) return false;
  }
  return polygon.size() >= 3;
}

double reach_of(const std::vector<Point> &polygon) {
  double reach = 0.0;
  for (const Point &corner : polygon) reach = std::max(reach, std::sqrt(corner.x * corner.x + corner.y * corner.y));
  return reach;
}

// Where the members of a robot's crowds are, nowhere without crowds.
void find_members(const BatchCrowds::Run *crowd, double time, Members &members) {
  members.poses.clear();
  if (crowd == nullptr) return;
  members.first = crowd->scene->first;
  for (std::size_t i = 0; i < crowd->scene->model->members.size(); ++i) {
    const crowds::Planar now = crowd->state.at(i, time);
    members.poses.push_back({now.at.x, now.at.y, now.yaw});
  }
}

}  // namespace

Batch::Batch(In<std::uint8_t, 1> fields, In<std::int64_t, 2> shapes, In<double, 2> frames, double resolution,
             In<double, 2> outline, In<double, 1> limits, In<double, 2> lidars, In<std::int64_t, 1> beams,
             In<double, 1> angles, In<double, 2> corners, In<std::int64_t, 1> corner_counts, In<double, 1> radii,
             In<double, 3> tracks, In<std::int64_t, 1> recordings, double period)
    : fields_(fields.data(), fields.data() + fields.size()), tracks_(tracks.data(), tracks.data() + tracks.size()) {
  require(resolution > 1e-6 && resolution < 1e6, "the resolution must be a positive number");
  require(shapes.shape(0) > 0 && shapes.shape(1) == 2 && frames.shape(0) == shapes.shape(0) && frames.shape(1) == 3,
          "maps need shapes (M, 2) and frames (M, 3)");
  require(is_finite(frames, kFarthest) && is_finite(tracks, kFarthest), "poses must be finite");
  std::size_t offset = 0;
  for (std::size_t i = 0; i < shapes.shape(0); ++i) {
    const std::int64_t rows = shapes.data()[2 * i], cols = shapes.data()[2 * i + 1];
    require(rows > 0 && cols > 0 && rows < (1 << 30) && cols < (1 << 30), "a map needs cells");
    const auto cells = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
    require(cells <= fields_.size() - offset, "there are fewer cells than the maps have");
    const double *frame = frames.data() + 3 * i;
    maps_.push_back({{fields_.data() + offset, static_cast<std::ptrdiff_t>(rows), static_cast<std::ptrdiff_t>(cols)},
                     frame[0], frame[1], frame[2], sin_cos(frame[2])});
    offset += cells;
  }
  require(offset == fields_.size(), "there are more cells than the maps have");

  require(outline.shape(1) == 2 && is_finite(outline), "the outline needs shape (N, 2)");
  for (std::size_t i = 0; i < outline.shape(0); ++i) {
    model_.outline.push_back({outline.data()[2 * i], outline.data()[2 * i + 1]});
  }
  require(is_convex(model_.outline), "the outline must be convex and counter-clockwise");
  model_.radius = reach_of(model_.outline);
  model_.resolution = resolution;
  model_.cover_outline();
  require(limits.size() == 9, "there are nine limits");
  for (std::size_t i = 0; i < 9; ++i) require(limits.data()[i] >= 0.0, "limits must not be negative");
  const double *l = limits.data();
  require(l[5] > 0.0 && l[6] > 0.0 && l[8] > 0.0 && l[8] <= 3600.0, "wheels, track and timestep must be positive");
  model_.limits = {l[0], l[1], l[2], {l[3], l[4], l[5], l[6], l[7]}, l[8]};

  require(lidars.shape(1) == 5 && beams.size() == lidars.shape(0) && is_finite(lidars) && is_finite(angles),
          "lidars need shape (L, 5), and a number of beams each");
  std::size_t first = 0;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const double *lidar = lidars.data() + 5 * i;
    const std::int64_t count = beams.data()[i];
    require(count >= 0 && static_cast<std::size_t>(count) <= angles.size() - first, "each beam needs an angle");
    require(lidar[3] >= 0.0 && lidar[4] >= lidar[3], "a lidar's range_max must be above its range_min");
    model_.lidars.push_back({{lidar[0], lidar[1]}, lidar[3], lidar[4], first, first + static_cast<std::size_t>(count)});
    for (std::int64_t k = 0; k < count; ++k) model_.beams.push_back(unit_vector(angles.data()[first++] + lidar[2]));
  }
  require(first == angles.size(), "each angle needs a lidar");

  const std::size_t movers = corner_counts.size();
  require(corners.shape(1) == 2 && is_finite(corners) && is_finite(radii) && radii.size() == movers &&
              tracks.shape(0) == movers && tracks.shape(2) == 3 && (movers == 0 || tracks.shape(1) > 0),
          "movers need corners (C, 2), a radius and a track (T, 3) each");
  require(period > 1e-9 && period < 1e9, "the period of tracks must be a positive number");
  movers_.samples = tracks.shape(1);
  movers_.period = period;
  std::size_t corner = 0;
  for (std::size_t i = 0; i < movers; ++i) {
    const std::int64_t count = corner_counts.data()[i];
    require(count >= 0 && static_cast<std::size_t>(count) <= corners.shape(0) - corner, "a mover lacks corners");
    Mover mover{radii.data()[i], {}, tracks_.data() + 3 * movers_.samples * i};
    for (std::int64_t k = 0; k < count; ++k, ++corner) {
      mover.corners.push_back({corners.data()[2 * corner], corners.data()[2 * corner + 1]});
    }
    require(count == 0 ? mover.radius > 0.0 : is_convex(mover.corners), "a mover must be a disc or a convex polygon");
    if (count > 0) mover.radius = reach_of(mover.corners);
    movers_.all.push_back(std::move(mover));
  }
  require(corner == corners.shape(0), "there are more corners than the movers have");
  for (std::size_t i = 0; i + 1 < recordings.size(); ++i) {
    const std::int64_t from = recordings.data()[i], to = recordings.data()[i + 1];
    require(0 <= from && from <= to && static_cast<std::size_t>(to) <= movers, "recordings are ranges of movers");
    movers_.recordings.push_back({static_cast<std::size_t>(from), static_cast<std::size_t>(to)});
  }
}

void Batch::check_places(const In<std::int64_t, 2> &places, const In<bool, 1> &active,
                         const BatchCrowds *crowds) const {
  if (crowds != nullptr) crowds->check(active.size(), movers_.all.size(), movers_.recordings.size());
  for (std::size_t i = 0; i < places.shape(0); ++i) {
    const std::int64_t map = places.data()[2 * i], recording = places.data()[2 * i + 1];
    require(map >= 0 && static_cast<std::size_t>(map) < maps_.size(), "there is no such map");
    require(recording >= -1 && recording < static_cast<std::int64_t>(movers_.recordings.size()),
            "there is no such recording");
    if (crowds != nullptr && active.data()[i]) {
      require(crowds->fits(i, recording), "a robot is among a crowd that was not placed");
    }
  }
}

void Batch::drive_one(double *pose, RampedMotion &motion, double *wheels, double &length, std::int64_t &step,
                      std::int64_t *contact, const double *command, const std::int64_t *place, std::int64_t substeps,
                      BatchCrowds::Run *crowd, Memory &memory) const {
  const Limits &limits = model_.limits;
  const Map &map = maps_[static_cast<std::size_t>(place[0])];
  const std::int64_t recording = place[1];
  const double v = std::min(limits.forward, std::max(-limits.reverse, command[0]));
  const double w = std::min(limits.turning, std::max(-limits.turning, command[1]));
  const double dt = limits.timestep;
  Touched touched{0, 0, 0, 0};
  // While what it has moved is less than the room that it had, the map needs no look.
  double spare = model_.room({pose[0], pose[1], pose[2]}, map);
  const auto look = [&](std::int64_t substep) {
    const double time = static_cast<double>(step) * dt;
    if (crowd != nullptr) {
      const SinCos turn = sin_cos(pose[2]);
      crowd->advance(time, {pose[0], pose[1], motion.v * turn.cos, motion.v * turn.sin, model_.radius}, memory.steps);
    }
    if (touched.kind != 0) return;
    if (spare < 0.0) spare = model_.room({pose[0], pose[1], pose[2]}, map);
    if (spare >= 0.0 && recording < 0) return;
    find_members(crowd, time, memory.members);
    touched = model_.touch({pose[0], pose[1], pose[2]}, map, spare >= 0.0, movers_, recording, time, memory.members,
                           memory.spans, memory.one, memory.other);
    touched.substep = substep;
  };
  if (substeps == 0) look(0);
  double by_length = 0.0, by_turn = 0.0, along = 1.0, across = 0.0, moved = 0.0;
  double last_v = std::nan(""), last_w = 0.0;
  for (std::int64_t substep = 1; substep <= substeps; ++substep) {
    motion.approach(v, w, limits.ramp);
    if (motion.v != last_v || motion.w != last_w) {
      last_v = motion.v;
      last_w = motion.w;
      by_length = motion.v * dt;
      by_turn = motion.w * dt;
      moved = (std::abs(by_length) + std::abs(by_turn) * model_.radius) * (1.0 + 1e-9);
      if (std::abs(by_turn) < 1e-6) {
        along = 1.0 - by_turn * by_turn / 6.0;
        across = by_turn / 2.0;
      } else {
        const SinCos turn = sin_cos(by_turn);
        along = turn.sin / by_turn;
        across = (1.0 - turn.cos) / by_turn;
      }
    }
    const SinCos turn = sin_cos(pose[2]);
    pose[0] += by_length * (turn.cos * along - turn.sin * across);
    pose[1] += by_length * (turn.sin * along + turn.cos * across);
    pose[2] += by_turn;
    wheels[0] += motion.left_speed * dt;
    wheels[1] += motion.right_speed * dt;
    length += std::abs(by_length);
    ++step;
    spare -= moved;
    look(substep);
  }
  contact[0] = touched.kind;
  contact[1] = touched.first;
  contact[2] = touched.second;
  contact[3] = touched.kind == 0 ? 0 : touched.substep;
}

void Batch::drive(InOut<double, 2> poses, InOut<double, 2> motions, InOut<double, 2> wheels, InOut<double, 1> lengths,
                  InOut<std::int64_t, 1> steps, InOut<std::int64_t, 2> contacts, In<double, 2> commands,
                  In<std::int64_t, 2> places, In<bool, 1> active, std::int64_t substeps, std::int64_t threads,
                  BatchCrowds *crowds) const {
  const std::size_t count = active.size();
  require(poses.shape(0) == count && poses.shape(1) == 3, "poses need shape (N, 3)");
  require(motions.shape(0) == count && motions.shape(1) == 6, "motions need shape (N, 6)");
  require(wheels.shape(0) == count && wheels.shape(1) == 2, "wheels need shape (N, 2)");
  require(lengths.size() == count && steps.size() == count, "lengths and steps need shape (N,)");
  require(contacts.shape(0) == count && contacts.shape(1) == 4, "contacts need shape (N, 4)");
  require(commands.shape(0) == count && commands.shape(1) == 2, "commands need shape (N, 2)");
  require(places.shape(0) == count && places.shape(1) == 2, "places need shape (N, 2)");
  require(is_finite(poses, kFarthest) && is_finite(commands, kFarthest) && is_finite(motions, kFarthest),
          "poses and commands must be finite");
  require(substeps >= 0 && substeps <= 10'000'000, "the number of substeps is out of range");
  check_places(places, active, crowds);
  double *pose = poses.data(), *motion = motions.data(), *wheel = wheels.data(), *length = lengths.data();
  std::int64_t *step = steps.data(), *contact = contacts.data();
  nb::gil_scoped_release release;
  each_robot<Memory>(count, active.data(), threads, 32, [&](std::size_t i, Memory &memory) {
    double *m = motion + 6 * i;
    RampedMotion now{m[0], m[1], m[2], m[3], m[4], m[5]};
    drive_one(pose + 3 * i, now, wheel + 2 * i, length[i], step[i], contact + 4 * i, commands.data() + 2 * i,
              places.data() + 2 * i, substeps, crowds == nullptr ? nullptr : crowds->run_of(i), memory);
    m[0] = now.ramp_v, m[1] = now.ramp_w, m[2] = now.v, m[3] = now.w, m[4] = now.left_speed, m[5] = now.right_speed;
  });
}

template <typename Range>
void Batch::scan(InOut<Range, 2> ranges, In<double, 2> poses, In<std::int64_t, 1> steps, In<std::int64_t, 2> places,
                 In<bool, 1> active, In<double, 2> errors, In<std::uint64_t, 1> keys, std::int64_t threads,
                 const BatchCrowds *crowds) const {
  const std::size_t count = active.size(), beams = model_.beams.size();
  require(ranges.shape(0) == count && ranges.shape(1) == beams, "ranges need shape (N, beams)");
  require(poses.shape(0) == count && poses.shape(1) == 3 && is_finite(poses, kFarthest), "poses need shape (N, 3)");
  require(places.shape(0) == count && places.shape(1) == 2, "places need shape (N, 2)");
  require(errors.shape(0) == count && errors.shape(1) == 2 && is_finite(errors), "errors need shape (N, 2)");
  require(steps.size() == count && keys.size() == count, "steps and keys need shape (N,)");
  check_places(places, active, crowds);
  Range *out = ranges.data();
  nb::gil_scoped_release release;
  each_robot<Memory>(count, active.data(), threads, 2, [&](std::size_t i, Memory &memory) {
    const double *pose = poses.data() + 3 * i, *error = errors.data() + 2 * i;
    const std::int64_t *place = places.data() + 2 * i, step = steps.data()[i];
    const double time = static_cast<double>(step) * model_.limits.timestep;
    find_members(crowds == nullptr ? nullptr : crowds->run_of(i), time, memory.members);
    const Errors errors_of_beams{error[0], error[1], keys.data()[i], static_cast<std::uint64_t>(step)};
    model_.scan(Pose{pose[0], pose[1], pose[2]}, maps_[static_cast<std::size_t>(place[0])], movers_, place[1],
                time, memory.members, errors_of_beams, memory.other, out + beams * i);
  });
}

template void Batch::scan(InOut<float, 2>, In<double, 2>, In<std::int64_t, 1>, In<std::int64_t, 2>, In<bool, 1>,
                          In<double, 2>, In<std::uint64_t, 1>, std::int64_t, const BatchCrowds *) const;
template void Batch::scan(InOut<double, 2>, In<double, 2>, In<std::int64_t, 1>, In<std::int64_t, 2>, In<bool, 1>,
                          In<double, 2>, In<std::uint64_t, 1>, std::int64_t, const BatchCrowds *) const;

}  // namespace trundle
