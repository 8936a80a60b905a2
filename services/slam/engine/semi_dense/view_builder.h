// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "geometry/camera_model.h"
#include "semi_dense/keyframe_view.h"

namespace kinemap {

/// Turns images as they came into undistorted views with gradients.
class ViewBuilder {
 public:
  explicit ViewBuilder(const CameraModel& camera);

  /// Replaces `view`'s raw image and labels by undistorted ones of the same size, and fills in the gradient.
  void Complete(KeyframeView* view) const;

  /// Fills in the gradient of a view that is undistorted already.
  static void AddGradient(KeyframeView* view);

 private:
  cv::Mat map_x_, map_y_;  // raw pixel of each undistorted one; empty when there is no distortion
};

}  // namespace kinemap
