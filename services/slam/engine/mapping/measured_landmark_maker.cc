// SPDX-License-Identifier: Apache-2.0
#include "mapping/measured_landmark_maker.h"

#include <algorithm>

#include "map/measured_landmarks.h"

namespace kinemap {
namespace {
constexpr size_t kLeastMeasured = 100;
}

std::vector<LandmarkId> MeasuredLandmarkMaker::Make(SlamMap* map, KeyframeId keyframe_id) const {
  if (!map->metric_scale()) return {};
  const Keyframe& keyframe = map->keyframe(keyframe_id);
  std::vector<std::pair<double, int>> by_depth;
  for (int i = 0; i < keyframe.features->size(); ++i) {
    const FeatureRole role = keyframe.labels[i].role;
    if (role != FeatureRole::kTracked && role != FeatureRole::kMapped) continue;
    const Keypoint& keypoint = keyframe.features->keypoints[i];
    if (keypoint.HasDepth()) by_depth.emplace_back(keypoint.depth_m, i);
  }
  std::sort(by_depth.begin(), by_depth.end());
  std::vector<int> unmapped;
  for (size_t rank = 0; rank < by_depth.size(); ++rank) {
    const int i = by_depth[rank].second;
    if (rank >= kLeastMeasured && !IsClose(camera_, keyframe.features->keypoints[i])) break;
    if (keyframe.landmark_ids[i] == kNoId) unmapped.push_back(i);
  }
  std::sort(unmapped.begin(), unmapped.end());
  return CreateMeasuredLandmarks(camera_, keyframe_id, unmapped, map);
}

}  // namespace kinemap
