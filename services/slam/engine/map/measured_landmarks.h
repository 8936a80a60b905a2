// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera_model.h"
#include "map/slam_map.h"

namespace kinemap {

/// Depth, in baselines, up to which one look says well enough where a point is (Mur-Artal and Tardos 2017, section
/// III-A).
constexpr double kCloseBaselines = 40;

/// Whether stereo or the depth image measured this keypoint, and near enough to trust it alone.
inline bool IsClose(const CameraModel& camera, const Keypoint& keypoint) {
  return keypoint.HasDepth() && keypoint.depth_m < kCloseBaselines * camera.baseline_m();
}

/// Makes a landmark of each of these keypoints, where its measured depth puts it, observed by this one keyframe. The
/// map must be metric. Returns their ids.
std::vector<LandmarkId> CreateMeasuredLandmarks(const CameraModel& camera, KeyframeId keyframe_id,
                                                const std::vector<int>& keypoints, SlamMap* map);

}  // namespace kinemap
