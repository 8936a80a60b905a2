// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace kinemap {

/// 256 binary tests of one keypoint's surroundings (ORB: Rublee et al. 2011).
using Descriptor = std::array<uint64_t, 4>;

/// Number of tests that differ, 0 to 256.
inline int HammingDistance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

/// Two descriptors further apart than this are never the same point.
constexpr int kMaxHammingDistance = 100;
/// Two descriptors nearer than this may be matched without a prediction of where the point should be.
constexpr int kStrictHammingDistance = 50;

}  // namespace kinemap
