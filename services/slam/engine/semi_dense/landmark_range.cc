// SPDX-License-Identifier: Apache-2.0
#include "semi_dense/landmark_range.h"

#include <algorithm>
#include <vector>

namespace kinemap {
namespace {
constexpr size_t kLeastLandmarks = 10;
// Pixels without a corner on them may be nearer than all landmarks: the road under the camera mostly is.
constexpr double kNearerFactor = 2.5;
constexpr double kFartherFactor = 0.3;
}  // namespace

DepthRange RangeOfLandmarks(const SlamMap& map, KeyframeId keyframe_id) {
  const SimilarityTransform anchor_from_map = map.MapFromAnchor(keyframe_id).Inverse();
  std::vector<double> inverse_depths;
  for (const LandmarkId id : map.keyframe(keyframe_id).landmark_ids) {
    const Landmark* landmark = map.FindLandmark(id);
    if (landmark == nullptr || !landmark->IsTrackable()) continue;
    const double depth = (anchor_from_map * map.PositionInMap(*landmark)).z();
    if (depth > 0) inverse_depths.push_back(1 / depth);
  }
  if (inverse_depths.size() < kLeastLandmarks) return {};
  std::sort(inverse_depths.begin(), inverse_depths.end());
  const size_t tail = inverse_depths.size() / 50;
  return {static_cast<float>(kFartherFactor * inverse_depths[tail]),
          static_cast<float>(kNearerFactor * inverse_depths[inverse_depths.size() - 1 - tail])};
}

}  // namespace kinemap
