// `BatchCrowds`: the crowds around each robot of a batch, which see that robot alone.
#pragma once

#include "crowds/arrays.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace trundle {

class BatchCrowds {
 public:
  // Crowds of one recording, whose members are the batch's movers from `first` on, and those who move by functions of
  // time: their (x, y, vx, vy) at each step. After the last one they stand.
  struct Scene {
    std::shared_ptr<const crowds::CrowdModel> model;
    std::size_t first;
    std::vector<double> movers;
    std::size_t samples;

    const double *movers_at(std::int64_t step) const {
      const std::size_t row = std::min(static_cast<std::size_t>(step), samples - 1);
      return movers.data() + 4 * model->mover_radii.size() * row;
    }
  };

  struct Run {
    static constexpr double kLongest = 1e8;  // [s]
    const Scene *scene;
    crowds::CrowdState state;

    void advance(double time, const crowds::Robot &robot, crowds::StepMemory &memory) {
      if (!(time < kLongest)) throw nb::value_error("a crowd walks for three years at most");
      const std::int64_t wanted = crowds::CrowdState::index_at(time);
      while (state.index() < wanted) state.step(*scene->model, &robot, scene->movers_at(state.index() + 1), memory);
    }
  };

  BatchCrowds(std::vector<std::shared_ptr<const crowds::CrowdModel>> models, In<std::int64_t, 1> firsts,
              In<std::int64_t, 1> of_recording, std::vector<In<double, 3>> movers, std::size_t count);
  BatchCrowds(const BatchCrowds &) = delete;
  BatchCrowds &operator=(const BatchCrowds &) = delete;

  // Start the crowds of some robots at poses on recordings, by random `words` of shape (robots, crowds, 4). Returns of
  // each robot the first member that finds no place, or −1. Where there is one, all robots keep the crowds they had.
  nb::ndarray<nb::numpy, std::int64_t> place(In<std::int64_t, 1> rows, In<std::int64_t, 1> recordings,
                                             In<double, 2> poses, double radius, In<std::uint64_t, 3> words,
                                             std::int64_t threads);

  // (x, y, yaw) of the members of a robot's crowds at the time that it has come to.
  nb::ndarray<nb::numpy, double> members(std::size_t robot, double time) const;

  // The crowds of a robot; none where its recording has none.
  Run *run_of(std::size_t robot) { return runs_[robot].get(); }
  const Run *run_of(std::size_t robot) const { return runs_[robot].get(); }

  // Whether a robot's crowds are those of a recording.
  bool fits(std::size_t robot, std::int64_t recording) const {
    const Run *run = run_of(robot);
    return (run == nullptr ? nullptr : run->scene) == scene_of(recording);
  }

  void check(std::size_t robots, std::size_t movers, std::size_t recordings) const;

 private:
  const Scene *scene_of(std::int64_t recording) const {
    const std::int64_t scene = recording < 0 ? -1 : of_recording_[static_cast<std::size_t>(recording)];
    return scene < 0 ? nullptr : &scenes_[static_cast<std::size_t>(scene)];
  }

  std::vector<Scene> scenes_;
  std::vector<std::int64_t> of_recording_;
  std::vector<std::unique_ptr<Run>> runs_;
};

}  // namespace trundle
