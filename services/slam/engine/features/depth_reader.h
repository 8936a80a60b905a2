// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "features/frame_features.h"
#include "geometry/camera_model.h"

namespace kinemap {

/// Reads a depth camera's image at the keypoints. Corners like to lie on the outlines of things, where a pixel more or
/// less decides between near and far: there it reads nothing.
class DepthReader {
 public:
  /// The camera needs a baseline: that of a pair which would measure depth about as well.
  explicit DepthReader(const CameraModel& camera) : camera_(camera) {}

  /// Depth along the optical axis in metres at a pixel of the image as it came; 0 where it is unknown or ambiguous.
  /// `depth_m` is CV_32F, 0 or not a number where unknown.
  double DepthAt(const cv::Mat& depth_m, const Eigen::Vector2d& raw_px) const;

  /// Fills right_x_px and depth_m of the keypoints that have no depth yet. Returns how many.
  int Read(const cv::Mat& depth_m, FrameFeatures* features) const;

 private:
  double DisparityAt(const cv::Mat& depth_m, int column, int row) const;

  CameraModel camera_;
};

}  // namespace kinemap
