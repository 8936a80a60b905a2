// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "features/keypoint.h"
#include "geometry/camera_model.h"
#include "map/slam_map.h"

namespace kinemap {

/// Column in the right image that may constrain poses and landmarks: it is in metres, so it says nothing in a map that
/// is not; not a number: none.
inline double RightXIn(const SlamMap& map, const Keypoint& keypoint) {
  return map.metric_scale() ? keypoint.right_x_px : std::numeric_limits<double>::quiet_NaN();
}

/// Whether a point (camera frame, map units, ahead of the camera) falls where the keypoint is, at the 95 % bound of
/// chi-squared.
inline bool Reprojects(const SlamMap& map, const CameraModel& camera, const Eigen::Vector3d& in_camera,
                       const Keypoint& keypoint) {
  constexpr double kBound = 5.991, kStereoBound = 7.815;  // two and three degrees of freedom
  double squared_px = (camera.Project(in_camera) - keypoint.pixel_px).squaredNorm();
  const double right_x_px = RightXIn(map, keypoint);
  const bool stereo = !std::isnan(right_x_px);
  if (stereo) squared_px += std::pow(camera.RightX(in_camera) - right_x_px, 2);
  return squared_px * keypoint.InverseVariance(map.scales()) <= (stereo ? kStereoBound : kBound);
}

}  // namespace kinemap
