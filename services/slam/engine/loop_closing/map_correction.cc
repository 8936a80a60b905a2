// SPDX-License-Identifier: Apache-2.0
#include "loop_closing/map_correction.h"

#include <set>

namespace kinemap {
namespace {

constexpr int kMostNeighbors = 1000;

/// The corrections with one for each live keyframe that has none; `elder` is its stand-in where it shares nothing.
Corrections Completed(const Corrections& corrections, const SlamMap& map) {
  Corrections complete = corrections;
  KeyframeId elder = map.first_keyframe_id();
  for (const KeyframeId id : map.LiveKeyframes()) {
    if (complete.count(id) == 0) {
      KeyframeId leader = elder;
      for (const KeyframeId neighbor : map.covisibility().Neighbors(id, kMostNeighbors)) {
        if (complete.count(neighbor) == 0) continue;
        leader = neighbor;
        break;
      }
      const auto found = complete.find(leader);
      complete[id] = found == complete.end() ? SimilarityTransform() : found->second;
    }
    elder = id;
  }
  return complete;
}

}  // namespace

void ApplyCorrections(const Corrections& corrections, SlamMap* map) {
  const Corrections complete = Completed(corrections, *map);
  for (const KeyframeId id : map->LiveKeyframes()) map->SetKeyframePose(id, complete.at(id) * map->MapFromAnchor(id));
  for (const LandmarkId id : map->LiveLandmarks()) map->UpdateViewRange(map->FindLandmark(id));
}

void ApplyAdjustment(const BundleProblem& solved, SlamMap* map) {
  Corrections corrections;
  for (const BundleCamera& camera : solved.cameras) {
    if (map->keyframe(camera.keyframe_id).culled) continue;
    const RigidTransform moved =
        camera.fixed ? map->MapFromKeyframe(camera.keyframe_id) : camera.camera_from_map.Inverse();
    corrections[camera.keyframe_id] = SimilarityTransform(moved * map->MapFromKeyframe(camera.keyframe_id).Inverse());
  }
  const Corrections complete = Completed(corrections, *map);
  std::set<LandmarkId> new_landmarks;
  for (const KeyframeId id : map->LiveKeyframes()) {
    if (corrections.count(id) > 0) continue;
    map->SetKeyframePose(id, complete.at(id) * map->MapFromAnchor(id));
    for (const LandmarkId landmark_id : map->keyframe(id).landmark_ids) {
      const Landmark* landmark = map->FindLandmark(landmark_id);
      if (landmark != nullptr) new_landmarks.insert(landmark->id);
    }
  }
  WriteBackBundle(solved, map);
  for (const LandmarkId id : new_landmarks) {
    Landmark* landmark = map->FindLandmark(id);
    if (landmark != nullptr) map->UpdateViewRange(landmark);
  }
}

}  // namespace kinemap
