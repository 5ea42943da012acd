// What a tracker takes for something that moves. trundle.tracking.TrackerSettings says what each number means.
#pragma once

namespace trundle::tracking {

struct Settings {
  double max_range, max_size, min_points, same_surface, acceleration, min_speed, confirm_scans, hidden_s, aside_s;
};

}  // namespace trundle::tracking
