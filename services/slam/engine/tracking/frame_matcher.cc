// SPDX-License-Identifier: Apache-2.0
#include "tracking/frame_matcher.h"

#include "features/brute_force_matcher.h"
#include "features/rotation_consistency.h"
#include "map/landmark_search.h"

namespace kinemap {

int MatchLastFrame(const SlamMap& map, const CameraModel& camera, const Frame& last, double radius_px, Frame* current) {
  current->ForgetMatches();
  KeypointSearch search;
  RotationConsistency rotation;
  int matches = 0;
  for (int i = 0; i < last.size(); ++i) {
    const Landmark* landmark = map.FindLandmark(last.landmark_ids[i]);
    if (landmark == nullptr || !landmark->IsTrackable()) continue;
    const Eigen::Vector3d in_camera = current->camera_from_map * map.PositionInMap(*landmark);
    if (in_camera.z() <= 0) continue;
    const Eigen::Vector2d pixel = camera.Project(in_camera);
    if (!camera.Contains(pixel)) continue;
    const int octave = last.features->keypoints[i].octave;
    const double radius = radius_px * map.scales().scale(octave) * camera.SpreadAt(pixel);
    const SearchWindow window{pixel, radius, octave - 1, octave + 1};
    const int best = search.FindBest(*current->features, landmark->descriptor, window, kMaxHammingDistance, 1.0,
                                     [&](int j) { return current->IsFree(j); });
    if (best < 0) continue;
    current->landmark_ids[best] = landmark->id;
    rotation.Add(best, last.features->keypoints[i].angle_deg, current->features->keypoints[best].angle_deg);
    ++matches;
  }
  for (const int j : rotation.Inconsistent()) {
    current->landmark_ids[j] = kNoId;
    --matches;
  }
  return matches;
}

int MatchKeyframe(const SlamMap& map, KeyframeId keyframe_id, double ratio, Frame* frame) {
  frame->ForgetMatches();
  const Keyframe& keyframe = map.keyframe(keyframe_id);
  std::vector<int> query, train;
  for (int i = 0; i < keyframe.features->size(); ++i) {
    const Landmark* landmark = map.FindLandmark(keyframe.landmark_ids[i]);
    if (landmark != nullptr && landmark->IsTrackable()) query.push_back(i);
  }
  for (int j = 0; j < frame->size(); ++j) {
    if (frame->IsFree(j)) train.push_back(j);
  }
  const std::vector<FeatureMatch> matches =
      MatchByDescriptor(*keyframe.features, query, *frame->features, train, ratio);
  for (const FeatureMatch& match : matches) frame->landmark_ids[match.train] = keyframe.landmark_ids[match.query];
  return static_cast<int>(matches.size());
}

int ProjectKeyframe(const SlamMap& map, const CameraModel& camera, KeyframeId keyframe_id, double radius_px,
                    int max_distance, Frame* frame) {
  const IdSet already = frame->MatchedLandmarks();
  const Eigen::Vector3d center = frame->camera_from_map.Inverse().translation;
  KeypointSearch search;
  int added = 0;
  for (const LandmarkId id : map.keyframe(keyframe_id).landmark_ids) {
    const Landmark* landmark = map.FindLandmark(id);
    if (landmark == nullptr || !landmark->IsTrackable() || already.Contains(landmark->id)) continue;
    const auto view =
        PredictView(*landmark, map.PositionInMap(*landmark), frame->camera_from_map, center, camera, map.scales());
    if (!view) continue;
    const double radius = radius_px * map.scales().scale(view->octave) * camera.SpreadAt(view->pixel_px);
    const SearchWindow window{view->pixel_px, radius, view->octave - 1, view->octave + 1};
    const int best = search.FindBest(*frame->features, landmark->descriptor, window, max_distance, 1.0,
                                     [&](int j) { return frame->IsFree(j); });
    if (best < 0) continue;
    frame->landmark_ids[best] = landmark->id;
    ++added;
  }
  return added;
}

}  // namespace kinemap
