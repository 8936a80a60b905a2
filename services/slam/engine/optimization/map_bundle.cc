// SPDX-License-Identifier: Apache-2.0
#include "optimization/map_bundle.h"

#include <algorithm>
#include <map>
#include <vector>

#include "map/reprojection_check.h"
#include "optimization/velocity_changes.h"

namespace kinemap {

BundleProblem CopyBundleProblem(const SlamMap& map, const std::set<KeyframeId>& moving) {
  std::vector<LandmarkId> landmarks;
  for (const KeyframeId id : moving) {
    for (const LandmarkId landmark_id : map.keyframe(id).landmark_ids) {
      const Landmark* landmark = map.FindLandmark(landmark_id);
      if (landmark != nullptr && landmark->IsTrackable()) landmarks.push_back(landmark->id);
    }
  }
  std::sort(landmarks.begin(), landmarks.end());
  landmarks.erase(std::unique(landmarks.begin(), landmarks.end()), landmarks.end());
  BundleProblem problem;
  std::map<KeyframeId, int> camera_of;
  const auto camera_index = [&](KeyframeId id) {
    const auto [entry, is_new] = camera_of.try_emplace(id, static_cast<int>(problem.cameras.size()));
    if (is_new) {
      const bool fixed = moving.count(id) == 0 || id == map.first_keyframe_id();
      problem.cameras.push_back({id, map.keyframe(id).map_from_keyframe.Inverse(), fixed});
    }
    return entry->second;
  };
  for (const KeyframeId id : moving) camera_index(id);
  for (const LandmarkId id : landmarks) {
    const Landmark& landmark = *map.FindLandmark(id);
    const int point = static_cast<int>(problem.points.size());
    problem.points.push_back({id, map.PositionInMap(landmark)});
    for (const auto& [observer_id, keypoint_index] : landmark.observations) {
      const Keypoint& keypoint = map.keyframe(observer_id).features->keypoints[keypoint_index];
      problem.observations.push_back({camera_index(observer_id), point, keypoint.pixel_px,
                                      keypoint.InverseVariance(map.scales()), RightXIn(map, keypoint)});
    }
  }
  problem.velocity_changes = VelocityChanges(map, problem);
  return problem;
}

void WriteBackBundle(const BundleProblem& solved, SlamMap* map) {
  for (const BundleCamera& camera : solved.cameras) {
    if (camera.fixed || map->keyframe(camera.keyframe_id).culled) continue;
    map->SetKeyframePose(camera.keyframe_id, camera.camera_from_map.Inverse());
  }
  for (const BundlePoint& point : solved.points) {
    Landmark* landmark = map->FindLandmark(point.landmark_id);
    if (landmark == nullptr || landmark->id != point.landmark_id) continue;
    map->SetPositionInMap(landmark, point.position_in_map);
    map->UpdateViewRange(landmark);
  }
  for (const BundleObservation& observation : solved.observations) {
    if (!observation.outlier) continue;
    Landmark* landmark = map->FindLandmark(solved.points[observation.point].landmark_id);
    if (landmark != nullptr) map->EraseObservation(landmark, solved.cameras[observation.camera].keyframe_id);
  }
}

}  // namespace kinemap
