#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The C++ tests under AddressSanitizer and UndefinedBehaviorSanitizer, then under ThreadSanitizer.
# usage: tests/sanitizers.sh [JOBS]
set -eo pipefail
cd "$(dirname "$0")/.."
jobs=${1:-$(nproc)}
export ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1 UBSAN_OPTIONS=print_stacktrace=1

# -O1 keeps the reports readable and the tests quick; NDEBUG stays off, so that Eigen's own checks run too.
run() {
  cmake -S . -B "build/$1" -G Ninja -DCMAKE_BUILD_TYPE=Sanitize -DCMAKE_CXX_FLAGS_SANITIZE=-O1 -DKINEMAP_SANITIZE="$2" \
    -DKINEMAP_BUILD_TESTS=ON -DKINEMAP_BUILD_BINDINGS=OFF ${CCACHE_DIR:+-DCMAKE_CXX_COMPILER_LAUNCHER=ccache} >/dev/null
  cmake --build "build/$1" -j "$jobs" | tail -n 1
  ctest --test-dir "build/$1" --output-on-failure -j "$jobs"
}
run sanitize_memory address,undefined
run sanitize_threads thread
