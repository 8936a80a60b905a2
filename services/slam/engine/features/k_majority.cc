// SPDX-License-Identifier: Apache-2.0
#include "features/k_majority.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace kinemap {
namespace {

std::vector<Descriptor> FirstCenters(const std::vector<Descriptor>& descriptors, const std::vector<int>& indices,
                                     int count, RandomEngine* random) {
  std::vector<Descriptor> centers{descriptors[indices[random->Below(indices.size())]]};
  std::vector<uint64_t> squared(indices.size(), UINT64_MAX);
  while (static_cast<int>(centers.size()) < count) {
    uint64_t total = 0;
    for (size_t i = 0; i < indices.size(); ++i) {
      const auto distance = static_cast<uint64_t>(HammingDistance(descriptors[indices[i]], centers.back()));
      squared[i] = std::min(squared[i], distance * distance);
      total += squared[i];
    }
    if (total == 0) break;  // nothing left that is not a centre
    uint64_t chosen = random->Below(total);
    size_t i = 0;
    while (chosen >= squared[i]) chosen -= squared[i++];
    centers.push_back(descriptors[indices[i]]);
  }
  return centers;
}

Descriptor Majority(const std::vector<Descriptor>& descriptors, const std::vector<int>& members,
                    const Descriptor& before) {
  std::array<int, 256> ones{};
  for (const int member : members) {
    for (int bit = 0; bit < 256; ++bit) ones[bit] += static_cast<int>(descriptors[member][bit / 64] >> (bit % 64) & 1);
  }
  Descriptor center = before;
  const int half_twice = static_cast<int>(members.size());
  for (int bit = 0; bit < 256; ++bit) {
    const uint64_t mask = uint64_t{1} << (bit % 64);
    // A tie leaves the bit as it was.
    if (2 * ones[bit] > half_twice) center[bit / 64] |= mask;
    if (2 * ones[bit] < half_twice) center[bit / 64] &= ~mask;
  }
  return center;
}

}  // namespace

DescriptorClusters ClusterByMajority(const std::vector<Descriptor>& descriptors, const std::vector<int>& indices,
                                     int count, int iterations, RandomEngine* random) {
  DescriptorClusters clusters;
  clusters.centers = FirstCenters(descriptors, indices, count, random);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    std::vector<std::vector<int>> members(clusters.centers.size());
    for (const int index : indices) {
      int best = 0, best_distance = 257;
      for (size_t center = 0; center < clusters.centers.size(); ++center) {
        const int distance = HammingDistance(descriptors[index], clusters.centers[center]);
        if (distance < best_distance) best_distance = distance, best = static_cast<int>(center);
      }
      members[best].push_back(index);
    }
    const bool settled = members == clusters.members;
    clusters.members = std::move(members);
    if (settled || iteration + 1 == iterations) break;
    for (size_t center = 0; center < clusters.centers.size(); ++center) {
      clusters.centers[center] = Majority(descriptors, clusters.members[center], clusters.centers[center]);
    }
  }
  DescriptorClusters filled;
  for (size_t center = 0; center < clusters.centers.size(); ++center) {
    if (clusters.members[center].empty()) continue;
    filled.centers.push_back(clusters.centers[center]);
    filled.members.push_back(std::move(clusters.members[center]));
  }
  return filled;
}

}  // namespace kinemap
