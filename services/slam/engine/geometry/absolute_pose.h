// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "geometry/camera_model.h"
#include "geometry/random_engine.h"
#include "geometry/rigid_transform.h"

namespace kinemap {

struct AbsolutePoseOptions {
  int iterations = 300;       ///< at most; fewer once `confidence` is reached
  double confidence = 0.999;  ///< of having drawn three right matches at least once
  int least_inliers = 10;
};

/// A known point and where a camera sees it.
struct PointSight {
  Eigen::Vector3d point_in_map;
  Eigen::Vector2d pixel_px;
  double max_error_px;  ///< of a right match
};

struct AbsolutePose {
  RigidTransform camera_from_map;
  std::vector<bool> inlier;  ///< one a sight
  int inliers = 0;
};

/// Pose of a camera that sees known points, some of them mistaken: RANSAC (Fischler and Bolles 1981) on three points
/// (AP3P: Ke and Roumeliotis 2017). Nothing when no pose explains `least_inliers` sights.
std::optional<AbsolutePose> EstimateAbsolutePose(const std::vector<PointSight>& sights, const CameraModel& camera,
                                                 const AbsolutePoseOptions& options, RandomEngine* random);

}  // namespace kinemap
