// SPDX-License-Identifier: Apache-2.0
#include "map/depth_error.h"

#include <algorithm>
#include <cmath>

#include "map/reprojection_check.h"

namespace kinemap {

Eigen::Vector3d DepthError(const SlamMap& map, const Landmark& landmark, const Eigen::Vector3d& center,
                           double error_rad) {
  const Eigen::Vector3d point = map.PositionInMap(landmark), seen_from_here = (point - center).normalized();
  Eigen::Vector3d nearest = Eigen::Vector3d::Zero();
  double nearest_cosine = -2, distance = 0;
  for (const auto& [keyframe_id, keypoint] : landmark.observations) {
    const Keyframe& keyframe = map.keyframe(keyframe_id);
    if (!std::isnan(RightXIn(map, keyframe.features->keypoints[keypoint]))) return Eigen::Vector3d::Zero();
    const Eigen::Vector3d ray = point - keyframe.map_from_keyframe.translation;
    const double length = ray.norm(), cosine = ray.dot(seen_from_here) / length;
    if (cosine <= nearest_cosine) continue;
    nearest = ray / length;
    nearest_cosine = cosine;
    distance = length;
  }
  double squared_sine = 0;
  for (const auto& [keyframe_id, keypoint] : landmark.observations) {
    const Eigen::Vector3d ray = point - map.keyframe(keyframe_id).map_from_keyframe.translation;
    squared_sine = std::max(squared_sine, nearest.cross(ray).squaredNorm() / ray.squaredNorm());
  }
  return distance * std::min(1.0, error_rad / std::sqrt(squared_sine)) * nearest;
}

}  // namespace kinemap
