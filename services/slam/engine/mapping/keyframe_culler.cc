// SPDX-License-Identifier: Apache-2.0
#include "mapping/keyframe_culler.h"

namespace kinemap {
namespace {
constexpr double kRedundantRatio = 0.9;
constexpr int kOtherObservers = 3;
constexpr int kMostNeighbors = 100;
}  // namespace

bool KeyframeCuller::IsRedundant(const SlamMap& map, KeyframeId keyframe_id) const {
  const Keyframe& keyframe = map.keyframe(keyframe_id);
  int landmarks = 0, redundant = 0;
  for (size_t i = 0; i < keyframe.landmark_ids.size(); ++i) {
    const Landmark* landmark = map.FindLandmark(keyframe.landmark_ids[i]);
    if (landmark == nullptr || !landmark->IsTrackable()) continue;
    ++landmarks;
    const int octave = keyframe.features->keypoints[i].octave;
    int others = 0;
    for (const auto& [observer_id, keypoint] : landmark->observations) {
      if (observer_id == keyframe_id) continue;
      if (map.keyframe(observer_id).features->keypoints[keypoint].octave <= octave + 1) ++others;
      if (others == kOtherObservers) break;
    }
    if (others == kOtherObservers) ++redundant;
  }
  return landmarks > 0 && redundant > kRedundantRatio * landmarks;
}

int KeyframeCuller::Cull(SlamMap* map, KeyframeId keyframe_id) const {
  int culled = 0;
  for (const KeyframeId neighbor : map->covisibility().Neighbors(keyframe_id, kMostNeighbors)) {
    if (neighbor == map->first_keyframe_id() || !map->keyframe(neighbor).loop_edges.empty()) continue;
    if (!IsRedundant(*map, neighbor)) continue;
    map->CullKeyframe(neighbor);
    ++culled;
  }
  return culled;
}

}  // namespace kinemap
