#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fuzz the engine: tests/fuzz/run.sh [SECONDS EACH, default 3600] [FUZZER ...]
# Needs clang with libFuzzer (Debian: clang, libclang-rt-*-dev). Ends with an error at the first crash, whose input it names.
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:-3600}
shift || true
fuzzers=("$@")
if [ ${#fuzzers[@]} -eq 0 ]; then fuzzers=($(basename -s .cc services/slam/engine/fuzz/fuzz_*.cc)); fi
build=build/fuzz
clang=${CLANGXX:-$(command -v clang++ || command -v clang++-14)}
cmake -S . -B $build -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_COMPILER="$clang" \
  -DKINEMAP_BUILD_FUZZERS=ON -DKINEMAP_SANITIZE=address,undefined -DKINEMAP_BUILD_BINDINGS=OFF \
  ${CCACHE_DIR:+-DCMAKE_CXX_COMPILER_LAUNCHER=ccache} >/dev/null
# What the fuzzers link alone: the layers above it are not needed.
cmake --build $build --target "${fuzzers[@]}" | tail -n 1
for fuzzer in "${fuzzers[@]}"; do
  corpus=$build/corpus/$fuzzer
  mkdir -p "$corpus"
  echo "fuzz: $fuzzer for $seconds s"
  $build/services/slam/engine/"$fuzzer" "$corpus" -max_total_time="$seconds" -max_len=65536 -timeout=60 -rss_limit_mb=4096 \
    -artifact_prefix=$build/ -print_final_stats=1 2>&1 | grep -E "stat::(number|average)|ERROR|SUMMARY|Test unit" || true
  test "${PIPESTATUS[0]}" -eq 0
done
