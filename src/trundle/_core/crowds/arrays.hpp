// Crowds as Python gives them: a floor, a model of floors and members, and one run of it. All numbers are checked here.
#pragma once

#include "crowds/walk.hpp"
#include "shared/checks.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include <mutex>

namespace trundle::crowds {

inline Robot robot_of(const In<double, 1> &values) {
  require(values.size() == 5 && is_finite(values), "a robot needs finite x, y, vx, vy and radius");
  const double *v = values.data();
  return {v[0], v[1], v[2], v[3], v[4]};
}

inline std::shared_ptr<const Floor> make_floor(In<std::uint8_t, 2> costs, In<std::uint8_t, 2> nearness,
                                               double corner_x, double corner_y, double resolution, double reach,
                                               int look) {
  auto floor = std::make_shared<Floor>();
  const std::size_t rows = costs.shape(0), cols = costs.shape(1);
  require(rows >= 3 && cols >= 3 && rows * cols < (1u << 30), "a floor needs 3 rows and columns or more");
  require(nearness.shape(0) == rows && nearness.shape(1) == cols, "nearness needs the shape of the costs");
  require(std::abs(corner_x) < 1e9 && std::abs(corner_y) < 1e9 && resolution > 1e-6 && resolution < 1e6 &&
              reach > 0.0 && reach < 1e6 && look > 0 && look < 10'000,
          "a floor needs a finite corner, and a positive resolution, reach and look");
  floor->rows = static_cast<std::int32_t>(rows), floor->cols = static_cast<std::int32_t>(cols);
  floor->costs.assign(costs.data(), costs.data() + costs.size());
  floor->nearness.assign(nearness.data(), nearness.data() + nearness.size());
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const std::size_t row = i / cols, col = i % cols;
    if (row == 0 || col == 0 || row + 1 == rows || col + 1 == cols) {
      require(floor->costs[i] == Floor::kWall, "the rim of a floor must be wall");
    } else if (floor->costs[i] != Floor::kWall) {
      floor->free.push_back(static_cast<std::int32_t>(i));
    }
  }
  require(!floor->free.empty(), "a floor needs a free cell");
  floor->corner_x = corner_x, floor->corner_y = corner_y, floor->resolution = resolution, floor->reach = reach;
  floor->look = look;
  return floor;
}

inline std::shared_ptr<const CrowdModel> make_model(std::vector<std::shared_ptr<const Floor>> floors,
                                                    In<std::int64_t, 1> counts, In<double, 2> members,
                                                    In<double, 2> corners, In<std::int64_t, 1> corner_counts,
                                                    In<double, 1> mover_radii) {
  auto model = std::make_shared<CrowdModel>();
  require(!floors.empty() && counts.size() == floors.size(), "each crowd needs a floor and a number of members");
  require(members.shape(1) == 4 && is_finite(members) && corner_counts.size() == members.shape(0),
          "members need shape (N, 4), and a number of corners each");
  require(corners.shape(1) == 2 && is_finite(corners) && is_finite(mover_radii), "corners and radii must be finite");
  std::size_t end = 0, corner = 0;
  for (std::size_t crowd = 0; crowd < floors.size(); ++crowd) {
    const std::int64_t count = counts.data()[crowd];
    require(floors[crowd] != nullptr && count > 0 && static_cast<std::size_t>(count) <= members.shape(0) - end,
            "there are fewer members than the crowds have");
    for (std::int64_t i = 0; i < count; ++i, ++end) {
      const double *m = members.data() + 4 * end;
      require(m[0] > 0.0 && m[1] > 0.0, "members need a positive radius and speed");
      Member member{crowd, m[0], m[1], m[2] != 0.0, m[3] != 0.0, {}};
      const std::int64_t sides = corner_counts.data()[end];
      require(sides >= 3 && static_cast<std::size_t>(sides) <= corners.shape(0) - corner, "a member lacks corners");
      for (std::int64_t k = 0; k < sides; ++k, ++corner) {
        member.outline.push_back({corners.data()[2 * corner], corners.data()[2 * corner + 1]});
      }
      model->members.push_back(std::move(member));
    }
    model->ends.push_back(end);
  }
  require(end == members.shape(0) && corner == corners.shape(0), "there are more members or corners than crowds have");
  model->floors = std::move(floors);
  model->mover_radii.assign(mover_radii.data(), mover_radii.data() + mover_radii.size());
  return model;
}

// One run of crowds, stepped from Python. Calls of several threads wait for each other.
class CrowdRun {
 public:
  explicit CrowdRun(std::shared_ptr<const CrowdModel> model) : model_(std::move(model)) {
    require(model_ != nullptr, "a run needs a model");
  }

  std::int64_t reset(In<std::uint64_t, 2> words, In<double, 1> robot, In<double, 2> movers) {
    require(words.shape(0) == model_->floors.size() && words.shape(1) == 4, "words need shape (crowds, 4)");
    check_movers(movers);
    const Robot seen = robot_of(robot);
    nb::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    is_placed_ = false;
    const std::int64_t missing = state_.reset(*model_, words.data(), seen, movers.data(), memory_);
    is_placed_ = missing < 0;
    return missing;
  }

  void step(const std::optional<In<double, 1>> &robot, In<double, 2> movers) {
    require(is_placed_, "a run begins with a reset");
    check_movers(movers);
    Robot seen{};
    if (robot) seen = robot_of(*robot);
    nb::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    state_.step(*model_, robot ? &seen : nullptr, movers.data(), memory_);
  }

  nb::ndarray<nb::numpy, double> at(double time) const {
    require(is_placed_ && std::abs(time) < 1e9, "a run begins with a reset, and times are finite");
    std::vector<double> rows;
    {
      nb::gil_scoped_release release;
      const std::lock_guard<std::mutex> lock(mutex_);
      for (std::size_t i = 0; i < model_->members.size(); ++i) {
        const Planar now = state_.at(i, time);
        rows.insert(rows.end(), {now.at.x, now.at.y, now.yaw, now.velocity.x, now.velocity.y, now.turning});
      }
    }
    return to_numpy(std::move(rows), {model_->members.size(), 6});
  }

  std::int64_t index() const { return state_.index(); }

 private:
  void check_movers(const In<double, 2> &movers) const {
    require(movers.shape(0) == model_->mover_radii.size() && movers.shape(1) == 4 && is_finite(movers),
            "movers need shape (M, 4)");
  }

  std::shared_ptr<const CrowdModel> model_;
  CrowdState state_;
  StepMemory memory_;
  bool is_placed_ = false;
  mutable std::mutex mutex_;
};

}  // namespace trundle::crowds
