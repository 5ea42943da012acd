// One control period of an ideal robot: no slip, no lag, every arc exact.
#pragma once

#include "shared/arrays.hpp"

namespace trundle {

// Drive towards a command (v, w) for some steps. A state is x, y, yaw, the angles of both wheels, and the motion: v and w
// of the ramp, v and w that are driven, and the speeds of both wheels. `limits` are the greatest speed forward, backward and
// of turns, by how much the ramp's v and w may change in a step, the wheels' radius, the track width, the wheels' largest
// speed, and the length of a step.
//
// Returns the state after each step, a row each; the least and the greatest x and y of them; and whether the command was
// above the limits, or the wheels had to turn slower than the ramp asks.
nb::tuple drive_period(In<double, 1> state, double v, double w, In<double, 1> limits, std::int64_t steps);

}  // namespace trundle
