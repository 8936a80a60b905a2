// SPDX-License-Identifier: Apache-2.0
#include "map/lasting.h"

#include <algorithm>

namespace kinemap {

std::vector<LandmarkId> LastingLandmarks(const SlamMap& map, const std::vector<KeyframeId>& keyframes) {
  std::vector<LandmarkId> landmarks;
  for (const KeyframeId keyframe_id : keyframes) {
    for (const LandmarkId id : map.keyframe(keyframe_id).landmark_ids) {
      const Landmark* landmark = map.FindLandmark(id);
      if (landmark != nullptr && IsLasting(*landmark)) landmarks.push_back(landmark->id);
    }
  }
  std::sort(landmarks.begin(), landmarks.end());
  landmarks.erase(std::unique(landmarks.begin(), landmarks.end()), landmarks.end());
  return landmarks;
}

}  // namespace kinemap
