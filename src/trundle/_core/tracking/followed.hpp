// What a tracker follows at present: a filter for each, and what shows that it moves.
//
// Each scan is cut into things at its gaps. Its hits go to the nearest track whose gate they are in; the filters are
// corrected by them; what belongs to no track and has not stood there before begins a new one. A track is confirmed by
// what the scans saw through: it is where an earlier scan saw free space, or has left a place through which the scans now
// see. A wall of which the robot sees another part does neither.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "tracking/disc_filter.hpp"
#include "tracking/earlier_sweeps.hpp"
#include "tracking/settings.hpp"
#include "tracking/sweep.hpp"

namespace trundle::tracking {

inline constexpr std::size_t kRimSamples = 5;

struct Followed {
  Followed(std::int64_t number, Point centre, double radius) : id(number), filter(centre, radius) {}

  std::int64_t id, hits = 1;
  DiscFilter filter;
  double seen_at = 0.0, empty_s = 0.0, proofs = 0.0;
  double aside_s = 0.0;  // how long no lidar has looked there since it was seen
  bool confirmed = false, moving = false;
  double mean_velocity[2] = {};
  // Of the scan at hand.
  std::vector<std::size_t> rim;  // its hits
  bool seen = false;
};

class ScanTracker {
 public:
  ScanTracker(const Settings &settings, std::vector<Point> body) : settings_(settings), body_(std::move(body)) {}

  // Take a scan of a lidar.
  void see(std::int64_t lidar, const Scan &scan);

  const std::vector<Followed> &tracks() const { return tracks_; }

  // The filter of a track, predicted to a time.
  DiscFilter ahead(const Followed &track, double now) const;

 private:
  struct Rims {  // where those that were seen in a scan were
    double time;
    std::vector<std::int64_t> ids;  // ascending
    std::vector<std::array<Point, kRimSamples>> points;
  };

  void measure_things();
  void assign();
  void correct(double seconds);
  void resize(Followed &track);
  void note_proofs(double seconds);
  bool has_left(const Followed &track, const Rims *before) const;
  bool is_in_wall(const Followed &track) const;
  bool is_looked_at(const Followed &track) const;
  void keep_rims();
  void decide(Followed &track) const;
  void begin();
  void end();
  bool is_kept(const Followed &track) const;
  double bounded(double radius) const;
  double width(const std::size_t *hits, std::size_t count, Point middle, double &distance) const;

  Settings settings_;
  std::vector<Point> body_;
  std::map<std::int64_t, EarlierSweeps> earlier_;
  std::vector<Followed> tracks_;
  std::deque<Rims> rims_;
  double time_ = std::numeric_limits<double>::quiet_NaN();
  std::int64_t lidar_ = 0;  // of the scan at hand
  std::int64_t next_id_ = 1;
  // Of the scan at hand.
  Sweep sweep_;
  std::vector<double> sizes_;        // of each thing
  std::vector<std::size_t> things_;  // that each hit is of
  std::vector<std::ptrdiff_t> owners_;  // the track that each hit belongs to, -1 for none
  std::vector<double> beyond_;
  std::vector<std::size_t> all_;
  std::vector<char> kept_, doubled_;
};

}  // namespace trundle::tracking
