// SPDX-License-Identifier: Apache-2.0
#include "loop_closing/place_fuser.h"

#include <vector>

#include "map/lasting.h"

namespace kinemap {
namespace {

constexpr int kMatchedNeighbors = 10, kKeyframeNeighbors = 20;
constexpr double kRadiusPx = 4.0;

/// The landmark is what this keypoint shows, whatever the map said before.
void Join(SlamMap* map, KeyframeId keyframe_id, const LandmarkMatch& match) {
  Landmark* landmark = map->FindLandmark(match.landmark_id);
  if (landmark == nullptr || landmark->observations.count(keyframe_id) > 0) return;
  Landmark* own = map->FindLandmark(map->keyframe(keyframe_id).landmark_ids[match.keypoint]);
  if (own == nullptr) {
    map->Observe(landmark, keyframe_id, match.keypoint);
  } else if (own != landmark && IsLasting(*own)) {
    map->FuseLandmarks(own->id, landmark->id);
  }
}

std::vector<KeyframeId> Around(const SlamMap& map, KeyframeId keyframe_id, int neighbors) {
  std::vector<KeyframeId> keyframes = map.covisibility().Neighbors(keyframe_id, neighbors);
  keyframes.insert(keyframes.begin(), keyframe_id);
  return keyframes;
}

}  // namespace

void PlaceFuser::Fuse(SlamMap* map, const VerifiedLoop& loop) const {
  // Either may have been culled since; its parent stands in the same place.
  const KeyframeId keyframe_id = map->LiveKeyframe(loop.keyframe_id);
  const KeyframeId matched_id = map->LiveKeyframe(loop.matched_id);
  const std::vector<KeyframeId> near_matched = Around(*map, matched_id, kMatchedNeighbors);
  const std::vector<KeyframeId> near_keyframe = Around(*map, keyframe_id, kKeyframeNeighbors);
  const std::vector<LandmarkId> landmarks = LastingLandmarks(*map, near_matched);
  if (keyframe_id == loop.keyframe_id) {
    for (const LandmarkMatch& match : loop.matches) Join(map, keyframe_id, match);
  }
  for (const KeyframeId target_id : near_keyframe) {
    const Keyframe& target = map->keyframe(target_id);
    for (const LandmarkMatch& match : MatchByProjection(*map, landmarks, camera_, target.map_from_keyframe.Inverse(),
                                                        target, kRadiusPx, kStrictHammingDistance)) {
      Join(map, target_id, match);
    }
  }
  for (const LandmarkId id : landmarks) {
    Landmark* landmark = map->FindLandmark(id);
    if (landmark == nullptr) continue;
    map->UpdateDescriptor(landmark);
    map->UpdateViewRange(landmark);
  }
  for (const KeyframeId id : near_keyframe) map->UpdateCovisibility(id);
  if (keyframe_id != matched_id) map->AddLoopEdge(keyframe_id, matched_id);
}

}  // namespace kinemap
