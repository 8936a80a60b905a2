// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace kinemap {

struct Keypoint {
  Eigen::Vector2d pixel_px;  ///< in the undistorted image
  Eigen::Vector2d raw_px;    ///< in the image as it came; masks and depth are looked up here
  float angle_deg = 0;       ///< direction of the patch's intensity centroid, [0, 360)
  int octave = 0;            ///< pyramid level
};

}  // namespace kinemap
