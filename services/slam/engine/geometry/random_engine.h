// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kinemap {

/// SplitMix64 (Steele, Lea, Flood 2014). Unlike std::uniform_int_distribution its numbers are the same with every
/// standard library, so a seed means the same map everywhere.
class RandomEngine {
 public:
  RandomEngine(uint64_t seed, int64_t timestamp_ns) : state_(seed ^ (static_cast<uint64_t>(timestamp_ns) * kGamma)) {}

  /// Uniform in [0, bound); the bias of the modulo is below bound / 2^64.
  uint64_t Below(uint64_t bound) { return Next() % bound; }

 private:
  static constexpr uint64_t kGamma = 0x9E3779B97F4A7C15ull;

  uint64_t Next() {
    uint64_t z = (state_ += kGamma);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }

  uint64_t state_;
};

}  // namespace kinemap
