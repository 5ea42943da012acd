// `CrowdModel`: the crowds of a world. `CrowdState`: where their members are in one run, stepped at a fixed period.
//
// Nothing of one run depends on another: the same seed, and the same poses of the robot, give the same bits.
#pragma once

#include "crowds/draws.hpp"
#include "crowds/floor.hpp"
#include "crowds/forces.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace trundle::crowds {

inline constexpr double kPeriod = 0.05;  // [s]; between two steps members move straight at constant speed

// A member of a crowd, or another that moves by a function of time: (x, y, yaw) and the velocities.
struct Planar {
  Vec at;
  double yaw;
  Vec velocity;
  double turning;
};

struct Member {
  std::size_t crowd;
  double radius, top;  // highest speed
  bool sees, steers;
  std::vector<Vec> outline;
};

struct CrowdModel {
  std::vector<std::shared_ptr<const Floor>> floors;  // of each crowd
  std::vector<std::size_t> ends;                     // where the members of each crowd end
  std::vector<Member> members;
  std::vector<double> mover_radii;  // of those who move by functions of time
};

// Memory that a thread keeps for the steps of any state.
struct StepMemory {
  MapMemory map;
  std::vector<Moving> others;
  std::vector<Vec> wanted, reached, slid;
  std::vector<double> turned, now;
  std::vector<std::uint8_t> stopped;
};

class CrowdState {
 public:
  // Start from four words of random bits for each crowd, with everyone at a random place. `movers` are (x, y, vx, vy) of
  // those who move by functions of time, at the start. Returns the first member without a place, or −1.
  std::int64_t reset(const CrowdModel &model, const std::uint64_t *words, const Robot &robot, const double *movers,
                     StepMemory &memory);

  // Go on by a period; `movers` are at its start. Who has no `robot` sees none.
  void step(const CrowdModel &model, const Robot *robot, const double *movers, StepMemory &memory) {
    ++index_;
    from_.swap(to_);
    next(model, robot, movers, memory);
  }

  // Steps since the start, and how many there are at a time: time has gone on to that of the last step, or beyond it.
  std::int64_t index() const { return index_; }
  static std::int64_t index_at(double time) { return static_cast<std::int64_t>(std::floor(time / kPeriod + 1e-9)); }

  // Where a member is at a time within the period that was stepped last.
  Planar at(std::size_t member, double time) const {
    const Planar &from = from_[member], &to = to_[member];
    const double since = (time / kPeriod - static_cast<double>(index_)) * kPeriod;
    return {{from.at.x + since * to.velocity.x, from.at.y + since * to.velocity.y},
            from.yaw + since * to.turning, to.velocity, to.turning};
  }

 private:
  bool place(const CrowdModel &model, std::size_t number, const Robot &robot, const double *movers);
  std::int32_t far_cell(const Floor &floor, Draws &draws, Vec here);
  void go_to(const Floor &floor, std::size_t number, std::int32_t cell, std::vector<Disc> discs);
  void back_out(const CrowdModel &model, std::size_t number, const Robot *robot, StepMemory &memory);
  void choose_goals(const CrowdModel &model, const Robot *robot, StepMemory &memory);
  void next(const CrowdModel &model, const Robot *robot, const double *movers, StepMemory &memory);
  Vec steer(const Member &member, const Planar &from, Vec wanted, const Robot *robot, double &turned) const;
  void keep_apart(const CrowdModel &model, StepMemory &memory) const;

  std::vector<Draws> draws_;  // of each crowd
  std::vector<Planar> from_, to_;
  std::vector<Vec> goals_, was_at_;  // `was_at_`: where the wait of each began
  std::vector<Route> routes_;
  std::vector<double> waits_, preferred_;
  std::int64_t index_ = 0;
};

}  // namespace trundle::crowds
