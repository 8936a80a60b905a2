// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "features/frame_features.h"

namespace kinemap {

struct FeatureMatch {
  int query;
  int train;
};

/// Matches the chosen keypoints of two images by descriptor alone: nearest within 50 bits, clearly nearer than the
/// second (ratio), each train keypoint once, all turning by the same angle.
std::vector<FeatureMatch> MatchByDescriptor(const FrameFeatures& query, const std::vector<int>& query_indices,
                                            const FrameFeatures& train, const std::vector<int>& train_indices,
                                            double ratio);

}  // namespace kinemap
