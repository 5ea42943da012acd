// What earlier scans of a lidar say about the hits of a new one: the scans of the last second, whose memory is used again.
#pragma once

#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "shared/bearing.hpp"
#include "tracking/sweep.hpp"

namespace trundle::tracking {

class EarlierSweeps {
 public:
  // Memory for a new scan; it becomes the newest of these with `keep`.
  View &fresh() {
    if (next_ == nullptr) {
      next_ = std::make_unique<View>();
    }
    return *next_;
  }

  void keep() {
    const double time = next_->time;
    views_.push_back(std::move(next_));
    while (views_.front()->time < time - kKept) {
      next_ = std::move(views_.front());
      views_.pop_front();
    }
  }

  // Of the latest scan that is kept; null without one.
  const View *latest() const { return views_.empty() ? nullptr : views_.back().get(); }

  // Which hits of a new scan are where an earlier one saw through, and which belong to what stands still: every scan of
  // half a second or a second ago, as far as it saw that place, saw a surface there.
  void judge(Sweep &sweep, double margin) {
    std::vector<Hit> &hits = sweep.hits();
    static_assert(sizeof(Hit) % sizeof(double) == 0);
    directions_.resize(hits.size());
    for (const double age : kAges) {
      const View *before = at(sweep.view().time - age);
      if (before == nullptr) {
        continue;
      }
      if (!hits.empty()) {
        bearings_from(before->sensor.x, before->sensor.y, &hits[0].point.x, sizeof(Hit) / sizeof(double), hits.size(),
                      directions_.data());
      }
      for (std::size_t i = 0; i < hits.size(); ++i) {
        Hit &hit = hits[i];
        if (hit.appeared) {
          continue;  // nothing makes that still
        }
        const Sight seen = before->judge(hit.point, margin, directions_[i]);
        hit.appeared = seen == Sight::kThrough;
        hit.still = hit.still || (age >= kStill && seen == Sight::kThere);
      }
    }
    for (Hit &hit : hits) {
      hit.still = hit.still && !hit.appeared;
    }
  }

 private:
  // The latest scan from before a time, if it is not much older.
  const View *at(double time) const {
    const View *found = nullptr;
    for (const auto &view : views_) {
      if (view->time > time + 1e-6) {
        break;
      }
      found = view.get();
    }
    return found != nullptr && found->time >= time - kLate ? found : nullptr;
  }

  static constexpr double kAges[] = {0.25, 0.5, 1.0};
  static constexpr double kStill = 0.4;  // what was there before this is still
  static constexpr double kLate = 0.1, kKept = 1.2;

  std::deque<std::unique_ptr<View>> views_;
  std::unique_ptr<View> next_;
  std::vector<double> directions_;  // of the hits at hand
};

}  // namespace trundle::tracking
