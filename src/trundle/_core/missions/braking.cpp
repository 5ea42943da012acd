#include "missions/braking.hpp"

#include "missions/measures.hpp"

namespace trundle {

nb::ndarray<nb::numpy, double> stopping_poses(double x, double y, double yaw, double v, double w, double goal_v,
                                              double goal_w, double forward, double reverse, double turning,
                                              double acceleration, double angular_acceleration, double dt,
                                              double turn_step) {
  using namespace missions;
  if (!(dt > 0.0 && turn_step > 0.0 && acceleration > 0.0 && angular_acceleration > 0.0)) {
    throw nb::value_error("stopping_poses needs accelerations, a time and a step of turns above 0");
  }
  std::vector<Pose> poses;
  drive_and_brake({forward, reverse, turning, acceleration, angular_acceleration}, {x, y, yaw}, {v, w}, {goal_v, goal_w}, dt,
                  turn_step, poses);
  std::vector<double> numbers;
  numbers.reserve(3 * poses.size());
  for (const Pose &pose : poses) numbers.insert(numbers.end(), {pose.x, pose.y, pose.yaw});
  return to_numpy(std::move(numbers), {poses.size(), 3});
}

}  // namespace trundle
