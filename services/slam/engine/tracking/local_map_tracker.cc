// SPDX-License-Identifier: Apache-2.0
#include "tracking/local_map_tracker.h"

#include <algorithm>
#include <limits>

#include "map/landmark_search.h"
#include "tracking/chance_test.h"

namespace kinemap {
namespace {

constexpr size_t kMostKeyframes = 80;
constexpr int kNeighborsOfEach = 10;
constexpr double kMatchRatio = 0.8;
// Points seen straight as before can be predicted better than points seen from the side.
constexpr double kStraightCosine = 0.998;
constexpr double kStraightRadiusPx = 2.5, kOtherRadiusPx = 4.0;
// With fewer landmarks the pose is worth a second, wider search around it.
constexpr int kFewInliers = 100;
constexpr double kWiderRadiusFactor = 2;
constexpr double kHiddenRadiusPx = 12;

// Whether something that stays out of tracking is in front of what would be seen there: the features around say so.
bool IsHidden(const Eigen::Vector3d& point_in_camera, const CameraModel& camera, const Frame& frame) {
  if (point_in_camera.z() <= 0) return false;
  std::vector<int> nearby;
  frame.features->grid.FindNear(camera.Project(point_in_camera), kHiddenRadiusPx, 0, std::numeric_limits<int>::max(),
                                &nearby);
  const auto tracked =
      std::count_if(nearby.begin(), nearby.end(), [&](int i) { return frame.labels[i].role == FeatureRole::kTracked; });
  return 2 * tracked < static_cast<std::ptrdiff_t>(nearby.size());
}

}  // namespace

std::vector<KeyframeId> LocalMapTracker::LocalKeyframes(const SlamMap& map, const Frame& frame) const {
  std::vector<KeyframeId> votes;
  for (const LandmarkId id : frame.landmark_ids) {
    const Landmark* landmark = map.FindLandmark(id);
    if (landmark == nullptr) continue;
    for (const auto& [keyframe_id, keypoint] : landmark->observations) votes.push_back(keyframe_id);
  }
  std::sort(votes.begin(), votes.end());
  std::vector<std::pair<int, KeyframeId>> ranked;
  for (const KeyframeId keyframe_id : votes) {
    if (ranked.empty() || ranked.back().second != keyframe_id) ranked.emplace_back(0, keyframe_id);
    --ranked.back().first;
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<KeyframeId> local;
  IdSet included;
  for (const auto& [negative_count, keyframe_id] : ranked) {
    if (local.size() == kMostKeyframes) break;
    local.push_back(keyframe_id);
    included.Insert(keyframe_id);
  }
  const size_t observers = local.size();
  for (size_t i = 0; i < observers && local.size() < kMostKeyframes; ++i) {
    // One new neighbour of each observer widens the map a little beyond what the frame already matches.
    for (const KeyframeId neighbor : map.covisibility().Neighbors(local[i], kNeighborsOfEach)) {
      if (!included.Insert(neighbor)) continue;
      local.push_back(neighbor);
      break;
    }
  }
  return local;
}

void LocalMapTracker::SearchLocalLandmarks(SlamMap* map, const std::vector<KeyframeId>& keyframes, double radius_factor,
                                           Searched* searched, Frame* frame) const {
  IdSet seen;
  for (LandmarkId& id : frame->landmark_ids) {
    Landmark* landmark = map->FindLandmark(id);
    id = landmark == nullptr ? kNoId : landmark->id;
    if (landmark == nullptr || !seen.Insert(id)) continue;
    searched->in_view.Insert(id);
    searched->looked_for.Insert(id);
  }
  const Eigen::Vector3d center = frame->camera_from_map.Inverse().translation;
  KeypointSearch search;
  for (const KeyframeId keyframe_id : keyframes) {
    for (const LandmarkId id : map->keyframe(keyframe_id).landmark_ids) {
      Landmark* landmark = map->FindLandmark(id);
      if (landmark == nullptr || !landmark->IsTrackable() || !seen.Insert(landmark->id)) continue;
      const auto view =
          PredictView(*landmark, map->PositionInMap(*landmark), frame->camera_from_map, center, camera_, map->scales());
      if (!view) continue;
      searched->in_view.Insert(landmark->id);
      const double radius = (view->view_cosine > kStraightCosine ? kStraightRadiusPx : kOtherRadiusPx) * radius_factor *
                            camera_.SpreadAt(view->pixel_px);
      const SearchWindow window{view->pixel_px, radius * map->scales().scale(view->octave), view->octave - 1,
                                view->octave + 1};
      const int best = search.FindBest(*frame->features, landmark->descriptor, window, kMaxHammingDistance, kMatchRatio,
                                       [&](int j) { return frame->IsFree(j); });
      if (search.IsAnyNear()) searched->looked_for.Insert(landmark->id);
      if (best >= 0) frame->landmark_ids[best] = landmark->id;
    }
  }
}

bool LocalMapTracker::IsFoundByChance(const SlamMap& map, const Searched& searched, const Frame& frame) const {
  SearchOutcome outcome;
  outcome.looked_for = static_cast<int>(searched.looked_for.size());
  int bits = 0;
  for (int i = 0; i < frame.size(); ++i) {
    const Landmark* landmark = map.FindLandmark(frame.landmark_ids[i]);
    if (landmark == nullptr) continue;
    ++outcome.found;
    bits += HammingDistance(landmark->descriptor, frame.features->descriptors[i]);
  }
  outcome.mean_distance_bits = static_cast<double>(bits) / std::max(outcome.found, 1);
  return IsByChance(outcome);
}

PoseEstimate LocalMapTracker::Track(SlamMap* map, double radius_factor, Frame* frame,
                                    const std::optional<PosePrior>& prior) const {
  const std::vector<KeyframeId> keyframes = LocalKeyframes(*map, *frame);
  if (!keyframes.empty()) frame->reference_keyframe_id = keyframes.front();
  Searched searched;
  SearchLocalLandmarks(map, keyframes, radius_factor, &searched, frame);
  PoseEstimate estimate = solver_.Solve(*map, frame, prior);
  if (estimate.inliers < kFewInliers) {
    SearchLocalLandmarks(map, keyframes, kWiderRadiusFactor * radius_factor, &searched, frame);
    estimate = solver_.Solve(*map, frame, prior);
  }
  if (IsFoundByChance(*map, searched, *frame)) {
    frame->ForgetMatches();
    estimate.inliers = 0;
    return estimate;
  }
  for (const LandmarkId id : frame->landmark_ids) {
    Landmark* landmark = map->FindLandmark(id);
    if (landmark == nullptr) continue;
    ++landmark->found;
    ++landmark->visible;
    searched.in_view.Erase(landmark->id);
  }
  searched.in_view.ForEach([&](LandmarkId id) {
    Landmark* landmark = map->FindLandmark(id);
    if (!IsHidden(frame->camera_from_map * map->PositionInMap(*landmark), camera_, *frame)) ++landmark->visible;
  });
  return estimate;
}

}  // namespace kinemap
