// Rolling out samples, on the widest registers that the processor has.
#pragma once

#include "mppi/problem.hpp"

namespace trundle::mppi {

enum class Level { kBase, kAvx2 };

bool has_avx2();

// Cost every sample.
void roll(const Problem &problem, const Outcome &outcome, Level level);

// Cost the nominal controls alone, as sample 0 of the outcome, which has room for four.
void roll_nominal(const Problem &problem, const Outcome &outcome);

}  // namespace trundle::mppi
