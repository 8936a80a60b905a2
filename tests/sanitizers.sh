#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The C++ tests under AddressSanitizer and UndefinedBehaviorSanitizer (memory), then under ThreadSanitizer (threads).
# usage: tests/sanitizers.sh [JOBS] [memory|threads]
set -eo pipefail
cd "$(dirname "$0")/.."
jobs=${1:-$(nproc)}
export ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1 UBSAN_OPTIONS=print_stacktrace=1
declare -A sanitizers=([memory]=address,undefined [threads]=thread)

# -O1 keeps the reports readable and the tests quick; NDEBUG stays off, so that Eigen's own checks run too.
for kind in ${2:-memory threads}; do
  build=build/sanitize_$kind
  cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Sanitize -DCMAKE_CXX_FLAGS_SANITIZE=-O1 \
    -DKINEMAP_SANITIZE="${sanitizers[$kind]}" -DKINEMAP_BUILD_TESTS=ON -DKINEMAP_BUILD_BINDINGS=OFF \
    ${CCACHE_DIR:+-DCMAKE_CXX_COMPILER_LAUNCHER=ccache} >/dev/null
  cmake --build "$build" -j "$jobs" | tail -n 1
  ctest --test-dir "$build" --output-on-failure -j "$jobs"
done
