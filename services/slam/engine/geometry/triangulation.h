// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "geometry/rigid_transform.h"

namespace kinemap {

/// Point (in the first camera's frame) that two rays meet in, by the linear method of Hartley and Zisserman, ch. 12.2.
/// `ray_1` and `ray_2` are scaled to z = 1. Not finite when the rays are parallel.
Eigen::Vector3d TriangulateTwoRays(const RigidTransform& second_from_first, const Eigen::Vector3d& ray_1,
                                   const Eigen::Vector3d& ray_2);

/// Cosine of the angle under which the two camera centres are seen from the point; all in one frame.
double ParallaxCosine(const Eigen::Vector3d& point, const Eigen::Vector3d& center_1, const Eigen::Vector3d& center_2);

/// F with pixel_2^T F pixel_1 = 0, for a pair of undistorted cameras with one calibration matrix.
Eigen::Matrix3d FundamentalFromMotion(const RigidTransform& second_from_first, const Eigen::Matrix3d& intrinsics);

}  // namespace kinemap
