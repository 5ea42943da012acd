// Whether the poses near one end of a query are closed off from the other end.
#pragma once

#include "shared/arrays.hpp"
#include "shared/call_limits.hpp"

namespace trundle {

// Fills boxes of poses, `cell` [m] wide and one of `headings` shares of the circle, from a pose, or its position at any
// yaw, over those at whose middle the outline touches nothing. The answer and how many boxes there are: 0 where they
// end without the other pose, 1 where that is among them, 2 where there are more than `most`, 3 at the deadline, 4 when
// cancelled.
nb::tuple flood_poses(In<std::uint8_t, 2> costs, double resolution, In<double, 2> outline, In<double, 1> from,
                      bool any_yaw, In<double, 1> to, bool to_any_yaw, double cell, std::int64_t headings,
                      std::uint64_t most, std::optional<double> seconds, Flag cancel);

}  // namespace trundle
