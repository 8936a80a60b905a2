// SPDX-License-Identifier: Apache-2.0
#include "mapping/landmark_fuser.h"

#include <algorithm>
#include <set>

#include "map/landmark_search.h"
#include "map/reprojection_check.h"

namespace kinemap {
namespace {

constexpr double kRadiusPx = 3.0;

std::vector<LandmarkId> LandmarksSeenBy(const SlamMap& map, const std::vector<KeyframeId>& keyframes) {
  std::vector<LandmarkId> seen;
  for (const KeyframeId keyframe_id : keyframes) {
    for (const LandmarkId id : map.keyframe(keyframe_id).landmark_ids) {
      if (id != kNoId) seen.push_back(id);
    }
  }
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return seen;
}

}  // namespace

std::vector<KeyframeId> LandmarkFuser::Targets(const SlamMap& map, KeyframeId keyframe_id) const {
  std::set<KeyframeId> targets;
  for (const KeyframeId neighbor : map.covisibility().Neighbors(keyframe_id, options_.neighbors)) {
    targets.insert(neighbor);
    for (const KeyframeId second : map.covisibility().Neighbors(neighbor, options_.second_neighbors)) {
      if (second != keyframe_id) targets.insert(second);
    }
  }
  return {targets.begin(), targets.end()};
}

void LandmarkFuser::FuseInto(SlamMap* map, KeyframeId target_id, const std::vector<LandmarkId>& landmarks) const {
  const Keyframe& target = map->keyframe(target_id);
  const RigidTransform target_from_map = target.map_from_keyframe.Inverse();
  const PyramidScales& scales = map->scales();
  KeypointSearch search;
  for (const LandmarkId id : landmarks) {
    Landmark* landmark = map->FindLandmark(id);
    if (landmark == nullptr || landmark->observations.empty() || landmark->observations.count(target_id) > 0) continue;
    const Eigen::Vector3d in_map = map->PositionInMap(*landmark);
    const auto view =
        PredictView(*landmark, in_map, target_from_map, target.map_from_keyframe.translation, camera_, scales);
    if (!view) continue;
    const Eigen::Vector3d in_target = target_from_map * in_map;
    const double radius = kRadiusPx * scales.scale(view->octave) * camera_.SpreadAt(view->pixel_px);
    const SearchWindow window{view->pixel_px, radius, view->octave - 1, view->octave};
    const int best =
        search.FindBest(*target.features, landmark->descriptor, window, kStrictHammingDistance, 1.0, [&](int j) {
          return landmark->IsCompatibleWith(target.labels[j]) &&
                 Reprojects(*map, camera_, in_target, target.features->keypoints[j]);
        });
    if (best < 0) continue;
    Landmark* other = map->FindLandmark(target.landmark_ids[best]);
    if (other == nullptr) {
      map->Observe(landmark, target_id, best);
    } else if (other->IsTrackable() == landmark->IsTrackable()) {
      const bool other_stays = other->observations.size() > landmark->observations.size();
      map->FuseLandmarks(other_stays ? landmark->id : other->id, other_stays ? other->id : landmark->id);
    }
  }
}

void LandmarkFuser::Fuse(SlamMap* map, KeyframeId keyframe_id) const {
  const std::vector<KeyframeId> targets = Targets(*map, keyframe_id);
  const Keyframe& keyframe = map->keyframe(keyframe_id);
  const std::vector<LandmarkId> own = LandmarksSeenBy(*map, {keyframe_id});
  for (const KeyframeId target : targets) FuseInto(map, target, own);
  FuseInto(map, keyframe_id, LandmarksSeenBy(*map, targets));
  for (const LandmarkId id : keyframe.landmark_ids) {
    Landmark* landmark = map->FindLandmark(id);
    if (landmark == nullptr) continue;
    map->UpdateDescriptor(landmark);
    map->UpdateViewRange(landmark);
  }
  map->UpdateCovisibility(keyframe_id);
}

}  // namespace kinemap
