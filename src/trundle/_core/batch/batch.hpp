// `Batch`: many robots of one model on many maps, each computed by itself, by as many threads as are asked for.
//
// Nothing of one robot depends on another or on the thread that computes it: N robots get the bits that each alone gets.
#pragma once

#include "batch/batch_crowds.hpp"
#include "batch/each_robot.hpp"
#include "batch/robot_model.hpp"
#include "shared/arrays.hpp"

#include <cstdint>
#include <vector>

namespace trundle {

template <typename T, int Rank>
using InOut = nb::ndarray<T, nb::ndim<Rank>, nb::c_contig, nb::device::cpu>;

class Batch {
 public:
  Batch(In<std::uint8_t, 1> fields, In<std::int64_t, 2> shapes, In<double, 2> frames, double resolution,
        In<double, 2> outline, In<double, 1> limits, In<double, 2> lidars, In<std::int64_t, 1> beams,
        In<double, 1> angles, In<double, 2> corners, In<std::int64_t, 1> corner_counts, In<double, 1> radii,
        In<double, 3> tracks, In<std::int64_t, 1> recordings, double period);

  // Drive `substeps` with a command (v, w) for each robot, and find the first thing that each touched; none for robots
  // that are not `active`. Without substeps it finds what they touch where they are. Recordings with crowds need these,
  // with each robot's placed.
  void drive(InOut<double, 2> poses, InOut<double, 2> motions, InOut<double, 2> wheels, InOut<double, 1> lengths,
             InOut<std::int64_t, 1> steps, InOut<std::int64_t, 2> contacts, In<double, 2> commands,
             In<std::int64_t, 2> places, In<bool, 1> active, std::int64_t substeps, std::int64_t threads,
             BatchCrowds *crowds) const;

  // Turn every lidar of the active robots once.
  template <typename Range>
  void scan(InOut<Range, 2> ranges, In<double, 2> poses, In<std::int64_t, 1> steps, In<std::int64_t, 2> places,
            In<bool, 1> active, In<double, 2> errors, In<std::uint64_t, 1> keys, std::int64_t threads,
            const BatchCrowds *crowds) const;

 private:
  struct Memory {
    batch::Spans spans;
    std::vector<batch::Point> one, other;
    batch::Members members;
    crowds::StepMemory steps;
  };

  void drive_one(double *pose, RampedMotion &motion, double *wheels, double &length,
                 std::int64_t &step, std::int64_t *contact, const double *command, const std::int64_t *place,
                 std::int64_t substeps, BatchCrowds::Run *crowd, Memory &memory) const;
  void check_places(const In<std::int64_t, 2> &places, const In<bool, 1> &active, const BatchCrowds *crowds) const;

  std::vector<std::uint8_t> fields_;
  std::vector<double> tracks_;
  std::vector<batch::Map> maps_;
  batch::Movers movers_;
  batch::RobotModel model_;
};

}  // namespace trundle
