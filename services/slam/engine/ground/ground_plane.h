// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace kinemap {

/// The road as a plane in a camera's frame: normal.dot(point) = height for the points on it.
struct GroundPlane {
  Eigen::Vector3d normal{0, 1, 0};  ///< unit length, from the camera down to the road
  double height = 0;                ///< of the camera above it, in the units of the camera's pose
};

}  // namespace kinemap
