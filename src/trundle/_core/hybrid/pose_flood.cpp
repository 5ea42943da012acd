// A flood over poses: whether the poses near one end that the footprint may take are closed off from the other end.
//
// The poses (x, y, yaw) are divided into boxes. The outline given is the footprint, shrunk by as much as a
// point of it moves within a box: where the shrunk outline at a box's middle touches something, so does the footprint
// at every pose of the box. Boxes that are left are filled from one end over their faces, whatever the motions of the
// robot: a continuous path cannot leave a region of boxes but over a face of one of them that is left, too. So if the
// flood ends without the other end, no path joins the two (approximate cell decomposition: Zhu and Latombe, "New
// heuristic algorithms for efficient hierarchical path planning", IEEE Transactions on Robotics and Automation 7(1),
// 1991).
#include "hybrid/kernels.hpp"

#include "costmap/pose_checker.hpp"
#include "hybrid/search_memory.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

namespace trundle {

namespace {

enum class Flood { kClosedOff = 0, kMet = 1, kTooMany = 2, kTimeout = 3, kCancelled = 4 };

struct Box {
  std::int64_t col, row, heading;
};

class PoseFlood {
 public:
  PoseFlood(const std::uint8_t *costs, std::int64_t rows, std::int64_t cols, double resolution, const double *outline,
            std::size_t corners, double cell, std::int64_t headings)
      : cell_(cell),
        width_(static_cast<double>(cols) * resolution),
        height_(static_cast<double>(rows) * resolution),
        headings_(headings) {
    checker_.begin(costs, rows, cols, resolution, outline, corners, resolution);
    cols_ = static_cast<std::int64_t>(width_ / cell) + 2;
    closed_.begin();
  }

  // From one pose, or that position at any yaw, towards another one.
  Flood fill(const PlanarPose &from, bool any_yaw, const PlanarPose &to, bool to_any_yaw, std::size_t most,
             const SearchLimits &limits) {
    const Box first = box_of(from), last = box_of(to);
    const auto meets = [&](const Box &box) {
      return box.col == last.col && box.row == last.row && (to_any_yaw || box.heading == last.heading);
    };
    for (std::int64_t heading = 0; heading < headings_; ++heading) {
      if (any_yaw || heading == first.heading) reach({first.col, first.row, heading});
    }
    for (std::size_t next = 0; next < boxes_.size(); ++next) {
      if (next >= most) return Flood::kTooMany;
      if (next % 256 == 0) {
        const SearchStatus status = limits.check();
        if (status != SearchStatus::kFound) {
          return status == SearchStatus::kTimeout ? Flood::kTimeout : Flood::kCancelled;
        }
      }
      const Box box = boxes_[next];
      if (meets(box)) return Flood::kMet;
      reach({box.col - 1, box.row, box.heading});
      reach({box.col + 1, box.row, box.heading});
      reach({box.col, box.row - 1, box.heading});
      reach({box.col, box.row + 1, box.heading});
      reach({box.col, box.row, (box.heading + headings_ - 1) % headings_});
      reach({box.col, box.row, (box.heading + 1) % headings_});
    }
    return Flood::kClosedOff;
  }

  std::size_t size() const { return boxes_.size(); }

 private:
  double turn() const { return 2.0 * kPi / static_cast<double>(headings_); }

  Box box_of(const PlanarPose &pose) const {
    const std::int64_t heading = std::llround(pose.yaw / turn()) % headings_;
    return {static_cast<std::int64_t>(pose.x / cell_), static_cast<std::int64_t>(pose.y / cell_),
            (heading + headings_) % headings_};
  }

  // Adds a box that is on the map, new, and left.
  void reach(const Box &box) {
    const double x = (static_cast<double>(box.col) + 0.5) * cell_, y = (static_cast<double>(box.row) + 0.5) * cell_;
    if (box.col < 0 || box.row < 0 || x - 0.5 * cell_ >= width_ || y - 0.5 * cell_ >= height_) return;
    const auto key = static_cast<std::uint64_t>((box.row * cols_ + box.col) * headings_ + box.heading);
    if (closed_.contains(key)) return;
    closed_.insert(key);
    if (!checker_.collides_at(x, y, turn() * static_cast<double>(box.heading))) boxes_.push_back(box);
  }

  PoseChecker checker_;
  StateSet closed_;
  std::vector<Box> boxes_;
  const double cell_, width_, height_;
  const std::int64_t headings_;
  std::int64_t cols_ = 0;
};

PlanarPose pose_in(const In<double, 1> &values, double width, double height) {
  if (values.shape(0) != 3) throw nb::value_error("a pose needs three numbers");
  const PlanarPose pose{values.data()[0], values.data()[1], values.data()[2]};
  if (!(pose.x >= 0.0 && pose.x < width && pose.y >= 0.0 && pose.y < height && std::fabs(pose.yaw) < 1e6)) {
    throw nb::value_error("both ends must lie on the grid");
  }
  return pose;
}

}  // namespace

nb::tuple flood_poses(In<std::uint8_t, 2> costs, double resolution, In<double, 2> outline, In<double, 1> from,
                      bool any_yaw, In<double, 1> to, bool to_any_yaw, double cell, std::int64_t headings,
                      std::uint64_t most, std::optional<double> seconds, Flag cancel) {
  const auto is_size = [](double value) { return value >= 1e-9 && value <= 1e6; };
  if (!is_size(resolution) || !is_size(cell)) throw nb::value_error("resolution and cell must be from 1e-9 to 1e6");
  if (outline.shape(1) != 2 || outline.shape(0) < 3) throw nb::value_error("the outline needs shape (N, 2), N >= 3");
  const auto rows = static_cast<std::int64_t>(costs.shape(0)), cols = static_cast<std::int64_t>(costs.shape(1));
  const double width = static_cast<double>(cols) * resolution, height = static_cast<double>(rows) * resolution;
  if (headings < 1 || headings > 100'000 || (width / cell + 2.0) * (height / cell + 2.0) > 1e13) {
    throw nb::value_error("headings must be from 1 to 100,000, and no more than 1e13 cells may cover the map");
  }
  const PlanarPose first = pose_in(from, width, height), last = pose_in(to, width, height);
  const CallLimits limits(seconds, cancel);
  Flood answer{};
  std::size_t count = 0;
  {
    nb::gil_scoped_release release;
    PoseFlood flood(costs.data(), rows, cols, resolution, outline.data(), outline.shape(0), cell, headings);
    answer = flood.fill(first, any_yaw, last, to_any_yaw, most, limits);
    count = flood.size();
  }
  limits.rethrow();
  return nb::make_tuple(static_cast<int>(answer), count);
}

}  // namespace trundle
