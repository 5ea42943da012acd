#include "mppi/rollout.hpp"

#include "mppi/kernels.hpp"
#include "shared/registers.hpp"

namespace trundle::mppi {

namespace {

void roll_portable(const Problem &problem, const Outcome &outcome) {
  roll_samples<16>(problem, outcome, 0, problem.samples);
}

#ifdef TRUNDLE_AVX2
TRUNDLE_TARGET("avx2") void roll_avx2(const Problem &problem, const Outcome &outcome) {
  roll_samples<32>(problem, outcome, 0, problem.samples);
}
#endif

}  // namespace

bool has_avx2() {
#ifdef TRUNDLE_AVX2
  return __builtin_cpu_supports("avx2");
#else
  return false;
#endif
}

void roll(const Problem &problem, const Outcome &outcome, Level level) {
#ifdef TRUNDLE_AVX2
  if (level == Level::kAvx2) return roll_avx2(problem, outcome);
#endif
  roll_portable(problem, outcome);
}

void roll_nominal(const Problem &problem, const Outcome &outcome) {
  Rollout<16> rollout(problem);
  rollout.run({problem.nominal, problem.draws, 0.0f, 0.0f});
  rollout.write(outcome, 0, 4);
}

}  // namespace trundle::mppi
