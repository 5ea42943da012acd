// `BatchCrowds`: its checks, and where the crowds of robots start.
#include "batch/batch_crowds.hpp"

#include "batch/each_robot.hpp"

namespace trundle {

BatchCrowds::BatchCrowds(std::vector<std::shared_ptr<const crowds::CrowdModel>> models, In<std::int64_t, 1> firsts,
                         In<std::int64_t, 1> of_recording, std::vector<In<double, 3>> movers, std::size_t count)
    : of_recording_(of_recording.data(), of_recording.data() + of_recording.size()), runs_(count) {
  require(firsts.size() == models.size() && movers.size() == models.size(), "each model needs a first and movers");
  for (std::size_t i = 0; i < models.size(); ++i) {
    const In<double, 3> &each = movers[i];
    require(models[i] != nullptr && firsts.data()[i] >= 0, "a recording needs a model and its first member");
    require(each.shape(0) > 0 && each.shape(1) == models[i]->mover_radii.size() && each.shape(2) == 4 &&
                is_finite(each),
            "movers need shape (samples, M, 4)");
    scenes_.push_back({std::move(models[i]), static_cast<std::size_t>(firsts.data()[i]),
                       {each.data(), each.data() + each.size()}, each.shape(0)});
  }
  for (const std::int64_t scene : of_recording_) {
    require(scene >= -1 && scene < static_cast<std::int64_t>(scenes_.size()), "there is no such model");
  }
}

nb::ndarray<nb::numpy, std::int64_t> BatchCrowds::place(In<std::int64_t, 1> rows, In<std::int64_t, 1> recordings,
                                                        In<double, 2> poses, double radius,
                                                        In<std::uint64_t, 3> words, std::int64_t threads) {
  const std::size_t count = rows.size();
  require(recordings.size() == count && poses.shape(0) == count && poses.shape(1) == 3 && is_finite(poses) &&
              words.shape(0) == count && words.shape(2) == 4 && radius >= 0.0 && radius < 1e6,
          "robots need a recording, a pose, and words of shape (crowds, 4) each");
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t row = rows.data()[i], recording = recordings.data()[i];
    require(row >= 0 && static_cast<std::size_t>(row) < runs_.size() && recording >= -1 &&
                recording < static_cast<std::int64_t>(of_recording_.size()),
            "there is no such robot or recording");
    const Scene *scene = scene_of(recording);
    require(scene == nullptr || scene->model->floors.size() <= words.shape(1), "each crowd needs random words");
  }
  std::vector<std::int64_t> missing(count, -1);
  std::vector<std::unique_ptr<Run>> started(count);
  {
    nb::gil_scoped_release release;
    each_robot<crowds::StepMemory>(count, nullptr, threads, 1, [&](std::size_t i, crowds::StepMemory &memory) {
      const Scene *scene = scene_of(recordings.data()[i]);
      if (scene == nullptr) return;
      started[i] = std::make_unique<Run>(Run{scene, {}});
      const double *pose = poses.data() + 3 * i;
      missing[i] = started[i]->state.reset(*scene->model, words.data() + 4 * words.shape(1) * i,
                                           {pose[0], pose[1], 0.0, 0.0, radius}, scene->movers_at(0), memory);
    });
  }
  if (std::all_of(missing.begin(), missing.end(), [](std::int64_t member) { return member < 0; })) {
    for (std::size_t i = 0; i < count; ++i) runs_[static_cast<std::size_t>(rows.data()[i])] = std::move(started[i]);
  }
  return to_numpy(std::move(missing), {count});
}

nb::ndarray<nb::numpy, double> BatchCrowds::members(std::size_t robot, double time) const {
  require(robot < runs_.size() && std::abs(time) < 1e9, "there is no such robot, or the time is not finite");
  std::vector<double> rows;
  const Run *run = run_of(robot);
  const std::size_t count = run == nullptr ? 0 : run->scene->model->members.size();
  for (std::size_t i = 0; i < count; ++i) {
    const crowds::Planar now = run->state.at(i, time);
    rows.insert(rows.end(), {now.at.x, now.at.y, now.yaw});
  }
  return to_numpy(std::move(rows), {count, 3});
}

void BatchCrowds::check(std::size_t robots, std::size_t movers, std::size_t recordings) const {
  require(runs_.size() == robots && of_recording_.size() == recordings, "crowds belong to another batch");
  for (const Scene &scene : scenes_) {
    require(scene.first <= movers && scene.model->members.size() <= movers - scene.first,
            "members of crowds need movers of the batch");
  }
}

}  // namespace trundle
