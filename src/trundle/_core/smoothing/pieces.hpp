// A path in pieces, and the stations along it between which curves may replace them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "smoothing/cost_model.hpp"

namespace trundle::smoothing {

// A point on the path, before a piece of it, with sums from the start to there.
struct Station {
  PlanarPose pose;
  std::size_t piece;
  PathCost sum;            // of the pieces
  double bend;          // of the angles by which they turn
  int changes;          // of direction
  int forward, back;    // pieces
  bool fixed;           // an end, or the path stops there
};

// Cuts pieces that are longer than `spacing`, and sets stations about as far apart; every stop has one.
inline std::vector<Station> lay_stations(std::vector<Piece> &pieces, const CostModel &costs, double spacing) {
  std::vector<Piece> cut;
  for (const Piece &piece : pieces) {
    const int parts = std::max(1, static_cast<int>(std::ceil(std::fabs(piece.segment.length) / spacing - 1e-9)));
    for (int i = 0; i < parts; ++i) {
      cut.push_back(parts == 1 ? piece : piece.part(static_cast<double>(i) / parts, static_cast<double>(i + 1) / parts));
    }
  }
  pieces = std::move(cut);
  std::vector<Station> stations;
  Station now{pieces.front().from, 0, {}, 0.0, 0, 0, 0, true};
  stations.push_back(now);
  double driven = 0.0;  // since the last station
  int last_direction = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece &piece = pieces[i];
    const PathCost price = costs.of(piece);
    if (last_direction * piece.direction() < 0) ++now.changes;
    last_direction = piece.direction();
    now.sum.line += price.line, now.sum.total += price.total;
    now.bend += std::fabs(piece.segment.turn);
    now.forward += piece.direction() > 0, now.back += piece.direction() < 0;
    driven += std::fabs(piece.segment.length);
    const bool ends = i + 1 == pieces.size();
    const bool stops = ends || piece.is_turn() || pieces[i + 1].is_turn() || piece.direction() != pieces[i + 1].direction();
    const double next = ends ? 0.0 : std::fabs(pieces[i + 1].segment.length);
    if (!stops && driven + next <= spacing * (1.0 + 1e-9)) continue;
    now.pose = piece.to, now.piece = i + 1, now.fixed = stops;
    stations.push_back(now);
    driven = 0.0;
  }
  return stations;
}

}  // namespace trundle::smoothing
