#!/usr/bin/env bash
# Build the kernels with AddressSanitizer and UndefinedBehaviorSanitizer and run the tests that call them.
# Usage: scripts/sanitize.sh [pytest arguments]
#        scripts/sanitize.sh --fuzz [TARGET ...] [--seconds N] [--seed N]
set -euo pipefail
cd "$(dirname "$0")/.."
venv=.venv-sanitize
make --no-print-directory dev build VENV=$venv \
  FLAGS="-C cmake.define.TRUNDLE_SANITIZE=ON -C build-dir=build/sanitize"
asan=$("${CXX:-g++}" -print-file-name=libasan.so)
stdcxx=$("${CXX:-g++}" -print-file-name=libstdc++.so)
# The interpreter itself leaks by design; what counts here is memory misused and undefined behaviour in the kernels.
export LD_PRELOAD="$asan:$stdcxx" ASAN_OPTIONS=detect_leaks=0:abort_on_error=1:allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1
if [ "${1:-}" = --fuzz ]; then
  shift
  PYTHONPATH=tests exec $venv/bin/python -W ignore::RuntimeWarning -m fuzz "$@"
fi
exec $venv/bin/python -m pytest -p no:cacheprovider tests/_core tests/maps tests/costmap tests/planning tests/fuzz "$@"
