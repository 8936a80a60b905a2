// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>

#include "features/pyramid_scales.h"

namespace kinemap {

struct Keypoint {
  Eigen::Vector2d pixel_px;  ///< in the undistorted image
  Eigen::Vector2d raw_px;    ///< in the image as it came; masks and depth are looked up here
  float angle_deg = 0;       ///< direction of the patch's intensity centroid, [0, 360)
  int octave = 0;            ///< pyramid level
  /// Column of the same point in the undistorted right image, or where it would be at the depth measured by a depth
  /// camera; not a number: unknown.
  double right_x_px = std::numeric_limits<double>::quiet_NaN();
  double spread = 1;   ///< what a pixel of the raw image is in the undistorted one here
  double depth_m = 0;  ///< along the optical axis, by stereo or the depth image; 0: unknown

  /// 1 / px^2 in the undistorted image.
  double InverseVariance(const PyramidScales& scales) const {
    return scales.inverse_variance(octave) / (spread * spread);
  }
  bool HasDepth() const { return depth_m > 0; }
};

}  // namespace kinemap
