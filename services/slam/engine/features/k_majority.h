// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "features/descriptor.h"
#include "geometry/random_engine.h"

namespace kinemap {

struct DescriptorClusters {
  std::vector<Descriptor> centers;
  std::vector<std::vector<int>> members;  ///< indices of descriptors, one list a centre, none of them empty
};

/// Parts descriptors into at most `count` clusters: each belongs to the nearest centre, and a centre has the bits that
/// the majority of its members has (Grana et al. 2013); first centres by k-means++. `indices` says which to part.
DescriptorClusters ClusterByMajority(const std::vector<Descriptor>& descriptors, const std::vector<int>& indices,
                                     int count, int iterations, RandomEngine* random);

}  // namespace kinemap
