#include "tracking/followed.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace trundle::tracking {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kGate = 0.15, kGateDeviations = 2.0, kWidestGate = 0.6;
constexpr double kAppearedShare = 0.3, kStillShare = 0.7;
constexpr std::size_t kLeftSamples = 3;  // of the rim
constexpr double kSamples[kRimSamples] = {0.1, 0.3, 0.5, 0.7, 0.9};
constexpr double kLeftAfter = 0.3, kRimsKept = 0.6;
constexpr double kTentative = 0.25, kEmpty = 0.3;
constexpr double kMostProofs = 6.0, kForgottenProof = 0.25;
constexpr std::size_t kMostTentative = 64;
constexpr double kLeastRadius = 0.05, kResizeShare = 0.15, kAway = 0.8;
constexpr double kSignificant = 2.5;  // standard deviations
constexpr double kStaysShare = 0.6, kFast = 0.3;
constexpr double kMean = 0.3, kStray = 0.2;
constexpr double kLost = 1.0, kJust = 0.15, kFastest = 4.0;
constexpr double kSamePlace = 0.6;  // of the larger radius

double length(double x, double y) { return std::sqrt(x * x + y * y); }

double square(Point a, Point b) {
  const double dx = a.x - b.x, dy = a.y - b.y;
  return dx * dx + dy * dy;
}

}  // namespace

void ScanTracker::see(std::int64_t lidar, const Scan &scan) {
  EarlierSweeps &earlier = earlier_[lidar];
  lidar_ = lidar;
  sweep_.take(scan, settings_.max_range, body_, earlier.fresh());
  sweep_.split();
  earlier.judge(sweep_, settings_.same_surface);
  const bool first = std::isnan(time_);
  const double seconds = first ? 0.0 : std::max(0.0, scan.time - time_);
  time_ = first ? scan.time : std::max(time_, scan.time);
  for (Followed &track : tracks_) {
    track.filter.predict(seconds, settings_.acceleration * settings_.acceleration);
  }
  measure_things();
  assign();
  if (!tracks_.empty()) {
    correct(seconds);
  }
  begin();
  end();
  earlier.keep();
}

DiscFilter ScanTracker::ahead(const Followed &track, double now) const {
  DiscFilter filter = track.filter;
  filter.predict(now - time_, settings_.acceleration * settings_.acceleration);
  return filter;
}

// The diagonal of the box around each thing.
void ScanTracker::measure_things() {
  const std::vector<Hit> &hits = sweep_.hits();
  sizes_.clear();
  things_.resize(hits.size());
  for (std::size_t thing = 0; thing + 1 < sweep_.starts().size(); ++thing) {
    Point low = {kInfinity, kInfinity}, high = {-kInfinity, -kInfinity};
    for (std::size_t i = sweep_.starts()[thing]; i < sweep_.starts()[thing + 1]; ++i) {
      const Point &point = hits[i].point;
      low = {std::min(low.x, point.x), std::min(low.y, point.y)};
      high = {std::max(high.x, point.x), std::max(high.y, point.y)};
      things_[i] = thing;
    }
    sizes_.push_back(length(high.x - low.x, high.y - low.y));
  }
}

// Hits to the nearest tracks. What stands still belongs to no track that is fast. What is too large, such as a wall that
// somebody is close to, only belongs to confirmed tracks that have just been seen.
void ScanTracker::assign() {
  const std::vector<Hit> &hits = sweep_.hits();
  owners_.assign(hits.size(), -1);
  beyond_.assign(hits.size(), kInfinity);
  for (std::size_t k = 0; k < tracks_.size(); ++k) {
    Followed &track = tracks_[k];
    const DiscFilter &filter = track.filter;
    const double deviation = std::sqrt(std::max(filter.cov[0][0], filter.cov[1][1]));
    const double reach = filter.radius + std::min(kGate + kGateDeviations * deviation, kWidestGate);
    const bool fast = filter.speed() > kFast;
    const bool close = track.confirmed && sweep_.view().time - track.seen_at <= kJust;
    const Point centre = filter.centre();
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const double apart = square(hits[i].point, centre);
      if (!(apart <= reach * reach)) {
        continue;
      }
      const bool small = sizes_[things_[i]] <= settings_.max_size;
      if ((fast && hits[i].still) || !(close || small) || (hits[i].still && !small)) {
        continue;
      }
      const double beyond = std::sqrt(apart) - filter.radius + (track.confirmed ? 0.0 : kGate);  // first the confirmed
      if (beyond < beyond_[i]) {
        beyond_[i] = beyond, owners_[i] = static_cast<std::ptrdiff_t>(k);
      }
    }
  }
}

// Correct the filters of what was hit, and gather what shows that it moves.
void ScanTracker::correct(double seconds) {
  const std::vector<Hit> &hits = sweep_.hits();
  for (Followed &track : tracks_) {
    track.rim.clear();
  }
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (owners_[i] >= 0) {
      tracks_[static_cast<std::size_t>(owners_[i])].rim.push_back(i);
    }
  }
  for (Followed &track : tracks_) {
    const auto count = static_cast<double>(track.rim.size());
    track.seen = count >= std::min(settings_.min_points, 2.0);
    if (!track.seen) {
      track.rim.clear();
      continue;
    }
    track.filter.correct(track.rim.size(), [&](std::size_t i) { return hits[track.rim[i]].point; });
    if (count >= settings_.min_points) {
      resize(track);
    }
  }
  note_proofs(seconds);
}

// Take the width that was seen; where something hides an end, that may only be too small.
void ScanTracker::resize(Followed &track) {
  double distance = 0.0;
  const double seen = width(track.rim.data(), track.rim.size(), track.filter.centre(), distance);
  const std::vector<Hit> &hits = sweep_.hits();
  const bool whole = sweep_.sees_past(hits[track.rim.front()], -1) && sweep_.sees_past(hits[track.rim.back()], 1);
  const double radius = track.filter.radius;
  const double sine = std::min(0.8, radius / std::max(distance, 1e-6));
  double grown = radius + kResizeShare * (0.5 * seen / std::sqrt(1.0 - sine * sine) - radius);
  grown = whole ? grown : std::max(grown, radius);
  track.filter.resize(bounded(grown), sweep_.view().sensor);
}

double ScanTracker::bounded(double radius) const {
  return std::min(std::max(radius, kLeastRadius), 0.5 * settings_.max_size);
}

// Width of some hits as seen from the sensor, around a middle, and the distance of that.
double ScanTracker::width(const std::size_t *hits, std::size_t count, Point middle, double &distance) const {
  const View &view = sweep_.view();
  const double dx = middle.x - view.sensor.x, dy = middle.y - view.sensor.y;
  distance = length(dx, dy);
  const double x = -dy / std::max(distance, 1e-6), y = dx / std::max(distance, 1e-6);
  double low = kInfinity, high = -kInfinity;
  for (std::size_t i = 0; i < count; ++i) {
    const Point &point = sweep_.hits()[hits[i]].point;
    const double aside = point.x * x + point.y * y;
    low = std::min(low, aside), high = std::max(high, aside);
  }
  return high - low + view.spacing * distance;
}

void ScanTracker::note_proofs(double seconds) {
  const std::vector<Hit> &hits = sweep_.hits();
  const double time = sweep_.view().time;
  const Rims *before = nullptr;
  for (auto rims = rims_.rbegin(); rims != rims_.rend() && before == nullptr; ++rims) {
    before = rims->time <= time - kLeftAfter + 1e-6 ? &*rims : nullptr;
  }
  for (Followed &track : tracks_) {
    std::size_t appeared = 0, still = 0;
    for (const std::size_t i : track.rim) {
      appeared += hits[i].appeared ? 1 : 0, still += hits[i].still ? 1 : 0;
    }
    const auto count = static_cast<double>(track.rim.size()), shares = std::max(count, 1.0);
    const bool moved_in =
        track.seen && count >= settings_.min_points && static_cast<double>(appeared) >= kAppearedShare * shares;
    const bool stays = static_cast<double>(still) >= kStillShare * shares;
    const bool shown = has_left(track, before) || moved_in;
    track.proofs = shown ? std::min(track.proofs + 1.0, kMostProofs) : std::max(track.proofs - kForgottenProof, 0.0);
    if (track.seen) {
      track.hits += 1;
      const double share = track.hits <= 2 ? 1.0 : -std::expm1(-seconds / kMean);
      for (int axis = 0; axis < 2; ++axis) {
        track.mean_velocity[axis] += share * (track.filter.state[axis + 2] - track.mean_velocity[axis]);
      }
      track.empty_s = track.aside_s = 0.0;
      track.seen_at = stays && !track.confirmed && track.hits > 3 ? -kInfinity : time;
    } else {
      track.aside_s += is_looked_at(track) ? 0.0 : seconds;
      if (is_in_wall(track)) {
        track.empty_s += kEmpty;  // once more, and it is gone
      }
      if (sweep_.view().judge(track.filter.centre(), settings_.same_surface) == Sight::kThrough) {
        track.empty_s += seconds;
      }
    }
    decide(track);
  }
  keep_rims();
}

// Whether the scan sees through where the rim of a track was a little before.
bool ScanTracker::has_left(const Followed &track, const Rims *before) const {
  if (before == nullptr) {
    return false;
  }
  const auto found = std::lower_bound(before->ids.begin(), before->ids.end(), track.id);
  if (found == before->ids.end() || *found != track.id) {
    return false;
  }
  std::size_t through = 0;
  for (const Point &point : before->points[static_cast<std::size_t>(found - before->ids.begin())]) {
    through += sweep_.view().judge(point, settings_.same_surface) == Sight::kThrough ? 1 : 0;
  }
  return through >= kLeftSamples;
}

// Whether a track has come to where something stands still.
bool ScanTracker::is_in_wall(const Followed &track) const {
  const double reach = track.filter.radius + kGate;
  const Point centre = track.filter.centre();
  const auto inside = std::count_if(sweep_.hits().begin(), sweep_.hits().end(), [&](const Hit &hit) {
    return hit.still && square(hit.point, centre) < reach * reach;
  });
  return static_cast<double>(inside) >= settings_.min_points;
}

// Whether a track is in the field of view of a lidar, hidden or not.
bool ScanTracker::is_looked_at(const Followed &track) const {
  const Point centre = track.filter.centre();
  return sweep_.view().faces(centre) || std::any_of(earlier_.begin(), earlier_.end(), [&](const auto &entry) {
           const View *view = entry.first == lidar_ ? nullptr : entry.second.latest();
           return view != nullptr && view->faces(centre);
         });
}

void ScanTracker::keep_rims() {
  const double time = sweep_.view().time;
  Rims rims;
  if (!rims_.empty() && rims_.front().time < time - kRimsKept) {  // its memory
    std::swap(rims, rims_.front());
    rims_.pop_front();
  }
  rims.time = time;
  rims.ids.clear(), rims.points.clear();
  for (const Followed &track : tracks_) {
    const auto count = static_cast<double>(track.rim.size());
    if (count < settings_.min_points) {
      continue;
    }
    rims.ids.push_back(track.id);
    std::array<Point, kRimSamples> points;
    for (std::size_t k = 0; k < kRimSamples; ++k) {
      points[k] = sweep_.hits()[track.rim[static_cast<std::size_t>(count * kSamples[k])]].point;
    }
    rims.points.push_back(points);
  }
  rims_.push_back(std::move(rims));
  while (rims_.front().time < time - kRimsKept) {
    rims_.pop_front();
  }
}

// Whether a track is confirmed, and whether it moves.
void ScanTracker::decide(Followed &track) const {
  double needed = std::max(settings_.min_speed, kSignificant * track.filter.speed_deviation());
  needed = track.moving ? kStaysShare * settings_.min_speed : needed;
  const bool fast = track.filter.speed() > needed;
  track.confirmed = track.confirmed || (fast && track.proofs >= settings_.confirm_scans && track.hits >= 3);
  track.moving = track.confirmed && fast;
}

// Begin to follow things that belong to no track and have not stood there before.
void ScanTracker::begin() {
  const std::vector<Hit> &hits = sweep_.hits();
  std::size_t tentative = 0;
  for (const Followed &track : tracks_) {
    tentative += track.confirmed ? 0 : 1;
  }
  all_.resize(hits.size());
  std::iota(all_.begin(), all_.end(), std::size_t{0});
  for (std::size_t thing = 0; thing < sizes_.size() && tentative < kMostTentative; ++thing) {
    const std::size_t first = sweep_.starts()[thing], size = sweep_.starts()[thing + 1] - first;
    const auto count = static_cast<double>(size);
    if (!(sizes_[thing] <= settings_.max_size && count >= settings_.min_points)) {
      continue;
    }
    double still = 0.0;
    bool owned = false;
    Point middle = {0.0, 0.0};
    for (std::size_t i = first; i < first + size; ++i) {
      still += hits[i].still ? 1.0 : 0.0;
      owned = owned || owners_[i] >= 0;
      middle.x += hits[i].point.x, middle.y += hits[i].point.y;
    }
    if (owned || still >= 0.5 * count) {
      continue;
    }
    middle = {middle.x / count, middle.y / count};
    double distance = 0.0;
    const double seen = width(all_.data() + first, size, middle, distance);
    const double radius = bounded(0.5 * seen);
    const double away = kAway * radius / std::max(distance, 1e-6);
    const Point sensor = sweep_.view().sensor;
    Followed track(next_id_++, {middle.x + away * (middle.x - sensor.x), middle.y + away * (middle.y - sensor.y)}, radius);
    track.filter.correct(size, [&](std::size_t i) { return hits[first + i].point; });
    track.seen_at = sweep_.view().time;
    tracks_.push_back(std::move(track));
    ++tentative;
  }
}

// Forget what is gone, and of two tracks at one place the less certain.
void ScanTracker::end() {
  kept_.resize(tracks_.size());
  std::transform(tracks_.begin(), tracks_.end(), kept_.begin(), [this](const Followed &track) { return is_kept(track); });
  // Confirmed ones first, and of these the oldest.
  const auto is_before = [](const Followed &a, const Followed &b) {
    return a.confirmed != b.confirmed ? a.confirmed : a.id < b.id;
  };
  doubled_.assign(tracks_.size(), 0);
  for (std::size_t k = 0; k < tracks_.size(); ++k) {
    for (std::size_t j = 0; j < tracks_.size() && kept_[k] && !doubled_[k]; ++j) {
      const DiscFilter &one = tracks_[k].filter, &other = tracks_[j].filter;
      doubled_[k] = kept_[j] && is_before(tracks_[j], tracks_[k]) &&
                    std::sqrt(square(one.centre(), other.centre())) < kSamePlace * std::max(one.radius, other.radius);
    }
  }
  std::size_t left = 0;
  for (std::size_t k = 0; k < tracks_.size(); ++k) {
    if (kept_[k] && !doubled_[k]) {
      if (left != k) {
        tracks_[left] = std::move(tracks_[k]);
      }
      ++left;
    }
  }
  tracks_.erase(tracks_.begin() + static_cast<std::ptrdiff_t>(left), tracks_.end());
}

bool ScanTracker::is_kept(const Followed &track) const {
  const DiscFilter &filter = track.filter;
  const double silent = time_ - track.seen_at, hidden = silent - track.aside_s;
  // What has just turned or sped up, or seems to as less and less of it is visible, may go on in any direction.
  const double strays = length(filter.state[2] - track.mean_velocity[0], filter.state[3] - track.mean_velocity[1]);
  if (!(hidden <= (track.confirmed ? settings_.hidden_s : kTentative)) ||
      !(track.aside_s <= (track.confirmed ? settings_.aside_s : kTentative)) ||
      !(hidden <= kJust || hidden * strays <= kStray) || !(track.empty_s <= kEmpty) || !(filter.speed() <= kFastest) ||
      !(filter.cov[0][0] + filter.cov[1][1] < kLost * kLost)) {
    return false;
  }
  if (!(silent > kEmpty)) {
    return true;
  }
  // Another part of something large that was followed as two.
  return std::none_of(tracks_.begin(), tracks_.end(), [&](const Followed &other) {
    const double reach = filter.radius + other.filter.radius + kGate;
    return other.confirmed && time_ - other.seen_at <= kJust &&
           std::sqrt(square(filter.centre(), other.filter.centre())) < reach;
  });
}

}  // namespace trundle::tracking
