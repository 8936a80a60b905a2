// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "features/bag_of_words.h"
#include "features/brute_force_matcher.h"
#include "features/frame_features.h"

namespace kinemap {

struct NodeMatchLimits {
  int max_distance;  ///< bits
  double ratio;      ///< of the nearest to the second nearest descriptor under the node
};

/// Matches the chosen keypoints of two images, looking only at those under the same node of the vocabulary: nearest,
/// clearly nearer than the second, each train keypoint once, all turning by the same angle. Indices ascend.
std::vector<FeatureMatch> MatchByNode(const FrameFeatures& query, const std::vector<int>& query_indices,
                                      const BagOfWords& query_bag, const FrameFeatures& train,
                                      const std::vector<int>& train_indices, const BagOfWords& train_bag,
                                      const NodeMatchLimits& limits);

}  // namespace kinemap
