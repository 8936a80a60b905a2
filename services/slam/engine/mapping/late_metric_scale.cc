// SPDX-License-Identifier: Apache-2.0
#include "mapping/late_metric_scale.h"

#include <algorithm>
#include <vector>

namespace kinemap {
namespace {
constexpr size_t kLeastLandmarks = 30;
}

void LateMetricScale::Look(const SlamMap& map, KeyframeId keyframe_id) {
  if (map.map_id() != state_.map_id) state_.metres_per_unit.clear();
  state_.map_id = map.map_id();
  const Keyframe& keyframe = map.keyframe(keyframe_id);
  const RigidTransform keyframe_from_map = keyframe.map_from_keyframe.Inverse();
  for (size_t i = 0; i < keyframe.landmark_ids.size(); ++i) {
    const Landmark* landmark = map.FindLandmark(keyframe.landmark_ids[i]);
    const double measured_m = keyframe.features->keypoints[i].depth_m;
    if (landmark == nullptr || !landmark->IsTrackable() || measured_m <= 0) continue;
    const double mapped = (keyframe_from_map * map.PositionInMap(*landmark)).z();
    if (mapped > 0) state_.metres_per_unit[landmark->id] = measured_m / mapped;
  }
}

bool LateMetricScale::IsFound() const { return state_.metres_per_unit.size() >= kLeastLandmarks; }

double LateMetricScale::Apply(SlamMap* map) {
  std::vector<double> ratios;
  for (const auto& [id, ratio] : state_.metres_per_unit) ratios.push_back(ratio);
  std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
  const double scale = ratios[ratios.size() / 2];
  state_.metres_per_unit.clear();
  const Eigen::Vector3d origin = map->keyframe(map->first_keyframe_id()).map_from_keyframe.translation;
  const SimilarityTransform metric_from_map(Eigen::Quaterniond::Identity(), (1 - scale) * origin, scale);
  for (const KeyframeId id : map->LiveKeyframes()) map->SetKeyframePose(id, metric_from_map * map->MapFromAnchor(id));
  for (const LandmarkId id : map->LiveLandmarks()) map->UpdateViewRange(map->FindLandmark(id));
  map->set_metric_scale(true);
  return scale;
}

}  // namespace kinemap
