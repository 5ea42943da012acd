#!/usr/bin/env bash
# Build the kernels with AddressSanitizer and UndefinedBehaviorSanitizer and run the tests that call them; or with
# ThreadSanitizer, and those of several threads.
# Usage: scripts/sanitize.sh [pytest arguments]
#        scripts/sanitize.sh --fuzz [TARGET ...] [--seconds N] [--seed N]
#        scripts/sanitize.sh --thread [pytest arguments]
set -euo pipefail
cd "$(dirname "$0")/.."
mode=${1:-}
if [ "$mode" = --thread ]; then
  sanitizers=thread suffix=-thread library=libtsan.so
else
  sanitizers=address,undefined suffix="" library=libasan.so
fi
venv=.venv-sanitize$suffix
# A build without NDEBUG: nanobind's own checks tell of Python objects that are touched without the GIL.
make --no-print-directory dev build VENV=$venv \
  FLAGS="-C cmake.build-type=Debug -C cmake.define.TRUNDLE_SANITIZE=$sanitizers -C build-dir=build/sanitize$suffix"
runtime=$("${CXX:-g++}" -print-file-name=$library)
stdcxx=$("${CXX:-g++}" -print-file-name=libstdc++.so)
# The interpreter itself leaks by design; what counts here is memory misused and undefined behaviour in the kernels.
export ASAN_OPTIONS=detect_leaks=0:abort_on_error=1:allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1
if [ "$mode" = --thread ]; then
  shift
  # Reports go to the terminal, and make the run fail at its end. ThreadSanitizer needs memory where it expects it.
  LD_PRELOAD="$runtime:$stdcxx" TSAN_OPTIONS=exitcode=66 exec setarch "$(uname -m)" -R \
    $venv/bin/python -m pytest -p no:cacheprovider --capture=sys tests/_core/test_threads.py tests/planning \
    -k "fields or thread or many or beside" "$@"
fi
export LD_PRELOAD="$runtime:$stdcxx"
if [ "$mode" = --fuzz ]; then
  shift
  PYTHONPATH=tests exec $venv/bin/python -W ignore::RuntimeWarning -m fuzz "$@"
fi
exec $venv/bin/python -m pytest -p no:cacheprovider tests/_core tests/maps tests/costmap tests/planning tests/fuzz "$@"
