// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/camera_model.h"
#include "geometry/rigid_transform.h"
#include "geometry/two_view_ransac.h"

namespace kinemap {

/// Camera motion and structure from a two-view model; translation has unit length.
struct TwoViewMotion {
  RigidTransform second_from_first;
  std::vector<Eigen::Vector3d> points_in_first;  ///< one a pair; valid where `triangulated`
  std::vector<bool> triangulated;                ///< in front of both cameras, small error, enough parallax
  int in_front = 0;                              ///< pairs that agree with the motion, distant ones included
  double parallax_deg = 0;                       ///< what all but 50 of the points stay below
};

/// Candidate motions of a model, in the order of their support (most first).
std::vector<TwoViewMotion> MotionsFromHomography(const TwoViewModel& model, const std::vector<PixelPair>& pairs,
                                                 const CameraModel& camera, double sigma_px);
std::vector<TwoViewMotion> MotionsFromFundamental(const TwoViewModel& model, const std::vector<PixelPair>& pairs,
                                                  const CameraModel& camera, double sigma_px);

}  // namespace kinemap
